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
