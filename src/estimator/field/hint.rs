//! Something warm beside: a ridge, a cloud bank (report section V: the positive side of what misleads the attitude).

use super::FieldEstimator;
use super::predict::scene;
use super::state::OFFSET;
use crate::attitude::Hint;
use crate::estimator::PAIR_SLOPE;
use crate::estimator::vector::{add_scaled, cross, dot};

/// Roll and pitch must be known by other instruments to this standard deviation, rad: else a warm side and a tilt
/// are one and the same.
const KNOWN: f64 = 0.05;
/// The least warmth that is worth a hint, K and as a share of the contrast.
const LEAST: (f64, f64) = (2.0, 0.08);

impl FieldEstimator {
    /// What is warmer beside than the even sky, where that can be told: with a gyro, and with turns and climbs that
    /// say where the horizon is.
    pub(super) fn hint(&self) -> Option<Hint> {
        let s = &self.state;
        let known = (0..2).all(|i| s.p[OFFSET + i][OFFSET + i] < KNOWN * KNOWN);
        if !self.gyro.in_use() || !known || !self.model.is_absolute() {
            return None;
        }
        let sky = scene(s);
        let up = s.vertical();
        // A horizon that leans is warm where it leans up to, as a pair would see it.
        let warm = |i: usize| s.axes[i].map(|c| PAIR_SLOPE * sky.contrast_k * sky.lean[i] * c);
        let mut toward = add_scaled(warm(0), 1.0, warm(1));
        for i in 0..self.model.sensors() {
            let extra_k = self.model.seen(i, &s.axes, &sky).scene * s.x[s.scene(i)];
            let direction = self.model.direction(i);
            toward = add_scaled(toward, extra_k, add_scaled(direction, -dot(direction, up), up));
        }
        let strength_k = dot(toward, toward).sqrt();
        // Front and left of the level plane.
        let front = add_scaled([1.0, 0.0, 0.0], -up[0], up);
        let left = cross(up, front);
        let bearing = -dot(toward, left).atan2(dot(toward, front));
        (strength_k > LEAST.0.max(LEAST.1 * sky.contrast_k.abs())).then_some(Hint { bearing, strength_k })
    }
}

#[cfg(test)]
mod tests {
    use super::super::Tuning;
    use super::super::state::{CONTRAST, DEPTH, GROUND, LEAN};
    use super::*;
    use crate::attitude::Attitude;
    use crate::estimator::vector::unit;
    use crate::frame::Aiding;
    use crate::head::Head;
    use crate::simulation::Scenario;
    use crate::sky::FieldOfView;
    use crate::time::Time;

    /// A filter that knows all and has a gyro, its nose so far clockwise from north.
    fn knowing(head: &Head, heading_deg: f64, attitude: Attitude) -> FieldEstimator {
        let mut e = FieldEstimator::new(head, FieldOfView::Gaussian { fwhm_deg: 90.0 }, Tuning::default());
        let at_rest = Aiding { gyro_deg_s: [Some(0.0); 3], ..Aiding::default() };
        e.gyro.update(&at_rest, Time::from_secs_f64(10.0), 0.02, false);
        for (i, value) in [(GROUND, 15.0), (CONTRAST, 35.0), (DEPTH, -1.2)] {
            e.state.x[i] = value;
        }
        let up = attitude.vertical();
        let ahead = unit(add_scaled([1.0, 0.0, 0.0], -up[0], up)).unwrap();
        let left = cross(up, ahead);
        let (sin, cos) = heading_deg.to_radians().sin_cos();
        let north = add_scaled(ahead.map(|c| c * cos), sin, left);
        e.state.axes = [north, cross(up, north), up];
        e
    }

    fn apart_deg(a: f64, b: f64) -> f64 {
        (a.to_degrees() - b + 540.0).rem_euclid(360.0) - 180.0
    }

    #[test]
    fn it_points_to_the_warm_side_clockwise_from_the_nose() {
        for heading_deg in [0.0, 60.0, 90.0, 200.0, 315.0] {
            for (roll_deg, pitch_deg) in [(0.0, 0.0), (30.0, 0.0), (-40.0, 10.0), (0.0, -20.0)] {
                // North, then west.
                for (side, bearing_deg) in [(0, -heading_deg), (1, -90.0 - heading_deg)] {
                    let attitude = Attitude::from_degrees(roll_deg, pitch_deg);
                    let mut e = knowing(&Head::six(), heading_deg, attitude);
                    e.state.x[LEAN + side] = 0.3;
                    let hint = e.hint().expect("a warm side");
                    let off = apart_deg(hint.bearing, bearing_deg);
                    let flown = format!("side {side} at {heading_deg}°, {roll_deg}°, {pitch_deg}°");
                    assert!(off.abs() < 1e-6, "{flown}: {off}");
                    e.state.x[LEAN + side] = 0.6;
                    let twice = e.hint().unwrap().strength_k;
                    assert!((twice - 2.0 * hint.strength_k).abs() < 1e-9, "{flown}");
                }
            }
        }
    }

    #[test]
    fn what_one_sensor_sees_beside_is_told_and_what_it_sees_overhead_is_not() {
        for (sensor, bearing_deg) in [(0, Some(0.0)), (1, Some(180.0)), (2, Some(-90.0)), (3, Some(90.0)), (4, None)] {
            let mut e = knowing(&Head::six(), 30.0, Attitude::default());
            let own = e.state.scene(sensor);
            e.state.x[own] = 12.0;
            let hint = e.hint();
            assert_eq!(hint.is_some(), bearing_deg.is_some(), "sensor {sensor}");
            assert!(hint.zip(bearing_deg).is_none_or(|(h, deg)| apart_deg(h.bearing, deg).abs() < 1e-6), "{hint:?}");
        }
    }

    #[test]
    fn there_is_none_of_little_warmth_nor_without_what_tells_it_from_a_tilt() {
        let warm = |head: &Head, lean: f64| {
            let mut e = knowing(head, 0.0, Attitude::default());
            e.state.x[LEAN] = lean;
            e
        };
        let six = Head::six();
        assert!(warm(&six, 0.3).hint().is_some() && warm(&six, 0.01).hint().is_none());
        // 8 % of the contrast.
        let mut strong = knowing(&six, 0.0, Attitude::default());
        let own = strong.state.scene(0);
        strong.state.x[own] = 12.0;
        let strength_k = strong.hint().unwrap().strength_k;
        strong.state.x[CONTRAST] = 1.1 * strength_k / 0.08;
        assert_eq!(strong.hint(), None, "{strength_k} K");
        for i in 0..2 {
            let mut vague = warm(&six, 0.3);
            vague.state.p[OFFSET + i][OFFSET + i] = 0.06 * 0.06;
            assert_eq!(vague.hint(), None, "roll or pitch is not known by anything else");
        }
        let mut bare = warm(&six, 0.3);
        bare.gyro.distrust();
        assert_eq!(bare.hint(), None, "no gyro");
        let pairs = Scenario::named("clear-dry").unwrap().differential().head();
        assert_eq!(warm(&pairs, 0.3).hint(), None, "pairs know no temperature");
    }
}
