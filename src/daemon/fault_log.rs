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
        /// How long it was there the last time, s.
        after_s: f64,
        /// Times it came and went in between, unsaid.
        unsaid: u32,
    },
}

#[derive(Clone, Copy, Debug)]
struct Entry {
    fault: ActiveFault,
    active: bool,
    /// What the log says now.
    said_active: bool,
    /// When it was there last.
    seen: Time,
    /// Times it came since the last line.
    came: u32,
    window_start: Time,
    lines: u32,
}

/// Which faults the log has spoken of.
#[derive(Clone, Debug)]
pub struct FaultLog {
    entries: Vec<Entry>,
}

impl FaultLog {
    /// With room for so many kinds of fault.
    pub fn with_capacity(kinds: usize) -> Self {
        Self { entries: Vec::with_capacity(kinds) }
    }

    /// Compares `faults` at `now` with what was said and calls `say` for each line that is due.
    pub fn update(&mut self, faults: &[ActiveFault], now: Time, mut say: impl FnMut(Line)) {
        for fault in faults {
            if !self.entries.iter().any(|e| e.fault.kind == fault.kind) {
                self.entries.push(Entry {
                    fault: *fault,
                    active: false,
                    said_active: false,
                    seen: now,
                    came: 0,
                    window_start: now,
                    lines: 0,
                });
            }
        }
        for entry in &mut self.entries {
            let fault = faults.iter().find(|f| f.kind == entry.fault.kind);
            if let Some(fault) = fault {
                entry.came += u32::from(!entry.active);
                entry.fault = *fault;
                entry.seen = now;
            }
            entry.active = fault.is_some();
            if now.since(entry.window_start) >= WINDOW_S {
                entry.window_start = now;
                entry.lines = 0;
            }
            if (entry.active == entry.said_active && entry.came == 0) || entry.lines >= LINES {
                continue;
            }
            say(match (entry.active, entry.said_active) {
                // What the log spoke of last has gone too.
                (true, true) => Line::Came { fault: entry.fault, unsaid: entry.came },
                (true, false) => Line::Came { fault: entry.fault, unsaid: entry.came - 1 },
                (false, _) => Line::Went {
                    kind: entry.fault.kind,
                    after_s: entry.seen.since(entry.fault.since),
                    unsaid: entry.came,
                },
            });
            entry.said_active = entry.active;
            entry.lines += 1;
            entry.came = 0;
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
        let (mut log, mut lines) = (FaultLog::with_capacity(1), Vec::new());
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
        let (mut log, mut lines) = (FaultLog::with_capacity(1), Vec::new());
        for i in 0..3000 {
            let now = f64::from(i) * 0.02;
            let faults = if i % 20 < 10 { vec![stale(now)] } else { vec![] };
            log.update(&faults, Time::from_secs_f64(now), |l| lines.push(l));
        }
        assert!(lines.len() <= 8, "60 s, 150 flutters: {}", lines.len());
        let told: u32 = lines
            .iter()
            .map(|l| match l {
                Line::Came { unsaid, .. } => unsaid + 1,
                Line::Went { unsaid, .. } => *unsaid,
            })
            .sum();
        // What came after the last line is told when its time has come.
        assert!((70..=150).contains(&told), "{told} of 150: {lines:?}");
        log.update(&[], Time::from_secs_f64(100.0), |l| lines.push(l));
        assert!(matches!(lines.last(), Some(Line::Went { unsaid: 60.., .. })), "{lines:?}");
    }
}
