//! How noisy the readings are.

use super::directions::{Pattern, dot};

/// Over this time it is averaged, s.
const WINDOW_S: f64 = 3.0;
/// What it begins with, K, and as if it had been seen for so long, s: a beginning that trusts the readings too much finds
/// leans and scenes in their noise.
const FIRST: (f64, f64) = (0.4, 0.05);
/// A jump counts for no more than so many times what is known: what is wild is no noise. The rest of a normal
/// distribution has this share of its mean square.
const LARGEST: f64 = 4.0;
const KEPT: f64 = 0.982;
/// As noise of no more than so many times the least is taken what the filter errs by; of what is more, so much is used.
const BESIDE: f64 = 1.2;
const MORE: f64 = 1.3;
/// No sensor worth hearing is noisier, K.
const MOST_K: f64 = 1.0;

/// Learns the noise of the readings from how they jump, from frame to frame, in what no turn, contrast or ground explains.
#[derive(Clone, Debug)]
pub struct NoiseLevel {
    /// K².
    least: f64,
    learnt: f64,
    /// For how long it has been learnt, s.
    learnt_s: f64,
    /// What was unexplained in the last frame, and of how many sensors.
    last: Option<(Pattern, usize)>,
}

impl NoiseLevel {
    /// Never less than `least_k`.
    pub fn new(least_k: f64) -> Self {
        let least = least_k * least_k;
        Self { least, learnt: least, learnt_s: 0.0, last: None }
    }

    /// Takes in what of the innovations of `count` sensors tells of noise, K, in how many dimensions, and how much of its
    /// square the filter expects by itself, K². Where nothing tells, what was learnt stays.
    pub fn update(&mut self, told: Option<(Pattern, usize, f64)>, count: usize, dt_s: f64) {
        let Some((rest, dimensions, expected)) = told else {
            self.last = None;
            return;
        };
        if self.learnt_s == 0.0 {
            self.learnt = FIRST.0 * FIRST.0;
        }
        let before = self.last.replace((rest, count)).filter(|(_, then)| *then == count);
        let Some((before, _)) = before else { return };
        let jump: Pattern = std::array::from_fn(|i| rest[i] - before[i]);
        let seen = (dot(&jump, &jump) / 2.0 - expected).max(0.0) / dimensions.max(1) as f64;
        let seen = seen.min(LARGEST * self.learnt) / KEPT;
        let share = (dt_s / (self.learnt_s + FIRST.1)).min(1.0);
        self.learnt = (self.learnt + share * (seen - self.learnt)).clamp(self.least / LARGEST, MOST_K * MOST_K);
        self.learnt_s = (self.learnt_s + dt_s).min(WINDOW_S);
    }

    /// The variance of a reading, K².
    pub fn variance(&self) -> f64 {
        self.least + MORE * (self.learnt - BESIDE * self.least).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulation::noise::Noise;

    /// What is found in ten seconds, K, of readings in two dimensions, each of which `more` may change, K.
    fn found_k(noise_k: f64, mut more: impl FnMut(u32, &mut Noise) -> f64) -> f64 {
        let (mut noise, mut random) = (NoiseLevel::new(0.085), Noise::new(7));
        for i in 0..500 {
            let mut rest = Pattern::default();
            rest[..2].fill_with(|| noise_k * random.normal());
            rest[0] += more(i, &mut random);
            noise.update(Some((rest, 2, 0.0)), 6, 0.02);
        }
        noise.variance().sqrt()
    }

    #[test]
    fn readings_are_as_noisy_as_they_jump_and_never_less_than_expected() {
        for (noise_k, least_k, most_k) in
            [(0.0, 0.085, 0.085), (0.08, 0.085, 0.09), (0.2, 0.18, 0.25), (0.5, 0.47, 0.63)]
        {
            let found_k = found_k(noise_k, |_, _| 0.0);
            assert!((least_k..=most_k).contains(&found_k), "{found_k} K of {noise_k} K");
        }
        assert_eq!(found_k(20.0, |_, _| 0.0), (0.085_f64.powi(2) + 1.3 * (1.0 - 1.2 * 0.085_f64.powi(2))).sqrt());
    }

    #[test]
    fn what_stays_and_what_is_wild_now_and_then_is_no_noise() {
        let stays = found_k(0.08, |i, _| if i > 450 { 5.0 } else { f64::from(i) * 0.01 });
        let wild = found_k(0.08, |i, random| if i % 50 == 0 { 8.0 * random.normal() } else { 0.0 });
        assert!(stays < 0.1 && wild < 0.12, "{stays} K, {wild} K");
    }

    #[test]
    fn too_few_sensors_to_tell_and_others_than_before_make_nothing_worse() {
        let mut noise = NoiseLevel::new(0.085);
        for i in 0..500 {
            // One more sensor in every second frame is another pattern, no jump.
            let far = if i % 2 == 0 { 3.0 } else { 0.0 };
            noise.update(Some(([far; 8], 1, 0.0)), 5 + i % 2, 0.02);
        }
        assert!(noise.variance().sqrt() < 1.2 * FIRST.0);
        let learnt = noise.variance();
        noise.update(None, 3, 0.02);
        assert_eq!(noise.variance(), learnt);
        assert_eq!(NoiseLevel::new(0.085).variance().sqrt(), 0.085);
    }
}
