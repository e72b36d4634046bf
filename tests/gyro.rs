//! A gyro that goes wrong in flight, and one beside sensors that are slower than they are said to be.

use irhorizon::attitude::Estimate;
use irhorizon::config::Settings;
use irhorizon::frame::Frame;
use irhorizon::head::Head;
use irhorizon::horizon::Horizon;
use irhorizon::simulation::Scenario;
use irhorizon::source::FrameSource;
use irhorizon::time::Time;

/// How long a flight is, s; the first part is not judged.
const FLIGHT_S: f64 = 180.0;
const BEGINS_S: f64 = 20.0;

/// How far off an attitude was.
#[derive(Debug, Default)]
struct Off {
    /// The larger error, rms and most, °.
    rms_deg: f64,
    most_deg: f64,
    /// The share of the time in which it was given, and that in which it was off by more than 2° and 2.5 standard
    /// deviations.
    given: f64,
    wrong: f64,
}

/// Flies with all instruments and sensors that are said to lag by `lag_s`; `spoil` is called with the time, s, and what the gyro says, °/s.
fn flown(scene: &str, seed: u64, lag_s: f64, mut spoil: impl FnMut(f64, &mut [f64; 3])) -> Off {
    let mut source = Scenario::named(scene).unwrap().lasting(FLIGHT_S).source(seed);
    let mut horizon = Horizon::new(&Settings::default(), Head::six());
    horizon.set_lag_s(lag_s);
    let (mut frame, mut estimate, mut off) = (Frame::new(6), Estimate::default(), Off::default());
    let (mut frames, mut given) = (0.0, 0.0);
    for i in 0..(50.0 * FLIGHT_S) as u64 {
        let now = Time::from_nanos(i * 20_000_000);
        source.scan(now, &mut frame);
        let mut rates = frame.aiding.gyro_deg_s.map(Option::unwrap);
        spoil(0.02 * i as f64, &mut rates);
        frame.aiding.gyro_deg_s = rates.map(Some);
        horizon.update(&frame, &[], &mut estimate);
        if 0.02 * (i as f64) < BEGINS_S {
            continue;
        }
        frames += 1.0;
        let Some(said) = estimate.attitude.filter(|_| estimate.valid_at == now) else { continue };
        given += 1.0;
        let truth = source.truth_at(now);
        let around = |a: f64| a.sin().atan2(a.cos()).abs();
        let errors = [around(said.roll - truth.roll), around(said.pitch - truth.pitch)];
        let larger_deg = errors[0].max(errors[1]).to_degrees();
        off.rms_deg += larger_deg * larger_deg;
        off.most_deg = off.most_deg.max(larger_deg);
        let beyond = |error: f64, sigma: f64| error.to_degrees() > 2.0 + 2.5 * sigma.to_degrees();
        let wrong = beyond(errors[0], estimate.sigma.roll) || beyond(errors[1], estimate.sigma.pitch);
        off.wrong += if wrong { 1.0 } else { 0.0 };
    }
    (off.rms_deg, off.given, off.wrong) = ((off.rms_deg / given).sqrt(), given / frames, off.wrong / given);
    println!("{scene} {seed}: {off:.3?}");
    off
}

/// Again and again it says what it said, for one second in four.
#[test]
fn one_that_repeats_itself_for_a_second_turns_nothing() {
    for seed in [2, 5] {
        let mut held = None;
        let off = flown("scattered", seed, 0.1, |time_s, rates| {
            held = if time_s % 4.0 < 3.0 { None } else { held.or(Some(*rates)) };
            *rates = held.unwrap_or(*rates);
        });
        assert!(off.rms_deg < 3.5 && off.most_deg < 10.0 && off.wrong < 0.01, "{off:?}");
    }
}

/// A bias that changes is seen by how the sky turns, and is no scene.
#[test]
fn a_bias_that_changes_is_found() {
    for (seed, step) in [(2, 2.0), (2, -3.0)] {
        let off = flown("scattered", seed, 0.1, |time_s, rates| {
            let bias = if time_s > 80.0 { step } else { 0.0 };
            *rates = rates.map(|r| r + bias);
        });
        assert!(off.rms_deg < 2.7 && off.most_deg < 9.0 && off.wrong < 0.025, "{off:?}");
    }
    for seed in [2, 5] {
        let off = flown("cumulus", seed, 0.1, |time_s, rates| *rates = rates.map(|r| r + time_s / 60.0));
        assert!(off.rms_deg < 2.7 && off.most_deg < 9.0 && off.wrong < 0.025, "{off:?}");
    }
}

/// What the sensors show late looks like a gyro that turns otherwise, until it is known how late they are.
#[test]
fn sensors_far_slower_than_said_speak_against_no_gyro() {
    for (scene, said_s) in [("lag-0.3", 0.1), ("aerobatics", 0.025)] {
        let off = flown(scene, 2, said_s, |_, _| ());
        assert!(off.rms_deg < 0.5 && off.wrong < 0.01, "{off:?}");
    }
}
