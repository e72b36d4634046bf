use super::*;
use crate::attitude::Attitude;
use crate::estimator::vector::{Vector, dot};
use crate::frame::{Missing, Sample, Value};
use crate::head::{Sensor, SensorKind};
use crate::simulation::noise::Noise;
use crate::sky::{Averaging, FieldOfView, Response, Sky};
use crate::time::Time;
use proptest::prelude::*;
use std::sync::OnceLock;

mod properties;

/// The curves of both skies of the report under three fields of view.
fn curves() -> &'static [PairCurve] {
    static MADE: OnceLock<Vec<PairCurve>> = OnceLock::new();
    MADE.get_or_init(|| {
        let fields = [
            FieldOfView::InPlane { half_deg: 50.0 },
            FieldOfView::Cone { half_deg: 50.0 },
            FieldOfView::Gaussian { fwhm_deg: 90.0 },
        ];
        let skies = [Sky::NAMIBIA, Sky::DURHAM].into_iter().flat_map(|s| fields.map(|f| (s, f)));
        let curve = |(s, f): (Sky, FieldOfView)| {
            Response::new(s.shape, f, Averaging::Temperature).pair_curve(s.ground_c, s.sky_max_k)
        };
        skies.map(curve).collect()
    })
}

/// A bell of 90° under the sky of Namibia.
fn usual() -> &'static PairCurve {
    &curves()[2]
}

const ORTHOGONAL: [Direction; 3] = [Direction::NOSE, Direction::LEFT, Direction::UP];

fn signals(directions: &[Direction], curve: &PairCurve, u: Vector, contrast_k: f64) -> Vec<Option<f64>> {
    directions.iter().map(|d| Some(contrast_k * curve.g(d.dot(u)))).collect()
}

fn degrees_apart(a: Vector, b: Vector) -> f64 {
    let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    dot(cross, cross).sqrt().atan2(dot(a, b)).to_degrees()
}

/// A head of pairs in volts of 10 K, with the method on it, under a sky of its own.
struct Flight {
    method: ProfileEstimator,
    curve: PairCurve,
    now_s: f64,
}

impl Flight {
    fn new(directions: &[Direction], curve: &PairCurve) -> Self {
        let kind = SensorKind::Pair { neutral_v: 0.0, kelvin_per_v: 10.0 };
        let sensors = directions.iter().map(|d| Sensor { name: "p".into(), direction: *d, kind, bus: None }).collect();
        let method = ProfileEstimator::new(Head::new(sensors, vec![]), curve.clone(), 3.0);
        Self { method, curve: curve.clone(), now_s: 100.0 }
    }

    /// What is made of these signals, K, `dt_s` after the last.
    fn hear(&mut self, signals: &[Option<f64>], dt_s: f64) -> Solution {
        self.now_s += dt_s;
        let time = Time::from_secs_f64(self.now_s);
        let mut frame = Frame::new(signals.len());
        for (reading, m) in frame.readings.iter_mut().zip(signals) {
            *reading = m.map(|m| Sample { value: Value::Volts(m / 10.0), time }).ok_or(Missing::NoAnswer);
        }
        self.method.update(&frame)
    }

    /// What is made of an attitude.
    fn fly(&mut self, roll_deg: f64, pitch_deg: f64, contrast_k: f64, dt_s: f64) -> Solution {
        let u = Attitude::from_degrees(roll_deg, pitch_deg).vertical();
        let directions: Vec<Direction> = self.method.head.pairs.iter().map(|p| p.direction).collect();
        self.hear(&signals(&directions, &self.curve, u, contrast_k), dt_s)
    }
}

/// Roll and pitch, degrees.
fn degrees(solution: &Solution) -> (f64, f64) {
    let a = solution.attitude.unwrap();
    (a.roll.to_degrees(), a.pitch.to_degrees())
}

#[test]
fn exact_in_the_model_s_own_sky_whatever_the_attitude() {
    for (n, curve) in curves().iter().enumerate() {
        let solver = Solver::new(&ORTHOGONAL, curve.clone()).unwrap();
        for (roll, pitch) in (-36..=36).flat_map(|roll| (-18..=18).map(move |pitch| (roll, pitch))) {
            let attitude = Attitude::from_degrees(f64::from(roll) * 5.0, f64::from(pitch) * 5.0);
            let s = solver.solve(&signals(&ORTHOGONAL, curve, attitude.vertical(), 27.0)).unwrap();
            let off = degrees_apart(s.vertical, attitude.vertical());
            assert!(off < 0.05 && (s.contrast_k - 27.0).abs() < 0.03, "curve {n} {attitude:?}: {off}° {s:?}");
            assert!((s.length - 1.0).abs() < 1e-6 && s.residual_k == 0.0);
        }
    }
}

#[test]
fn turned_over_in_flight_it_stays_itself_and_the_contrast_stays_upright() {
    for turn in [1.0, -1.0] {
        let mut f = Flight::new(&ORTHOGONAL, usual());
        for i in 0..=720 {
            let roll = turn * f64::from(i);
            let s = f.fly(roll, 10.0, 25.0, 0.02);
            let off = degrees_apart(s.attitude.unwrap().vertical(), Attitude::from_degrees(roll, 10.0).vertical());
            assert!(off < 0.05, "{roll}: {s:?}");
            assert!(s.contrast_k.unwrap() > 0.0 && s.seen_k.unwrap()[2] > 0.0);
        }
    }
}

#[test]
fn ground_and_sky_exchanged_at_once_or_slowly_show_a_contrast_below_zero() {
    for seconds in [0.02, 1.0, 20.0] {
        let mut f = Flight::new(&ORTHOGONAL, usual());
        f.fly(15.0, -5.0, 25.0, 0.0);
        let steps = (seconds * 50.0_f64).round() as u32;
        let mut last = Solution::default();
        for i in 1..=steps + 50 {
            last = f.fly(15.0, -5.0, (25.0 - 31.0 * f64::from(i) / f64::from(steps)).max(-6.0), 0.02);
        }
        assert!(last.contrast_k.unwrap() < 0.0 && last.seen_k.unwrap()[2] < -5.9, "{seconds} s: {last:?}");
        let (roll, pitch) = degrees(&last);
        assert!(roll > 14.9 && pitch < -4.9, "{roll} {pitch}");
    }
}

#[test]
fn switched_on_upside_down_it_is_believed_to_be_upright_until_it_is() {
    let mut f = Flight::new(&ORTHOGONAL, usual());
    assert!(f.fly(180.0, 0.0, 25.0, 0.0).seen_k.unwrap()[2] < -24.9);
    for i in 1..=90 {
        f.fly(180.0 - f64::from(i) * 2.0, 0.0, 25.0, 0.02);
    }
    let s = f.fly(0.0, 0.0, 25.0, 0.02);
    assert!(s.seen_k.unwrap()[2] > 24.9 && s.contrast_k.unwrap() > 0.0 && degrees(&s).0.abs() < 0.05, "{s:?}");
    // And what was last seen a second ago is not held on to.
    f.fly(0.0, 0.0, 25.0, 0.02);
    assert!(f.fly(170.0, 0.0, 25.0, 2.0).seen_k.unwrap()[2] < 0.0);
}

#[test]
fn no_angle_is_underestimated_on_the_solved_contrast_or_a_smaller_range() {
    for (n, curve) in curves().iter().enumerate() {
        for share in [1.0, 0.99, 0.9, 0.6, 0.3] {
            for (roll, pitch) in (0..=17).flat_map(|roll| (0..=16).map(move |pitch| (roll, pitch))) {
                let (roll, pitch) = (f64::from(roll) * 5.0, f64::from(pitch) * 5.0);
                for (turn, climb) in [(1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)] {
                    let mut f = Flight::new(&ORTHOGONAL, curve);
                    f.fly(0.0, 0.0, 30.0 * share, 0.0);
                    let (r, p) = degrees(&f.fly(turn * roll, climb * pitch, 30.0, 1e-4));
                    let least = |got: f64, way: f64, true_deg: f64| got * way >= true_deg - 0.05;
                    assert!(least(r, turn, roll) && least(p, climb, pitch), "{n} {share} {roll} {pitch}: {r} {p}");
                }
            }
        }
    }
}

/// Before anything is learnt of the sky it is taken for the report's, and an angle in doubt is shown larger.
#[test]
fn in_flight_no_angle_is_underestimated_in_the_report_s_sky_and_none_is_far_off() {
    let head = Flight::new(&ORTHOGONAL, usual()).method.head;
    let fresh = ProfileEstimator::in_flight(head, FieldOfView::Gaussian { fwhm_deg: 90.0 }, 0.1, 3.0);
    for (roll, pitch) in (-17..=17).flat_map(|roll| (-16..=16).map(move |pitch| (roll, pitch))) {
        let (roll, pitch) = (f64::from(roll) * 5.0, f64::from(pitch) * 5.0);
        let mut f = Flight { method: fresh.clone(), curve: usual().clone(), now_s: 100.0 };
        let said: Vec<_> = (0..50).map(|_| f.fly(roll, pitch, 30.0, 0.02)).collect();
        for s in [said[0], said[49]] {
            let (r, p) = degrees(&s);
            let good = |got: f64, truth: f64| (-0.06..1.8).contains(&((got - truth) * truth.signum()));
            assert!(good(r, roll) && good(p, pitch), "{roll} {pitch}: {r} {p}");
            assert!(s.sigma.roll > 0.03 && s.sigma.pitch > 0.03, "{s:?}");
        }
    }
}

#[test]
fn a_cloud_that_halves_the_contrast_shrinks_no_angle_and_the_blue_after_it_is_owned_up_to() {
    let mut f = Flight::new(&ORTHOGONAL, usual());
    let before = f.fly(40.0, 10.0, 30.0, 0.0);
    for contrast_k in [15.0, 15.0, 4.0, 4.0] {
        let (roll, pitch) = degrees(&f.fly(40.0, 10.0, contrast_k, 0.02));
        assert!((39.95..40.05).contains(&roll) && (9.95..10.05).contains(&pitch), "{roll} {pitch}");
    }
    for _ in 0..50 {
        f.fly(40.0, 10.0, 4.0, 0.02);
    }
    let after = f.fly(40.0, 10.0, 30.0, 0.02);
    let over = after.attitude.unwrap().roll - 40.0_f64.to_radians();
    assert!(over > 0.0 && after.sigma.roll >= over * 0.99 && after.sigma.roll > 5.0 * before.sigma.roll);
    assert!(f.method.residual().unwrap() > 0.3);
    // A pair that shows less than it should: with the range the vertical is too short.
    let mut f = Flight::new(&ORTHOGONAL, usual());
    f.fly(40.0, 10.0, 30.0, 0.0);
    let mut blocked = signals(&ORTHOGONAL, usual(), Attitude::from_degrees(40.0, 10.0).vertical(), 30.0);
    blocked[1] = blocked[1].map(|m| m / 3.0);
    f.hear(&blocked, 0.001);
    assert!(f.method.residual().unwrap() < -0.1);
}

#[test]
fn a_fourth_pair_stands_in_for_a_missing_one_and_shows_a_lie() {
    let mut directions = ORTHOGONAL.to_vec();
    directions.push(Direction::from_angles(135.0, 40.0).unwrap());
    let solver = Solver::new(&directions, usual().clone()).unwrap();
    let u = Attitude::from_degrees(35.0, -20.0).vertical();
    let all = signals(&directions, usual(), u, 20.0);
    assert!(solver.solve(&all).unwrap().residual_k < 0.01);
    for missing in 0..4 {
        let mut some = all.clone();
        some[missing] = None;
        let s = solver.solve(&some).unwrap();
        assert!(degrees_apart(s.vertical, u) < 0.05 && s.residual_k == 0.0, "{missing}: {s:?}");
        some[(missing + 1) % 4] = Some(f64::NAN);
        assert_eq!(solver.solve(&some), None);
        let mut lying = all.clone();
        lying[missing] = lying[missing].map(|m| m - 5.0);
        assert!(solver.solve(&lying).unwrap().residual_k > 0.5);
    }
}

#[test]
fn pairs_that_do_not_span_space_give_nothing() {
    let flat = [Direction::NOSE, Direction::LEFT, Direction::from_angles(45.0, 0.0).unwrap()];
    assert!(Solver::new(&flat, usual().clone()).is_none());
    let mut f = Flight::new(&flat, usual());
    assert_eq!(f.fly(10.0, 0.0, 20.0, 0.02), Solution::default());
    let mut f = Flight::new(&ORTHOGONAL, usual());
    assert_eq!(f.hear(&[Some(1.0), None, Some(3.0)], 0.02), Solution::default());
    // No contrast at all is seen as that, and has no direction.
    let none = f.hear(&[Some(0.0); 3], 0.02);
    assert_eq!((none.attitude, none.seen_k), (None, Some([0.0; 3])));
}

#[test]
fn noise_stays_within_two_standard_deviations_19_times_out_of_20() {
    let mut noise = Noise::new(11);
    for (roll, pitch) in [(0.0, 0.0), (20.0, 5.0), (45.0, -30.0), (70.0, 10.0), (90.0, 0.0), (160.0, 50.0), (0.0, 85.0)]
    {
        let (mut inside, count) = ((0, 0), 2000);
        for _ in 0..count {
            let mut f = Flight::new(&ORTHOGONAL, usual());
            let up = Attitude::from_degrees(roll, pitch).vertical();
            f.method.sides = Sides::knowing(up, Time::from_secs_f64(99.99));
            let mut m = signals(&ORTHOGONAL, usual(), Attitude::from_degrees(roll, pitch).vertical(), 20.0);
            m.iter_mut().flatten().for_each(|m| *m += 0.08 * 2.0_f64.sqrt() * noise.normal());
            let s = f.hear(&m, 0.0);
            let (r, p) = degrees(&s);
            inside.0 += i32::from((r - roll).abs() < 2.0 * s.sigma.roll.to_degrees());
            inside.1 += i32::from((p - pitch).abs() < 2.0 * s.sigma.pitch.to_degrees());
        }
        let share = |n: i32| f64::from(n) / f64::from(count);
        let good = |n| (0.93..0.98).contains(&share(n));
        assert!(good(inside.0) && good(inside.1), "{roll} {pitch}: {} {}", share(inside.0), share(inside.1));
    }
}
