//! A first-order low-pass filter over samples that come when they come.

use crate::time::Time;

/// A first-order low-pass filter, exact for a signal that holds between samples.
///
/// The report scales the angles by the vertical pair's output "filtered with a time constant of a
/// few seconds" (section IV.A.2).
#[derive(Clone, Copy, Debug)]
pub struct LowPass {
    time_constant_s: f64,
    state: Option<(f64, Time)>,
    /// The last interval, s, and its [`share`]: samples that come regularly ask for the same one.
    step: (f64, f64),
}

impl LowPass {
    /// With `time_constant_s` > 0, in seconds.
    pub fn new(time_constant_s: f64) -> Self {
        Self { time_constant_s, state: None, step: (0.0, 0.0) }
    }

    /// Takes in `value` seen at `time`; the first value is taken as it is. A value that is not
    /// finite, or not later than the one before, changes nothing. Gives the filtered value.
    pub fn update(&mut self, value: f64, time: Time) -> Option<f64> {
        if value.is_finite() {
            match &mut self.state {
                None => self.state = Some((value, time)),
                Some((filtered, last)) if time > *last => {
                    let dt_s = time.since(*last);
                    if dt_s != self.step.0 {
                        self.step = (dt_s, share(dt_s, self.time_constant_s));
                    }
                    *filtered += (value - *filtered) * self.step.1;
                    *last = time;
                }
                Some(_) => {}
            }
        }
        self.value()
    }

    /// The filtered value; `None` before the first.
    pub fn value(&self) -> Option<f64> {
        self.state.map(|(v, _)| v)
    }
}

/// How much of a step has gone through a first-order low-pass filter after `dt_s`: 0..1.
pub fn share(dt_s: f64, time_constant_s: f64) -> f64 {
    -(-dt_s / time_constant_s).exp_m1()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(s: f64) -> Time {
        Time::from_secs_f64(s)
    }

    #[test]
    fn a_step_reaches_63_percent_after_one_time_constant_whatever_the_rate() {
        for rate in [1.0, 10.0, 50.0] {
            let mut f = LowPass::new(3.0);
            f.update(0.0, at(0.0));
            for i in 1..=(3.0 * rate) as u32 {
                f.update(1.0, at(f64::from(i) / rate));
            }
            assert!((f.value().unwrap() - 0.632_12).abs() < 1e-4, "{rate} Hz: {:?}", f.value());
        }
    }

    #[test]
    fn repeated_backward_and_impossible_samples_change_nothing() {
        let mut f = LowPass::new(1.0);
        assert_eq!(f.update(f64::NAN, at(0.0)), None);
        f.update(5.0, at(1.0));
        assert_eq!(f.update(9.0, at(1.0)), Some(5.0));
        assert_eq!(f.update(9.0, at(0.5)), Some(5.0));
        assert_eq!(f.update(f64::INFINITY, at(2.0)), Some(5.0));
    }
}
