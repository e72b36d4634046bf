//! A field of view that is told wrongly: sensors of 90° of which `field` is told that they see over 75° or 110°. Flights
//! of five minutes, three seeds pooled, the first 20 s left out.

mod flights;

use flights::{Flown, score};
use irhorizon::ctl::score::statistics::Said;
use irhorizon::estimator::field::Tuning;
use irhorizon::estimator::{Estimator, FieldEstimator};
use irhorizon::frame::{Aiding, Frame};
use irhorizon::simulation::Scenario;
use irhorizon::sky::FieldOfView;

/// Root mean squares of roll and pitch, °, not to be exceeded; by the field of view that is told.
type Limits = [(f64, [f64; 2]); 2];

/// Prints what was reached with instruments or without, and wants no more, and σ to own up to it.
fn holds(scenario: &Scenario, aided: bool, limits: Limits) {
    let flights = Flown::all(scenario);
    let change = |frame: &mut Frame| {
        if !aided {
            frame.aiding = Aiding::default();
        }
    };
    for (fwhm_deg, limits) in limits {
        let score = score(&flights, change, || {
            let field = FieldOfView::Gaussian { fwhm_deg };
            let mut method = FieldEstimator::new(&scenario.head(), field, Tuning::default());
            move |frame: &Frame| {
                let solution = method.update(frame);
                solution.attitude.map(|a| Said::new(a, solution.sigma))
            }
        });
        let reached = [score.roll_rms_deg, score.pitch_rms_deg];
        let covered = [score.roll_in_2_sigma_percent, score.pitch_in_2_sigma_percent];
        let (name, less) = (scenario.name(), score.underestimated_p99_deg);
        println!("{name}, told {fwhm_deg}°, aided {aided}: {reached:.2?}, {less:.2?}, within 2 sigma {covered:.1?} %");
        assert!(reached.iter().zip(limits).all(|(r, limit)| r.is_some_and(|r| r <= limit)), "{reached:?} {limits:?}");
        assert!(covered.iter().all(|c| c.is_some_and(|c| c >= 90.0)), "{covered:?}");
    }
}

fn scenario(name: &str) -> Scenario {
    Scenario::named(name).unwrap()
}

/// What is asked where it is told rightly, or half as much again. Under a strong contrast what does not fit is taken for a
/// scene at first, and the wider it is told the longer.
#[test]
fn with_rates_and_gps() {
    holds(&scenario("clear-humid"), true, [(75.0, [0.15, 0.15]), (110.0, [0.15, 0.15])]);
    holds(&scenario("clear-dry").with_contrast(12.0), true, [(75.0, [0.15, 0.15]), (110.0, [0.35, 0.35])]);
    holds(&scenario("clear-dry"), true, [(75.0, [0.15, 0.15]), (110.0, [0.6, 0.6])]);
    holds(&scenario("overcast"), true, [(75.0, [0.25, 0.25]), (110.0, [0.25, 0.25])]);
}

#[test]
fn without_aiding() {
    holds(&scenario("clear-humid"), false, [(75.0, [0.6, 0.42]), (110.0, [0.6, 0.42])]);
    holds(&scenario("clear-dry").with_contrast(12.0), false, [(75.0, [0.6, 0.42]), (110.0, [0.8, 0.42])]);
    holds(&scenario("clear-dry"), false, [(75.0, [0.6, 0.42]), (110.0, [0.8, 0.42])]);
    holds(&scenario("overcast"), false, [(75.0, [1.2, 0.9]), (110.0, [1.2, 0.9])]);
}
