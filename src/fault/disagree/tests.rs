//! A flight with a GPS fix each second, and an attitude that is not the one flown.

use super::super::kit::{at, told, value};
use super::*;

const SPEED_M_S: f64 = 18.0;
const LIMIT_DEG: f64 = 12.0;
const SIGMA_DEG: f64 = 1.0;

/// What is said of a flight, 50 frames a second.
struct Flight {
    disagree: Disagree,
    scan: u32,
    course_deg: f64,
}

impl Flight {
    fn new() -> Self {
        Self { disagree: Disagree::new(LIMIT_DEG.to_radians()), scan: 0, course_deg: 100.0 }
    }

    /// So many seconds: roll and pitch that are said, bank and angle of climb that are flown, °.
    fn fly(&mut self, seconds: f64, said: (f64, f64), flown: (f64, f64)) {
        self.with(seconds, Some(said), flown, |_| {});
    }

    /// The same where there may be no attitude, and `spoil` changes what other instruments say.
    fn with(&mut self, seconds: f64, said: Option<(f64, f64)>, flown: (f64, f64), spoil: impl Fn(&mut Aiding)) {
        let sigma = Attitude::from_degrees(SIGMA_DEG, SIGMA_DEG);
        let attitude = said.map(|(roll, pitch)| (Attitude::from_degrees(roll, pitch), sigma));
        for _ in 0..(seconds * 50.0).round() as u32 {
            self.scan += 1;
            // A coordinated turn: tan φ = V·ω/g.
            let turn = flown.0.to_radians().tan() * 9.80665 / SPEED_M_S;
            self.course_deg = (self.course_deg + 0.02 * turn.to_degrees()).rem_euclid(360.0);
            let mut aiding = Aiding::default();
            if self.scan.is_multiple_of(50) {
                aiding.ground_speed_m_s = Some(SPEED_M_S);
                aiding.course_deg = Some(self.course_deg);
                aiding.climb_m_s = Some(SPEED_M_S * flown.1.to_radians().sin());
            }
            spoil(&mut aiding);
            self.disagree.update(attitude, &aiding, at(100.0 + 0.02 * f64::from(self.scan)));
        }
    }

    fn told(&self) -> Vec<FaultKind> {
        told(|f| self.disagree.report(f)).iter().map(|t| t.0).collect()
    }
}

#[test]
fn a_bank_that_is_not_that_of_the_turn_is_told_and_doubted_by_half() {
    for (said_deg, flown_deg) in [(0.0, 20.0), (20.0, 0.0), (-15.0, 10.0), (0.0, -25.0)] {
        let mut flight = Flight::new();
        flight.fly(30.0, (flown_deg, 0.0), (flown_deg, 0.0));
        assert_eq!((flight.told(), flight.disagree.doubt(false)), (vec![], Attitude::default()));
        flight.fly(1.0, (said_deg, 0.0), (flown_deg, 0.0));
        assert_eq!(flight.told(), [], "one fix is not enough");
        flight.fly(9.0, (said_deg, 0.0), (flown_deg, 0.0));
        assert_eq!(flight.told(), [FaultKind::RollDisagrees], "{said_deg}° in a turn of {flown_deg}°");
        flight.fly(30.0, (said_deg, 0.0), (flown_deg, 0.0));
        let (difference, unit) = value(&told(|f| flight.disagree.report(f))[0]);
        assert!((difference - (said_deg - flown_deg)).abs() < 0.5 && unit == "°", "{difference}");
        let doubt = flight.disagree.doubt(false);
        assert!((doubt.roll.to_degrees() - 0.5 * difference.abs()).abs() < 1e-9 && doubt.pitch == 0.0, "{doubt:?}");
        // With a sensor left out there is more to be wrong.
        assert_eq!(flight.disagree.doubt(true), Attitude { roll: 2.0 * doubt.roll, pitch: 0.0 });
        // In accord again for a while.
        flight.fly(30.0, (flown_deg, 0.0), (flown_deg, 0.0));
        assert_eq!((flight.told(), flight.disagree.doubt(false)), (vec![], Attitude::default()));
    }
}

/// As of a head whose left and right are exchanged: the mean of the difference passes through nothing when the turn does.
#[test]
fn a_roll_to_the_other_side_stays_in_doubt_when_the_turn_changes_sides() {
    let mut flight = Flight::new();
    flight.fly(30.0, (-25.0, 0.0), (25.0, 0.0));
    for side in [-25.0, 25.0, -25.0] {
        for _ in 0..20 {
            flight.fly(1.0, (-side, 0.0), (side, 0.0));
            let doubt_deg = flight.disagree.doubt(false).roll.to_degrees();
            assert!(flight.told() == [FaultKind::RollDisagrees] && doubt_deg > 11.5, "{doubt_deg}°");
        }
    }
}

#[test]
fn a_bank_twenty_degrees_off_from_the_start_is_told_within_seven_seconds() {
    let mut flight = Flight::new();
    flight.fly(7.0, (0.0, 0.0), (20.0, 0.0));
    assert_eq!(flight.told(), [FaultKind::RollDisagrees]);
}

#[test]
fn a_pitch_that_is_not_that_of_the_climb_is_told() {
    let mut flight = Flight::new();
    flight.fly(20.0, (0.0, 5.0), (0.0, 5.0));
    assert_eq!(flight.told(), []);
    flight.fly(12.0, (0.0, -14.0), (0.0, 6.0));
    assert_eq!(flight.told(), [FaultKind::PitchDisagrees]);
    flight.fly(12.0, (25.0, -14.0), (0.0, 6.0));
    assert_eq!(flight.told(), [FaultKind::RollDisagrees, FaultKind::PitchDisagrees]);
}

#[test]
fn a_steep_roll_in_a_turn_that_is_not_is_told() {
    for (said_deg, flown_deg) in [(60.0, -35.0), (80.0, 0.0), (-50.0, 10.0)] {
        let mut flight = Flight::new();
        flight.fly(10.0, (said_deg, 0.0), (flown_deg, 0.0));
        assert_eq!(flight.told(), [FaultKind::RollDisagrees], "{said_deg}° in a turn of {flown_deg}°");
    }
    // And a roll that is not, or is one to the other side, in a steep turn.
    for (said_deg, flown_deg) in [(-55.0, 55.0), (0.0, 50.0), (20.0, -60.0)] {
        let mut flight = Flight::new();
        flight.fly(10.0, (said_deg, 0.0), (flown_deg, 0.0));
        assert_eq!(flight.told(), [FaultKind::RollDisagrees], "{said_deg}° in a turn of {flown_deg}°");
    }
    // A steep turn, and one that is all but that; a loop's way down.
    for (said, flown) in [((60.0, 0.0), (60.0, 0.0)), ((60.0, 0.0), (40.0, 0.0)), ((60.0, -60.0), (0.0, 0.0))] {
        let mut flight = Flight::new();
        flight.fly(30.0, said, flown);
        assert!(!flight.told().contains(&FaultKind::RollDisagrees), "{said:?} in {flown:?}");
    }
}

#[test]
fn what_is_within_the_limit_or_lasts_a_moment_is_not_told() {
    for off_deg in [-11.0, 4.0, 11.0] {
        let mut flight = Flight::new();
        flight.fly(60.0, (20.0 + off_deg, off_deg), (20.0, 0.0));
        assert_eq!(flight.told(), [], "{off_deg}°");
    }
    let mut flight = Flight::new();
    for _ in 0..20 {
        flight.fly(5.0, (0.0, 0.0), (0.0, 0.0));
        flight.fly(1.0, (20.0, 0.0), (0.0, 0.0));
        assert_eq!(flight.told(), []);
    }
}

#[test]
fn it_ends_without_gps_and_without_an_attitude() {
    let off = || {
        let mut flight = Flight::new();
        flight.fly(20.0, (0.0, 0.0), (25.0, 0.0));
        assert_eq!(flight.told(), [FaultKind::RollDisagrees]);
        flight
    };
    let mut silent = off();
    silent.with(6.0, Some((0.0, 0.0)), (25.0, 0.0), |a| *a = Aiding::default());
    assert_eq!(silent.told(), [FaultKind::RollDisagrees]);
    silent.with(3.0, Some((0.0, 0.0)), (25.0, 0.0), |a| *a = Aiding::default());
    assert_eq!(silent.told(), []);
    let mut withheld = off();
    withheld.with(0.02, None, (25.0, 0.0), |_| {});
    assert_eq!((withheld.told(), withheld.disagree.doubt(false)), (vec![], Attitude::default()));
}

#[test]
fn what_is_no_number_says_nothing() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
        for which in 0..4 {
            let mut flight = Flight::new();
            flight.with(30.0, Some((0.0, 0.0)), (0.0, 0.0), |a| {
                *[&mut a.ground_speed_m_s, &mut a.course_deg, &mut a.climb_m_s, &mut a.airspeed_m_s][which] = Some(bad);
            });
            assert_eq!(
                (flight.told(), flight.disagree.doubt(false)),
                (vec![], Attitude::default()),
                "{bad} for {which}"
            );
        }
    }
}

/// Circuits of so many seconds, with turns to both sides, in which such a share of the bank is said, and so much more, °.
fn circuits(flight: &mut Flight, seconds: u32, bank_deg: f64, share: f64, more_deg: f64) {
    for second in 0..seconds {
        let flown_deg = [0.0, 1.0, 0.0, -1.0][(second / 8 % 4) as usize] * bank_deg;
        flight.fly(1.0, (share * flown_deg + more_deg, 0.0), (flown_deg, 0.0));
    }
}

#[test]
fn a_roll_that_is_always_a_share_of_the_bank_is_told_and_doubted_by_what_is_missing() {
    // Too little for the mean of five seconds, but all of it wrong.
    for (share, bank_deg) in [(0.5, 20.0), (0.55, 24.0), (0.3, 15.0), (1.7, 16.0)] {
        let mut flight = Flight::new();
        circuits(&mut flight, 120, bank_deg, share, 0.0);
        assert_eq!(flight.told(), [FaultKind::RollDisagrees], "{share} of {bank_deg}°");
        let (percent, unit) = value(&told(|f| flight.disagree.report(f))[0]);
        assert!((percent - 100.0 * share).abs() < 5.0 && unit == "%", "{share}: {percent} %");
        flight.fly(2.0, (share * bank_deg, share * 6.0), (bank_deg, 6.0));
        let doubt = flight.disagree.doubt(false);
        let expected = Attitude::from_degrees(bank_deg, 6.0);
        let missing = [doubt.roll / expected.roll, doubt.pitch / expected.pitch];
        assert!(missing.iter().all(|m| (m - (1.0 - share).abs()).abs() < 0.05), "{share}: {missing:?}");
        // When it is right again it is over.
        circuits(&mut flight, 150, bank_deg, 1.0, 0.0);
        assert_eq!((flight.told(), flight.disagree.doubt(false)), (vec![], Attitude::default()), "{share}");
    }
}

#[test]
fn a_head_that_sits_askew_and_one_that_flies_straight_on_have_no_wrong_scale() {
    for (share, bank_deg, more_deg) in
        [(1.0, 25.0, 8.0), (1.0, 25.0, -8.0), (0.8, 25.0, 0.0), (1.4, 25.0, 0.0), (0.0, 3.0, 0.0), (0.5, 5.0, 5.0)]
    {
        let mut flight = Flight::new();
        circuits(&mut flight, 300, bank_deg, share, more_deg);
        assert_eq!(flight.told(), [], "{share} of {bank_deg}° and {more_deg}°");
    }
}

#[test]
fn a_wrong_scale_ends_without_gps_and_outlasts_a_withheld_attitude() {
    let off = || {
        let mut flight = Flight::new();
        circuits(&mut flight, 120, 20.0, 0.5, 0.0);
        assert_eq!(flight.told(), [FaultKind::RollDisagrees]);
        flight
    };
    let mut withheld = off();
    withheld.with(2.0, None, (20.0, 0.0), |_| {});
    assert_eq!(withheld.told(), [FaultKind::RollDisagrees]);
    let mut silent = off();
    silent.with(8.0, Some((10.0, 0.0)), (20.0, 0.0), |a| *a = Aiding::default());
    assert_eq!((silent.told(), silent.disagree.doubt(false)), (vec![], Attitude::default()));
}
