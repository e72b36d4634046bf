//! How right the method `field` must be: fifteen flights of five minutes under each of the simulator's skies, pooled, the
//! first 20 s left out. Each test prints its figures and names every one that is missed.

mod field;
mod flights;

use field::field;
use flights::{Flown, hear, said, score};
use irhorizon::attitude::Estimate;
use irhorizon::config::Settings;
use irhorizon::ctl::score::statistics::{Said, Score};
use irhorizon::frame::{Frame, Missing, Sample, Value};
use irhorizon::head::Head;
use irhorizon::horizon::Horizon;
use irhorizon::simulation::Scenario;
use irhorizon::sky::Averaging;

/// Root mean squares of roll and pitch, 99th percentile of the larger error, 99th percentile of the
/// underestimation of rolls beyond 20°; degrees, none of them to be exceeded.
type Limits = [f64; 4];

const WHAT: [&str; 4] = ["roll rms", "pitch rms", "p99", "underestimated p99"];
/// The share of errors that must lie within twice their standard deviation, %.
const COVERED_PERCENT: std::ops::RangeInclusive<f64> = 92.0..=98.0;

/// Flights under each sky.
const FLIGHTS: u64 = 15;

/// The clear skies: dry and humid grey atmospheres, and the report's two.
const CLEAR: [Limits; 2] = [[0.40, 0.28, 1.1, 0.9], [0.10, 0.10, 0.35, 0.2]];
/// A closed cover, 8 K.
const OVERCAST: [Limits; 2] = [[1.2, 0.9, 3.5, 2.2], [0.25, 0.25, 0.7, 0.4]];
/// From 40 K to 10 K in 1.5 s.
const INTO_CLOUD: [Limits; 2] = [[0.6, 0.45, 2.0, 1.4], [0.12, 0.12, 0.45, 0.3]];

/// A fresh estimator for six sensors that are told to lag by `lag_s`.
fn fresh(lag_s: f64) -> impl FnMut(&Frame) -> Option<Said> {
    said(field(&Head::six(), lag_s))
}

/// All that the daemon makes of frames by default: detectors, trim learnt in flight, the guard.
fn whole() -> impl FnMut(&Frame) -> Option<Said> {
    let mut horizon = Horizon::new(&Settings::default(), Head::six());
    let mut estimate = Estimate::default();
    move |frame| {
        horizon.update(frame, &[], &mut estimate);
        estimate.attitude.map(|a| Said::new(a, estimate.sigma))
    }
}

fn degrees(score: &Score) -> Limits {
    [score.roll_rms_deg, score.pitch_rms_deg, score.error_p99_deg, score.underestimated_p99_deg]
        .map(|f| f.unwrap_or(f64::NAN))
}

/// The scenario called `name`; to sensors that average radiance with a second word.
fn scenario(name: &str) -> Scenario {
    match name.split_once(' ') {
        Some((name, "radiance")) => Scenario::named(name).unwrap().with_averaging(Averaging::Radiance),
        _ => Scenario::named(name).unwrap(),
    }
}

/// Its flights.
fn flown(name: &str) -> Vec<Flown> {
    Flown::all(&scenario(name), FLIGHTS)
}

/// Prints what was reached; gives what was missed.
fn misses(what: &str, score: &Score, limits: Limits) -> Vec<String> {
    let reached = degrees(score);
    let covered = [score.roll_in_2_sigma_percent, score.pitch_in_2_sigma_percent].map(|c| c.unwrap_or(f64::NAN));
    let [roll, pitch, p99, under] = reached;
    let [roll_in, pitch_in] = covered;
    println!("{what}: {roll:.3} / {pitch:.3} / {p99:.2} / {under:.2}; 2 sigma {roll_in:.1} % {pitch_in:.1} %");
    let mut missed = Vec::new();
    if score.withheld_percent != Some(0.0) {
        missed.push(format!("{what}: frames without an attitude, {:?} %", score.withheld_percent));
    }
    for ((name, reached), limit) in WHAT.iter().zip(reached).zip(limits) {
        // What is no number is a miss.
        if !reached.le(&limit) {
            let over = 100.0 * (reached / limit - 1.0);
            missed.push(format!("{what}: {name} {reached:.3}°, asked for {limit}°: {over:.0} % over"));
        }
    }
    for (name, covered) in ["roll", "pitch"].into_iter().zip(covered) {
        if !COVERED_PERCENT.contains(&covered) {
            missed.push(format!("{what}: {covered:.1} % of the errors of {name} within 2 sigma, asked for 92 to 98"));
        }
    }
    missed
}

/// What is known to be missed, said in docs/estimation.md: the figures asked for above stay as they are, and
/// what is reached instead must not get worse than this.
const KNOWN: [(&str, &str, f64); 25] = [
    ("scattered without aiding", "p99", 6.70),
    ("scattered without aiding", "pitch rms", 1.85),
    ("scattered without aiding", "roll rms", 2.45),
    ("scattered without aiding", "underestimated p99", 4.50),
    ("warm-slope with rates and GPS", "underestimated p99", 2.30),
    ("without nose, with rates and GPS", "pitch rms", 1.70),
    ("without tail, with rates and GPS", "pitch rms", 1.69),
    ("clear-dry with rates and GPS", "2 sigma", 98.00),
    ("clear-dry radiance with rates and GPS", "2 sigma", 98.00),
    ("clear-humid with rates and GPS", "2 sigma", 98.00),
    ("clear-humid radiance with rates and GPS", "2 sigma", 98.00),
    ("durham with rates and GPS", "2 sigma", 98.00),
    ("durham radiance with rates and GPS", "2 sigma", 98.00),
    ("namibia with rates and GPS", "2 sigma", 98.00),
    ("namibia radiance with rates and GPS", "2 sigma", 98.00),
    ("overcast with rates and GPS", "2 sigma", 98.00),
    ("overcast radiance with rates and GPS", "2 sigma", 98.00),
    ("into-cloud with rates and GPS", "2 sigma", 98.00),
    ("into-cloud radiance with rates and GPS", "2 sigma", 98.00),
    ("lag-0.3 with rates and GPS", "2 sigma", 98.00),
    ("scattered with rates and GPS", "2 sigma", 98.00),
    ("scattered without aiding", "2 sigma", 98.00),
    ("warm-sky with rates and GPS", "2 sigma", 98.00),
    ("warm-slope with rates and GPS", "2 sigma", 98.00),
    ("warm-sky without aiding", "2 sigma", 98.00),
];

/// Whether a miss is one of the known ones, and no worse.
fn is_known(miss: &str) -> bool {
    let value = |after: &str| after.split([' ', '°']).find_map(|w| w.parse::<f64>().ok());
    KNOWN.iter().any(|(what, name, worst)| {
        let Some(rest) = miss.strip_prefix(what).and_then(|r| r.strip_prefix(": ")) else { return false };
        if *name == "2 sigma" {
            // No fewer than that; too many inside are on the safe side.
            return rest.contains("within 2 sigma") && value(rest).is_some_and(|v| v >= *worst);
        }
        rest.strip_prefix(name).and_then(value).is_some_and(|v| v <= *worst)
    })
}

/// Prints all that was missed, and fails with what was not known to be.
fn none(missed: &[String]) {
    missed.iter().for_each(|m| println!("MISSED {m}"));
    let new: Vec<&String> = missed.iter().filter(|m| !is_known(m)).collect();
    assert!(new.is_empty(), "missed beyond what is known: {new:#?}");
}

/// A scenario without aiding, then with body rates and GPS.
fn row(name: &str, lag_s: f64, [alone, aided]: [Limits; 2]) {
    let flights = flown(name);
    let make = || fresh(lag_s);
    let mut missed = misses(&format!("{name} without aiding"), &score(&flights, hear(false), make), alone);
    missed.extend(misses(&format!("{name} with rates and GPS"), &score(&flights, hear(true), make), aided));
    none(&missed);
}

/// A head that sits straight on an aircraft that flies 2.5° nose up is not trimmed by what that differs from the climb.
#[test]
fn as_the_daemon_flies() {
    let mut missed = Vec::new();
    for name in ["clear-dry", "clear-humid"] {
        let flights = flown(name);
        missed.extend(misses(&format!("{name} without aiding"), &score(&flights, hear(false), whole), CLEAR[0]));
        missed.extend(misses(&format!("{name} with rates and GPS"), &score(&flights, hear(true), whole), CLEAR[1]));
    }
    none(&missed);
}

#[test]
fn clear_and_dry() {
    row("clear-dry", 0.1, CLEAR);
}

#[test]
fn clear_and_humid() {
    row("clear-humid", 0.1, CLEAR);
}

#[test]
fn namibia() {
    row("namibia", 0.1, CLEAR);
}

#[test]
fn durham() {
    row("durham", 0.1, CLEAR);
}

#[test]
fn overcast() {
    row("overcast", 0.1, OVERCAST);
}

#[test]
fn scattered_cumulus() {
    row("scattered", 0.1, [[1.4, 0.9, 3.0, 2.5], [1.0, 0.8, 2.2, 1.6]]);
}

#[test]
fn one_side_of_the_sky_is_warmer() {
    row("warm-sky", 0.1, [[2.6, 2.3, 4.4, 3.5], [1.0, 1.8, 3.5, 1.8]]);
}

/// Warmer evenly across the zenith, which to the thermopiles is a horizon that leans: only turns and climb tell.
#[test]
fn one_side_of_the_sky_is_warmer_by_a_slope() {
    row("warm-slope", 0.1, [[2.6, 2.3, 4.4, 3.5], [1.0, 1.8, 3.5, 1.8]]);
}

#[test]
fn flying_into_cloud() {
    row("into-cloud", 0.1, INTO_CLOUD);
}

/// As thermopiles do.
#[test]
fn sensors_that_average_radiance() {
    row("clear-dry radiance", 0.1, CLEAR);
    row("clear-humid radiance", 0.1, CLEAR);
    row("namibia radiance", 0.1, CLEAR);
    row("durham radiance", 0.1, CLEAR);
    row("overcast radiance", 0.1, OVERCAST);
}

#[test]
fn flying_into_cloud_with_sensors_that_average_radiance() {
    row("into-cloud radiance", 0.1, INTO_CLOUD);
}

#[test]
fn slow_sensors() {
    row("lag-0.3", 0.3, [[0.8, 0.5, 2.2, 1.7], [0.10, 0.08, 0.35, 0.2]]);
}

/// Each sensor missing in turn from the beginning: at most half as much error again as with all six.
#[test]
fn five_of_six_sensors() {
    let flights = flown("clear-dry");
    let mut missed = Vec::new();
    for aided in [false, true] {
        let change = hear(aided);
        let six = degrees(&score(&flights, &change, || fresh(0.1)));
        for (i, sensor) in Head::six().sensors.iter().enumerate() {
            let five = |frame: &mut Frame| {
                change(frame);
                frame.readings[i] = Err(Missing::NoAnswer);
            };
            let aiding = if aided { "with rates and GPS" } else { "without aiding" };
            let what = format!("without {}, {aiding}", sensor.name);
            let reached = degrees(&score(&flights, five, || fresh(0.1)));
            let ratio: Limits = std::array::from_fn(|k| reached[k] / six[k]);
            println!("{what}: {reached:.3?}, {ratio:.2?} times the error with six");
            for k in 0..2 {
                if !ratio[k].le(&1.5) {
                    missed.push(format!("{what}: {} {:.2} times that with six, asked for 1.5", WHAT[k], ratio[k]));
                }
            }
        }
    }
    none(&missed);
}

/// Flies `name` with frames made `worse`; nobody tells the estimator. The largest rms of roll and pitch, °; the least share
/// within 2 σ, %.
fn with_worse(name: &str, worse: impl Fn(&mut Frame), (rms_deg, covered): ([f64; 2], f64)) {
    let score = score(&flown(name), worse, || fresh(0.1));
    let [roll, pitch, p99, under] = degrees(&score);
    let within = [score.roll_in_2_sigma_percent, score.pitch_in_2_sigma_percent].map(|v| v.unwrap_or(f64::NAN));
    println!("{name}: {roll:.3} / {pitch:.3} / {p99:.2} / {under:.2}; 2 sigma {within:.1?} %");
    assert!(roll <= rms_deg[0] && pitch <= rms_deg[1], "{roll} {pitch}");
    assert!(within.iter().all(|w| *w >= covered), "{within:?}");
    assert_eq!(score.withheld_percent, Some(0.0));
}

/// The same with body rates changed by `change`, as autopilots have them: of another scale, on axes that are not the
/// head's, noisy.
fn with_rates(name: &str, change: impl Fn([f64; 3]) -> [f64; 3], limits: ([f64; 2], f64)) {
    let worse = |frame: &mut Frame| {
        if let [Some(p), Some(q), Some(r)] = frame.aiding.gyro_deg_s {
            frame.aiding.gyro_deg_s = change([p, q, r]).map(Some);
        }
    };
    with_worse(name, worse, limits);
}

/// Turned by so many degrees about each of its axes, the other way round about the second.
fn askew(deg: f64) -> impl Fn([f64; 3]) -> [f64; 3] {
    let m = deg.to_radians();
    move |[p, q, r]| [p + m * q - m * r, q - m * p + m * r, r + m * p - m * q]
}

#[test]
fn a_scale_that_is_off_by_2_percent() {
    with_rates("clear-dry", |rates| rates.map(|r| 1.02 * r), ([0.12, 0.1], 92.0));
}

#[test]
fn axes_that_are_1_degree_askew() {
    with_rates("clear-dry", askew(1.0), ([0.08, 0.08], 92.0));
}

#[test]
fn axes_that_are_1_degree_askew_under_an_overcast() {
    with_rates("overcast", askew(1.0), ([0.2, 0.2], 92.0));
}

/// As far as two boxes are askew that nobody has aligned. A horizon that leans must not be taken for it, nor it for that.
#[test]
fn axes_that_are_3_degrees_askew() {
    with_rates("clear-dry", askew(3.0), ([0.1, 0.1], 92.0));
    with_rates("overcast", askew(3.0), ([0.2, 0.2], 92.0));
    with_rates("scattered", askew(3.0), ([0.95, 1.1], 92.0));
    with_rates("warm-slope", askew(3.0), ([0.85, 0.85], 92.0));
}

#[test]
fn rates_with_four_times_the_noise() {
    let noise = std::cell::Cell::new(1_u64);
    let next = || {
        noise.set(noise.get().wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407));
        (noise.get() >> 11) as f64 / (1_u64 << 53) as f64
    };
    // Of uniform numbers: 0.4 °/s rms.
    with_rates("clear-dry", |rates| rates.map(|r| r + 0.4 * 12_f64.sqrt() * (next() - 0.5)), ([0.15, 0.15], 90.0));
}

/// As a datasheet allows: what is always the same is learnt while the aircraft turns, and is no scene. Until that shows, a
/// minute or so, the errors are larger and the standard deviations too small.
#[test]
fn sensors_that_show_too_much_or_too_little() {
    let off = |errors: [f64; 6], by: fn(&mut f64, f64, f64)| {
        move |frame: &mut Frame| {
            for (reading, error) in frame.readings.iter_mut().zip(errors) {
                if let Ok(Sample { value: Value::Absolute { object_c, ambient_c: Some(ambient_c) }, .. }) = reading {
                    by(object_c, *ambient_c, error);
                }
            }
        }
    };
    let constant = off([0.4, -0.3, 0.2, -0.4, 0.3, -0.1], |object_c, _, error_k| *object_c += error_k);
    let scale =
        off([0.02, -0.03, 0.02, -0.02, 0.03, -0.01], |object_c, die_c, by| *object_c += by * (*object_c - die_c));
    with_worse("clear-dry", constant, ([0.8, 0.75], 85.0));
    with_worse("clear-humid", constant, ([1.0, 1.15], 85.0));
    with_worse("clear-dry", scale, ([0.85, 0.8], 85.0));
    // In humid air such a scale is a scene for most of the five minutes: a known miss, σ is too small.
    with_worse("clear-humid", scale, ([1.0, 1.0], 70.0));
}

/// A filter in the autopilot, stamps that are of its end: the thermopiles cannot tell whose clock is right.
#[test]
fn rates_that_are_10_ms_late() {
    let before = std::cell::Cell::new([0.0; 3]);
    let late = |rates: [f64; 3]| {
        let before = before.replace(rates);
        std::array::from_fn(|i| 0.5 * (before[i] + rates[i]))
    };
    with_rates("clear-dry", late, ([0.12, 0.1], 92.0));
}
