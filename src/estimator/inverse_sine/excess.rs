//! How much the sine overestimates, so that the standard deviation can own up to it.

use crate::sky::{Averaging, FieldOfView, Response, Sky};

/// Entries a degree.
const STEPS_PER_DEG: usize = 4;

/// The excess of the inverse sine over the true angle for the report's sky, seen by sensors with a
/// bell-shaped field of view: up to 2.7° for a 90° field (report, figures 8 and 9). A table over the
/// indicated angle, 0 to 90°.
#[derive(Clone, Debug)]
pub struct Excess(Vec<f64>);

impl Excess {
    /// For sensors of `field_of_view_deg` between half-power points; takes a few milliseconds.
    pub fn new(field_of_view_deg: f64) -> Self {
        let Sky { ground_c, sky_max_k, shape } = Sky::NAMIBIA;
        let field = FieldOfView::Gaussian { fwhm_deg: field_of_view_deg };
        let curve = Response::new(shape, field, Averaging::Temperature).pair_curve(ground_c, sky_max_k);
        let at = |i: usize| {
            let angle = (i as f64 / STEPS_PER_DEG as f64).to_radians();
            (angle - curve.inverse(angle.sin()).asin()).abs()
        };
        Self((0..=90 * STEPS_PER_DEG).map(at).collect())
    }

    /// How far an indicated `angle` (rad, within ±90°) may lie beyond the true one, rad, ≥ 0.
    pub fn at(&self, angle: f64) -> f64 {
        let place = angle.abs().to_degrees() * STEPS_PER_DEG as f64;
        let cell = (place as usize).min(self.0.len() - 2);
        let (low, high) = (self.0[cell], self.0[cell + 1]);
        low + (place - cell as f64).min(1.0) * (high - low)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_90_degree_sensor_reads_up_to_2_7_degrees_too_much() {
        let excess = Excess::new(90.0);
        let worst = (0..=900).map(|i| excess.at(f64::from(i).to_radians() / 10.0)).fold(0.0, f64::max).to_degrees();
        assert!((2.6..2.8).contains(&worst), "{worst}");
        assert!(excess.at(0.0) < 1e-9);
        assert!((excess.at(-0.5) - excess.at(0.5)).abs() < 1e-12);
    }
}
