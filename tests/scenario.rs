//! Named scenarios: what they hold, that they can be had again, and that they survive being recorded.

use irhorizon::frame::{Aiding, Frame, Missing, Value};
use irhorizon::recording::{Recording, Reference, Writer};
use irhorizon::simulation::aircraft::Aircraft;
use irhorizon::simulation::instruments::Fitted;
use irhorizon::simulation::scenario::LIST;
use irhorizon::simulation::{Flight, Outage, Scenario};
use irhorizon::sky::FieldOfView;
use irhorizon::source::FrameSource;
use irhorizon::time::Time;

fn scenario(name: &str) -> Scenario {
    Scenario::named(name).unwrap().lasting(20.0)
}

fn tick(i: u32) -> Time {
    Time::from_nanos(u64::from(i) * 20_000_000)
}

/// `count` frames at 50 Hz.
fn frames(scenario: &Scenario, seed: u64, count: u32) -> Vec<Frame> {
    let mut source = scenario.source(seed);
    let mut frame = Frame::new(scenario.head().sensors.len());
    (0..count)
        .map(|i| {
            source.scan(tick(i), &mut frame);
            frame.clone()
        })
        .collect()
}

fn object_c(frame: &Frame, sensor: usize) -> f64 {
    match frame.readings[sensor].unwrap().value {
        Value::Absolute { object_c, .. } => object_c,
        Value::Volts(_) => f64::NAN,
    }
}

#[test]
fn every_scenario_flies_and_is_another_one() {
    let plain = frames(&scenario("clear-dry"), 1, 200);
    for (name, about) in LIST {
        let scenario = scenario(name);
        assert_eq!(scenario.name(), name);
        assert_eq!(scenario.field(), FieldOfView::Gaussian { fwhm_deg: 90.0 });
        let got = frames(&scenario, 1, 200);
        assert!(got.iter().all(|f| (0..6).all(|i| (-60.0..40.0).contains(&object_c(f, i)))), "{name}");
        assert!(got.iter().all(|f| f.aiding.gyro_deg_s.iter().all(|r| r.is_some_and(f64::is_finite))), "{name}");
        assert_eq!(got == plain, name == "clear-dry", "{name}: {about}");
    }
    assert!(Scenario::named("clear").is_none());
    assert_eq!(Scenario::named("ridge").unwrap().seconds(), 300.0);
}

#[test]
fn the_seed_decides_everything() {
    for name in ["cumulus", "uncoordinated"] {
        let twice = [1, 1, 2].map(|seed| frames(&scenario(name), seed, 100));
        assert_eq!(twice[0], twice[1]);
        assert_ne!(twice[0], twice[2]);
    }
}

#[test]
fn the_vertical_pair_sees_the_contrast_that_the_name_stands_for() {
    for (name, contrast_k) in
        [("clear-dry", 40.0), ("clear-humid", 25.0), ("overcast", 8.0), ("namibia", 35.4), ("durham", 26.55)]
    {
        // The flight begins nearly level.
        let frame = &frames(&scenario(name), 3, 1)[0];
        let contrast = object_c(frame, 5) - object_c(frame, 4);
        assert!((contrast - contrast_k).abs() < 0.6, "{name}: {contrast}");
    }
}

#[test]
fn the_sky_of_into_cloud_goes_and_comes_back() {
    let source = Scenario::named("into-cloud").unwrap().source(1);
    let sky_max_k = |s: f64| source.weather_at(Time::from_secs_f64(s)).sky_max_k;
    let got = [10.0, 20.75, 30.0, 45.0, 65.0, 290.0].map(sky_max_k);
    assert_eq!(got, [40.0, 25.0, 10.0, 40.0, 10.0, 40.0]);
}

#[test]
fn options_take_away_what_they_say() {
    let bare = scenario("clear-dry").with_instruments(None);
    assert!(frames(&bare, 1, 50).iter().all(|f| f.aiding == Aiding::default()));
    let no_gyro = scenario("clear-dry").with_instruments(Some(Fitted { gyro: false, ..Fitted::default() }));
    let got = frames(&no_gyro, 1, 50);
    assert!(got.iter().all(|f| f.aiding.gyro_deg_s == [None; 3]));
    assert_eq!(got.iter().filter(|f| f.aiding.course_deg.is_some()).count(), 5);
    let lossy = frames(&scenario("clear-dry").with_dropped(0.1), 1, 1000);
    let lost = lossy.iter().filter(|f| f.readings.iter().all(Result::is_err)).count();
    assert!((70..130).contains(&lost), "{lost}");
    let volts = scenario("clear-dry").differential();
    assert!(frames(&volts, 1, 5).iter().all(|f| matches!(f.readings[2].unwrap().value, Value::Volts(v) if v > 0.9)));
    let slow = scenario("clear-dry").with_aircraft(Aircraft { airspeed_m_s: 12.0, ..Aircraft::default() });
    let airspeeds: Vec<f64> = frames(&slow, 1, 500).iter().filter_map(|f| f.aiding.airspeed_m_s).collect();
    let mean = airspeeds.iter().sum::<f64>() / airspeeds.len() as f64;
    assert!((10.0..14.0).contains(&mean), "{mean}");
    let without_up = Outage { sensor: 4, from_s: 0.0, to_s: 9.0, reason: Missing::NoAnswer };
    let mut source = scenario("clear-dry").source(1).with_outages(vec![without_up]);
    let mut frame = Frame::new(6);
    source.scan(tick(0), &mut frame);
    assert_eq!(frame.readings.iter().filter(|r| r.is_err()).count(), 1);
}

#[test]
fn contrast_and_noise_are_those_asked_for() {
    // Level and without noise a vertical pair sees the contrast.
    for name in ["clear-dry", "namibia", "overcast"] {
        let mut source =
            scenario(name).with_contrast(5.0).with_noise(0.0).source(1).with_flight(Flight::steady(0.0, 0.0));
        let mut frame = Frame::new(6);
        source.scan(tick(0), &mut frame);
        let seen_k = object_c(&frame, 5) - object_c(&frame, 4);
        assert!((seen_k - 5.0).abs() < 0.05, "{name}: {seen_k}");
    }
}

#[test]
fn a_script_is_flown_with_a_heading_too() {
    let scripted = scenario("clear-dry").scripted(1);
    let source = scripted.source(1);
    let at =
        |s: f64| (source.truth_at(Time::from_secs_f64(s)).roll.to_degrees(), source.yaw_at(Time::from_secs_f64(s)));
    // The demonstration's first turn: 30° to the right, then.
    assert!((25.0..35.0).contains(&at(12.0).0), "{:?}", at(12.0));
    let turned = (at(15.0).1 - at(10.0).1).rem_euclid(std::f64::consts::TAU);
    assert!((turned - 5.0 * 9.80665 * 30_f64.to_radians().tan() / 18.0).abs() < 0.5, "{turned}");
}

#[test]
fn a_recording_gives_back_frames_and_truth() {
    let scenario = scenario("warm-side");
    let (head, mut source) = (scenario.head(), scenario.source(4));
    let writer = Writer::new(&head, "");
    let mut text = writer.reference_header();
    let mut frame = Frame::new(6);
    let mut expected = Vec::new();
    for i in 0..100 {
        source.scan(tick(i), &mut frame);
        let (truth, yaw) = (source.truth_at(tick(i)), source.yaw_at(tick(i)));
        let [roll_deg, pitch_deg, yaw_deg] = [truth.roll, truth.pitch, yaw].map(|a| Some(a.to_degrees()));
        let reference = Reference { roll_deg, pitch_deg, yaw_deg };
        writer.reference_row(&frame, &reference, &mut text);
        expected.push((frame.clone(), reference));
    }
    let mut reader = Recording::new(text.as_bytes(), "made up".into()).unwrap().frames(None).unwrap();
    assert!(reader.notices().is_empty());
    let near = |a: Option<f64>, b: Option<f64>| match (a, b) {
        (Some(a), Some(b)) => (a - b).abs() < 6e-5,
        (a, b) => a == b,
    };
    for (wrote, reference) in expected {
        assert!(reader.next_frame(&mut frame).unwrap());
        assert_eq!(frame.time, wrote.time);
        assert!((0..6).all(|i| near(Some(object_c(&frame, i)), Some(object_c(&wrote, i)))));
        assert!(near(frame.aiding.course_deg, wrote.aiding.course_deg));
        assert!((0..3).all(|i| near(frame.aiding.gyro_deg_s[i], wrote.aiding.gyro_deg_s[i])));
        let read = reader.reference();
        assert!(near(read.roll_deg, reference.roll_deg) && near(read.pitch_deg, reference.pitch_deg));
        assert!(near(read.yaw_deg, reference.yaw_deg));
    }
    assert!(!reader.next_frame(&mut frame).unwrap());
    assert!(reader.tally().is_clean());
}
