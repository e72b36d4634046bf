//! A field of view that is told wrongly: sensors of 90° of which `field` is told that they see over 75° or 110°, and sensors
//! that see in another form than the bell that it is told. Flights of five minutes, three seeds pooled or eight, the first 20 s
//! left out.

mod flights;

use flights::{Flown, hear, said, score};
use irhorizon::estimator::FieldEstimator;
use irhorizon::estimator::field::Tuning;
use irhorizon::simulation::Scenario;
use irhorizon::sky::FieldOfView;

/// Root mean squares of roll and pitch, °, not to be exceeded; told 75° and told 110°.
type Limits = [[f64; 2]; 2];

/// Prints what was reached without instruments and with, and wants no more, and σ to own up to it.
fn holds(scenario: &Scenario, limits: [Limits; 2]) {
    let flights = Flown::all(scenario, 3);
    for (aided, limits) in [false, true].into_iter().zip(limits) {
        for (fwhm_deg, limits) in [75.0, 110.0].into_iter().zip(limits) {
            let field = FieldOfView::Gaussian { fwhm_deg };
            let make = || said(FieldEstimator::new(&scenario.head(), field, Tuning::default()));
            let score = score(&flights, hear(aided), make);
            let reached = [score.roll_rms_deg, score.pitch_rms_deg];
            let covered = [score.roll_in_2_sigma_percent, score.pitch_in_2_sigma_percent];
            let (name, less) = (scenario.name(), score.underestimated_p99_deg);
            println!(
                "{name}, told {fwhm_deg}°, aided {aided}: {reached:.2?}, {less:.2?}, within 2 sigma {covered:.1?} %"
            );
            assert!(
                reached.iter().zip(limits).all(|(r, limit)| r.is_some_and(|r| r <= limit)),
                "{reached:?} {limits:?}"
            );
            assert!(covered.iter().all(|c| c.is_some_and(|c| c >= 90.0)), "{covered:?}");
        }
    }
}

fn scenario(name: &str) -> Scenario {
    Scenario::named(name).unwrap()
}

/// What is asked of clear skies where it is told rightly, or half as much again.
const CLEAR: [Limits; 2] = [[[0.6, 0.42], [0.6, 0.42]], [[0.15, 0.15], [0.15, 0.15]]];

#[test]
fn clear_and_humid() {
    holds(&scenario("clear-humid"), CLEAR);
}

#[test]
fn overcast() {
    holds(&scenario("overcast"), [[[1.2, 0.9], [1.2, 0.9]], [[0.25, 0.25], [0.25, 0.25]]]);
}

#[test]
fn clear_and_dry() {
    let [[alone, _], [aided, _]] = CLEAR;
    holds(&scenario("clear-dry"), [[alone, [0.8, 0.42]], [aided; 2]]);
    holds(&scenario("clear-dry").with_contrast(12.0), [[alone, [0.8, 0.42]], [aided; 2]]);
}

/// Sensors that see alike all over a cone, as a flat plate in a tube, and with long tails, where a bell is told. With a gyro
/// that is found once the aircraft has turned one and a half times round; until then, and in humid air for longer, it is
/// taken for a scene, or for another sky: in some flights to the end. Nothing is looked for without.
#[test]
fn another_form() {
    let forms = [
        (FieldOfView::Even { half_deg: 50.0 }, "even"),
        (FieldOfView::Cone { half_deg: 50.0 }, "plate"),
        (FieldOfView::Tailed { fwhm_deg: 90.0 }, "tailed"),
    ];
    for (name, limits) in [("clear-dry", [0.4, 0.3, 0.4]), ("clear-humid", [0.9, 0.8, 0.15])] {
        for ((seen, form), limit) in forms.into_iter().zip(limits) {
            let scenario = scenario(name).seeing(seen);
            let flights = Flown::all(&scenario, 8);
            for (aided, limit, under) in [(false, 1.9, 1.7), (true, limit, 1.5)] {
                let make = || said(FieldEstimator::new(&scenario.head(), scenario.field(), Tuning::default()));
                let score = score(&flights, hear(aided), make);
                let reached = [score.roll_rms_deg, score.pitch_rms_deg];
                let covered = [score.roll_in_2_sigma_percent, score.pitch_in_2_sigma_percent];
                let less = score.underestimated_p99_deg;
                println!("{name}, {form}, aided {aided}: {reached:.2?}, {less:.2?}, within 2 sigma {covered:.1?} %");
                assert!(reached.iter().all(|r| r.is_some_and(|r| r <= limit)), "{reached:?}");
                assert!(covered.iter().all(|c| c.is_some_and(|c| c >= 85.0)), "{covered:?}");
                assert!(less.is_some_and(|less| less <= under), "{less:?}");
            }
        }
    }
}
