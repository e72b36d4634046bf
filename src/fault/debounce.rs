//! Time hysteresis: a condition must last before it is a fault, and be gone before it is none.

use super::{ActiveFault, Evidence, FaultKind};
use crate::time::Time;
use std::time::Duration;

/// What was not looked at was not seen to last: more than so much between two looks, s, counts for so much.
const UNSEEN_S: (f64, f64) = (3.0, 0.5);

/// A wary one is over when it has been gone in so many looks, or for so long, s.
const WARY: (u32, f64) = (10, 3.0);

/// Where a condition stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// Not there.
    Clear,
    /// Seen, not for long enough to be called a fault; nothing should be built on it meanwhile.
    Suspected,
    /// A fault.
    Active,
}

/// A condition with the time that it takes to believe it, and to believe that it is over.
#[derive(Clone, Copy, Debug)]
pub struct Debounce {
    on_after_s: f64,
    off_after_s: f64,
    active: bool,
    /// Since when the condition has been other than `active` says.
    changing_since: Option<Time>,
    active_since: Time,
    looked: Option<Time>,
    wary: bool,
    /// How many looks have found it other than `active` says.
    looks: u32,
}

impl Debounce {
    /// Believed after `on_after_s` seconds, over after `off_after_s` seconds.
    pub fn new(on_after_s: f64, off_after_s: f64) -> Self {
        let active_since = Time::default();
        let (wary, looks) = (false, 0);
        Self { on_after_s, off_after_s, active: false, changing_since: None, active_since, looked: None, wary, looks }
    }

    /// One that takes ten looks at least to be over: by chance alone it is gone in two or three.
    pub fn wary(self) -> Self {
        Self { wary: true, ..self }
    }

    /// Other times, from now on.
    pub fn retune(&mut self, on_after_s: f64, off_after_s: f64) {
        (self.on_after_s, self.off_after_s) = (on_after_s, off_after_s);
    }

    /// Takes in at `now` whether the condition is there; gives where it stands.
    pub fn update(&mut self, present: bool, now: Time) -> State {
        let between_s = self.looked.replace(now).map_or(0.0, |looked| now.since(looked));
        if between_s > UNSEEN_S.0 {
            let unseen = Duration::from_secs_f64(between_s - UNSEEN_S.1);
            self.changing_since = self.changing_since.map(|since| since + unseen);
        }
        self.looks = if self.changing_since.is_some() { self.looks.saturating_add(1) } else { 1 };
        if present == self.active {
            self.changing_since = None;
        } else {
            let since = *self.changing_since.get_or_insert(now);
            let few = self.wary && !present && self.looks < WARY.0 && now.since(since) < WARY.1;
            let needed = if present { self.on_after_s } else { self.off_after_s };
            // Half a millisecond of grace: scans are not placed to the nanosecond.
            if now.since(since) >= needed - 0.000_5 && !few {
                self.active = present;
                self.active_since = since;
                self.changing_since = None;
            }
        }
        self.state()
    }

    /// Nothing can be seen of the condition for now: it stands where it stood, and a change must last anew.
    pub fn rest(&mut self) {
        self.changing_since = None;
    }

    /// Where the condition stands.
    pub fn state(&self) -> State {
        match (self.active, self.changing_since) {
            (true, _) => State::Active,
            (false, Some(_)) => State::Suspected,
            (false, None) => State::Clear,
        }
    }

    /// Adds the fault to `faults` while it is there.
    pub fn report(&self, kind: FaultKind, evidence: Evidence, faults: &mut Vec<ActiveFault>) {
        if self.active {
            faults.push(ActiveFault { kind, since: self.active_since, evidence });
        }
    }

    /// Since when the fault has been there; meaningful while active.
    pub fn since(&self) -> Time {
        self.active_since
    }

    /// Whether the condition is a fault now.
    pub fn is_active(&self) -> bool {
        self.active
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn believed_after_a_while_and_over_after_another() {
        let mut d = Debounce::new(0.2, 1.0);
        let at = |s: f64| Time::from_secs_f64(10.0 + s);
        assert_eq!(d.update(false, at(0.0)), State::Clear);
        assert_eq!(d.update(true, at(0.1)), State::Suspected);
        assert_eq!(d.update(true, at(0.2)), State::Suspected);
        assert_eq!(d.update(true, at(0.3)), State::Active);
        assert_eq!(d.since(), at(0.1), "since it was first seen");
        assert_eq!(d.update(false, at(0.4)), State::Active);
        assert_eq!(d.update(true, at(1.3)), State::Active, "seen again: the wait begins anew");
        assert_eq!(d.update(false, at(1.5)), State::Active);
        assert_eq!(d.update(false, at(2.5)), State::Clear);
    }

    #[test]
    fn what_was_not_looked_at_has_not_lasted() {
        let at = |s: f64| Time::from_secs_f64(10.0 + s);
        for gap_s in [10.0, 600.0, 36_000.0] {
            let mut d = Debounce::new(2.0, 3.0);
            assert_eq!(d.update(true, at(0.0)), State::Suspected);
            assert_eq!(d.update(true, at(gap_s)), State::Suspected);
            assert_eq!(d.update(true, at(gap_s + 1.4)), State::Suspected);
            assert_eq!(d.update(true, at(gap_s + 1.5)), State::Active);
            assert_eq!(d.update(false, at(gap_s + 2.0)), State::Active);
            assert_eq!(d.update(false, at(2.0 * gap_s + 2.0)), State::Active);
            assert_eq!(d.update(false, at(2.0 * gap_s + 4.4)), State::Active);
            assert_eq!(d.update(false, at(2.0 * gap_s + 4.5)), State::Clear);
        }
        // Rows that come every five seconds are enough of them in the end.
        let mut d = Debounce::new(1.0, 3.0);
        let states = [0.0, 5.0, 10.0].map(|s| d.update(true, at(s)));
        assert_eq!(states, [State::Suspected, State::Suspected, State::Active]);
        // A rest leaves what is believed, and no more.
        d.update(false, at(10.1));
        d.rest();
        assert_eq!(d.update(false, at(13.0)), State::Active);
        assert_eq!(d.update(false, at(15.9)), State::Active);
        assert_eq!(d.update(false, at(16.0)), State::Clear);
    }

    #[test]
    fn a_wary_one_is_over_after_ten_looks_or_three_seconds() {
        let over_after = |d: Debounce, every_ms: u64| {
            let at = |i: u64| Time::from_nanos(10_000_000_000 + i * every_ms * 1_000_000);
            let mut d = d;
            assert_eq!(d.update(true, at(0)), State::Active);
            // What is gone for less does not count.
            (1..=3).for_each(|i| assert_eq!(d.update(i == 3, at(i)), State::Active, "{every_ms} ms"));
            (4..500).find(|i| d.update(false, at(*i)) == State::Clear).map(|i| i - 3)
        };
        let (plain, wary) = (Debounce::new(0.0, 0.1), Debounce::new(0.0, 0.1).wary());
        assert_eq!([5, 20, 100, 1000].map(|ms| over_after(wary, ms)), [21, 10, 10, 4].map(Some));
        assert_eq!(over_after(plain, 20), Some(6));
        assert_eq!(over_after(Debounce::new(0.0, 5.0).wary(), 1000), Some(6), "a longer time of its own");
    }

    #[test]
    fn a_moment_is_no_fault() {
        let mut d = Debounce::new(0.2, 1.0);
        for i in 0..100 {
            assert_ne!(d.update(i % 5 != 0, Time::from_secs_f64(f64::from(i) * 0.04)), State::Active);
        }
    }
}
