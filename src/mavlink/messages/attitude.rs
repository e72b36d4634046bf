//! The attitude in its three forms: angles, a quaternion, a quaternion with covariance.
//!
//! Yaw is not known to a horizon. It is 0, or what the caller has from another source; no message but the covariance
//! has a way to say which. The same holds for body rates, which some methods tell.

use super::{Message, time_boot_ms};
use crate::mavlink::session::Seen;
use ::mavlink::dialects::common::{ATTITUDE_DATA, ATTITUDE_QUATERNION_COV_DATA, ATTITUDE_QUATERNION_DATA};
use std::f64::consts::PI;

/// The variance of a heading of which nothing is known, rad²: uniform over a turn.
const UNKNOWN_YAW: f64 = PI * PI / 3.0;

/// Roll, pitch and yaw, rad, if all of them are numbers.
fn angles(seen: &Seen) -> Option<[f64; 3]> {
    let attitude = seen.moment.attitude?;
    let yaw = seen.yaw.filter(|y| y.is_finite()).map_or(0.0, f64::from);
    let angles = [attitude.roll, attitude.pitch, yaw];
    angles.iter().all(|a| a.is_finite()).then_some(angles)
}

/// Body rates, rad/s; 0 where they are not known.
fn rates(seen: &Seen) -> [f32; 3] {
    let known = seen.moment.rates.filter(|rates| rates.iter().all(|r| r.is_finite()));
    known.unwrap_or_default().map(|r| r as f32)
}

/// The rotation from the airframe's axes (front, right, down) to (north, east, down): w, x, y, z; w ≥ 0.
fn rotation([roll, pitch, yaw]: [f64; 3]) -> [f32; 4] {
    let ((sr, cr), (sp, cp), (sy, cy)) = ((roll / 2.0).sin_cos(), (pitch / 2.0).sin_cos(), (yaw / 2.0).sin_cos());
    let q = [
        cr * cp * cy + sr * sp * sy,
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
    ];
    q.map(|c| if q[0] < 0.0 { -c } else { c } as f32)
}

/// ATTITUDE of the moment that the attitude speaks of; `None` while there is none, and for angles that are not finite.
pub fn attitude(seen: &Seen) -> Option<Message> {
    let ([roll, pitch, yaw], [rollspeed, pitchspeed, yawspeed]) = (angles(seen)?, rates(seen));
    Some(Message::Attitude(ATTITUDE_DATA {
        time_boot_ms: time_boot_ms(seen.moment.valid_at),
        roll: roll as f32,
        pitch: pitch as f32,
        yaw: yaw as f32,
        rollspeed,
        pitchspeed,
        yawspeed,
    }))
}

/// ATTITUDE_QUATERNION, under the same conditions.
pub fn quaternion(seen: &Seen) -> Option<Message> {
    let ([q1, q2, q3, q4], [rollspeed, pitchspeed, yawspeed]) = (rotation(angles(seen)?), rates(seen));
    Some(Message::Quaternion(ATTITUDE_QUATERNION_DATA {
        time_boot_ms: time_boot_ms(seen.moment.valid_at),
        q1,
        q2,
        q3,
        q4,
        rollspeed,
        pitchspeed,
        yawspeed,
    }))
}

/// ATTITUDE_QUATERNION_COV, if the standard deviations are finite as well. The covariance is of roll, pitch and yaw,
/// rad², uncorrelated; that of yaw is of a heading not known, whatever was handed in.
pub fn covariance(seen: &Seen) -> Option<Message> {
    let (q, [rollspeed, pitchspeed, yawspeed]) = (rotation(angles(seen)?), rates(seen));
    let (roll, pitch) = (seen.moment.sigma.roll.powi(2), seen.moment.sigma.pitch.powi(2));
    if !(roll as f32).is_finite() || !(pitch as f32).is_finite() {
        return None;
    }
    let mut covariance = [0.0; 9];
    (covariance[0], covariance[4], covariance[8]) = (roll as f32, pitch as f32, UNKNOWN_YAW as f32);
    let time_usec = seen.moment.valid_at.as_micros();
    Some(Message::Covariance(ATTITUDE_QUATERNION_COV_DATA {
        time_usec,
        q,
        rollspeed,
        pitchspeed,
        yawspeed,
        covariance,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::attitude::Attitude;
    use crate::state::Moment;
    use crate::time::Time;
    use proptest::prelude::*;

    fn seen(roll: f64, pitch: f64, yaw: Option<f32>) -> Seen {
        let valid_at = Time::from_nanos(12_345_678_999);
        let sigma = Attitude { roll: 0.03, pitch: 0.05 };
        let attitude = Some(Attitude { roll, pitch });
        Seen { moment: Moment { attitude, sigma, valid_at, ..Moment::default() }, yaw, ..Seen::default() }
    }

    #[test]
    fn angles_that_are_not_finite_are_no_attitude() {
        for (roll, pitch) in [(f64::NAN, 0.0), (0.0, f64::INFINITY)] {
            let seen = seen(roll, pitch, None);
            assert_eq!((attitude(&seen), quaternion(&seen), covariance(&seen)), (None, None, None));
        }
        let mut withheld = seen(0.0, 0.0, None);
        withheld.moment.attitude = None;
        assert_eq!((attitude(&withheld), quaternion(&withheld), covariance(&withheld)), (None, None, None));
        for sigma in [f64::NAN, f64::INFINITY, 1e30] {
            let mut unsure = seen(0.1, 0.1, None);
            unsure.moment.sigma = Attitude { roll: sigma, pitch: 0.1 };
            assert!(covariance(&unsure).is_none() && quaternion(&unsure).is_some());
        }
    }

    #[test]
    fn a_yaw_that_is_no_number_is_none() {
        for (given, sent) in [(None, 0.0), (Some(f32::NAN), 0.0), (Some(1.5), 1.5)] {
            let Some(Message::Attitude(a)) = attitude(&seen(0.1, 0.2, given)) else { panic!() };
            assert_eq!(a.yaw, sent);
        }
    }

    #[test]
    fn rates_are_told_where_they_are_known() {
        let told = |rates| {
            let mut seen = seen(0.1, 0.2, None);
            seen.moment.rates = rates;
            let Some(Message::Attitude(a)) = attitude(&seen) else { panic!() };
            let Some(Message::Quaternion(q)) = quaternion(&seen) else { panic!() };
            let Some(Message::Covariance(c)) = covariance(&seen) else { panic!() };
            let told = [a.rollspeed, a.pitchspeed, a.yawspeed];
            assert_eq!(told, [q.rollspeed, q.pitchspeed, q.yawspeed]);
            assert_eq!(told, [c.rollspeed, c.pitchspeed, c.yawspeed]);
            told
        };
        assert_eq!(told(Some([0.5, -0.25, 1.0])), [0.5, -0.25, 1.0]);
        assert_eq!([told(None), told(Some([0.5, f64::NAN, 0.0]))], [[0.0; 3]; 2]);
    }

    #[test]
    fn the_covariance_is_of_roll_pitch_and_yaw_row_by_row() {
        let Some(Message::Covariance(m)) = covariance(&seen(0.0, 0.0, Some(1.0))) else { panic!() };
        assert_eq!(m.time_usec, 12_345_678);
        let expected = [0.0009, 0.0, 0.0, 0.0, 0.0025, 0.0, 0.0, 0.0, 3.289_868];
        assert!(m.covariance.iter().zip(expected).all(|(c, e): (&f32, f32)| (c - e).abs() < 1e-6), "{m:?}");
    }

    proptest! {
        #[test]
        fn the_quaternion_turns_back_into_the_angles(
            roll in -3.1_f64..3.1, pitch in -1.5_f64..1.5, yaw in -3.1_f32..3.1,
        ) {
            let Some(Message::Quaternion(q)) = quaternion(&seen(roll, pitch, Some(yaw))) else { panic!() };
            let [w, x, y, z] = [q.q1, q.q2, q.q3, q.q4].map(f64::from);
            prop_assert!(w >= 0.0);
            prop_assert!((w * w + x * x + y * y + z * z - 1.0).abs() < 1e-6);
            let got_roll = (2.0 * (w * x + y * z)).atan2(1.0 - 2.0 * (x * x + y * y));
            let got_pitch = (2.0 * (w * y - z * x)).clamp(-1.0, 1.0).asin();
            let got_yaw = (2.0 * (w * z + x * y)).atan2(1.0 - 2.0 * (y * y + z * z));
            prop_assert!((got_roll - roll).abs() < 1e-4 && (got_pitch - pitch).abs() < 1e-3);
            prop_assert!((got_yaw - f64::from(yaw)).abs() < 1e-4);
        }
    }
}
