//! Three pairs in volts, as an analogue head has them: how right `profile` is without other instruments, and `field` with
//! them; flights of five minutes under the simulator's skies, three seeds pooled, the first 20 s left out.

mod field;
mod flights;

use field::field;
use flights::{Flown, hear, said, score};
use irhorizon::attitude::Estimate;
use irhorizon::config::Settings;
use irhorizon::ctl::score::statistics::Score;
use irhorizon::estimator::{Estimator, ProfileEstimator};
use irhorizon::frame::{Aiding, Frame, Sample, Value};
use irhorizon::head::SensorKind;
use irhorizon::horizon::Horizon;
use irhorizon::simulation::Scenario;
use irhorizon::source::FrameSource;
use irhorizon::time::Time;

/// Root mean squares of roll and pitch, 99th percentile of the larger error, 99th percentile of the
/// underestimation of rolls beyond 20°; degrees, none of them to be exceeded.
type Limits = [f64; 4];

/// As many errors at least are within twice their standard deviation, %: three pairs see nothing of a warm side, so that in
/// an even sky all are.
const COVERED_PERCENT: f64 = 92.0;

fn pairs(name: &str) -> Scenario {
    Scenario::named(name).unwrap().differential()
}

fn flown<M: Estimator>(name: &str, aided: bool, make: impl Fn(&Scenario) -> M) -> Score {
    let scenario = pairs(name);
    score(&Flown::all(&scenario, 3), hear(aided), || said(make(&scenario)))
}

fn profile(lag_s: f64) -> impl Fn(&Scenario) -> ProfileEstimator {
    move |s| ProfileEstimator::in_flight(s.head(), s.field(), lag_s, 3.0)
}

fn holds(what: &str, score: &Score, limits: Limits) {
    let reached = [score.roll_rms_deg, score.pitch_rms_deg, score.error_p99_deg, score.underestimated_p99_deg];
    let covered = [score.roll_in_2_sigma_percent, score.pitch_in_2_sigma_percent];
    println!("{what}: {reached:.2?}, within 2 sigma {covered:.1?} %");
    assert_eq!(score.withheld_percent, Some(0.0), "{what}");
    assert!(
        reached.iter().zip(limits).all(|(r, limit)| r.is_some_and(|r| r <= limit)),
        "{what}: {reached:?} {limits:?}"
    );
    assert!(covered.iter().all(|c| c.is_some_and(|c| c >= COVERED_PERCENT)), "{what}: {covered:?}");
}

/// What is asked of six temperatures by `field`.
#[test]
fn profile_without_aiding() {
    for name in ["clear-dry", "clear-humid", "namibia", "durham"] {
        holds(name, &flown(name, false, profile(0.1)), [0.40, 0.28, 1.1, 0.9]);
    }
    holds("overcast", &flown("overcast", false, profile(0.1)), [1.2, 0.9, 3.5, 2.2]);
    holds("lag-0.3", &flown("lag-0.3", false, profile(0.3)), [0.8, 0.5, 2.2, 1.7]);
}

/// Clouds and a warm side are an attitude to three pairs; that there may be some is owned up to.
#[test]
fn profile_where_the_sky_is_not_alike_all_around() {
    for name in ["scattered", "warm-slope", "warm-sky"] {
        holds(name, &flown(name, false, profile(0.1)), [3.0, 3.0, 5.0, 5.0]);
    }
}

#[test]
fn field_with_rates_and_gps() {
    for name in ["clear-dry", "clear-humid", "namibia", "durham"] {
        holds(name, &flown(name, true, |s| field(&s.head(), 0.1)), [0.10, 0.10, 0.35, 0.2]);
    }
    for (name, limits) in [
        ("overcast", [0.25, 0.25, 0.7, 0.4]),
        // Of six sensors at most 3.5° and 1.8° are asked in the last two; pairs show nothing of a cloud, or a warm side.
        ("scattered", [1.25, 1.1, 3.3, 3.4]),
        ("warm-sky", [1.2, 1.8, 3.5, 3.5]),
        ("warm-slope", [1.2, 1.8, 3.5, 3.0]),
        ("into-cloud", [0.12, 0.12, 0.45, 0.3]),
    ] {
        holds(name, &flown(name, true, |s| field(&s.head(), 0.1)), limits);
    }
}

/// An ADS1115's step at a gain of 4.096 V.
const STEP_V: f64 = 0.000_125;

/// Off its wire for ten seconds, at ground, at no difference or at the rail, by itself or as its converter flickers: what is
/// still given is not wrong by 10° and 3σ.
#[test]
fn a_pair_that_is_off_its_wire_is_no_wrong_roll_given_with_confidence() {
    let scenario = pairs("clear-dry");
    let head = scenario.head();
    let SensorKind::Pair { neutral_v, kelvin_per_v } = head.sensors[1].kind else { panic!("no pair") };
    let off = [-49.5, 0.0, 49.5].into_iter().flat_map(|off_k| [0.0, 1.0].map(|flicker| (off_k, flicker)));
    for (off_k, flicker) in off {
        let (mut source, mut horizon) = (scenario.source(3), Horizon::new(&Settings::default(), head.clone()));
        let (mut frame, mut estimate) = (Frame::new(3), Estimate::default());
        let (mut wrong, mut named) = (0, 0);
        for i in 0..1000 {
            source.scan(Time::from_secs_f64(100.0 + 0.02 * f64::from(i)), &mut frame);
            frame.aiding = Aiding::default();
            let off = i >= 500;
            let steps = |volts: f64| (volts / STEP_V).round() * STEP_V;
            for (pair, reading) in frame.readings.iter_mut().enumerate() {
                let Ok(Sample { value: Value::Volts(volts), .. }) = reading else { continue };
                *volts = steps(*volts);
                if off && pair == 1 {
                    let steps_off = flicker * f64::from(i * i / 7 % 2);
                    *volts = steps(neutral_v + off_k / kelvin_per_v) + steps_off * STEP_V;
                }
            }
            horizon.update(&frame, &[], &mut estimate);
            named += i32::from(off && !estimate.faults.is_empty());
            if let Some(attitude) = estimate.attitude.filter(|_| off) {
                let error = (attitude.roll - source.truth_at(estimate.valid_at).roll).abs();
                wrong += i32::from(error > 10_f64.to_radians().max(3.0 * estimate.sigma.roll));
            }
        }
        assert!(wrong == 0 && named > 430, "{off_k} K, flickers by {flicker}: {wrong} wrong, {named} with a fault");
    }
}
