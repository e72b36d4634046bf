//! Gusts as filtered noise.

use super::noise::Noise;

/// The time over which an airframe and its controls round off what shakes them, s.
const ROUNDING_S: f64 = 0.1;
/// How fast the air changes between quiet and rough, s, and by how much (log of the strength, rms).
const PATCH_S: f64 = 15.0;
const PATCHINESS: f64 = 0.4;

/// Noise of zero mean that forgets with a time constant (Ornstein and Uhlenbeck).
#[derive(Clone, Debug)]
pub struct Wander {
    rms: f64,
    time_constant_s: f64,
    value: f64,
}

impl Wander {
    /// Of `rms` and a time constant above 0; begins anywhere in its range.
    pub fn new(rms: f64, time_constant_s: f64, noise: &mut Noise) -> Self {
        Self { rms, time_constant_s, value: rms * noise.normal() }
    }

    /// The value `dt_s` later.
    pub fn step(&mut self, dt_s: f64, noise: &mut Noise) -> f64 {
        let keep = (-dt_s / self.time_constant_s).exp();
        self.value = keep * self.value + self.rms * (1.0 - keep * keep).sqrt() * noise.normal();
        self.value
    }
}

/// An angle shaken by gusts: noise through a rounding and an oscillator, as the Dryden spectra
/// have it, in air that is rough in patches.
#[derive(Clone, Debug)]
pub struct Gusts {
    /// Natural frequency, rad/s, and damping, of the oscillator.
    omega: f64,
    damping: f64,
    /// Push at strength 1.
    push: Wander,
    patch: Wander,
    noise: Noise,
    /// Angle, rad.
    angle: f64,
    /// Its rate, rad/s.
    rate: f64,
}

impl Gusts {
    /// Of a rate of `rate_rms` rad/s and an angle of `rate_rms / omega` rad, about.
    pub fn new(rate_rms: f64, omega: f64, damping: f64, seed: u64) -> Self {
        let mut noise = Noise::new(seed);
        // White noise of density S through 1/(τs + 1) and 1/(s² + 2ζωs + ω²) gives a rate of
        // variance S / 2(d₁d₂ − d₀d₃), d the product's coefficients; the push alone has S / 2τ.
        let d2 = 1.0 + 2.0 * damping * omega * ROUNDING_S;
        let d1 = 2.0 * damping * omega + omega * omega * ROUNDING_S;
        let push_rms = rate_rms * ((d1 * d2 - omega * omega * ROUNDING_S) / ROUNDING_S).sqrt();
        // The mean square of a log-normal strength is exp(2σ²).
        let push = Wander::new(push_rms * (-PATCHINESS * PATCHINESS).exp(), ROUNDING_S, &mut noise);
        let patch = Wander::new(PATCHINESS, PATCH_S, &mut noise);
        Self { omega, damping, push, patch, noise, angle: 0.0, rate: 0.0 }
    }

    /// Angle, rad, and rate, rad/s, `dt_s` later.
    pub fn step(&mut self, dt_s: f64) -> [f64; 2] {
        let push = self.push.step(dt_s, &mut self.noise) * self.patch.step(dt_s, &mut self.noise).exp();
        let swing = push - self.omega * (2.0 * self.damping * self.rate + self.omega * self.angle);
        let before = self.rate;
        self.rate += swing * dt_s;
        self.angle += 0.5 * (before + self.rate) * dt_s;
        [self.angle, self.rate]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT_S: f64 = 0.005;

    fn rms(values: impl Iterator<Item = f64>) -> f64 {
        let (sum, n) = values.fold((0.0, 0.0), |(sum, n), v| (sum + v * v, n + 1.0));
        f64::sqrt(sum / n)
    }

    #[test]
    fn what_wanders_keeps_its_strength_and_forgets_in_its_time() {
        let mut noise = Noise::new(1);
        let mut wander = Wander::new(2.0, 0.5, &mut noise);
        let x: Vec<f64> = (0..400_000).map(|_| wander.step(DT_S, &mut noise)).collect();
        assert!((rms(x.iter().copied()) - 2.0).abs() < 0.06);
        let follow = x.windows(101).map(|w| w[0] * w[100]).sum::<f64>() / (x.len() - 100) as f64;
        assert!((follow / 4.0 - (-1.0_f64).exp()).abs() < 0.05, "{follow}");
    }

    #[test]
    fn gusts_have_the_rate_asked_for_and_heavy_tails() {
        let (mut rates, mut angles) = (Vec::new(), Vec::new());
        for seed in 0..20 {
            let mut gusts = Gusts::new(5.0, 2.5, 0.7, seed);
            for _ in 0..60_000 {
                let [angle, rate] = gusts.step(DT_S);
                angles.push(angle);
                rates.push(rate);
            }
        }
        let rate = rms(rates.iter().copied());
        assert!((rate - 5.0).abs() < 0.5, "{rate}");
        let angle = rms(angles.iter().copied());
        assert!((1.5..3.0).contains(&angle), "{angle}");
        rates.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
        let most = rates[rates.len() * 99 / 100].abs() / rate;
        // A normal distribution has 2.58.
        assert!((2.7..4.0).contains(&most), "{most}");
    }

    #[test]
    fn the_rate_is_the_angle_s_derivative() {
        let mut gusts = Gusts::new(5.0, 2.5, 0.7, 3);
        let [mut angle, mut rate] = gusts.step(DT_S);
        for _ in 0..1000 {
            let before = [angle, rate];
            [angle, rate] = gusts.step(DT_S);
            assert!((angle - before[0] - 0.5 * DT_S * (before[1] + rate)).abs() < 1e-12);
        }
    }
}
