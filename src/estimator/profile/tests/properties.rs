//! What holds for every attitude, head and contrast.

use super::*;

type Matrix = [Vector; 3];

/// The rotation by `turn` about the vertical and then of the vertical to another direction.
fn rotation(a: f64, b: f64, c: f64) -> Matrix {
    let ((sa, ca), (sb, cb), (sc, cc)) = (a.sin_cos(), b.sin_cos(), c.sin_cos());
    [
        [ca * cb, ca * sb * sc - sa * cc, ca * sb * cc + sa * sc],
        [sa * cb, sa * sb * sc + ca * cc, sa * sb * cc - ca * sc],
        [-sb, cb * sc, cb * cc],
    ]
}

fn direction(v: Vector) -> Direction {
    let azimuth_deg = (-v[1]).atan2(v[0]).to_degrees();
    Direction::from_angles(azimuth_deg, v[2].clamp(-1.0, 1.0).asin().to_degrees()).unwrap()
}

fn turned(directions: &[Direction], by: &Matrix) -> Vec<Direction> {
    directions.iter().map(|d| direction(by.map(|row| dot(row, d.components())))).collect()
}

/// One frame's angles, degrees, on a head that has seen nothing before.
fn first(directions: &[Direction], curve: &PairCurve, roll_deg: f64, pitch_deg: f64, contrast_k: f64) -> (f64, f64) {
    degrees(&Flight::new(directions, curve).fly(roll_deg, pitch_deg, contrast_k, 0.0))
}

fn near(a: (f64, f64), b: (f64, f64), most: f64) -> bool {
    (a.0 - b.0).abs() < most && (a.1 - b.1).abs() < most
}

fn any_signal() -> impl Strategy<Value = Option<f64>> {
    prop_oneof![
        4 => (-50.0..50.0_f64).prop_map(Some),
        1 => any::<f64>().prop_map(Some),
        1 => prop::sample::select(vec![Some(0.0), Some(f64::NAN), Some(f64::INFINITY), Some(f64::MAX), None]),
    ]
}

proptest! {
    #[test]
    fn left_and_right_exchanged_negate_roll_and_nothing_else(
        m in prop::array::uniform3(-30.0..30.0_f64), before in 5.0..40.0_f64, n in 0..6_usize,
    ) {
        let made = |left: f64| {
            let mut f = Flight::new(&ORTHOGONAL, &curves()[n]);
            f.fly(0.0, 0.0, before, 0.0);
            f.hear(&[Some(m[0]), Some(left), Some(m[2])], 0.01)
        };
        let (a, b) = (made(m[1]), made(-m[1]));
        let ((ra, pa), (rb, pb)) = (degrees(&a), degrees(&b));
        prop_assert!((ra + rb).abs() < 1e-9 && (pa - pb).abs() < 1e-9);
        prop_assert_eq!(a.seen_k, b.seen_k);
    }

    #[test]
    fn a_turned_head_is_only_other_directions(
        roll in -85.0..85.0_f64, pitch in -80.0..80.0_f64, n in 0..6_usize,
        turn in prop::array::uniform3(-3.1..3.1_f64), extra in prop::array::uniform2(-60.0..60.0_f64),
    ) {
        let by = rotation(turn[0], turn[1], turn[2]);
        let mut head = turned(&ORTHOGONAL, &by);
        prop_assert!(near(first(&head, &curves()[n], roll, pitch, 20.0), (roll, pitch), 0.3));
        head.push(Direction::from_angles(3.0 * extra[0], extra[1]).unwrap());
        prop_assert!(near(first(&head, &curves()[n], roll, pitch, 20.0), (roll, pitch), 0.3));
        let u = Attitude::from_degrees(roll, pitch).vertical();
        let s = Solver::new(&head, curves()[n].clone()).unwrap().solve(&signals(&head, &curves()[n], u, 20.0)).unwrap();
        prop_assert!(degrees_apart(s.vertical, u) < 0.05 && s.residual_k < 0.02, "{:?}", s);
    }

    #[test]
    fn signals_k_times_as_large_have_the_same_vertical_and_k_times_the_contrast(
        m in prop::array::uniform3(-30.0..30.0_f64), k in 0.2..5.0_f64, n in 0..6_usize,
    ) {
        let solver = Solver::new(&ORTHOGONAL, curves()[n].clone()).unwrap();
        let solve = |k: f64| solver.solve(&m.map(|m| Some(m * k))).unwrap();
        let (one, other) = (solve(1.0), solve(k));
        prop_assert!(degrees_apart(one.vertical, other.vertical) < 1e-6);
        prop_assert!((one.contrast_k * k - other.contrast_k).abs() < 1e-6 * other.contrast_k);
    }

    #[test]
    fn steeper_reads_steeper(
        a in 0.0..89.0_f64, b in 0.0..89.0_f64, pitch in -60.0..60.0_f64, share in 0.3..1.0_f64, n in 0..6_usize,
    ) {
        let at = |roll_deg: f64| {
            let mut f = Flight::new(&ORTHOGONAL, &curves()[n]);
            f.fly(0.0, 0.0, 30.0 * share, 0.0);
            degrees(&f.fly(roll_deg, pitch, 30.0, 1e-4)).0
        };
        prop_assert!(a >= b || at(a) <= at(b) + 0.02, "{} {}", at(a), at(b));
    }

    #[test]
    fn heading_makes_no_difference(
        roll in -85.0..85.0_f64, pitch in -80.0..80.0_f64, yaw in -3.1..3.1_f64, n in 0..6_usize,
    ) {
        // The body's axes in a world whose third axis is up, turned about it.
        let (r, p) = (roll.to_radians(), pitch.to_radians());
        let body = rotation(yaw, -p, r);
        let m = body[2].map(|up| Some(20.0 * curves()[n].g(up)));
        prop_assert!(near(degrees(&Flight::new(&ORTHOGONAL, &curves()[n]).hear(&m, 0.0)), (roll, pitch), 0.3));
    }

    #[test]
    fn with_the_solved_contrast_the_same_vertical_of_length_1_and_shorter_with_a_larger(
        roll in -180.0..180.0_f64, pitch in -90.0..90.0_f64, more in 1.01..3.0_f64, n in 0..6_usize,
    ) {
        let solver = Solver::new(&ORTHOGONAL, curves()[n].clone()).unwrap();
        let m = signals(&ORTHOGONAL, &curves()[n], Attitude::from_degrees(roll, pitch).vertical(), 20.0);
        let solved = solver.solve(&m).unwrap();
        let same = solver.with_contrast(&m, solved.contrast_k).unwrap();
        prop_assert!(degrees_apart(same.vertical, solved.vertical) < 1e-6 && (same.length - 1.0).abs() < 1e-5);
        prop_assert!(solver.with_contrast(&m, solved.contrast_k * more).unwrap().length < 1.0);
        let small = solver.with_contrast(&m, solved.contrast_k / (2.0 * more)).unwrap();
        prop_assert!(small.length > 1.0 && small.saturated);
        prop_assert_eq!(solver.with_contrast(&m, f64::NAN), None);
        prop_assert_eq!(solver.with_contrast(&m, -1.0), None);
    }

    #[test]
    fn nothing_a_pair_says_makes_anything_that_is_not_finite(
        frames in prop::collection::vec((prop::array::uniform4(any_signal()), -0.1..0.5_f64), 1..6),
        elevation in -80.0..80.0_f64, n in 0..6_usize,
    ) {
        let mut head = ORTHOGONAL.to_vec();
        head.push(Direction::from_angles(70.0, elevation).unwrap());
        let mut f = Flight::new(&head, &curves()[n]);
        for (signals, dt_s) in frames {
            let s = f.hear(&signals, dt_s);
            if let Some(a) = s.attitude {
                prop_assert!(a.roll.abs() <= 3.15 && a.pitch.abs() <= 1.58);
                prop_assert!(s.sigma.roll >= 0.0 && s.sigma.roll.is_finite());
                prop_assert!(s.sigma.pitch >= 0.0 && s.sigma.pitch.is_finite());
            }
            prop_assert!(s.contrast_k.is_none_or(f64::is_finite));
            prop_assert!(s.seen_k.is_none_or(|seen| seen.iter().all(|k| k.is_finite())));
        }
    }
}
