//! The mounting's trim learnt in flight, over whole simulated flights with all instruments and a well
//! mounted head: the angle of attack is 2.5°, and there is nothing to learn.

use irhorizon::attitude::Attitude;
use irhorizon::estimator::field::Tuning;
use irhorizon::estimator::trim::{Learner, level};
use irhorizon::estimator::{Estimator, FieldEstimator, ProfileEstimator};
use irhorizon::frame::Frame;
use irhorizon::simulation::Scenario;
use irhorizon::simulation::aircraft::Aircraft;
use irhorizon::source::FrameSource;
use irhorizon::time::Time;

/// Frames of a flight, at 20 Hz.
const FRAMES: u64 = 6000;

/// Squared errors of roll and pitch, summed.
#[derive(Default)]
struct Errors([f64; 2]);

impl Errors {
    fn add(&mut self, is: Attitude, truth: Attitude) {
        self.0[0] += (is.roll - truth.roll).sin().powi(2);
        self.0[1] += (is.pitch - truth.pitch).sin().powi(2);
    }

    fn rms_deg(&self) -> [f64; 2] {
        self.0.map(|sum| (sum / FRAMES as f64).sqrt().to_degrees())
    }
}

/// A method for a scenario's head.
type Method = fn(&Scenario) -> Box<dyn Estimator>;

const PROFILE: Method = |scenario| Box::new(ProfileEstimator::in_flight(scenario.head(), scenario.field(), 0.1, 3.0));

const FIELD: Method = |scenario| Box::new(FieldEstimator::new(&scenario.head(), scenario.field(), Tuning::default()));

/// The largest trims of a flight with a head `nose_up_deg` askew, and the errors without and with them, all roll
/// and pitch in degrees.
fn flown(name: &str, seed: u64, method: Method, nose_up_deg: f64) -> [[f64; 2]; 3] {
    let scenario = Scenario::named(name).unwrap().lasting(300.0);
    let (mut method, askew) = (method(&scenario), Attitude::from_degrees(0.0, -nose_up_deg));
    let (mut source, mut frame, mut learner) = (scenario.source(seed), Frame::new(6), Learner::default());
    let (mut largest, mut without, mut with) = ([0.0_f64; 2], Errors::default(), Errors::default());
    for i in 0..FRAMES {
        let tick = Time::from_nanos(i * 50_000_000);
        source.scan(tick, &mut frame);
        let Some(seen) = method.update(&frame).attitude.map(|a| level(a, askew)) else { continue };
        learner.update(seen, &frame.aiding, frame.time);
        let trim = learner.trim();
        for (l, t) in largest.iter_mut().zip([trim.roll, trim.pitch]) {
            *l = l.max(t.to_degrees().abs());
        }
        without.add(seen, source.truth_at(tick));
        with.add(level(seen, trim), source.truth_at(tick));
    }
    let found = [largest, without.rms_deg(), with.rms_deg()];
    println!(
        "{name} {seed}, {nose_up_deg}° askew: trim at most {:.2?}°, rms without it {:.2?}°, with {:.2?}°",
        found[0], found[1], found[2]
    );
    found
}

#[test]
fn a_well_mounted_head_is_let_be() {
    for name in ["clear-dry", "clear-humid", "overcast", "uncoordinated", "inverted"] {
        for seed in [1, 2] {
            let [largest, ..] = flown(name, seed, PROFILE, 0.0);
            assert!(largest[0] < 0.2 && largest[1] < 0.6, "{name} {seed}: {largest:?}");
        }
    }
}

/// In air that rises and sinks, half a minute of climbing looks like a head that sits askew. A trim that comes in vain
/// is small, and within what is said of it.
#[test]
fn a_trim_in_vain_is_within_sigma() {
    for seed in [3, 8, 17] {
        let air = Aircraft { wind_m_s: [3.0, -4.0], updraught_m_s: 0.8, ..Aircraft::default() };
        let scenario = Scenario::named("clear-dry").unwrap().with_aircraft(air);
        let (mut source, mut frame, mut learner) = (scenario.source(seed), Frame::new(6), Learner::default());
        let (mut largest, mut beyond) = (0.0_f64, 0.0_f64);
        for i in 0..FRAMES {
            let tick = Time::from_nanos(i * 50_000_000);
            source.scan(tick, &mut frame);
            learner.update(source.truth_at(tick), &frame.aiding, frame.time);
            let [trim, sigma] = [learner.trim(), learner.sigma()].map(|a| a.pitch.to_degrees().abs());
            (largest, beyond) = (largest.max(trim), beyond.max(trim - 2.0 * sigma));
        }
        println!("{seed}: pitch trimmed by {largest:.2}° in vain, {beyond:.2}° beyond 2 sigma");
        assert!(largest < 2.0 && beyond < 0.2, "{seed}: {largest}, {beyond}");
    }
}

#[test]
fn no_scene_that_leans_pulls_a_well_mounted_head_away() {
    for name in ["warm-side", "warm-sky", "cumulus", "ridge"] {
        for seed in [1, 2] {
            let [largest, without, with] = flown(name, seed, PROFILE, 0.0);
            let worse = [0, 1].map(|i| with[i] - without[i]);
            assert!(worse.iter().all(|w| *w < 0.2), "{name} {seed}: worse by {worse:?}");
            assert!(largest[0] < 1.0 && largest[1] < 2.5, "{name} {seed}: {largest:?}");
        }
    }
}

#[test]
fn a_head_that_sits_askew_is_trimmed_and_by_any_method_alike() {
    for (name, method) in [("clear-dry", PROFILE), ("overcast", PROFILE), ("clear-dry", FIELD)] {
        for nose_up_deg in [-9.0, 9.0] {
            // What the angle of attack adds to, or takes from, the mounting is taken for the mounting.
            let [largest, without, with] = flown(name, 1, method, nose_up_deg);
            assert!((4.0..12.0).contains(&largest[1]) && largest[0] < 0.2, "{name} {nose_up_deg}: {largest:?}");
            assert!(with[1] < 0.8 * without[1] && with[0] < without[0] + 0.2, "{name}: {with:?} {without:?}");
        }
    }
    let [largest, ..] = flown("clear-dry", 1, FIELD, 0.0);
    assert!(largest[0] < 0.2 && largest[1] < 0.6, "{largest:?}");
}
