//! A slower stream out of a faster one. Pure.

use crate::time::Time;
use std::time::Duration;

/// Lets some of the frames pass: the one nearest to each due time, so that the mean rate is kept
/// whatever the frames' own rate and jitter.
#[derive(Clone, Debug)]
pub struct Decimator {
    period: Duration,
    next: Time,
    last: Time,
}

impl Decimator {
    /// `None` for a rate that is none.
    pub fn new(hz: f64) -> Option<Self> {
        let period = Duration::try_from_secs_f64(1.0 / hz).ok().filter(|p| !p.is_zero())?;
        Some(Self { period, next: Time::default(), last: Time::default() })
    }

    /// Whether the frame of `time` passes.
    pub fn passes(&mut self, time: Time) -> bool {
        let period_s = self.period.as_secs_f64();
        let interval_s = time.since(self.last).clamp(0.0, period_s);
        self.last = time;
        let early_s = self.next.since(time);
        // Periods away from the schedule: there was a pause, or the clock was set back.
        let astray = early_s.abs() > 2.0 * period_s;
        if !astray && early_s > interval_s / 2.0 {
            return false;
        }
        self.next = if astray { time + self.period } else { self.next + self.period };
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn at(secs: f64) -> Time {
        Time::from_secs_f64(1000.0 + secs)
    }

    #[test]
    fn a_rate_that_is_none_lets_every_frame_pass() {
        assert!([0.0, -1.0, f64::NAN, f64::INFINITY, 1e300].into_iter().all(|hz| Decimator::new(hz).is_none()));
    }

    #[test]
    fn a_clock_set_back_does_not_stop_attitude() {
        let mut decimator = Decimator::new(10.0).unwrap();
        assert!(decimator.passes(at(100.0)));
        assert!(decimator.passes(at(0.0)));
        assert!(!decimator.passes(at(0.02)));
        assert!(decimator.passes(at(0.1)));
    }

    proptest! {
        #[test]
        fn decimation_keeps_its_mean_rate(
            frames_hz in 1.0_f64..200.0,
            part in 0.05_f64..1.0,
            jitter in prop::collection::vec(-0.3_f64..0.3, 64),
        ) {
            let attitude_hz = frames_hz * part;
            let mut decimator = Decimator::new(attitude_hz).unwrap();
            let frames = 4000_u32;
            let passed = (0..frames)
                .filter(|i| decimator.passes(at((f64::from(*i) + jitter[*i as usize % 64]) / frames_hz)))
                .count() as f64;
            let expected = f64::from(frames) * part;
            prop_assert!((passed - expected).abs() <= 2.0, "{passed} passed, {expected:.1} expected");
        }
    }
}
