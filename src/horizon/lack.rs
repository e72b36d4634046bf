//! What the method cannot do without: a sensor's fault withholds at once, until there have been solutions for a while.

use crate::fault::debounce::Debounce;
use crate::time::Time;

/// Where it withholds again within so long, s, solutions must have come for twice as long as before, so many s at most.
const AGAIN_S: f64 = 10.0;
const LONGEST_S: f64 = 3.0;

/// Whether a sensor's fault withholds the attitude.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lack {
    unsolved: Debounce,
    back_after_s: f64,
    /// How many times as long they must come now, and when it withheld last.
    times: f64,
    withheld: Option<Time>,
}

impl Lack {
    /// Over after `back_after_s` and ten of solutions without a break.
    pub fn new(back_after_s: f64) -> Self {
        Self { unsolved: Debounce::new(0.0, back_after_s).wary(), back_after_s, times: 1.0, withheld: None }
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
            return false;
        }
        let before = self.unsolved.is_active();
        if solved || named || before {
            self.unsolved.update(!solved, now);
        }
        let withholds = self.unsolved.is_active();
        if withholds && !before {
            let again = self.withheld.is_some_and(|at| now.since(at) < AGAIN_S);
            self.times = if again { (2.0 * self.times).min(64.0) } else { 1.0 };
            self.unsolved.retune(0.0, (self.times * self.back_after_s).min(self.back_after_s.max(LONGEST_S)));
        }
        if withholds {
            self.withheld = Some(now);
        }
        withholds
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

    #[test]
    fn what_is_withheld_again_and_again_is_so_for_longer() {
        let mut lack = Lack::new(0.1);
        let at = |i: u64| Time::from_nanos(5_000_000_000 + i * 20_000_000);
        // Half a second of solutions, then one frame without: the fault stands all the while.
        let states: Vec<bool> = (0..1000).map(|i| lack.update(true, i % 26 != 0, true, at(i))).collect();
        let changes = states.windows(2).filter(|w| w[0] != w[1]).count();
        assert!(changes <= 6 && states[999], "{changes}");
        // After 3 s of them it is given; and 10 s later it is as at first.
        let given = |lack: &mut Lack, from| (from..from + 200).find(|i| !lack.update(true, true, true, at(*i)));
        assert!(given(&mut lack, 1000).is_some_and(|i| i < 1152));
        assert!(lack.update(true, false, true, at(2000)));
        assert_eq!(given(&mut lack, 2001), Some(2010));
    }
}
