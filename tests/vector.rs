//! Vectors and rotations against what geometry says of them.

use irhorizon::estimator::vector::{Vector, add_scaled, cross, dot, length, product, rotation, unit};
use proptest::prelude::*;

fn vector(largest: f64) -> impl Strategy<Value = Vector> {
    proptest::array::uniform3(-largest..largest)
}

fn apart(a: Vector, b: Vector) -> f64 {
    length(add_scaled(a, -1.0, b))
}

#[test]
fn a_quarter_turn_about_each_axis_takes_one_to_the_next() {
    let quarter = std::f64::consts::FRAC_PI_2;
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for i in 0..3 {
        let (axis, next, after) = (axes[i], axes[(i + 1) % 3], axes[(i + 2) % 3]);
        let m = rotation(axis.map(|c| c * quarter));
        assert!(apart(product(&m, next), after) < 1e-15 && apart(product(&m, axis), axis) < 1e-15, "{axis:?}");
        assert!(apart(cross(axis, next), after) < 1e-15);
    }
}

#[test]
fn no_turn_changes_nothing_and_a_whole_one_comes_back() {
    assert_eq!(rotation([0.0; 3]), [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    let whole = rotation([0.0, std::f64::consts::TAU, 0.0]);
    assert!(apart(product(&whole, [1.0, 2.0, 3.0]), [1.0, 2.0, 3.0]) < 1e-14);
}

#[test]
fn what_has_no_direction_has_no_unit() {
    for v in [[0.0; 3], [1e-13, 0.0, 0.0], [f64::NAN, 0.0, 1.0], [f64::INFINITY, 0.0, 0.0], [f64::MAX; 3]] {
        assert_eq!(unit(v), None, "{v:?}");
    }
    assert_eq!(unit([0.0, -3.0, 4.0]), Some([0.0, -0.6, 0.8]));
}

proptest! {
    #[test]
    fn products_are_what_they_are(a in vector(1e3), b in vector(1e3), s in -10.0..10.0_f64) {
        let c = cross(a, b);
        prop_assert!(dot(c, a).abs() < 1e-6 && dot(c, b).abs() < 1e-6);
        // Lagrange's identity.
        let squares = dot(a, a) * dot(b, b);
        prop_assert!((dot(c, c) + dot(a, b).powi(2) - squares).abs() <= 1e-9 * squares.max(1.0));
        prop_assert!((dot(add_scaled(a, s, b), b) - dot(a, b) - s * dot(b, b)).abs() < 1e-6);
        prop_assert!(unit(a).is_none_or(|u| (length(u) - 1.0).abs() < 1e-12 && dot(u, a) > 0.0));
    }

    #[test]
    fn a_rotation_is_orthogonal_and_right_handed(turn in vector(7.0)) {
        let m = rotation(turn);
        for i in 0..3 {
            for j in 0..3 {
                prop_assert!((dot(m[i], m[j]) - f64::from(u8::from(i == j))).abs() < 1e-12);
            }
        }
        prop_assert!((dot(cross(m[0], m[1]), m[2]) - 1.0).abs() < 1e-12);
    }

    /// By the angle, about the axis, in the sense of the right hand.
    #[test]
    fn a_rotation_turns_by_its_angle(turn in vector(1.7), v in vector(1.0)) {
        let (Some(axis), angle) = (unit(turn), length(turn)) else { return Ok(()) };
        let turned = product(&rotation(turn), v);
        prop_assert!((dot(turned, axis) - dot(v, axis)).abs() < 1e-12);
        let level = |v: Vector| add_scaled(v, -dot(v, axis), axis);
        let (before, after) = (level(v), level(turned));
        let (sin, cos) = angle.sin_cos();
        let square = dot(before, before);
        prop_assert!((dot(before, after) - square * cos).abs() < 1e-12);
        prop_assert!((dot(cross(before, after), axis) - square * sin).abs() < 1e-12);
    }

    /// The opposite turn undoes it; turns about one axis add up.
    #[test]
    fn rotations_about_one_axis_add_up(turn in vector(1.0), share in -2.0..2.0_f64, v in vector(1.0)) {
        let by = |s: f64, v: Vector| product(&rotation(turn.map(|c| c * s)), v);
        prop_assert!(apart(by(-1.0, by(1.0, v)), v) < 1e-12);
        prop_assert!(apart(by(share, by(1.0, v)), by(1.0 + share, v)) < 1e-12);
    }

    /// Where the series takes over from the sine nothing jumps, and tiny turns are `v + turn × v`.
    #[test]
    fn small_turns_are_continuous(axis in vector(1.0), exponent in -12.0..-2.0_f64, v in vector(1.0)) {
        let Some(axis) = unit(axis) else { return Ok(()) };
        let angle = 10_f64.powf(exponent);
        let turn = axis.map(|c| c * angle);
        let turned = product(&rotation(turn), v);
        let (first, second) = (cross(turn, v), cross(turn, cross(turn, v)));
        let expected = add_scaled(add_scaled(v, 1.0, first), 0.5, second);
        prop_assert!(apart(turned, expected) < angle.powi(3) + 1e-15, "{} at {angle}", apart(turned, expected));
    }
}
