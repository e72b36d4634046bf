//! How much the sine overestimates, so that the standard deviation can own up to it.

use crate::sky::{Averaging, FieldOfView, PairCurve, Response, Sky};

/// The excess of the inverse sine over the true angle for the report's sky, seen by sensors with a
/// bell-shaped field of view: up to 2.7° for a 90° field (report, figures 8 and 9).
#[derive(Clone, Debug)]
pub struct Excess(PairCurve);

impl Excess {
    /// For sensors of `field_of_view_deg` between half-power points; takes a few milliseconds.
    pub fn new(field_of_view_deg: f64) -> Self {
        let Sky { ground_c, sky_max_k, shape } = Sky::NAMIBIA;
        let field = FieldOfView::Gaussian { fwhm_deg: field_of_view_deg };
        Self(Response::new(shape, field, Averaging::Temperature).pair_curve(ground_c, sky_max_k))
    }

    /// How far an indicated `angle` (rad, within ±90°) may lie beyond the true one, rad, ≥ 0.
    pub fn at(&self, angle: f64) -> f64 {
        (angle - self.0.inverse(angle.sin()).asin()).abs()
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
