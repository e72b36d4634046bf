//! Not too often: a rate with a burst ahead of it. Pure.

use crate::time::Time;
use std::time::Duration;

/// Lets something happen once in every period in the long run, and some times at once before that.
#[derive(Clone, Debug)]
pub struct Pace {
    period: Duration,
    burst: Duration,
    /// When all that was let pass is paid for.
    paid: Time,
}

impl Pace {
    /// Once in `period`, `burst` times more at once.
    pub fn new(period: Duration, burst: u32) -> Self {
        Self { period, burst: period * burst, paid: Time::default() }
    }

    /// From when on it is let pass.
    pub fn free_at(&self) -> Time {
        let burst = u64::try_from(self.burst.as_nanos()).unwrap_or(u64::MAX);
        Time::from_nanos(self.paid.as_nanos().saturating_sub(burst))
    }

    /// Whether it is let pass at `now`; then it has happened.
    pub fn take(&mut self, now: Time) -> bool {
        let free = now >= self.free_at();
        if free {
            self.paid = self.paid.max(now) + self.period;
        }
        free
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_burst_passes_and_then_the_rate_holds() {
        let mut pace = Pace::new(Duration::from_millis(10), 4);
        let at = |ms: u64| Time::from_nanos((1000 + ms) * 1_000_000);
        assert_eq!((0..100).filter(|_| pace.take(at(0))).count(), 5);
        assert_eq!((1..=1000).filter(|ms| pace.take(at(*ms))).count(), 100);
        assert!(!pace.take(at(1000)) && pace.free_at() > at(1000));
        assert_eq!((0..100).filter(|_| pace.take(at(5000))).count(), 5, "a pause saves up the burst, no more");
    }
}
