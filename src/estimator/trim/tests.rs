use super::*;
use crate::frame::Aiding;
use crate::time::Time;
use proptest::prelude::*;

/// A flight with GPS five times a second; what the head shows is the truth turned by its mounting.
struct Flight {
    learner: Learner,
    now_s: f64,
    course_deg: f64,
    /// The largest change of the trim per second, °/s.
    fastest: f64,
}

impl Flight {
    fn new() -> Self {
        Self { learner: Learner::default(), now_s: 50.0, course_deg: 0.0, fastest: 0.0 }
    }

    /// Circuits of a straight leg of 40 s and a turn of 10 s at 18 °/s, at 18 m/s; of `attack_deg` in level
    /// flight.
    fn fly(&mut self, seconds: f64, mounted: Attitude, attack_deg: f64) -> Attitude {
        for i in 0..(seconds * 5.0) as u32 {
            let turn_deg_s: f64 = if i % 250 < 200 { 0.0 } else { 18.0 };
            self.now_s += 0.2;
            self.course_deg = (self.course_deg + turn_deg_s * 0.2).rem_euclid(360.0);
            let bank = (18.0 * turn_deg_s.to_radians() / 9.80665).atan();
            // 5° more at twice the weight.
            let attack_deg = attack_deg + 5.0 * (1.0 / bank.cos() - 1.0);
            let body = Attitude { roll: bank, pitch: attack_deg.to_radians() * bank.cos() };
            let aiding = Aiding {
                ground_speed_m_s: Some(18.0),
                course_deg: Some(self.course_deg),
                climb_m_s: Some(0.0),
                ..Aiding::default()
            };
            self.hear(mount(body, mounted), &aiding);
        }
        degrees(self.learner.trim())
    }

    fn hear(&mut self, seen: Attitude, aiding: &Aiding) {
        let before = degrees(self.learner.trim());
        self.learner.update(seen, aiding, Time::from_secs_f64(self.now_s));
        let after = degrees(self.learner.trim());
        self.fastest = self.fastest.max((after.roll - before.roll).abs()).max((after.pitch - before.pitch).abs());
    }
}

/// The vertical turned about the left wing, then about the nose.
fn mount(body: Attitude, by: Attitude) -> Attitude {
    let [x, y, z] = body.vertical();
    let (x, z) = (x * by.pitch.cos() + z * by.pitch.sin(), z * by.pitch.cos() - x * by.pitch.sin());
    let (y, z) = (y * by.roll.cos() + z * by.roll.sin(), z * by.roll.cos() - y * by.roll.sin());
    Attitude { roll: y.atan2(z), pitch: x.clamp(-1.0, 1.0).asin() }
}

fn degrees(a: Attitude) -> Attitude {
    Attitude { roll: a.roll.to_degrees(), pitch: a.pitch.to_degrees() }
}

#[test]
fn a_head_7_degrees_nose_up_is_trimmed_within_four_minutes_and_never_by_a_step() {
    for sign in [1.0, -1.0] {
        let mut f = Flight::new();
        let trim = f.fly(240.0, Attitude::from_degrees(0.0, sign * 7.0), 0.0);
        assert!((trim.pitch - sign * 7.0).abs() < 0.5 && trim.roll.abs() < 0.3, "{trim:?}");
        assert!(f.fastest <= 0.05 * 0.2 + 1e-9, "{}", f.fastest);
        let sigma = degrees(f.learner.sigma());
        assert!((1.0..2.0).contains(&sigma.pitch) && sigma.roll < 0.3, "{sigma:?}");
    }
}

#[test]
fn a_head_that_leans_is_trimmed_in_roll() {
    for sign in [1.0, -1.0] {
        let trim = Flight::new().fly(300.0, Attitude::from_degrees(sign * 5.0, 0.0), 1.0);
        assert!((trim.roll - sign * 5.0).abs() < 0.7 && trim.pitch.abs() < 0.3, "{trim:?}");
    }
}

#[test]
fn an_angle_of_attack_is_no_mounting() {
    for attack_deg in [-2.5, 1.0, 2.5] {
        let mut f = Flight::new();
        let trim = f.fly(600.0, Attitude::default(), attack_deg);
        assert!(trim.pitch.abs() < 0.5 && trim.roll.abs() < 0.1, "{attack_deg}: {trim:?}");
        assert!(degrees(f.learner.sigma()).pitch < 0.3);
    }
}

/// A horizon that leans by 5° to the south-west, of the mounting 6° nose up: flown round or not, half the circle or all of it,
/// the two are told apart as far as they can be.
#[test]
fn a_horizon_that_leans_is_no_mounting() {
    let lean = [-3.5_f64, -3.5];
    for (turned_deg, off_deg) in [(360.0, 0.3), (180.0, 0.6)] {
        let mut f = Flight::new();
        for i in 0..3000_u32 {
            f.now_s += 0.2;
            // To and fro, within what is turned.
            let phase = f64::from(i % 600) / 300.0;
            let heading = (turned_deg * (phase.min(2.0 - phase))).to_radians();
            let turn = turned_deg.to_radians() / 60.0 * if phase < 1.0 { 1.0 } else { -1.0 };
            let bank = (18.0 * turn / 9.80665).atan();
            let beside = lean[0] * heading.sin() - lean[1] * heading.cos();
            let ahead = lean[0] * heading.cos() + lean[1] * heading.sin();
            let seen = Attitude::from_degrees(bank.to_degrees() + beside, 6.0 * bank.cos() + ahead);
            let aiding = Aiding {
                airspeed_m_s: Some(18.0),
                ground_speed_m_s: Some(18.0),
                course_deg: Some(heading.to_degrees()),
                climb_m_s: Some(0.0),
                ..Aiding::default()
            };
            f.hear(seen, &aiding);
        }
        let trim = degrees(f.learner.trim());
        assert!((trim.pitch - 5.8).abs() < off_deg && trim.roll.abs() < off_deg, "{turned_deg}: {trim:?}");
    }
}

#[test]
fn straight_flight_beside_a_warm_side_of_the_sky_is_believed_less() {
    let learn = |turning: bool| {
        let mut f = Flight::new();
        for i in 0..1500 {
            f.now_s += 0.2;
            let course_deg = if turning { f64::from(i % 900) * 0.4 } else { 90.0 };
            let aiding = Aiding {
                ground_speed_m_s: Some(18.0),
                course_deg: Some(course_deg),
                climb_m_s: Some(0.0),
                ..Aiding::default()
            };
            let bank = if turning { 3.7 } else { 0.0 };
            f.hear(Attitude::from_degrees(bank, 4.5), &aiding);
        }
        degrees(f.learner.trim()).pitch
    };
    let (turning, straight) = (learn(true), learn(false));
    assert!(straight < 0.5 * turning, "{straight} {turning}");
}

#[test]
fn without_references_there_is_no_trim_and_what_was_learnt_stays() {
    let silent = |f: &mut Flight| {
        for _ in 0..5000 {
            f.now_s += 0.02;
            f.hear(Attitude::from_degrees(9.0, 9.0), &Aiding::default());
        }
        (f.learner.trim(), f.learner.sigma())
    };
    let mut f = Flight::new();
    assert_eq!(silent(&mut f), (Attitude::default(), Attitude::default()));
    f.fly(300.0, Attitude::from_degrees(0.0, 7.0), 0.0);
    let before = (f.learner.trim(), f.learner.sigma());
    assert_eq!(silent(&mut f), before);
}

/// What a head shows beside its mounting after minutes, as with a wet sensor, is no mounting: nothing is learnt of it, and it
/// is said by how much the attitude is off.
#[test]
fn what_departs_from_the_minutes_before_is_said_and_not_learnt() {
    let mounted = Attitude::from_degrees(0.0, 6.0);
    for (roll, pitch) in [(9.0, 0.0), (-9.0, 0.0), (0.0, 9.0), (0.0, -9.0), (-35.0, 0.0)] {
        let off = Attitude::from_degrees(roll, 6.0 + pitch);
        let mut f = Flight::new();
        let before = f.fly(300.0, mounted, 0.0);
        assert_eq!(f.learner.departed(), Attitude::default());
        for minutes in 1..=4 {
            let trim = f.fly(60.0, off, 0.0);
            let moved = (trim.roll - before.roll).abs().max((trim.pitch - before.pitch).abs());
            let departed = degrees(f.learner.departed());
            assert!(moved < 1.0, "{roll} {pitch}, {minutes} min: {moved}");
            let is = [departed.roll, departed.pitch];
            for (is, by) in is.into_iter().zip([roll, pitch]) {
                assert!(is >= 0.75 * by.abs() && is < by.abs() + 1.5, "{roll} {pitch}, {minutes} min: {departed:?}");
            }
        }
        f.fly(90.0, mounted, 0.0);
        assert_eq!(f.learner.departed(), Attitude::default(), "{roll} {pitch}");
    }
}

/// Whether the first minute or all that came after it was odd: the longer is believed.
#[test]
fn what_lasts_longer_than_what_was_learnt_before_is_learnt() {
    let mut f = Flight::new();
    f.fly(60.0, Attitude::from_degrees(8.0, 0.0), 0.0);
    let trim = f.fly(600.0, Attitude::default(), 0.0);
    assert!(trim.roll.abs() < 1.0, "{trim:?}");
    assert_eq!(f.learner.departed(), Attitude::default());
}

#[test]
fn the_mounting_is_undone_exactly_at_any_attitude() {
    let mounted = Attitude::from_degrees(-8.0, 12.0);
    for (roll, pitch) in [(0.0, 0.0), (50.0, 20.0), (-170.0, -30.0), (90.0, 5.0), (10.0, 80.0)] {
        let back = level(mount(Attitude::from_degrees(roll, pitch), mounted), mounted);
        let back = degrees(back);
        assert!((back.roll - roll).abs() < 1e-9 && (back.pitch - pitch).abs() < 1e-9, "{back:?}");
    }
}

proptest! {
    #[test]
    fn no_reference_moves_it_faster_or_farther_than_it_may(
        frames in prop::collection::vec(
            (-0.5..3.0_f64, prop::array::uniform2(-200.0..200.0_f64), prop::array::uniform4(hostile())), 1..400
        )
    ) {
        let mut f = Flight::new();
        for (step_s, [roll, pitch], [airspeed, ground_speed, course, climb]) in frames {
            f.now_s += step_s;
            let before = degrees(f.learner.trim());
            let aiding = Aiding {
                airspeed_m_s: airspeed, ground_speed_m_s: ground_speed, course_deg: course, climb_m_s: climb,
                ..Aiding::default()
            };
            f.learner.update(Attitude::from_degrees(roll, pitch), &aiding, Time::from_secs_f64(f.now_s));
            let (trim, sigma) = (degrees(f.learner.trim()), f.learner.sigma());
            // A turn's rate stands for the time since it began.
            prop_assert!((trim.pitch - before.pitch).abs() <= 0.05 * 2.5 + 1e-9);
            prop_assert!((trim.roll - before.roll).abs() <= 0.05 * 2.5 + 1e-9);
            prop_assert!(trim.roll.abs() <= 10.0 + 1e-9 && trim.pitch.abs() <= 15.0 + 1e-9);
            prop_assert!(sigma.roll.is_finite() && sigma.pitch.is_finite());
        }
    }

    #[test]
    fn left_is_as_right(roll in -9.0..9.0_f64, pitch in -9.0..9.0_f64, climb in -1.0..1.0_f64) {
        let learn = |sign: f64| {
            let course = |i: u32| Some((sign * 0.6 * f64::from(i)).rem_euclid(360.0));
            flown(Attitude::from_degrees(sign * roll, pitch), course, climb)
        };
        let (right, left) = (learn(1.0), learn(-1.0));
        prop_assert!((right.roll + left.roll).abs() < 1e-9 && (right.pitch - left.pitch).abs() < 1e-9);
    }

    #[test]
    fn up_is_as_down(pitch in -9.0..9.0_f64, climb in -1.0..1.0_f64) {
        let learn = |sign: f64| flown(Attitude::from_degrees(0.0, sign * pitch), |_| None, sign * climb);
        let (up, down) = (learn(1.0), learn(-1.0));
        prop_assert!((up.pitch + down.pitch).abs() < 1e-9 && up.roll == 0.0 && down.roll == 0.0);
    }
}

/// The trim, °, where two minutes show `seen` on courses in degrees, climbing at `climb` m/s.
fn flown(seen: Attitude, course: impl Fn(u32) -> Option<f64>, climb: f64) -> Attitude {
    let mut f = Flight::new();
    for i in 0..600 {
        f.now_s += 0.2;
        let (ground_speed_m_s, climb_m_s) = (Some(15.0), Some(climb));
        f.hear(seen, &Aiding { ground_speed_m_s, course_deg: course(i), climb_m_s, ..Aiding::default() });
    }
    degrees(f.learner.trim())
}

/// Values from sane to absurd, and none.
fn hostile() -> impl Strategy<Value = Option<f64>> {
    let absurd = prop::sample::select(vec![f64::NAN, f64::INFINITY, -1e300, 1e300, 0.0, -5.0]);
    prop_oneof![3 => (0.0..40.0_f64).prop_map(Some), 1 => absurd.prop_map(Some), 1 => Just(None)]
}

proptest! {
    #[test]
    fn what_a_head_shows_is_the_inverse_of_what_it_is_levelled_to(
        roll in -179.0_f64..179.0, pitch in -89.0_f64..89.0, trim_roll in -45.0_f64..45.0, trim_pitch in -45.0_f64..45.0,
    ) {
        let (body, trim) = (Attitude::from_degrees(roll, pitch), Attitude::from_degrees(trim_roll, trim_pitch));
        let back = level(shown(body, trim), trim).vertical();
        for (a, b) in back.into_iter().zip(body.vertical()) {
            prop_assert!((a - b).abs() < 1e-12, "{:?} {:?}", body, trim);
        }
        let flat = shown(Attitude::default(), trim);
        prop_assert!((flat.roll - trim.roll).abs() < 1e-12 && (flat.pitch - trim.pitch).abs() < 1e-12);
    }
}
