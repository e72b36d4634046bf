//! From the head's axes to the airframe's: the trims, taken off.

use crate::attitude::Attitude;
use crate::estimator::trim::{level, turned};
use crate::estimator::vector::Vector;

/// How the head sits on the airframe, by the roll and pitch that it shows in level flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mounting {
    /// The vertical is turned from the head's axes to the airframe's: right in any attitude.
    Turned(Attitude),
    /// Angles are subtracted, as published: right for small trims. For `inverse-sine`, whose roll is
    /// no angle of a vertical: turning one made of it would carry its errors of roll into pitch.
    Offset(Attitude),
}

impl Mounting {
    /// The airframe's attitude when the head's is `head`. Roll in (−π, π] when turned.
    pub fn to_body(self, head: Attitude) -> Attitude {
        match self {
            Self::Offset(trim) => Attitude { roll: head.roll - trim.roll, pitch: head.pitch - trim.pitch },
            Self::Turned(trim) => level(head, trim),
        }
    }

    /// The airframe's body rates about x (nose), y (right), z (down) when the head's are `head` on (nose, left, up).
    pub fn rates_to_body(self, head: Vector) -> Vector {
        let (Self::Offset(trim) | Self::Turned(trim)) = self;
        let [nose, left, up] = turned(head, trim);
        [nose, -left, -up]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimator::vector::{product, rotation};

    fn body_deg(trim_deg: (f64, f64), head_deg: (f64, f64)) -> (f64, f64) {
        let trim = Attitude::from_degrees(trim_deg.0, trim_deg.1);
        let body = Mounting::Turned(trim).to_body(Attitude::from_degrees(head_deg.0, head_deg.1));
        (body.roll.to_degrees(), body.pitch.to_degrees())
    }

    fn close(a: (f64, f64), b: (f64, f64)) -> bool {
        // ±180 is one roll.
        let roll = (a.0 - b.0 + 180.0).rem_euclid(360.0) - 180.0;
        roll.abs() < 1e-9 && (a.1 - b.1).abs() < 1e-9
    }

    #[test]
    fn what_the_head_shows_in_level_flight_is_level() {
        for trim in [(3.0, -2.0), (-45.0, 45.0), (10.0, 0.0), (0.0, 7.0)] {
            assert!(close(body_deg(trim, trim), (0.0, 0.0)), "{trim:?}");
        }
    }

    #[test]
    fn a_trim_of_roll_alone_is_subtracted_in_any_attitude() {
        for head in [(0.0, 0.0), (30.0, -20.0), (-120.0, 60.0), (179.0, 5.0), (-179.0, 5.0)] {
            assert!(close(body_deg((4.0, 0.0), head), (head.0 - 4.0, head.1)), "{head:?}");
        }
    }

    #[test]
    fn a_trim_of_pitch_alone_is_subtracted_with_wings_level_and_added_on_the_back() {
        for pitch in [-60.0, -5.0, 0.0, 20.0, 80.0] {
            assert!(close(body_deg((0.0, 6.0), (0.0, pitch)), (0.0, pitch - 6.0)), "{pitch}");
            assert!(close(body_deg((0.0, 6.0), (180.0, -pitch)), (180.0, 6.0 - pitch)), "{pitch}");
        }
    }

    #[test]
    fn nearly_level_it_is_the_subtraction() {
        let (roll, pitch) = body_deg((2.0, -1.5), (3.0, 1.0));
        assert!((roll - 1.0).abs() < 0.1 && (pitch - 2.5).abs() < 0.1, "{roll} {pitch}");
        let trim = Attitude::from_degrees(2.0, -1.5);
        let offset = Mounting::Offset(trim).to_body(Attitude::from_degrees(3.0, 1.0));
        assert!(close((offset.roll.to_degrees(), offset.pitch.to_degrees()), (1.0, 2.5)));
    }

    /// An airframe's vertical goes round with its rates, and a head's on it with the head's: to first order in the time.
    #[test]
    fn rates_are_turned_as_the_vertical_is() {
        let trim = Attitude::from_degrees(12.0, -25.0);
        let (rates, dt_s) = ([0.3, -0.8, 0.5], 1e-5);
        let step = |up: Vector, [p, q, r]: [f64; 3]| product(&rotation([-p * dt_s, q * dt_s, r * dt_s]), up);
        let head = Attitude::from_degrees(40.0, 15.0);
        let mounting = Mounting::Turned(trim);
        let turned = Attitude::from_vertical(step(head.vertical(), rates));
        // On (nose, left, up) of the head, from (nose, right, down).
        let [p, q, r] = rates;
        let expected = step(mounting.to_body(head).vertical(), mounting.rates_to_body([p, -q, -r]));
        let found = mounting.to_body(turned).vertical();
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?} {expected:?}");
        assert_eq!(Mounting::Turned(Attitude::default()).rates_to_body([1.0, 2.0, 3.0]), [1.0, -2.0, -3.0]);
    }

    /// The airframe's vertical, turned to the head as the head is turned on the airframe, comes back.
    #[test]
    fn a_head_turned_on_the_airframe_is_turned_back() {
        let trim = Attitude::from_degrees(12.0, -25.0);
        for body in [(0.0, 0.0), (50.0, 20.0), (-100.0, -40.0), (170.0, 10.0)] {
            let up = Attitude::from_degrees(body.0, body.1).vertical();
            // About the left wing, then about the nose.
            let pitched = product(&rotation([0.0, trim.pitch, 0.0]), up);
            let [x, y, z] = product(&rotation([-trim.roll, 0.0, 0.0]), pitched);
            let head = (y.atan2(z).to_degrees(), x.asin().to_degrees());
            let back = body_deg((12.0, -25.0), head);
            assert!(close(back, body), "{body:?} {head:?} {back:?}");
        }
    }

    #[test]
    fn without_a_trim_nothing_changes() {
        let head = Attitude::from_degrees(123.4, -56.7);
        for mounting in [Mounting::Turned(Attitude::default()), Mounting::Offset(Attitude::default())] {
            assert_eq!(mounting.to_body(head), head);
        }
    }
}
