//! The autopilot's clock beside ours. Pure.
//!
//! A stamp on its clock and the moment of arrival on ours differ by an offset and the time on the way. Of all that
//! arrive, the quickest tell the offset best; but only a question with its answer (TIMESYNC) tells the two apart.

use crate::time::Time;

/// The minimum is over this time and as much again, s: crystals differ by 0.1 ms a second at most.
const WINDOW_S: f64 = 10.0;
/// How far two clocks drift apart at most, as a share.
const DRIFT: f64 = 1e-4;
/// Answers that are kept.
const KEPT: usize = 16;
/// An answer that took longer tells nothing, s.
const SLOWEST_S: f64 = 1.0;
/// A clock that goes back by more has been set, or the autopilot was started again, ns.
const BACK_NS: i64 = 1_000_000_000;
/// A stamp so far ahead of what can be was made by a clock that has been set, ns.
const AHEAD_NS: i64 = 250_000_000;
/// A count of milliseconds in 32 bits begins anew after this, ns.
const WRAP_NS: i64 = (1 << 32) * 1_000_000;

/// An answer: ours less theirs, and half of the time it took, ns.
#[derive(Clone, Copy, Debug)]
struct Answer {
    offset: i64,
    half: i64,
    at: Time,
}

/// What is known of a clock.
#[derive(Clone, Debug, Default)]
pub struct Clock {
    newest: Option<i64>,
    /// The least of arrival less stamp, ns: now, and in the window before.
    least: [Option<i64>; 2],
    since: Time,
    answers: [Option<Answer>; KEPT],
    next: usize,
    /// A message that speaks of another clock: its offset and stamp.
    suspect: Option<(i64, i64)>,
}

fn nanos(time: Time) -> i64 {
    i64::try_from(time.as_nanos()).unwrap_or(i64::MAX)
}

impl Clock {
    /// The stamp of a count of milliseconds that begins anew every 49.7 days, in the middle of its millisecond, ns.
    pub fn of_millis(&self, ms: u32) -> i64 {
        let newest = self.newest.unwrap_or(0).max(0) / 1_000_000;
        let ahead = ms.wrapping_sub(newest as u32) as i32;
        let unwrapped = if self.newest.is_some() { newest.saturating_add(i64::from(ahead)) } else { i64::from(ms) };
        // What goes back by days is a count that has begun anew, not one from before the beginning.
        (if unwrapped < 0 { i64::from(ms) } else { unwrapped }).saturating_mul(1_000_000).saturating_add(500_000)
    }

    /// Takes in that something stamped `sent` (ns) has arrived; `true` when that clock has turned out to be another
    /// than before, as after a start of the autopilot. One stamp that does not fit is passed over.
    pub fn arrived(&mut self, now: Time, sent: i64) -> bool {
        let offset = nanos(now).saturating_sub(sent);
        let (Some(newest), Some(known)) = (self.newest, self.offset(now)) else {
            self.begin(now, sent);
            return false;
        };
        if sent < newest.saturating_sub(BACK_NS) || offset < known.saturating_sub(AHEAD_NS) {
            let again = |(o, s): (i64, i64)| sent > s && offset.abs_diff(o) < AHEAD_NS.unsigned_abs();
            if self.suspect.replace((offset, sent)).is_some_and(again) {
                self.begin(now, sent);
                return true;
            }
            return false;
        }
        self.suspect = None;
        self.newest = Some(newest.max(sent));
        if now.since(self.since) > WINDOW_S {
            self.least = [None, self.least[0]];
            self.since = now;
        }
        self.least[0] = Some(self.least[0].map_or(offset, |least| least.min(offset)));
        false
    }

    fn begin(&mut self, now: Time, sent: i64) {
        let least = [Some(nanos(now).saturating_sub(sent)), None];
        *self = Self { newest: Some(sent), least, since: now, ..Self::default() };
    }

    /// Takes in that a question sent at `asked` was answered with `theirs` (ns), which arrived at `now`.
    pub fn answered(&mut self, asked: Time, theirs: i64, now: Time) {
        let (rtt_s, Some(most)) = (now.since(asked), self.least()) else { return };
        if !(0.0..=SLOWEST_S).contains(&rtt_s) {
            return;
        }
        let half = nanos(now).saturating_sub(nanos(asked)) / 2;
        let offset = nanos(asked).saturating_add(half).saturating_sub(theirs);
        // The answer counts nanoseconds, where the stamps' milliseconds may have begun anew.
        let apart = most.saturating_sub(offset);
        let apart = apart.saturating_add(WRAP_NS / 2).rem_euclid(WRAP_NS) - WRAP_NS / 2;
        // Nothing arrives before it is sent; and what takes this long is another clock.
        if (-AHEAD_NS..=BACK_NS).contains(&apart) {
            self.answers[self.next % KEPT] = Some(Answer { offset: most.saturating_sub(apart), half, at: now });
            self.next = (self.next + 1) % KEPT;
        }
    }

    fn least(&self) -> Option<i64> {
        self.least.iter().flatten().min().copied()
    }

    /// By the best answer: a quick one, and a new one.
    fn best(&self, now: Time) -> Option<Answer> {
        let doubt = |a: &Answer| a.half as f64 + DRIFT * 1e9 * now.since(a.at).max(0.0);
        self.answers.iter().flatten().min_by(|a, b| doubt(a).total_cmp(&doubt(b))).copied()
    }

    fn offset(&self, now: Time) -> Option<i64> {
        self.best(now).map(|a| a.offset).or(self.least())
    }

    /// Whether questions are answered.
    pub fn is_synced(&self) -> bool {
        self.answers.iter().flatten().next().is_some()
    }

    /// The moment on our clock of what was stamped `sent` (ns) and has arrived at `now`; `None` before anything has.
    pub fn ours(&self, now: Time, sent: i64) -> Option<Time> {
        let ours = sent.saturating_add(self.offset(now)?).clamp(0, nanos(now));
        Some(Time::from_nanos(u64::try_from(ours).unwrap_or(0)))
    }

    /// How long the quickest messages take, s; 0 where that is not known.
    pub fn delay_s(&self, now: Time) -> f64 {
        match (self.best(now), self.least()) {
            (Some(best), Some(least)) => least.saturating_sub(best.offset).max(0) as f64 * 1e-9,
            _ => 0.0,
        }
    }
}

#[cfg(test)]
mod tests;
