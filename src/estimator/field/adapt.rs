//! How much the world moves, learnt from the innovations: they are white when the filter is right.

use super::state::MAX_SENSORS;

/// The bounds of a factor, and how fast it is learnt, 1/s.
const WINDOW_S: f64 = 4.0;

/// Watches one group of innovations. Where they keep their sign the process noise is too small;
/// where they change it too often, too large. The sensors' own noise has no part in it.
#[derive(Clone, Debug)]
pub struct Whiteness<const N: usize> {
    smooth_s: f64,
    gain: (f64, f64),
    bounds: (f64, f64),
    smooth: [f64; N],
    slow: f64,
    all: f64,
    /// What the process noise is multiplied with.
    pub factor: f64,
}

impl<const N: usize> Whiteness<N> {
    /// With the time over which innovations are averaged, s, how fast the factor is learnt, 1/s, and
    /// its bounds.
    pub fn new(smooth_s: f64, gain: (f64, f64), bounds: (f64, f64), factor: f64) -> Self {
        Self { smooth_s, gain, bounds, smooth: [0.0; N], slow: 0.0, all: 0.0, factor }
    }

    /// Takes in a frame's innovations.
    pub fn update(&mut self, innovations: &[f64; N], dt_s: f64) {
        let a = (-dt_s / self.smooth_s).exp();
        let w = -(-dt_s / WINDOW_S).exp_m1();
        let (mut slow, mut all) = (0.0, 0.0);
        for (s, v) in self.smooth.iter_mut().zip(innovations) {
            *s = a * *s + (1.0 - a) * v;
            slow += *s * *s;
            all += v * v;
        }
        // White: the average has this share of the power.
        self.slow += w * (slow * (1.0 + a) / (1.0 - a) - self.slow);
        self.all += w * (all - self.all);
        if self.all > 0.0 && self.slow > 0.0 {
            let excess = (self.slow / self.all).ln().clamp(-1.0, 1.5);
            let gain = if excess > 0.0 { self.gain.0 } else { self.gain.1 };
            self.factor = (self.factor * (gain * excess * dt_s).exp()).clamp(self.bounds.0, self.bounds.1);
        }
    }
}

/// Learns how strong the sensors' own scenes are from what the filter makes of them.
#[derive(Clone, Debug)]
pub struct SceneStrength {
    left: [f64; MAX_SENSORS],
    /// Their variance, K².
    pub variance: f64,
    floor: f64,
    /// The variance without its floor.
    bare: f64,
}

impl SceneStrength {
    /// Begins at `sigma`, K.
    pub fn new(sigma: f64, floor: f64) -> Self {
        Self { left: [0.0; MAX_SENSORS], variance: sigma * sigma, floor: floor * floor, bare: sigma * sigma }
    }

    /// Takes in each sensor's innovation and its scene, K; `rest` leaves of a pattern over the sensors
    /// what nothing else explains, and says in how many dimensions.
    pub fn update(
        &mut self,
        innovations: &[f64; MAX_SENSORS],
        scenes: &[f64; MAX_SENSORS],
        dt_s: f64,
        time_s: (f64, f64),
        rest: impl Fn(&mut [f64; MAX_SENSORS]) -> usize,
    ) {
        let w = -(-dt_s / 1.0).exp_m1();
        for (left, innovation) in self.left.iter_mut().zip(innovations) {
            *left += w * (innovation - *left);
        }
        let mut pattern = std::array::from_fn(|i| self.left[i] + scenes[i]);
        let dimensions = rest(&mut pattern);
        if dimensions > 0 {
            let seen = pattern.iter().map(|v| v * v).sum::<f64>() / dimensions as f64;
            let time_s = if seen > self.bare { time_s.0 } else { time_s.1 };
            let w = -(-dt_s / time_s).exp_m1();
            self.bare = (self.bare + w * (seen - self.bare)).min(9.0);
            self.variance = self.bare.max(self.floor);
        }
    }

    /// How surely what is seen is no sky that is alike all around, 0..1.
    pub fn unlike(&self) -> f64 {
        let x = ((self.bare.sqrt() - 0.015) / 0.025).clamp(0.0, 1.0);
        x * x * (3.0 - 2.0 * x)
    }
}
