//! An attitude turned on by body rates, to a moment after the last measurement. Pure.

use super::rates::Rates;
use crate::attitude::Attitude;
use crate::estimator::vector::{Vector, add_scaled, product, rotation};
use crate::time::Time;

/// An attitude is carried no farther than this, s.
pub const FARTHEST_S: f64 = 0.25;

/// The attitude at `to` of what had `attitude` and `sigma` at `from`; `None` where the rates do not tell.
///
/// After the newest rates theirs are a guess; what such guesses were off by of late is added to the standard
/// deviations. `correction` is added to the rates, rad/s on (nose, left, up).
pub fn carry(
    (attitude, sigma): (Attitude, Attitude),
    rates: &Rates,
    correction: Vector,
    (from, to): (Time, Time),
) -> Option<(Attitude, Attitude)> {
    if !(0.0..=FARTHEST_S).contains(&to.since(from)) {
        return None;
    }
    let mut up = attitude.vertical();
    rates.through(from, to, |rate, dt_s| {
        // Front, right, down to nose, left, up; the vertical goes the other way round than the body.
        let [p, q, r] = rate.map(f64::to_radians);
        let turn = add_scaled([p, -q, -r], 1.0, correction);
        up = product(&rotation(turn.map(|c| -c * dt_s)), up);
    })?;
    let carried = Attitude::from_vertical(up);
    let [p, q, r] = rates.unknown(to);
    let (sin, cos) = carried.roll.sin_cos();
    let pitch = (q * cos * cos + r * sin * sin).sqrt().to_radians();
    let tan = carried.pitch.tan().clamp(-5.0, 5.0);
    let across = (q * sin * sin + r * cos * cos).sqrt().to_radians();
    let roll = p.sqrt().to_radians().hypot(across * tan);
    Some((carried, Attitude { roll: sigma.roll.hypot(roll), pitch: sigma.pitch.hypot(pitch) }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulation::aircraft::Aircraft;
    use crate::simulation::manoeuvre::{Random, Style};
    use crate::simulation::trajectory::Trajectory;

    fn at(s: f64) -> Time {
        Time::from_secs_f64(100.0 + s)
    }

    /// Along a flight the carried attitude is the flown one.
    #[test]
    fn a_flight_is_followed() {
        let flight = Trajectory::fly(&Aircraft::default(), &Style::Random(Random::default()), 60.0, 5);
        let mut rates = Rates::default();
        let (mut worst, mut checked) = (0.0_f64, 0);
        for i in 0..6000 {
            let t = f64::from(i) * 0.01;
            let [p, q, r] = flight.at(t).body_rates_deg_s();
            // With a bias about the nose and to the right, which is known.
            rates.insert(at(t), [p + 0.02_f64.to_degrees(), q + 0.03_f64.to_degrees(), r]);
            if t > 1.0 {
                let given = (flight.at(t - 0.2).attitude(), Attitude::default());
                let (now, sigma) = carry(given, &rates, [-0.02, 0.03, 0.0], (at(t - 0.2), at(t))).unwrap();
                let truth = flight.at(t).attitude();
                worst = worst.max((now.roll - truth.roll).abs().max((now.pitch - truth.pitch).abs()).to_degrees());
                assert_eq!(sigma, Attitude::default(), "all of it is known");
                checked += 1;
            }
        }
        assert!(checked > 5000 && worst < 0.02, "{worst}°");
    }

    #[test]
    fn what_is_not_known_widens_and_what_is_too_far_is_not_carried() {
        let mut rates = Rates::default();
        // Rates that nobody foresees.
        let gust = |i: u32| f64::from(i.wrapping_mul(2_654_435_761) >> 16) / 6553.6;
        (0..50).for_each(|i| assert!(rates.insert(at(f64::from(i) * 0.02), [gust(i), 0.0, 0.0])));
        let level = (Attitude::default(), Attitude::from_degrees(0.5, 0.5));
        let known = carry(level, &rates, [0.0; 3], (at(0.9), at(0.98))).unwrap().1;
        let held = carry(level, &rates, [0.0; 3], (at(0.9), at(1.06))).unwrap().1;
        assert!(known == level.1 && held.roll > 1.05 * known.roll && held.pitch < 1.02 * known.pitch, "{held:?}");
        assert_eq!(carry(level, &rates, [0.0; 3], (at(0.9), at(1.2))), None);
        assert_eq!(carry(level, &rates, [0.0; 3], (at(0.9), at(0.8))), None, "backwards");
        assert_eq!(carry(level, &Rates::default(), [0.0; 3], (at(0.9), at(0.9))), None, "no rates at all");
    }
}
