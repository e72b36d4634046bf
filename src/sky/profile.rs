//! The sky's temperature against elevation.

/// How the sky's deficit against the ground grows from the horizon up, as a share of its largest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// `1 − exp(−k·E/90)`, E in degrees (MECSE-2-2007, section IV.A; k = 5.5 there).
    Exponential {
        /// Steepness, above 0.
        k: f64,
    },
    /// A plane-parallel grey atmosphere as warm as the ground, of emissivity `1 − exp(−τ/sin E)`.
    ///
    /// The deficit is what shines through of a cold space, `exp(−τ/sin E)`, over its value at the
    /// zenith. It is taken in temperature, which is exact for small deficits.
    Grey {
        /// Optical depth τ at the zenith, above 0: about 0.3 is dry, 1.5 humid.
        depth: f64,
    },
}

impl Shape {
    /// The deficit at the elevation whose sine is `sin_elevation`, 0 at and below the horizon,
    /// 0..1, increasing.
    pub fn deficit(self, sin_elevation: f64) -> f64 {
        if sin_elevation.is_nan() || sin_elevation <= 0.0 {
            return 0.0;
        }
        let s = sin_elevation.min(1.0);
        match self {
            Self::Exponential { k } => -(-k * s.asin() / std::f64::consts::FRAC_PI_2).exp_m1(),
            Self::Grey { depth } => (depth * (1.0 - 1.0 / s)).exp(),
        }
    }
}

/// Ground and sky.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sky {
    /// The ground's temperature, °C: what is seen everywhere below the horizon.
    pub ground_c: f64,
    /// The report's `SkyMax`, K: the ground less the coldest sky. Negative where the ground is the
    /// colder one (hail, section V.3).
    pub sky_max_k: f64,
    /// How the deficit grows with elevation.
    pub shape: Shape,
}

impl Sky {
    /// The night sky over Namibia of the report's figure 6: ground 16 °C, `SkyMax` 40 K.
    pub const NAMIBIA: Self = Self { ground_c: 16.0, sky_max_k: 40.0, shape: Shape::Exponential { k: 5.5 } };

    /// The afternoon sky over Durham of the report's figure 6: ground 5 °C, `SkyMax` 30 K.
    ///
    /// The ground is the caption's of figure 2. `SkyMax` is a choice: the text gives no number, only
    /// that Namibia's sky is the warmer of the two in °C (section III) and that a pair's output is
    /// flattened where the difference is low (section IV.A). With 30 K Durham's zenith, −24.9 °C,
    /// lies just below Namibia's −23.8 °C, and its contrast well below Namibia's.
    pub const DURHAM: Self = Self { ground_c: 5.0, sky_max_k: 30.0, shape: Shape::Exponential { k: 5.5 } };

    /// The temperature at `elevation_deg`, °C: the ground's below the horizon.
    pub fn temperature_c(&self, elevation_deg: f64) -> f64 {
        self.ground_c - self.sky_max_k * self.shape.deficit(elevation_deg.to_radians().sin())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exponential_is_the_reports_formula() {
        for sky in [Sky::NAMIBIA, Sky::DURHAM] {
            for e in 0..=90 {
                let e = f64::from(e);
                let report = sky.sky_max_k * (-e / 90.0 * 5.5).exp() - (sky.sky_max_k - sky.ground_c);
                assert!((sky.temperature_c(e) - report).abs() < 1e-6, "{e}°");
                assert_eq!(sky.temperature_c(-e), sky.ground_c);
            }
        }
    }

    #[test]
    fn namibias_sky_is_the_warmer_one_with_the_higher_contrast() {
        let [namibia, durham] = [Sky::NAMIBIA, Sky::DURHAM].map(|s| s.temperature_c(90.0));
        assert!(namibia > durham);
        assert!(16.0 - namibia > 5.0 - durham);
    }

    #[test]
    fn a_grey_atmosphere_radiates_by_its_thickness_along_the_view() {
        let depth = 0.5;
        let transparency = |e: f64| (-depth / e.to_radians().sin()).exp();
        for e in [1.0_f64, 5.0, 20.0, 60.0, 90.0] {
            let deficit = Shape::Grey { depth }.deficit(e.to_radians().sin());
            assert!((deficit - transparency(e) / transparency(90.0)).abs() < 1e-12, "{e}°");
        }
        // Dry air lets more of space through near the horizon.
        assert!(Shape::Grey { depth: 0.2 }.deficit(0.2) > Shape::Grey { depth: 1.5 }.deficit(0.2));
    }

    #[test]
    fn the_deficit_rises_from_the_horizon_to_the_zenith_and_bears_any_number() {
        for shape in [Shape::Exponential { k: 5.5 }, Shape::Grey { depth: 0.3 }, Shape::Grey { depth: 3.0 }] {
            let values: Vec<f64> = (-100..=100).map(|i| shape.deficit(f64::from(i) / 100.0)).collect();
            assert!(values.windows(2).all(|w| w[0] <= w[1]));
            assert_eq!(values[100], 0.0);
            assert_eq!(shape.deficit(f64::NAN), 0.0);
            assert_eq!(shape.deficit(7.0), shape.deficit(1.0));
            assert!(shape.deficit(f64::MIN_POSITIVE / 2.0) < 1e-300);
        }
    }
}
