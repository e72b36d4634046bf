//! How right the method `field` is with a gyro as autopilots have it: of another scale, on axes that are not the head's,
//! noisy. None of it is told to the estimator, which has to learn how far the rates can be believed.

mod field;
mod flights;

use field::field;
use flights::{Flown, score};
use irhorizon::ctl::score::statistics::Said;
use irhorizon::estimator::Estimator;
use irhorizon::frame::Frame;
use irhorizon::head::Head;

/// The largest rms of roll and pitch, °; the least share within 2 σ, %.
type Limits = ([f64; 2], f64);

/// Flies `name` with rates changed by `change`.
fn flown(name: &str, change: impl Fn([f64; 3]) -> [f64; 3], (rms_deg, covered): Limits) {
    let make = || {
        let mut estimator = field(&Head::six(), 0.1);
        move |frame: &Frame| {
            let solution = estimator.update(frame);
            solution.attitude.map(|a| Said::new(a, solution.sigma))
        }
    };
    let worse = |frame: &mut Frame| {
        if let [Some(p), Some(q), Some(r)] = frame.aiding.gyro_deg_s {
            frame.aiding.gyro_deg_s = change([p, q, r]).map(Some);
        }
    };
    let score = score(&Flown::all(name).unwrap(), worse, make);
    let rms = [score.roll_rms_deg, score.pitch_rms_deg].map(|v| v.unwrap_or(f64::NAN));
    let within = [score.roll_in_2_sigma_percent, score.pitch_in_2_sigma_percent].map(|v| v.unwrap_or(f64::NAN));
    println!("{name}: {rms:.3?}°, within 2 sigma {within:.1?} %, largest {:?}°", score.error_p99_deg);
    assert!(rms.iter().zip(rms_deg).all(|(reached, limit)| *reached <= limit), "{rms:?}");
    assert!(within.iter().all(|w| *w >= covered), "{within:?}");
    assert_eq!(score.withheld_percent, Some(0.0));
}

/// Turned by so many degrees about each of its axes, the other way round about the second.
fn askew(deg: f64) -> impl Fn([f64; 3]) -> [f64; 3] {
    let m = deg.to_radians();
    move |[p, q, r]| [p + m * q - m * r, q - m * p + m * r, r + m * p - m * q]
}

#[test]
fn a_scale_that_is_off_by_2_percent() {
    flown("clear-dry", |rates| rates.map(|r| 1.02 * r), ([0.2, 0.15], 85.0));
}

#[test]
fn axes_that_are_1_degree_askew() {
    flown("clear-dry", askew(1.0), ([0.2, 0.2], 92.0));
}

#[test]
fn axes_that_are_1_degree_askew_under_an_overcast() {
    flown("overcast", askew(1.0), ([0.45, 0.45], 80.0));
}

#[test]
fn rates_with_four_times_the_noise() {
    let noise = std::cell::Cell::new(1_u64);
    let next = || {
        noise.set(noise.get().wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407));
        (noise.get() >> 11) as f64 / (1_u64 << 53) as f64
    };
    // Of uniform numbers: 0.4 °/s rms.
    flown("clear-dry", |rates| rates.map(|r| r + 0.4 * 12_f64.sqrt() * (next() - 0.5)), ([0.15, 0.15], 90.0));
}
