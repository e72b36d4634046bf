//! How often something comes. Pure.

use crate::time::Time;

/// Over this time it is counted, s.
const SPAN_S: f64 = 2.0;

/// Counts a second, over the last few.
#[derive(Clone, Copy, Debug, Default)]
pub struct Meter {
    since: Option<Time>,
    count: u32,
    before_hz: Option<f64>,
}

impl Meter {
    /// Counts one.
    pub fn count(&mut self, now: Time) {
        let since = *self.since.get_or_insert(now);
        let elapsed_s = now.since(since);
        if !(0.0..SPAN_S).contains(&elapsed_s) {
            // A hole counts; a clock set back begins anew.
            self.before_hz = (elapsed_s > 0.0).then(|| f64::from(self.count) / elapsed_s);
            (self.since, self.count) = (Some(now), 0);
        }
        self.count += 1;
    }

    /// How many a second.
    pub fn hz(&self, now: Time) -> f64 {
        let elapsed_s = self.since.map_or(0.0, |since| now.since(since));
        match self.before_hz {
            Some(hz) if elapsed_s <= SPAN_S => hz,
            _ if elapsed_s > 0.0 => f64::from(self.count) / elapsed_s.max(1.0),
            _ => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_comes_is_counted_and_what_stops_fades() {
        let at = |s: f64| Time::from_secs_f64(3.0 + s);
        let mut meter = Meter::default();
        assert_eq!(meter.hz(at(0.0)), 0.0);
        for i in 0..500 {
            meter.count(at(f64::from(i) * 0.02));
            let hz = meter.hz(at(f64::from(i) * 0.02));
            assert!(i < 60 || (hz - 50.0).abs() < 1.5, "{i}: {hz}");
        }
        assert!(meter.hz(at(20.0)) < 10.0 && meter.hz(at(200.0)) < 1.0);
        meter.count(at(-3.0));
        assert!(meter.hz(at(-3.0)) < 2.0);
    }
}
