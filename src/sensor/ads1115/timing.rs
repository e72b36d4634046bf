//! How long conversions take, and the clock that they are waited for by.

use super::registers::Rate;
use crate::clock;
use crate::time::Time;
use std::time::Duration;

/// No wait is longer, whatever the rate: two of the slowest conversions and a little.
const CAP: Duration = Duration::from_millis(260);

/// The longest that a conversion takes: 10 % over its nominal time, and the wake-up (25 µs) twice.
pub fn longest(rate: Rate) -> Duration {
    rate.conversion_time() * 11 / 10 + Duration::from_micros(50)
}

/// The shortest: 10 % under its nominal time.
pub fn shortest(rate: Rate) -> Duration {
    rate.conversion_time() * 9 / 10
}

/// How long a read may wait: two conversion times and 2 ms.
pub fn patience(rate: Rate) -> Duration {
    (rate.conversion_time() * 2 + Duration::from_millis(2)).min(CAP)
}

/// When a conversion that never ends is given up, so that another may be tried.
pub fn abandon(rate: Rate) -> Duration {
    rate.conversion_time() * 8 + Duration::from_millis(100)
}

/// A clock to wait by.
pub trait Clock: Send {
    /// Now.
    fn now(&mut self) -> Time;
    /// Waits until `deadline`; not at all when it has passed.
    fn sleep_until(&mut self, deadline: Time);
}

/// The system's clock.
#[derive(Clone, Copy, Debug, Default)]
pub struct SystemClock;

impl Clock for SystemClock {
    fn now(&mut self) -> Time {
        clock::now()
    }

    fn sleep_until(&mut self, deadline: Time) {
        clock::sleep_until(deadline);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waits_are_bounded_and_outlast_a_slow_oscillator() {
        for rate in Rate::ALL {
            let nominal_s = 1.0 / f64::from(rate.sps());
            assert!(longest(rate).as_secs_f64() > nominal_s * 1.1);
            assert!(shortest(rate).as_secs_f64() <= nominal_s * 0.9 + 1e-9);
            assert!(patience(rate) > longest(rate));
            assert!(patience(rate).as_secs_f64() <= nominal_s * 2.0 + 0.002 + 1e-8);
            assert!(patience(rate) <= Duration::from_millis(260));
            assert!(abandon(rate) > patience(rate) * 2);
        }
    }
}
