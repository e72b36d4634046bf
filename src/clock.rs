//! The shell's clock: `CLOCK_BOOTTIME`, which goes on while the machine sleeps and never steps.

use crate::time::Time;
use rustix::thread::{ClockId, clock_nanosleep_absolute};
use rustix::time::{Timespec, clock_gettime};

/// Now.
pub fn now() -> Time {
    let t = clock_gettime(rustix::time::ClockId::Boottime);
    let secs = u64::try_from(t.tv_sec).unwrap_or(0);
    let nanos = u64::try_from(t.tv_nsec).unwrap_or(0);
    Time::from_nanos(secs.saturating_mul(1_000_000_000).saturating_add(nanos))
}

/// Sleeps until `deadline`; returns at once when it has passed.
pub fn sleep_until(deadline: Time) {
    let nanos = deadline.as_nanos();
    let request = Timespec {
        tv_sec: i64::try_from(nanos / 1_000_000_000).unwrap_or(i64::MAX),
        tv_nsec: (nanos % 1_000_000_000) as i64,
    };
    while clock_nanosleep_absolute(ClockId::Boottime, &request).is_err_and(|e| e == rustix::io::Errno::INTR) {}
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn sleeping_reaches_its_deadline_and_never_waits_for_the_past() {
        let start = now();
        let deadline = start + Duration::from_millis(5);
        sleep_until(deadline);
        assert!(now() >= deadline);
        sleep_until(start);
    }
}
