//! ArduPilot 1.x and 2.x: angles in proportion to the signals.

use super::Baseline;

/// The filter of the vertical pair takes in nothing beyond this roll, °.
const FILTER_ROLL_DEG: f64 = 15.0;
/// The largest angles, °.
const LIMIT_DEG: f64 = 60.0;

/// `90° · v/M`, `M` 0.88 times the vertical pair's size, which a filter of a tenth a sample follows
/// while the wings are nearly level. A roll that a fallen contrast makes too large stops the filter.
#[derive(Debug, Default)]
pub struct ArduPilot {
    filtered_k: Option<f64>,
    roll_deg: f64,
}

impl Baseline for ArduPilot {
    fn update(&mut self, _: f64, [x, y, z]: [f64; 3]) -> Option<(f64, f64)> {
        let filtered_k = match self.filtered_k {
            None => z,
            Some(before) if self.roll_deg.abs() <= FILTER_ROLL_DEG => 0.1 * z + 0.9 * before,
            Some(before) => before,
        };
        self.filtered_k = Some(filtered_k);
        let largest_k = 0.88 * filtered_k.abs();
        if largest_k <= 0.0 {
            return None;
        }
        let angle_deg = |v: f64| (90.0 * (v / largest_k)).clamp(-LIMIT_DEG, LIMIT_DEG);
        self.roll_deg = angle_deg(y);
        Some((self.roll_deg, angle_deg(x)))
    }
}
