//! The noise of the sensors: what standard deviations assume of it, and how it shows.

use crate::time::Time;

/// Noise of one pair's signal, K rms: two sensors of 0.08 K.
pub const PAIR_NOISE_K: f64 = 0.113;

/// Farther apart than this the aircraft itself moves from reading to reading, s.
const APART_S: f64 = 0.045;
/// A jump so many times the noise known is no noise.
const LARGEST: f64 = 4.0;
/// A sensor whose noise is so many of its steps never stays the same.
const NOISY: f64 = 1.5;
/// One of such noise that stays within this share of it says the same, whatever its converter adds.
const STILL: f64 = 0.25;
/// Over this time the noise of one sensor is averaged, and it is known after so much of it, s.
const NOISE_S: (f64, f64) = (10.0, 5.0);

/// One sensor's last two readings, K, with the time of the last: noise shows in second differences, as what changes
/// evenly leaves none.
#[derive(Clone, Copy, Debug, Default)]
pub struct Jumps {
    last: Option<(f64, Option<f64>, Time)>,
}

impl Jumps {
    /// Takes in a reading; with the two before it, how long after the last it came, s, and the variance that the three
    /// show, K²: a jump far beyond the variance that is `known` is no noise, and cut off. None where they are too far
    /// apart, and for a reading that is not new.
    pub fn update(&mut self, reading_k: f64, time: Time, known_k2: f64) -> Option<(f64, f64)> {
        let Some((one, two, at)) = self.last.filter(|(.., at)| time.since(*at) <= APART_S) else {
            self.last = Some((reading_k, None, time));
            return None;
        };
        let since_s = time.since(at);
        if since_s <= 0.0 {
            return None;
        }
        self.last = Some((reading_k, Some(one), time));
        // White noise: the variance of x − 2y + z is six times that of each.
        let seen = (reading_k - 2.0 * one + two?).powi(2) / 6.0;
        Some((since_s, seen.min(LARGEST * LARGEST * known_k2.max(1e-6))))
    }
}

/// The noise of one sensor, K², and its smallest step, K.
#[derive(Clone, Copy, Debug, Default)]
pub struct Noise {
    jumps: Jumps,
    variance: f64,
    learnt_s: f64,
    step: Option<f64>,
}

impl Noise {
    /// Takes in a reading, K, and the one before it.
    pub fn update(&mut self, reading: f64, time: Time, before: Option<f64>) {
        if let Some(step) = before.map(|b| (reading - b).abs()).filter(|s| *s > 0.0) {
            self.step = Some(self.step.map_or(step, |s| s.min(step)));
        }
        if let Some((dt_s, seen)) = self.jumps.update(reading, time, self.variance) {
            self.learnt_s = (self.learnt_s + dt_s).min(NOISE_S.0);
            self.variance += dt_s / self.learnt_s * (seen - self.variance);
        }
    }

    /// Whether it is so large that readings never stay the same.
    pub fn moves_all(&self) -> bool {
        self.learnt_s >= NOISE_S.1 && self.step.is_some_and(|step| self.variance.sqrt() >= NOISY * step)
    }

    /// How far apart two readings are at most that are the same, K.
    pub fn still_k(&self) -> f64 {
        if self.moves_all() { STILL * self.rms_k() } else { 0.0 }
    }

    /// The smallest step of its readings, K; none where it has yet to show one.
    pub fn step_k(&self) -> f64 {
        self.step.unwrap_or(0.0)
    }

    /// How large it is, K rms.
    pub fn rms_k(&self) -> f64 {
        self.variance.sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_changes_evenly_has_no_noise_and_what_alternates_has() {
        let (mut even, mut alternating) = (Jumps::default(), Jumps::default());
        for i in 0..100 {
            let time = Time::from_secs_f64(5.0 + 0.02 * f64::from(i));
            let (a, b) = (even.update(0.3 * f64::from(i), time, 1.0), alternating.update(f64::from(i % 2), time, 1.0));
            assert_eq!((a.is_some(), b.is_some()), (i > 1, i > 1));
            if let (Some((dt_s, none)), Some((_, much))) = (a, b) {
                assert!((dt_s - 0.02).abs() < 1e-9 && none < 1e-20 && (much - 4.0 / 6.0).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn a_jump_far_beyond_the_noise_known_is_cut_off() {
        let mut jumps = Jumps::default();
        let seen = [(5.0, 0.0), (5.02, 0.0), (5.04, 90.0)].map(|(s, k)| jumps.update(k, Time::from_secs_f64(s), 0.01));
        assert!(seen[2].is_some_and(|(_, k2)| (k2 - 0.16).abs() < 1e-9), "{seen:?}");
    }

    #[test]
    fn what_is_not_new_or_comes_too_late_tells_nothing() {
        let mut jumps = Jumps::default();
        let told: Vec<bool> = [1.0, 1.02, 1.04, 1.04, 1.0, 1.06, 1.2, 1.22, 1.24]
            .map(|s| jumps.update(s * s, Time::from_secs_f64(s), 1.0).is_some())
            .into();
        assert_eq!(told, [false, false, true, false, false, true, false, false, true]);
    }
}
