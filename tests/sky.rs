//! The sky's model against values computed on their own, and what must hold for every sky.

use irhorizon::sky::{Averaging, FieldOfView, Response, Shape, Sky};
use proptest::prelude::*;

/// Ground 16 °C, SkyMax 40 K, k 5.5: pair at 90°, g at 0, 10 … 90°, asin(g) less the angle.
type Check = (FieldOfView, f64, [f64; 10], [f64; 10]);

const CHECKS: [Check; 3] = [
    (
        FieldOfView::InPlane { half_deg: 50.0 },
        38.92,
        [0.0, 0.195, 0.386, 0.568, 0.731, 0.860, 0.936, 0.975, 0.994, 1.0],
        [0.0, 1.3, 2.7, 4.6, 7.0, 9.3, 9.3, 7.2, 3.9, 0.0],
    ),
    (
        FieldOfView::Cone { half_deg: 50.0 },
        38.58,
        [0.0, 0.223, 0.434, 0.622, 0.775, 0.882, 0.945, 0.978, 0.995, 1.0],
        [0.0, 2.9, 5.7, 8.5, 10.8, 11.9, 10.9, 8.1, 4.3, 0.0],
    ),
    (
        FieldOfView::Gaussian { fwhm_deg: 90.0 },
        35.40,
        [0.0, 0.191, 0.372, 0.537, 0.679, 0.795, 0.884, 0.948, 0.987, 1.0],
        [0.0, 1.0, 1.9, 2.5, 2.7, 2.6, 2.2, 1.4, 0.6, 0.0],
    ),
];

fn sin_deg(deg: f64) -> f64 {
    deg.to_radians().sin()
}

#[test]
fn check_values() {
    for (field, pair_at_90, g, excess) in CHECKS {
        let response = Response::new(Shape::Exponential { k: 5.5 }, field, Averaging::Temperature);
        let curve = response.pair_curve(16.0, 40.0);
        assert!((curve.contrast_k() - pair_at_90).abs() < 0.006, "{field:?}: {}", curve.contrast_k());
        for (i, (g, excess)) in g.into_iter().zip(excess).enumerate() {
            let angle = i as f64 * 10.0;
            let got = curve.g(sin_deg(angle));
            // Half a unit of the last figure, and a little for the grid the values came from.
            assert!((got - g).abs() < 0.0007, "{field:?} {angle}°: g {got}");
            let got = got.asin().to_degrees() - angle;
            assert!((got - excess).abs() < 0.08, "{field:?} {angle}°: excess {got}");
        }
    }
}

#[test]
fn the_reports_sine_overestimates_everywhere_below_the_vertical() {
    for (field, ..) in CHECKS {
        let curve = Response::new(Shape::Exponential { k: 5.5 }, field, Averaging::Temperature).pair_curve(5.0, 30.0);
        for deg in 1..90 {
            let deg = f64::from(deg);
            assert!(curve.g(sin_deg(deg)) > sin_deg(deg), "{field:?} {deg}°");
        }
    }
}

#[test]
fn a_narrow_field_sees_the_sky_itself() {
    let sky = Sky::NAMIBIA;
    for averaging in [Averaging::Temperature, Averaging::Radiance] {
        let response = Response::new(sky.shape, FieldOfView::Gaussian { fwhm_deg: 1.0 }, averaging);
        for deg in [-60.0, -10.0, 10.0, 25.0, 50.0, 85.0] {
            let seen = response.sensor_c(sin_deg(deg), sky.ground_c, sky.sky_max_k);
            assert!((seen - sky.temperature_c(deg)).abs() < 0.03, "{averaging:?} {deg}°: {seen}");
        }
    }
}

#[test]
fn radiance_is_the_mean_of_fourth_powers() {
    let (field, ground_c, sky_max_k) = (FieldOfView::Gaussian { fwhm_deg: 90.0 }, 16.0, 40.0);
    let response = Response::new(Shape::Exponential { k: 5.5 }, field, Averaging::Radiance);
    let by_temperature = Response::new(Shape::Exponential { k: 5.5 }, field, Averaging::Temperature);
    for deg in [-90.0, -45.0, 0.0, 30.0, 90.0] {
        let (s, c) = f64::to_radians(deg).sin_cos();
        let mean: f64 = field
            .nodes()
            .iter()
            .map(|n| {
                let e = (n.along * s + n.across * c).asin().to_degrees();
                let k = 273.15 + ground_c - if e > 0.0 { sky_max_k * (1.0 - (-5.5 * e / 90.0).exp()) } else { 0.0 };
                n.weight * k.powi(4)
            })
            .sum();
        let seen = response.sensor_c(s, ground_c, sky_max_k);
        assert!((seen - (mean.powf(0.25) - 273.15)).abs() < 1e-3, "{deg}°: {seen}");
        // The warmer parts of a mixed view weigh more.
        assert!(seen >= by_temperature.sensor_c(s, ground_c, sky_max_k) - 1e-9);
    }
}

#[test]
fn a_table_keeps_its_grid_error_below_a_millikelvin_in_a_wide_field() {
    for (field, ..) in CHECKS {
        let response = Response::new(Shape::Exponential { k: 5.5 }, field, Averaging::Temperature);
        let nodes = field.nodes();
        for i in 0..720 {
            let (s, c) = (f64::from(i) * 0.25 - 89.875).to_radians().sin_cos();
            let exact: f64 = nodes
                .iter()
                .map(|n| n.weight * Shape::Exponential { k: 5.5 }.deficit(n.along * s + n.across * c))
                .sum();
            assert!((response.deficit(s) - exact).abs() * 40.0 < 1e-3, "{field:?} entry {i}");
        }
    }
}

#[test]
fn a_response_is_the_integral_over_the_field() {
    // On a finer grid of its own: off the axis by a, around it by b.
    let weight = |a: f64| a.sin() * (-4.0 * 2.0_f64.ln() * (a.to_degrees() / 90.0).powi(2)).exp();
    let response =
        Response::new(Shape::Exponential { k: 5.5 }, FieldOfView::Gaussian { fwhm_deg: 90.0 }, Averaging::Temperature);
    let n = 300;
    for deg in [-90.0, -30.0, 0.0, 15.0, 60.0, 90.0] {
        let (s, c) = f64::to_radians(deg).sin_cos();
        let (mut deficit, mut whole) = (0.0, 0.0);
        for i in 0..n {
            let a = (f64::from(i) + 0.5) * 90.0_f64.to_radians() / f64::from(n);
            whole += weight(a) * f64::from(n);
            for j in 0..n {
                let b = (f64::from(j) + 0.5) * std::f64::consts::PI / f64::from(n);
                let e = (s * a.cos() + c * a.sin() * b.cos()).clamp(-1.0, 1.0).asin().to_degrees();
                deficit += weight(a) * if e > 0.0 { 1.0 - (-5.5 * e / 90.0).exp() } else { 0.0 };
            }
        }
        let error_k = 40.0 * (response.deficit(s) - deficit / whole);
        assert!(error_k.abs() < 0.005, "{deg}°: {error_k} K");
    }
}

#[test]
fn weather_may_turn_over_or_vanish() {
    let response =
        Response::new(Shape::Exponential { k: 5.5 }, FieldOfView::Gaussian { fwhm_deg: 90.0 }, Averaging::Radiance);
    let hail = response.pair_curve(-4.0, -2.0);
    assert!(hail.contrast_k() < -1.0);
    assert!(hail.g(0.5) > 0.0);
    let none = response.pair_curve(10.0, 0.0);
    assert_eq!(none.contrast_k(), 0.0);
    assert!((none.inverse(none.g(0.3)) - 0.3).abs() < 1e-9);
    for hostile in [f64::NAN, f64::INFINITY, -1e300] {
        let curve = response.pair_curve(hostile, hostile);
        let _ = (curve.inverse(0.5), curve.g(hostile), response.sensor_c(hostile, hostile, hostile));
    }
}

fn shapes() -> impl Strategy<Value = Shape> {
    prop_oneof![(0.5..12.0).prop_map(|k| Shape::Exponential { k }), (0.05..3.0).prop_map(|depth| Shape::Grey { depth })]
}

fn fields() -> impl Strategy<Value = FieldOfView> {
    prop_oneof![
        (5.0..90.0).prop_map(|half_deg| FieldOfView::InPlane { half_deg }),
        (5.0..90.0).prop_map(|half_deg| FieldOfView::Cone { half_deg }),
        (5.0..150.0).prop_map(|fwhm_deg| FieldOfView::Gaussian { fwhm_deg })
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn every_sky_and_field_gives_a_curve_that_can_be_inverted(
        shape in shapes(),
        field in fields(),
        radiance in any::<bool>(),
        ground_c in -20.0..45.0,
        sky_max_k in 2.0..80.0,
    ) {
        let averaging = if radiance { Averaging::Radiance } else { Averaging::Temperature };
        let response = Response::new(shape, field, averaging);
        let curve = response.pair_curve(ground_c, sky_max_k);
        prop_assert!(curve.contrast_k() > 0.0 && curve.contrast_k() <= sky_max_k + 1e-9);
        prop_assert_eq!(curve.g(1.0), 1.0);
        prop_assert_eq!(curve.inverse(1.5), 1.0);
        // In radiance the table's own grain shows where the edge of a very wide field touches the horizon.
        let grain_k = if radiance { 1e-4 * sky_max_k } else { 1e-9 };
        let mut before = (f64::NEG_INFINITY, f64::INFINITY);
        for i in -90..=90 {
            let s = sin_deg(f64::from(i));
            let (g, seen) = (curve.g(s), response.sensor_c(s, ground_c, sky_max_k));
            prop_assert!(g >= before.0, "g falls at {}°", i);
            prop_assert!(seen <= before.1 + grain_k, "it warms at {}°", i);
            prop_assert_eq!(curve.g(-s), -g);
            // The way back to the same reading, and to the same angle where the curve is not flat.
            prop_assert!((curve.g(curve.inverse(g)) - g).abs() < 1e-9);
            if g - before.0 > 1e-6 && curve.g(sin_deg(f64::from(i) + 0.25)) - g > 1e-7 {
                prop_assert!((curve.inverse(g) - s).abs() < 1e-6, "{}° comes back as {}", i, curve.inverse(g));
            }
            // A pair is what its contrast and shape say; beyond the contrast it is by the same grain only.
            let (pair, most) = (response.pair_k(s, ground_c, sky_max_k), curve.contrast_k());
            prop_assert!(pair.abs() <= most + grain_k);
            prop_assert!((pair.clamp(-most, most) - most * g).abs() < 1e-6);
            before = (g, seen);
        }
    }
}
