//! UAVX: inverse sine over the largest signal seen, which decays.

use super::{Baseline, arc_sine_deg};

/// Full scale of a pair, K. UAVX has its converter's; for thermopiles in kelvin, what no sky exceeds.
const FULL_SCALE_K: f64 = 100.0;
/// What the peak loses with each sample of each of the three axes, of full scale.
const DECAY: f64 = 1e-5;

/// `S` is the largest of `|x|`, `|y|`, `|z|` seen so far, less its decay: a matter of samples, not of time.
#[derive(Debug, Default)]
pub struct Uavx {
    peak_k: f64,
}

impl Baseline for Uavx {
    fn update(&mut self, _: f64, signals_k: [f64; 3]) -> Option<(f64, f64)> {
        let peak_k = signals_k.iter().fold(self.peak_k, |s, v| s.max(v.abs()));
        self.peak_k = (peak_k - 3.0 * DECAY * FULL_SCALE_K).max(0.0);
        let [x, y, _] = signals_k;
        Some((arc_sine_deg(y, self.peak_k)?, arc_sine_deg(x, self.peak_k)?))
    }
}
