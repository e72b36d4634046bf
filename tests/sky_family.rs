//! The family's one table against each sky's own, against integrals, and with arguments that are none.

use irhorizon::sky::family::{LN_DEPTH, RADIANCE_K, View, WIDER};
use irhorizon::sky::{Averaging, Family, FieldOfView, Response, Shape};
use proptest::prelude::*;
use std::sync::LazyLock;

const FIELD: FieldOfView = FieldOfView::Gaussian { fwhm_deg: 90.0 };
/// The contrast for which kelvins are stated.
const CONTRAST_K: f64 = 40.0;

static FAMILY: LazyLock<Family> = LazyLock::new(|| Family::new(FIELD));

/// Elevations, °, between the table's entries too.
fn elevations() -> impl Iterator<Item = f64> {
    (-180..=180).map(|i| f64::from(i) * 0.4975)
}

fn sin_deg(deg: f64) -> f64 {
    deg.to_radians().sin()
}

/// What a sensor shows under `shape`, between 0 straight down and 1 straight up, averaged as said under 40 K.
fn alone(shape: Shape, field: FieldOfView, averaging: Averaging) -> Vec<f64> {
    let response = Response::new(shape, field, averaging);
    let shown = |sine| 10.0 - response.sensor_c(sine, 10.0, CONTRAST_K);
    let (down, up) = (shown(-1.0), shown(1.0));
    elevations().map(|e| (shown(sin_deg(e)) - down) / (up - down)).collect()
}

/// A field of view as it was said to be.
const AS_SAID: View = [0.0; 3];

fn levels(family: &Family, ln_depth: f64, radiance: f64) -> Vec<f64> {
    elevations().map(|e| family.level(sin_deg(e), ln_depth, radiance, AS_SAID).value).collect()
}

fn largest_apart(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// The largest misfit of `b` to `a`, K, with the ground and the contrast that fit best.
fn misfit_k(a: &[f64], b: &[f64]) -> f64 {
    let n = a.len() as f64;
    let mean = |v: &[f64]| v.iter().sum::<f64>() / n;
    let (ma, mb) = (mean(a), mean(b));
    let covariance: f64 = a.iter().zip(b).map(|(a, b)| (a - ma) * (b - mb)).sum();
    let scale = covariance / b.iter().map(|b| (b - mb).powi(2)).sum::<f64>();
    let fitted: Vec<f64> = b.iter().map(|b| ma + scale * (b - mb)).collect();
    CONTRAST_K * largest_apart(a, &fitted)
}

/// The smallest misfit over the family's depths.
fn best_misfit_k(a: &[f64], radiance: f64) -> f64 {
    let depths = (0..=2000).map(|i| LN_DEPTH.0 + (LN_DEPTH.1 - LN_DEPTH.0) * f64::from(i) / 2000.0);
    depths.map(|d| misfit_k(a, &levels(&FAMILY, d, radiance))).fold(f64::INFINITY, f64::min)
}

#[test]
fn grey_atmospheres_are_what_their_own_tables_say() {
    let cone = FieldOfView::Cone { half_deg: 50.0 };
    // A narrower field blurs the horizon less than the table's steps were made for.
    for (field, limit_k) in [(FIELD, 0.01), (FieldOfView::Gaussian { fwhm_deg: 60.0 }, 0.025), (cone, 0.025)] {
        let family = Family::new(field);
        for depth in [0.035_f64, 0.1, 0.17, 0.3, 0.8, 1.5, 2.9, 4.0] {
            let own = alone(Shape::Grey { depth }, field, Averaging::Temperature);
            let off_k = CONTRAST_K * largest_apart(&own, &levels(&family, depth.ln(), 0.0));
            println!("{field:?}, depth {depth}: {off_k:.4} K");
            assert!(off_k < limit_k, "{field:?}, depth {depth}: {off_k} K");
        }
    }
}

#[test]
fn the_reports_exponentials_are_near_some_depth() {
    // The report's own k is 5.5; flatter ones are less like a grey atmosphere.
    for (k, limit_k) in [(2.0, 0.15), (3.5, 0.11), (5.5, 0.1), (8.0, 0.1), (12.0, 0.1)] {
        let off_k = best_misfit_k(&alone(Shape::Exponential { k }, FIELD, Averaging::Temperature), 0.0);
        println!("k {k}: {off_k:.3} K");
        assert!(off_k < limit_k, "k {k}: {off_k} K");
    }
}

/// The base of a closed cloud: of one temperature down to a few degrees above the horizon, or farther.
#[test]
fn a_dome_of_one_temperature_is_near_no_depth() {
    for (k, limit_k) in [(20.0, 0.1), (40.0, 0.1), (80.0, 0.1), (160.0, 0.1)] {
        let off_k = best_misfit_k(&alone(Shape::Exponential { k }, FIELD, Averaging::Temperature), 0.0);
        println!("k {k}: {off_k:.3} K");
        assert!(off_k < limit_k, "k {k}: {off_k} K");
    }
}

/// The share of averaging in radiance is of use: with it each depth is what it is, as without none is, and what half of it
/// does lies between.
#[test]
fn averaging_in_radiance_is_part_of_it() {
    for depth in [0.05_f64, 0.15, 0.3, 0.6, 1.5, 2.9] {
        let own = alone(Shape::Grey { depth }, FIELD, Averaging::Radiance);
        let at = |share| CONTRAST_K * largest_apart(&own, &levels(&FAMILY, depth.ln(), share));
        let response = Response::new(Shape::Grey { depth }, FIELD, Averaging::Temperature);
        let pair_k = response.sensor_c(-1.0, 10.0, CONTRAST_K) - response.sensor_c(1.0, 10.0, CONTRAST_K);
        let (share, nearest_k) = (pair_k / RADIANCE_K, best_misfit_k(&own, 0.0));
        println!(
            "depth {depth}: {:.3} K with, {:.3} half, {:.3} without, another depth {nearest_k:.3} K",
            at(share),
            at(share / 2.0),
            at(0.0)
        );
        assert!(at(share) < 0.1 && at(share) < nearest_k, "depth {depth}: {} K, {nearest_k} K", at(share));
        assert!(at(share / 2.0) < 0.6 * at(0.0), "depth {depth}: {} K, {} K", at(share / 2.0), at(0.0));
    }
}

/// A field of view that was said wrongly is told by its spread: exactly at its ends, and hardly worse between and a
/// little beyond.
#[test]
fn a_wider_or_narrower_field_of_view_is_part_of_it() {
    for (spread, limit_k) in [(-1.5, 0.25), (-1.0, 0.01), (-0.5, 0.1), (0.5, 0.1), (1.0, 0.01), (1.5, 0.25)] {
        let field = FieldOfView::Gaussian { fwhm_deg: 90.0 * (1.0 + WIDER * spread) };
        for depth in [0.1_f64, 0.3, 0.8, 2.9] {
            let own = alone(Shape::Grey { depth }, field, Averaging::Temperature);
            let levels: Vec<f64> =
                elevations().map(|e| FAMILY.level(sin_deg(e), depth.ln(), 0.0, [spread, 0.0, 0.0]).value).collect();
            let off_k = CONTRAST_K * largest_apart(&own, &levels);
            println!("spread {spread}, depth {depth}: {off_k:.3} K");
            assert!(off_k < limit_k, "spread {spread}, depth {depth}: {off_k} K");
        }
    }
}

/// So is one of another form: alike all over a cone, or with long tails, or between.
#[test]
fn other_forms_of_the_field_of_view_are_part_of_it() {
    let [even, tailed] = FIELD.others();
    assert_eq!(even, FieldOfView::Even { half_deg: 50.0 });
    for (field, view, limit_k) in [
        // In humid air the grain of a cone's edge.
        (even, [0.0, 1.0, 0.0], 0.03),
        (tailed, [0.0, 0.0, 1.0], 0.01),
        // A flat plate in a tube: narrower, and of both.
        (FieldOfView::Cone { half_deg: 50.0 }, [-1.1, 0.8, 0.35], 0.15),
    ] {
        for depth in [0.1_f64, 0.3, 0.8, 2.9] {
            let own = alone(Shape::Grey { depth }, field, Averaging::Temperature);
            let levels: Vec<f64> =
                elevations().map(|e| FAMILY.level(sin_deg(e), depth.ln(), 0.0, view).value).collect();
            let off_k = misfit_k(&own, &levels);
            println!("{field:?}, depth {depth}: {off_k:.3} K");
            assert!(off_k < limit_k, "{field:?}, depth {depth}: {off_k} K");
        }
    }
}

#[test]
fn levels_rise_from_nothing_to_one() {
    for i in 0..=20 {
        let ln_depth = LN_DEPTH.0 + (LN_DEPTH.1 - LN_DEPTH.0) * f64::from(i) / 20.0;
        let at = |e: f64| FAMILY.level(sin_deg(e), ln_depth, 0.0, AS_SAID).value;
        // The integral's grain in very dry air: less than a millikelvin of 40.
        assert!(at(-90.0).abs() < 1e-9 && (at(90.0) - 1.0).abs() < 2e-5, "{ln_depth}");
        let all: Vec<f64> = (-900..=900).map(|e| at(f64::from(e) * 0.1)).collect();
        // A hair for the cubics between the entries.
        assert!(all.windows(2).all(|w| w[1] >= w[0] - 1e-5), "{ln_depth}");
        // As wide or narrow as the filter lets it be, where the parabola is far from what it was made of; and of other forms.
        let wide = [-2.0, -1.0, 1.0, 2.0].map(|spread| [spread, 0.0, 0.0]);
        let forms = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [-1.0, 0.8, 0.4], [0.5, -0.3, -0.7]];
        for view in wide.into_iter().chain(forms) {
            let at = |e: u32| FAMILY.level(sin_deg(f64::from(e) - 90.0), ln_depth, 0.0, view).value;
            let fall = (0..180).map(|e| at(e) - at(e + 1)).fold(0.0, f64::max);
            assert!(fall < 1e-3, "{ln_depth} {view:?}: {fall}");
        }
    }
}

#[test]
fn what_is_no_number_gives_none_and_what_is_too_far_the_end() {
    for i in 0..6 {
        let [sine, ln_depth, radiance, spread, one, other]: [f64; 6] =
            std::array::from_fn(|k| if k == i { f64::NAN } else { 0.3 });
        assert!(FAMILY.level(sine, ln_depth, radiance, [spread, one, other]).value.is_nan(), "{i}");
    }
    let inside = |sine, ln_depth| FAMILY.level(sine, ln_depth, 0.5, [0.7, 0.2, 0.1]);
    for far in [1.1, 1e300, f64::INFINITY] {
        assert_eq!(inside(far, -1.0), inside(1.0, -1.0));
        assert_eq!(inside(-far, -1.0), inside(-1.0, -1.0));
        assert_eq!(inside(0.2, LN_DEPTH.1 + far), inside(0.2, LN_DEPTH.1));
        assert_eq!(inside(0.2, LN_DEPTH.0 - far), inside(0.2, LN_DEPTH.0));
    }
    for x in [f64::NAN, 0.0, -5.0, 1e300] {
        let family = Family::new(FieldOfView::Gaussian { fwhm_deg: x });
        assert!(
            (0..=180).all(|e| family.level(sin_deg(f64::from(e) - 90.0), 0.0, 0.5, [1.0, 0.5, 0.5]).value.is_finite()),
            "{x}"
        );
    }
}

proptest! {
    /// Slopes are what a small step changes, away from the poles.
    #[test]
    fn slopes_are_differences(
        deg in -87.0..87.0_f64,
        ln_depth in (LN_DEPTH.0 + 0.1)..1.3_f64,
        radiance in 0.0..1.0_f64,
        spread in -2.0..2.0_f64,
        forms in proptest::array::uniform2(-1.0..1.0_f64),
    ) {
        let (sine, h) = (sin_deg(deg), 1e-6);
        let view = [spread, forms[0], forms[1]];
        let level = FAMILY.level(sine, ln_depth, radiance, view);
        let value = |s: f64, d: f64, w: f64| FAMILY.level(s, d, radiance, [w, forms[0], forms[1]]).value;
        let by_sine = (value(sine + h, ln_depth, spread) - value(sine - h, ln_depth, spread)) / (2.0 * h);
        prop_assert!((level.by_sine - by_sine).abs() < 1e-4, "{} and {by_sine}", level.by_sine);
        // Linear between two depths, and on either side of the field of view that was given; on an entry the slope is
        // one side's.
        let within = |slope: f64, less: f64, more: f64| {
            let sides = [-h, h].into_iter().zip([less, more]).map(|(h, there)| (there - level.value) / h);
            let (least, most) = sides.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, m), s| (l.min(s), m.max(s)));
            (least - 1e-6..=most + 1e-6).contains(&slope)
        };
        let by_depth = within(level.by_ln_depth, value(sine, ln_depth - h, spread), value(sine, ln_depth + h, spread));
        prop_assert!(by_depth, "{}", level.by_ln_depth);
        let by_spread = within(level.by_view[0], value(sine, ln_depth, spread - h), value(sine, ln_depth, spread + h));
        prop_assert!(by_spread, "{:?}", level.by_view);
        // Linear.
        let more = |radiance, view| FAMILY.level(sine, ln_depth, radiance, view).value - level.value;
        let linear = [
            (level.by_radiance, more(radiance + 1.0, view)),
            (level.by_view[1], more(radiance, [spread, forms[0] + 1.0, forms[1]])),
            (level.by_view[2], more(radiance, [spread, forms[0], forms[1] + 1.0])),
        ];
        for (slope, more) in linear {
            prop_assert!((slope - more).abs() < 1e-9, "{slope} and {more}");
        }
    }
}
