//! The adaptive range: the contrast that scales the angles, falling fast and rising slowly.

use crate::estimator::noise::PAIR_NOISE_K;
use crate::estimator::range::share;
use crate::time::Time;

/// Time constant of the fall, s: two samples or three.
const FALL_S: f64 = 0.05;

/// Contrasts this far below the range may be noise, K: three times the noise of a pair, about
/// three standard deviations of a solved contrast. Within it the range falls as slowly as it rises.
const DEAD_BAND_K: f64 = 3.0 * PAIR_NOISE_K;

/// A filter over solved contrasts. An angle is underestimated when the range it is scaled by is too
/// large: a cloud is followed at once, the blue after it only slowly.
///
/// With 0.08 K of noise in each sensor, 50 times a second, it settles 0.002 K below the mean
/// contrast. Without the dead band it would be 0.17 K, 0.9 % of a contrast of 20 K.
#[derive(Clone, Copy, Debug)]
pub struct AdaptiveRange {
    rise_s: f64,
    state: Option<(f64, Time)>,
}

impl AdaptiveRange {
    /// Rising with a time constant of `rise_s` > 0, in seconds.
    pub fn new(rise_s: f64) -> Self {
        Self { rise_s, state: None }
    }

    /// Takes in the contrast solved at `time`, K; the first is taken as it is. One that is not
    /// finite, or not later than the one before, changes nothing. Gives the range, K.
    pub fn update(&mut self, contrast_k: f64, time: Time) -> Option<f64> {
        self.state = match self.state {
            state if !contrast_k.is_finite() => state,
            None => Some((contrast_k, time)),
            Some((range, last)) if time > last => {
                let dt_s = time.since(last);
                let slow = range + (contrast_k - range) * share(dt_s, self.rise_s);
                let below = (slow - DEAD_BAND_K - contrast_k).max(0.0);
                Some((slow - below * share(dt_s, FALL_S), time))
            }
            state => state,
        };
        self.value()
    }

    /// The range, K; `None` before the first contrast.
    pub fn value(&self) -> Option<f64> {
        self.state.map(|(range, _)| range)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulation::noise::Noise;

    fn at(s: f64) -> Time {
        Time::from_secs_f64(s)
    }

    #[test]
    fn a_drop_is_followed_at_once_and_a_rise_slowly() {
        let mut range = AdaptiveRange::new(3.0);
        assert_eq!(range.value(), None);
        range.update(30.0, at(0.0));
        for i in 1..=10 {
            range.update(15.0, at(f64::from(i) * 0.02));
        }
        // Four time constants of the fall: 2 % of the drop are left, and the dead band.
        assert!((15.0..15.7).contains(&range.value().unwrap()), "{:?}", range.value());
        for i in 1..=500 {
            range.update(15.0, at(0.2 + f64::from(i) * 0.02));
        }
        let low = range.value().unwrap();
        assert!((low - 15.0).abs() < 0.05, "{low}");
        for i in 1..=150 {
            range.update(30.0, at(10.2 + f64::from(i) * 0.02));
        }
        let expected = low + (30.0 - low) * (1.0 - (-1.0_f64).exp());
        assert!((range.value().unwrap() - expected).abs() < 1e-6);
    }

    #[test]
    fn noise_alone_does_not_pull_it_down() {
        let (mut range, mut noise) = (AdaptiveRange::new(3.0), Noise::new(7));
        let (mut sum, mut count) = (0.0, 0.0);
        for i in 0..50_000 {
            let value = range.update(20.0 + 0.08 * 2.0_f64.sqrt() * noise.normal(), at(f64::from(i) * 0.02));
            if i > 1000 {
                sum += value.unwrap() - 20.0;
                count += 1.0;
            }
        }
        let bias_k: f64 = sum / count;
        assert!(bias_k.abs() < 0.02, "{bias_k}");
    }

    #[test]
    fn repeated_backward_and_impossible_contrasts_change_nothing() {
        let mut range = AdaptiveRange::new(1.0);
        assert_eq!(range.update(f64::NAN, at(0.0)), None);
        range.update(5.0, at(1.0));
        assert_eq!(range.update(2.0, at(1.0)), Some(5.0));
        assert_eq!(range.update(2.0, at(0.5)), Some(5.0));
        assert_eq!(range.update(f64::NEG_INFINITY, at(2.0)), Some(5.0));
    }
}
