//! What the method cannot do without: a sensor's fault withholds at once, until there have been solutions for a while.

use crate::fault::debounce::{Debounce, State};
use crate::time::Time;

/// Whether a sensor's fault withholds the attitude.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lack {
    unsolved: Debounce,
    back_after_s: f64,
}

impl Lack {
    /// Over after `back_after_s` and ten of solutions without a break.
    pub fn new(back_after_s: f64) -> Self {
        Self { unsolved: Debounce::new(0.0, back_after_s).wary(), back_after_s }
    }

    /// Another time.
    pub fn retune(&mut self, back_after_s: f64) {
        self.back_after_s = back_after_s;
        self.unsolved.retune(0.0, back_after_s);
    }

    /// Takes in at `now` whether a sensor's fault `stands`, whether the frame is `solved`, and whether all that is not in
    /// it has a fault (`named`): what else is missing was one missed read. Gives whether the fault withholds.
    pub fn update(&mut self, stands: bool, solved: bool, named: bool, now: Time) -> bool {
        if !stands {
            *self = Self::new(self.back_after_s);
        } else if solved || named || self.unsolved.is_active() {
            return self.unsolved.update(!solved, now) == State::Active;
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn withheld_at_once_and_given_after_a_while_or_when_the_fault_is_gone() {
        let mut lack = Lack::new(0.1);
        let at = |ms: u64| Time::from_nanos(5_000_000_000 + ms * 1_000_000);
        assert!(!lack.update(false, false, true, at(0)), "no fault, no withholding");
        assert!(!lack.update(true, true, true, at(20)));
        assert!(!lack.update(true, false, false, at(40)), "a missed read");
        assert!(lack.update(true, false, true, at(60)));
        // Solutions that never last.
        for i in 0..500 {
            assert!(lack.update(true, i % 5 != 4, i % 2 == 0, at(80 + 20 * i)), "frame {i}");
        }
        let mut given = |i: u64| !lack.update(true, true, true, at(10_080 + 20 * i));
        assert_eq!((0..11).position(&mut given), Some(9));
        assert!(lack.update(true, false, true, at(10_300)));
        assert!(!lack.update(false, true, true, at(10_320)), "the fault is gone");
        assert!(!lack.update(true, true, true, at(10_340)));
    }
}
