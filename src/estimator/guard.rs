//! The guard against underestimation.

/// Below this standard deviation there is nothing to guard against, rad: 0.15°.
const SURE: f64 = 0.002_6;
/// The share of the doubt beyond it by which an angle is shown larger.
const GUARD: f64 = 0.5;
/// Angles from which, and beyond which wholly, that is done, rad: 10° and 30°.
const GUARDED: (f64, f64) = (0.175, 0.524);
/// The largest angle added, rad: 5°.
const LARGEST: f64 = 0.087;

/// Where the model is in doubt the error goes to the safe side: an angle beyond 10° is shown larger by
/// a share of the doubt. Roll beyond 90° goes toward the back.
pub fn guard(angle: f64, sigma: f64, limit: f64) -> f64 {
    let x = ((angle.abs() - GUARDED.0) / (GUARDED.1 - GUARDED.0)).clamp(0.0, 1.0);
    let added = (GUARD * (sigma - SURE).max(0.0)).min(LARGEST) * x;
    (angle.abs() + added).min(limit.max(angle.abs())).copysign(angle)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_guard_never_makes_an_angle_smaller_and_is_idle_while_sure() {
        for deg in -180..=180 {
            let angle = f64::from(deg).to_radians();
            for sigma in [0.0, 0.005, 0.02, 0.1, 3.0] {
                let shown = guard(angle, sigma, std::f64::consts::PI);
                assert!(shown.abs() >= angle.abs() && shown.abs() <= angle.abs() + 0.0871 && shown * angle >= 0.0);
            }
            assert_eq!(guard(angle, SURE, std::f64::consts::PI), angle);
        }
        assert_eq!(guard(std::f64::consts::PI, 1.0, std::f64::consts::PI), std::f64::consts::PI);
    }
}
