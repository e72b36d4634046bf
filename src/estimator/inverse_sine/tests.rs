use super::*;
use crate::direction::Direction;
use crate::frame::{Missing, Sample, Value};
use crate::head::{Sensor, SensorKind};
use crate::sky::{Averaging, FieldOfView, Response, Sky};
use crate::time::Time;
use proptest::prelude::*;

/// Six absolute sensors under a sky whose pairs are sinusoids: `T = G − D/2·(1 + b·u)`.
fn six_frame(attitude: Attitude, contrast_k: f64, time_s: f64) -> Frame {
    let mut frame = Frame::new(6);
    for (reading, (_, direction)) in frame.readings.iter_mut().zip(Direction::NAMED) {
        let object_c = 16.0 - contrast_k / 2.0 * (1.0 + direction.dot(attitude.vertical()));
        *reading =
            Ok(Sample { value: Value::Absolute { object_c, ambient_c: None }, time: Time::from_secs_f64(time_s) });
    }
    frame
}

/// Pairs in volts in the given directions under the same sky.
fn pair_head(directions: &[Direction]) -> Head {
    let sensors = directions
        .iter()
        .enumerate()
        .map(|(i, d)| Sensor {
            name: format!("p{i}"),
            direction: *d,
            kind: SensorKind::Pair { neutral_v: 1.65, kelvin_per_v: if i % 2 == 0 { 40.0 } else { -40.0 } },
            bus: None,
        })
        .collect();
    Head::new(sensors, vec![])
}

fn pair_frame(head: &Head, attitude: Attitude, contrast_k: f64, time_s: f64) -> Frame {
    let mut frame = Frame::new(head.sensors.len());
    for (reading, sensor) in frame.readings.iter_mut().zip(&head.sensors) {
        let SensorKind::Pair { neutral_v, kelvin_per_v } = sensor.kind else { unreachable!() };
        let volts = neutral_v + contrast_k * sensor.direction.dot(attitude.vertical()) / kelvin_per_v;
        *reading = Ok(Sample { value: Value::Volts(volts), time: Time::from_secs_f64(time_s) });
    }
    frame
}

fn estimator(head: Head) -> InverseSineEstimator {
    // The excess table is the same for all and takes milliseconds to make.
    static MADE: std::sync::OnceLock<InverseSineEstimator> = std::sync::OnceLock::new();
    let mut e = MADE.get_or_init(|| InverseSineEstimator::new(Head::six(), 90.0, 3.0, 45.0)).clone();
    e.solver = ContrastSolver::new(&head);
    e.head = head;
    e
}

/// What the scheme gives when the range was learnt in level flight.
fn after_level(attitude: Attitude, contrast_k: f64) -> Attitude {
    let mut e = estimator(Head::six());
    e.update(&six_frame(Attitude::default(), contrast_k, 0.0));
    e.update(&six_frame(attitude, contrast_k, 0.001)).attitude.unwrap()
}

#[test]
fn level_flight_is_level() {
    let a = after_level(Attitude::default(), 30.0);
    assert!(a.roll.abs() < 1e-12 && a.pitch.abs() < 1e-12);
}

#[test]
fn right_wing_down_is_positive_roll_and_nose_up_positive_pitch() {
    let a = after_level(Attitude::from_degrees(30.0, 0.0), 30.0);
    assert!((a.roll.to_degrees() - 30.0).abs() < 0.05, "{}", a.roll.to_degrees());
    let a = after_level(Attitude::from_degrees(0.0, -15.0), 30.0);
    assert!((a.pitch.to_degrees() + 15.0).abs() < 0.05);
}

#[test]
fn roll_is_limited_as_configured() {
    assert!((after_level(Attitude::from_degrees(70.0, 0.0), 30.0).roll.to_degrees() - 45.0).abs() < 1e-9);
    let mut free = InverseSineEstimator::new(Head::six(), 90.0, 3.0, 0.0);
    free.update(&six_frame(Attitude::default(), 30.0, 0.0));
    let a = free.update(&six_frame(Attitude::from_degrees(70.0, 0.0), 30.0, 0.001)).attitude.unwrap();
    assert!((a.roll.to_degrees() - 70.0).abs() < 0.1);
}

#[test]
fn the_range_follows_the_vertical_pair_with_its_time_constant() {
    let mut e = estimator(Head::six());
    e.update(&six_frame(Attitude::default(), 40.0, 0.0));
    let contrast = e.update(&six_frame(Attitude::default(), 10.0, 3.0)).contrast_k.unwrap();
    assert!((contrast - (10.0 + 30.0 * (-1.0_f64).exp())).abs() < 1e-9, "{contrast}");
}

#[test]
fn a_sustained_bank_reads_steeper_never_shallower() {
    // Known fault of the scheme: R falls with cos φ; at 40° for ever asin(tan 40°) = 57°.
    let mut e = InverseSineEstimator::new(Head::six(), 90.0, 3.0, 0.0);
    let mut last = Solution::default();
    for i in 0..3000 {
        last = e.update(&six_frame(Attitude::from_degrees(40.0, 0.0), 30.0, f64::from(i) * 0.02));
    }
    let expected = 40.0_f64.to_radians().tan().asin().to_degrees();
    assert!((last.attitude.unwrap().roll.to_degrees() - expected).abs() < 0.1);
    assert!(last.sigma.roll.to_degrees() > expected - 41.0, "σ must own up to the shrunk range");
}

#[test]
fn a_pair_without_a_signal_gives_no_attitude_and_the_range_stays() {
    let mut e = estimator(Head::six());
    e.update(&six_frame(Attitude::default(), 30.0, 0.0));
    let mut frame = six_frame(Attitude::default(), 30.0, 0.02);
    frame.readings[4] = Err(Missing::NoAnswer);
    let s = e.update(&frame);
    assert_eq!(s.attitude, None);
    assert_eq!(s.contrast_k, Some(30.0));
}

#[test]
fn a_redundant_head_goes_on_without_one_pair() {
    let turned = Direction::from_angles(45.0, 0.0).unwrap();
    let head = pair_head(&[Direction::NOSE, Direction::LEFT, Direction::UP, turned]);
    let mut e = estimator(head.clone());
    e.update(&pair_frame(&head, Attitude::default(), 30.0, 0.0));
    let mut frame = pair_frame(&head, Attitude::from_degrees(20.0, 0.0), 30.0, 0.001);
    frame.readings[1] = Err(Missing::Saturated);
    assert!((e.update(&frame).attitude.unwrap().roll.to_degrees() - 20.0).abs() < 0.05);
}

#[test]
fn the_standard_deviation_grows_when_the_contrast_is_gone_before_the_range_follows() {
    let bank = Attitude::from_degrees(30.0, 0.0);
    let mut e = estimator(Head::six());
    e.update(&six_frame(bank, 40.0, 0.0));
    let before = e.update(&six_frame(bank, 40.0, 0.02)).sigma.roll;
    let after = e.update(&six_frame(bank, 20.0, 0.04));
    let error = bank.roll - after.attitude.unwrap().roll;
    assert!(error > 0.2, "cloud: the angle is underestimated");
    assert!(after.sigma.roll > error * 0.99 && after.sigma.roll > before, "and σ says by how much");
}

/// Six absolute sensors under one of the report's two skies (figure 6).
fn report_frame(response: &Response, sky: Sky, attitude: Attitude, time_s: f64) -> Frame {
    let mut frame = Frame::new(6);
    for (reading, (_, direction)) in frame.readings.iter_mut().zip(Direction::NAMED) {
        let object_c = response.sensor_c(direction.dot(attitude.vertical()), sky.ground_c, sky.sky_max_k);
        let value = Value::Absolute { object_c, ambient_c: None };
        *reading = Ok(Sample { value, time: Time::from_secs_f64(time_s) });
    }
    frame
}

#[test]
fn in_the_report_s_own_skies_no_angle_is_underestimated() {
    let fields = [
        FieldOfView::InPlane { half_deg: 50.0 },
        FieldOfView::Cone { half_deg: 50.0 },
        FieldOfView::Gaussian { fwhm_deg: 90.0 },
    ];
    // A hundredth of a degree for the tables.
    let least = |angle_deg: f64| angle_deg.to_radians() - 2e-4;
    for (sky, field) in [Sky::NAMIBIA, Sky::DURHAM].into_iter().flat_map(|s| fields.map(|f| (s, f))) {
        let response = Response::new(sky.shape, field, Averaging::Temperature);
        for angle in 0..=44 {
            let angle_deg = f64::from(angle);
            // Rolled, then pitched, out of level flight.
            for (bank, climb) in [(angle_deg, 0.0), (0.0, angle_deg)] {
                let mut e = estimator(Head::six());
                e.update(&report_frame(&response, sky, Attitude::default(), 0.0));
                let frame = report_frame(&response, sky, Attitude::from_degrees(bank, climb), 0.001);
                let a = e.update(&frame).attitude.unwrap();
                assert!(a.roll >= least(bank) && a.pitch >= least(climb), "{sky:?} {field:?} {bank} {climb}: {a:?}");
            }
            // Both at once, and for long.
            let attitude = Attitude::from_degrees(angle_deg, 20.0);
            let mut e = estimator(Head::six());
            e.update(&report_frame(&response, sky, attitude, 0.0));
            let a = e.update(&report_frame(&response, sky, attitude, 60.0)).attitude.unwrap();
            assert!(a.roll >= least(angle_deg) && a.pitch >= least(20.0), "{sky:?} {field:?} {angle}: {a:?}");
        }
    }
}

proptest! {
    #[test]
    fn mirrored_attitudes_give_mirrored_angles(roll in -44.0..44.0_f64, pitch in -40.0..40.0_f64, k in 3.0..60.0_f64) {
        let a = after_level(Attitude::from_degrees(roll, pitch), k);
        let b = after_level(Attitude::from_degrees(-roll, -pitch), k);
        prop_assert!((a.roll + b.roll).abs() < 1e-9 && (a.pitch + b.pitch).abs() < 1e-9);
        prop_assert!(a.roll * roll >= 0.0 && a.pitch * pitch >= 0.0);
    }

    #[test]
    fn steeper_reads_steeper(a in 0.0..44.0_f64, b in 0.0..44.0_f64) {
        let at = |roll| after_level(Attitude::from_degrees(roll, 0.0), 25.0).roll;
        prop_assert!(a >= b || at(a) <= at(b));
    }

    #[test]
    fn the_contrast_does_not_change_the_angle(roll in -44.0..44.0_f64, k in 3.0..60.0_f64) {
        let (a, b) = (after_level(Attitude::from_degrees(roll, 5.0), k), after_level(Attitude::from_degrees(roll, 5.0), 30.0));
        prop_assert!((a.roll - b.roll).abs() < 1e-9);
    }

    #[test]
    fn a_turned_differential_head_is_only_other_directions(
        roll in -44.0..44.0_f64, pitch in -40.0..40.0_f64, turn in 0.0..360.0_f64, tilt in -30.0..30.0_f64,
    ) {
        let attitude = Attitude::from_degrees(roll, pitch);
        let straight = after_level(attitude, 30.0);
        let head = pair_head(&[
            Direction::from_angles(turn, tilt).unwrap(),
            Direction::from_angles(turn - 90.0, 0.0).unwrap(),
            Direction::UP,
        ]);
        let mut e = estimator(head.clone());
        e.update(&pair_frame(&head, Attitude::default(), 30.0, 0.0));
        let turned = e.update(&pair_frame(&head, attitude, 30.0, 0.001)).attitude.unwrap();
        prop_assert!((turned.roll - straight.roll).abs() < 1e-6 && (turned.pitch - straight.pitch).abs() < 1e-6);
    }

    #[test]
    fn nothing_a_sensor_says_makes_an_angle_that_is_not_finite(t in proptest::array::uniform6(-1e9..1e9_f64)) {
        let mut frame = Frame::new(6);
        for (r, object_c) in frame.readings.iter_mut().zip(t) {
            *r = Ok(Sample { value: Value::Absolute { object_c, ambient_c: None }, time: Time::default() });
        }
        let s = estimator(Head::six()).update(&frame);
        prop_assert!(s.attitude.is_none_or(|a| a.roll.is_finite() && a.pitch.is_finite()));
        prop_assert!(s.sigma.roll.is_finite() && s.sigma.pitch.is_finite());
    }
}
