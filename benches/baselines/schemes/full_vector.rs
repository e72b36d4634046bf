//! The vector of the pairs taken for the vertical itself: `atan2(y, z)`, `asin(x/|(x, y, z)|)`.

use super::{Baseline, arc_sine_deg};

/// No state, no filter.
#[derive(Debug)]
pub struct FullVector;

impl Baseline for FullVector {
    fn update(&mut self, _: f64, [x, y, z]: [f64; 3]) -> Option<(f64, f64)> {
        Some((y.atan2(z).to_degrees(), arc_sine_deg(x, x.hypot(y).hypot(z))?))
    }
}
