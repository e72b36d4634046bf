//! Faults in the log: a line when one comes and when it goes, a count when it flutters.

use crate::fault::{ActiveFault, FaultKind};
use crate::time::Time;

/// Lines about one kind of fault in one window; what comes beyond them is counted.
const LINES: u32 = 4;

/// The window, s.
const WINDOW_S: f64 = 30.0;

/// What is to be said about a fault.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Line {
    /// It came; it had come and gone `unsaid` times since the last line about it.
    Came {
        /// The fault.
        fault: ActiveFault,
        /// Times it came and went in between, unsaid.
        unsaid: u32,
    },
    /// It is over.
    Went {
        /// The fault's kind.
        kind: FaultKind,
        /// How long it was there, s.
        after_s: f64,
    },
}

#[derive(Clone, Copy, Debug)]
struct Entry {
    fault: ActiveFault,
    active: bool,
    /// What the log says now.
    said_active: bool,
    window_start: Time,
    lines: u32,
    /// Times it came since the log last said so.
    comings: u32,
}

/// Which faults the log has spoken of. Grows with the kinds of fault that were ever seen, which the
/// number of sensors bounds.
#[derive(Clone, Debug, Default)]
pub struct FaultLog {
    entries: Vec<Entry>,
}

impl FaultLog {
    /// Compares `faults` at `now` with what was said and calls `say` for each line that is due.
    pub fn update(&mut self, faults: &[ActiveFault], now: Time, mut say: impl FnMut(Line)) {
        for fault in faults {
            match self.entries.iter_mut().find(|e| e.fault.kind == fault.kind) {
                Some(entry) => {
                    if !entry.active {
                        entry.active = true;
                        entry.comings = entry.comings.saturating_add(1);
                    }
                    entry.fault = *fault;
                }
                None => self.entries.push(Entry {
                    fault: *fault,
                    active: true,
                    said_active: false,
                    window_start: now,
                    lines: 0,
                    comings: 1,
                }),
            }
        }
        for entry in &mut self.entries {
            entry.active &= faults.iter().any(|f| f.kind == entry.fault.kind);
            if now.since(entry.window_start) >= WINDOW_S {
                entry.window_start = now;
                entry.lines = 0;
            }
            let unsaid = if entry.active { entry.comings > 0 } else { entry.said_active };
            if !unsaid || entry.lines >= LINES {
                continue;
            }
            if entry.active {
                say(Line::Came { fault: entry.fault, unsaid: entry.comings - 1 });
                entry.comings = 0;
            } else {
                say(Line::Went { kind: entry.fault.kind, after_s: now.since(entry.fault.since) });
            }
            entry.said_active = entry.active;
            entry.lines += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fault::Evidence;

    fn stale(since: f64) -> ActiveFault {
        let evidence = Evidence::Limit { value: 1.0, limit: 0.5, unit: "s" };
        ActiveFault { kind: FaultKind::Stale, since: Time::from_secs_f64(since), evidence }
    }

    #[test]
    fn comes_once_and_goes_once_however_long_it_lasts() {
        let (mut log, mut lines) = (FaultLog::default(), Vec::new());
        for i in 0..1000 {
            let now = f64::from(i) * 0.02;
            let faults = if (1.0..15.0).contains(&now) { vec![stale(1.0)] } else { vec![] };
            log.update(&faults, Time::from_secs_f64(now), |l| lines.push(l));
        }
        assert_eq!(lines.len(), 2, "{lines:?}");
        assert!(matches!(lines[0], Line::Came { unsaid: 0, .. }));
        assert!(matches!(lines[1], Line::Went { .. }));
    }

    #[test]
    fn fluttering_is_counted() {
        let (mut log, mut lines) = (FaultLog::default(), Vec::new());
        for i in 0..3000 {
            let now = f64::from(i) * 0.02;
            let faults = if i % 20 < 10 { vec![stale(now)] } else { vec![] };
            log.update(&faults, Time::from_secs_f64(now), |l| lines.push(l));
        }
        assert!(lines.len() <= 8, "60 s, 150 flutters: {}", lines.len());
        assert!(lines.iter().any(|l| matches!(l, Line::Came { unsaid: 10.., .. })));
    }
}
