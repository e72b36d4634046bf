//! The report's scheme: `asin(y/R)`, `asin(x/R)`.

use super::{Baseline, arc_sine_deg};

/// The time constant of the low-pass over the vertical pair, s ("a few seconds").
const TIME_CONSTANT_S: f64 = 3.0;
/// The largest roll, °.
const ROLL_LIMIT_DEG: f64 = 45.0;

/// `R` is the vertical pair's size, low-passed over 3 s; roll within ±45°.
#[derive(Debug, Default)]
pub struct Report {
    /// `R` with the time of the sample that it holds, K and s.
    range: Option<(f64, f64)>,
}

impl Baseline for Report {
    fn update(&mut self, time_s: f64, [x, y, z]: [f64; 3]) -> Option<(f64, f64)> {
        let range = match self.range {
            None => z.abs(),
            Some((before, last_s)) => {
                let kept = ((last_s - time_s) / TIME_CONSTANT_S).min(0.0).exp();
                before * kept + z.abs() * (1.0 - kept)
            }
        };
        self.range = Some((range, time_s));
        let roll = arc_sine_deg(y, range)?.clamp(-ROLL_LIMIT_DEG, ROLL_LIMIT_DEG);
        Some((roll, arc_sine_deg(x, range)?))
    }
}
