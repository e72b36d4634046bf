//! Instants as the pure core sees them: numbers handed in, never read from a clock.

use std::time::Duration;

/// An instant in nanoseconds on `CLOCK_BOOTTIME`, or on a recording's own clock.
///
/// The core only subtracts instants; where the zero lies is the source's business.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Time(u64);

impl Time {
    /// The instant `nanos` nanoseconds after the clock's zero.
    pub const fn from_nanos(nanos: u64) -> Self {
        Self(nanos)
    }

    /// The instant `secs` seconds after the clock's zero; negative and NaN give the zero itself.
    pub fn from_secs_f64(secs: f64) -> Self {
        // A float to integer cast saturates and sends NaN to 0.
        Self((secs * 1e9).round() as u64)
    }

    /// Nanoseconds since the clock's zero.
    pub const fn as_nanos(self) -> u64 {
        self.0
    }

    /// Whole microseconds since the clock's zero (D-Bus `SampleTimeUsec`).
    pub const fn as_micros(self) -> u64 {
        self.0 / 1_000
    }

    /// Whole milliseconds since the clock's zero (MAVLink `time_boot_ms` before it wraps).
    pub const fn as_millis(self) -> u64 {
        self.0 / 1_000_000
    }

    /// Seconds since the clock's zero.
    pub fn as_secs_f64(self) -> f64 {
        self.0 as f64 * 1e-9
    }

    /// Seconds from `earlier` to `self`; negative when `earlier` is the later one.
    pub fn since(self, earlier: Time) -> f64 {
        if self.0 >= earlier.0 { (self.0 - earlier.0) as f64 * 1e-9 } else { -((earlier.0 - self.0) as f64 * 1e-9) }
    }
}

impl std::ops::Add<Duration> for Time {
    type Output = Time;

    fn add(self, rhs: Duration) -> Time {
        Time(self.0.saturating_add(u64::try_from(rhs.as_nanos()).unwrap_or(u64::MAX)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn since_is_signed() {
        let (a, b) = (Time::from_secs_f64(1.0), Time::from_secs_f64(1.5));
        assert!((b.since(a) - 0.5).abs() < 1e-12);
        assert!((a.since(b) + 0.5).abs() < 1e-12);
    }

    #[test]
    fn hostile_seconds_do_not_panic() {
        assert_eq!(Time::from_secs_f64(f64::NAN), Time::from_nanos(0));
        assert_eq!(Time::from_secs_f64(-1.0), Time::from_nanos(0));
        assert_eq!(Time::from_secs_f64(f64::INFINITY).as_nanos(), u64::MAX);
        assert_eq!(Time::from_nanos(u64::MAX) + Duration::from_secs(1), Time::from_nanos(u64::MAX));
    }
}
