//! Too little contrast: fog, heavy overcast, in cloud.

use super::debounce::{Debounce, State};
use super::noise::NoiseMeter;
use super::{ActiveFault, Evidence, FaultKind};
use crate::estimator::{PAIR_SLOPE, Solution};
use crate::frame::Frame;
use crate::head::Head;

/// The fault ends where this much more than its limit is seen.
const HYSTERESIS: f64 = 1.25;
/// Seconds for which the contrast must be low, and must be back.
const LASTS_S: (f64, f64) = (0.2, 1.0);

/// Sees `low-contrast`. Its limit is the configured one, or the contrast at which the sensors' own noise
/// would make a larger error than is wanted, if that is more.
#[derive(Clone, Debug)]
pub struct LowContrast {
    head: Head,
    noise: NoiseMeter,
    least_k: f64,
    accuracy: f64,
    low: Debounce,
    lowest_k: f64,
    limit_k: f64,
}

impl LowContrast {
    /// With the least limit, K, and the accuracy wanted of one scan, rad.
    pub fn new(head: &Head, least_k: f64, accuracy: f64) -> Self {
        let mut new = Self {
            head: head.clone(),
            noise: NoiseMeter::new(head),
            least_k,
            accuracy,
            low: Debounce::new(LASTS_S.0, LASTS_S.1),
            lowest_k: 0.0,
            limit_k: 0.0,
        };
        new.find_limit();
        new
    }

    /// Another least limit, K, and another accuracy wanted, rad.
    pub fn retune(&mut self, least_k: f64, accuracy: f64) {
        (self.least_k, self.accuracy) = (least_k, accuracy);
        self.find_limit();
    }

    /// The contrast below which there is no attitude, K.
    pub fn limit_k(&self) -> f64 {
        self.limit_k
    }

    fn find_limit(&mut self) {
        self.limit_k = self.least_k.max(self.noise.pair_k(&self.head) / (PAIR_SLOPE * self.accuracy));
    }

    /// Takes in what was seen. A frame in which nothing was seen changes nothing.
    pub fn update(&mut self, solution: &Solution, frame: &Frame) -> State {
        self.noise.update(&self.head, frame);
        self.find_limit();
        if let Some([x, y, z]) = solution.seen_k {
            let seen = (x * x + y * y + z * z).sqrt();
            // Both count: what is seen now, and the range that scales the angles.
            self.lowest_k = solution.contrast_k.map_or(seen, |c| seen.min(c.abs()));
            let limit_k = if self.low.is_active() { HYSTERESIS * self.limit_k } else { self.limit_k };
            return self.low.update(self.lowest_k < limit_k, frame.time);
        }
        self.low.state()
    }

    /// Adds what is there to `faults`.
    pub fn report(&self, faults: &mut Vec<ActiveFault>) {
        let evidence = Evidence::Limit { value: self.lowest_k, limit: self.limit_k, unit: "K" };
        self.low.report(FaultKind::LowContrast, evidence, faults);
    }
}

#[cfg(test)]
mod tests {
    use super::super::kit::{frame, seen, told, value};
    use super::*;
    use crate::simulation::noise::Noise;

    const ACCURACY_DEG: f64 = 5.0;

    /// After a minute of sensors with so much noise, K; and the time.
    fn noisy(noise_k: f64) -> (LowContrast, f64) {
        let mut low = LowContrast::new(&Head::six(), 2.0, ACCURACY_DEG.to_radians());
        let mut noise = Noise::new(11);
        for i in 0..3000 {
            let shown = [(); 6].map(|()| noise_k * noise.normal());
            low.update(&seen(40.0), &frame(10.0 + 0.02 * f64::from(i), &shown, None));
        }
        (low, 70.0)
    }

    #[test]
    fn the_limit_follows_the_noise_where_that_is_more_than_the_least() {
        // σ√2 over a slope of 1.1 of the contrast for a radian, and 5°.
        for (noise_k, expected_k) in [(0.05, 2.0), (0.1, 2.0), (0.3, 4.42), (1.0, 14.7)] {
            let limit_k = noisy(noise_k).0.limit_k();
            assert!((limit_k / expected_k - 1.0).abs() < 0.2, "{noise_k} K: {limit_k} K, not {expected_k} K");
        }
    }

    #[test]
    fn ten_kelvin_are_low_for_noisy_sensors_alone() {
        for (noise_k, expected) in [(0.1, false), (1.0, true)] {
            let (mut low, from_s) = noisy(noise_k);
            let mut noise = Noise::new(12);
            for i in 0..50 {
                let shown = [(); 6].map(|()| noise_k * noise.normal());
                low.update(&seen(10.0), &frame(from_s + 0.02 * f64::from(i), &shown, None));
            }
            let told = told(|f| low.report(f));
            assert_eq!(told.len(), usize::from(expected), "{noise_k} K");
            assert!(told.iter().all(|t| t.0 == FaultKind::LowContrast && value(t) == (10.0, "K")), "{told:?}");
        }
    }

    #[test]
    fn it_is_told_after_a_while_and_ends_a_while_after_there_is_clearly_more() {
        let mut low = LowContrast::new(&Head::six(), 2.0, ACCURACY_DEG.to_radians());
        let mut time_s = 10.0;
        let mut after = |seconds: f64, solution: &Solution| {
            let mut state = State::Clear;
            for _ in 0..(seconds / 0.02_f64).round() as u32 {
                time_s += 0.02;
                state = low.update(solution, &frame(time_s, &[1.0; 6], None));
            }
            state
        };
        for (seconds, solution, expected) in [
            (1.0, seen(2.1), State::Clear),
            (0.1, seen(1.9), State::Suspected),
            (0.5, Solution::default(), State::Suspected),
            (0.14, seen(-1.9), State::Active),
            (3.0, seen(2.4), State::Active),
            (3.0, Solution::default(), State::Active),
            (0.9, seen(2.6), State::Active),
            (0.2, seen(2.6), State::Clear),
            // The range that scales the angles counts as well, and a level pair's signal.
            (0.3, Solution { contrast_k: Some(1.0), ..seen(20.0) }, State::Active),
            (1.1, Solution { seen_k: Some([20.0, 0.0, 0.1]), contrast_k: None, ..seen(0.0) }, State::Clear),
        ] {
            assert_eq!(after(seconds, &solution), expected, "{seconds} s of {solution:?}");
        }
    }
}
