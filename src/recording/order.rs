//! Which rows of a recording are taken, by their times: one that is wrong costs that row, and a clock that was set back
//! costs a second.

use super::tally::RowFault;

/// A row so much later than the one before, ns, waits for the next to bear it out: half a second.
const ODD_NANOS: u64 = 500_000_000;
/// A step forward in which the next row must be near, ns: an hour.
const LEAP_NANOS: u64 = 3_600_000_000_000;
/// Rows so much earlier than the last taken, ns, may be of a clock that was set back: two seconds.
const BACK_NANOS: u64 = 2_000_000_000;
/// For so long they must go on rising, ns: a second.
const RISING_NANOS: u64 = 1_000_000_000;
/// What a clock that was set back is said to have missed, ns: ten seconds, a gap after which all begins anew.
const MISSED_NANOS: u64 = 10_000_000_000;

/// What becomes of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// It is taken, at this time, ns.
    Take(u64),
    /// It is the first that is taken of a clock that was set back, at this time, ns.
    Anew(u64),
    /// It waits for the next one.
    Wait,
    /// It is left out.
    Drop(RowFault),
}

/// The times of a recording, in which those taken rise.
#[derive(Clone, Debug, Default)]
pub struct Order {
    /// The time of the last row taken, ns, as it stands in the recording; and as it was given.
    last: Option<(u64, u64)>,
    /// That of a row that waits.
    held: Option<u64>,
    /// Of a run of rising rows before the last one taken, the first and the newest, ns.
    back: Option<(u64, u64)>,
    /// By how much later than it stands there a time is given, ns.
    shift: u64,
}

impl Order {
    /// What becomes of the row that waits, now that the next is known, or that there is none; `None` where none waits.
    pub fn settle(&mut self, next: Option<u64>) -> Option<Verdict> {
        let held = self.held?;
        let last = self.last.map(|(last, _)| last);
        let leaps = last.is_some_and(|last| held - last > LEAP_NANOS);
        let verdict = match next {
            Some(next) if next > held && leaps && next - held > LEAP_NANOS => Verdict::Drop(RowFault::Ahead),
            None if leaps => Verdict::Drop(RowFault::Ahead),
            Some(next) if next <= held => {
                let follows = last.map_or(held - next > ODD_NANOS, |last| next > last);
                if follows { Verdict::Drop(RowFault::Ahead) } else { Verdict::Wait }
            }
            _ => self.take(held),
        };
        if verdict != Verdict::Wait {
            self.held = None;
        }
        Some(verdict)
    }

    /// What becomes of a row of this time; the one that waits has been settled.
    pub fn row(&mut self, time: u64) -> Verdict {
        match self.last {
            Some((last, given)) if time <= last => self.back(time, last, given),
            None if self.held.is_some() => Verdict::Drop(RowFault::Backwards),
            Some((last, _)) if time - last <= ODD_NANOS => self.take(time),
            _ => {
                self.back = None;
                self.held = Some(time);
                Verdict::Wait
            }
        }
    }

    /// A row before the last one taken: left out, until there are enough of them that the clock must have been set back.
    fn back(&mut self, time: u64, last: u64, given: u64) -> Verdict {
        let first = match self.back {
            Some((first, newest)) if time > newest && time - newest <= LEAP_NANOS => first,
            _ => time,
        };
        self.back = (last - time > BACK_NANOS).then_some((first, time));
        let goes_on = given.checked_add(MISSED_NANOS).filter(|_| self.back.is_some() && time - first >= RISING_NANOS);
        let Some(goes_on) = goes_on else { return Verdict::Drop(RowFault::Backwards) };
        (self.held, self.shift) = (None, goes_on - time);
        (self.last, self.back) = (Some((time, goes_on)), None);
        Verdict::Anew(goes_on)
    }

    fn take(&mut self, time: u64) -> Verdict {
        let Some(given) = time.checked_add(self.shift) else { return Verdict::Drop(RowFault::Ahead) };
        self.last = Some((time, given));
        self.back = None;
        Verdict::Take(given)
    }
}
