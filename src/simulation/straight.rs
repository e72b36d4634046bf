//! What runs straight past the flight as far as one can see: ridges, banks of cloud.

use super::feature::{CLOUD_BASE_K, behind_k};

/// A bank of cloud's edge from full to none, °.
const EDGE_DEG: f64 = 10.0;

/// A long straight thing on one side. Seen from beside its middle, a line as high as `h` there is as
/// high as `atan(tan h · cos off)` at an azimuth `off` it, and nothing behind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Straight {
    /// Cosine and sine of its middle's azimuth.
    toward: [f64; 2],
    what: What,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum What {
    /// As warm as the ground; the tangent of its height.
    Ridge(f64),
    /// Its height, °, and its opacity, 0..1.
    Cloud(f64, f64),
}

impl Straight {
    /// A ridge toward `azimuth`, rad clockwise from north, `height_deg` above the horizon.
    pub fn ridge(azimuth: f64, height_deg: f64) -> Self {
        let (sin, cos) = azimuth.sin_cos();
        Self { toward: [cos, sin], what: What::Ridge(height_deg.to_radians().tan()) }
    }

    /// A bank of cloud from the horizon to `height_deg`, with a soft edge there, of an opacity of 0..1.
    pub fn cloud(azimuth: f64, height_deg: f64, opacity: f64) -> Self {
        let (sin, cos) = azimuth.sin_cos();
        Self { toward: [cos, sin], what: What::Cloud(height_deg, opacity) }
    }

    /// Whether ground is seen there: north, east, up.
    pub(super) fn is_ground(&self, direction: [f64; 3]) -> bool {
        match self.what {
            What::Ridge(tan) => direction[2] < tan * self.nearing(direction),
            What::Cloud(..) => false,
        }
    }

    /// What is left of a sky that is `deficit_k` colder than the ground, K.
    pub(super) fn through_k(&self, deficit_k: f64, direction: [f64; 3]) -> f64 {
        let near = self.nearing(direction);
        let What::Cloud(height_deg, opacity) = self.what else { return deficit_k };
        if near <= 0.0 {
            return deficit_k;
        }
        let below_deg = height_deg - direction[2].atan2(near).to_degrees();
        let inside = (0.5 + below_deg / EDGE_DEG).clamp(0.0, 1.0);
        behind_k(deficit_k, opacity * inside * inside * (3.0 - 2.0 * inside), CLOUD_BASE_K)
    }

    /// How far a direction goes toward it.
    fn nearing(&self, [north, east, _]: [f64; 3]) -> f64 {
        self.toward[0] * north + self.toward[1] * east
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn direction(azimuth_deg: f64, elevation_deg: f64) -> [f64; 3] {
        let ((sa, ca), (se, ce)) = (azimuth_deg.to_radians().sin_cos(), elevation_deg.to_radians().sin_cos());
        [ce * ca, ce * sa, se]
    }

    #[test]
    fn a_long_ridge_falls_off_along_its_outline() {
        for height_deg in [5.0, 25.0, 60.0, 85.0_f64] {
            let ridge = Straight::ridge(70.0_f64.to_radians(), height_deg);
            for off_deg in [-89.0, -60.0, -20.0, 0.0, 45.0, 80.0_f64] {
                let edge_deg = (height_deg.to_radians().tan() * off_deg.to_radians().cos()).atan().to_degrees();
                assert!(ridge.is_ground(direction(70.0 + off_deg, edge_deg - 0.01)), "{height_deg} {off_deg}");
                assert!(!ridge.is_ground(direction(70.0 + off_deg, edge_deg + 0.01)), "{height_deg} {off_deg}");
            }
            assert!(!ridge.is_ground(direction(250.0, 0.1)) && !ridge.is_ground(direction(161.0, 0.1)));
        }
    }

    #[test]
    fn a_bank_of_cloud_is_8_k_colder_than_the_ground_with_a_soft_edge() {
        let bank = Straight::cloud(0.0, 40.0, 1.0);
        let left = |azimuth_deg, elevation_deg| bank.through_k(30.0, direction(azimuth_deg, elevation_deg));
        assert_eq!([left(0.0, 10.0), left(0.0, 46.0), left(180.0, 10.0)], [8.0, 30.0, 30.0]);
        assert!((left(0.0, 40.0) - 19.0).abs() < 1e-9);
        // 60° off it is lower: atan(tan 40° · cos 60°) is 22.8°.
        assert!((left(60.0, (40.0_f64.to_radians().tan() * 0.5).atan().to_degrees()) - 19.0).abs() < 1e-9);
        assert_eq!(bank.through_k(5.0, direction(0.0, 10.0)), 5.0, "the sky behind is warmer");
        assert_eq!(bank.through_k(-3.0, direction(0.0, 10.0)), -3.0);
    }
}
