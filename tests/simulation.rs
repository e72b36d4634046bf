//! The simulated source: signs, symmetry, lag, noise, scripts, and the same bytes for the same seed.

mod calm;

use calm::CALM;
use irhorizon::attitude::Attitude;
use irhorizon::config::settings::{SimulationSettings, SkyName};
use irhorizon::direction::Direction;
use irhorizon::frame::{Frame, Missing, Value};
use irhorizon::head::{Head, Sensor, SensorKind};
use irhorizon::simulation::{Flight, Outage, SimulatedSource, Waypoint, Weather};
use irhorizon::sky::{Averaging, FieldOfView, Shape, Sky};
use irhorizon::source::{FrameSource, Integrity};
use irhorizon::time::Time;
use proptest::prelude::*;

const FIELD: FieldOfView = FieldOfView::Gaussian { fwhm_deg: 90.0 };
const NOSE: usize = 0;
const TAIL: usize = 1;
const LEFT: usize = 2;
const RIGHT: usize = 3;
const UP: usize = 4;
const DOWN: usize = 5;

fn six(settings: &SimulationSettings) -> SimulatedSource {
    SimulatedSource::new(settings, &Head::six(), FIELD)
}

/// `seconds` of frames at `rate_hz`, from second 100 of the clock.
fn frames(source: &mut SimulatedSource, sensors: usize, rate_hz: f64, seconds: f64) -> Vec<Frame> {
    let mut frame = Frame::new(sensors);
    (0..(rate_hz * seconds).round() as u32)
        .map(|i| {
            source.scan(Time::from_secs_f64(100.0 + f64::from(i) / rate_hz), &mut frame);
            frame.clone()
        })
        .collect()
}

fn object_c(frame: &Frame, sensor: usize) -> f64 {
    match frame.readings[sensor].expect("a reading").value {
        Value::Absolute { object_c, .. } => object_c,
        Value::Volts(_) => panic!("sensor {sensor} gives volts"),
    }
}

fn volts(frame: &Frame, sensor: usize) -> f64 {
    match frame.readings[sensor].expect("a reading").value {
        Value::Volts(v) => v,
        Value::Absolute { .. } => panic!("sensor {sensor} gives a temperature"),
    }
}

/// What the six see at an attitude, °C.
fn seen(roll_deg: f64, pitch_deg: f64) -> [f64; 6] {
    let mut source = six(&CALM).with_flight(Flight::steady(roll_deg, pitch_deg));
    let frame = &frames(&mut source, 6, 50.0, 0.02)[0];
    std::array::from_fn(|i| object_c(frame, i))
}

fn near(a: f64, b: f64) -> bool {
    // Two readings, each rounded to 0.02 K.
    (a - b).abs() < 0.021
}

#[test]
fn signs() {
    let level = seen(0.0, 0.0);
    assert!([TAIL, LEFT, RIGHT].iter().all(|i| near(level[*i], level[NOSE])));
    assert!(level[UP] < level[NOSE] - 10.0 && level[DOWN] > level[NOSE] + 10.0);
    assert!(near(level[DOWN], 16.0));
    let nose_up = seen(0.0, 20.0);
    assert!(nose_up[NOSE] < level[NOSE] - 3.0 && nose_up[TAIL] > level[TAIL] + 3.0);
    assert!(near(nose_up[LEFT], nose_up[RIGHT]));
    // Right wing down: the left sensor looks at the sky.
    let right_down = seen(20.0, 0.0);
    assert!(right_down[LEFT] < level[LEFT] - 3.0 && right_down[RIGHT] > level[RIGHT] + 3.0);
    assert!(near(right_down[NOSE], right_down[TAIL]));
}

#[test]
fn on_its_back_up_and_down_change_places() {
    let (level, inverted) = (seen(0.0, 0.0), seen(180.0, 0.0));
    assert!(near(level[UP], inverted[DOWN]) && near(level[DOWN], inverted[UP]));
    let head = Head::six();
    let mut source = six(&CALM).with_flight(Flight::steady(180.0, 0.0));
    let signal = head.signal_k(2, &frames(&mut source, 6, 50.0, 0.02)[0]).unwrap();
    assert!((signal + 35.40).abs() < 0.03, "{signal}");
}

#[test]
fn a_vertical_pair_shows_the_check_value_in_level_flight() {
    let head = Head::six();
    for (field, pair_at_90) in [
        (FieldOfView::InPlane { half_deg: 50.0 }, 38.92),
        (FieldOfView::Cone { half_deg: 50.0 }, 38.58),
        (FieldOfView::Gaussian { fwhm_deg: 90.0 }, 35.40),
    ] {
        let mut source = SimulatedSource::new(&CALM, &head, field).with_flight(Flight::steady(0.0, 0.0));
        let signal = head.signal_k(2, &frames(&mut source, 6, 50.0, 0.02)[0]).unwrap();
        assert!((signal - pair_at_90).abs() < 0.03, "{field:?}: {signal}");
    }
}

#[test]
fn a_head_turned_on_the_airframe_sees_what_a_turned_airframe_sees() {
    let turned = |azimuth: f64| Sensor {
        name: "s".into(),
        direction: Direction::from_angles(azimuth, 0.0).unwrap(),
        kind: SensorKind::ABSOLUTE,
        bus: None,
    };
    for (roll, pitch) in [(0.0, 0.0), (30.0, 0.0), (-20.0, 35.0), (140.0, -10.0)] {
        let head = Head::new([45.0, 225.0, 315.0, 135.0].map(turned).to_vec(), vec![]);
        let mut source = SimulatedSource::new(&CALM, &head, FIELD).with_flight(Flight::steady(roll, pitch));
        let frame = &frames(&mut source, 4, 50.0, 0.02)[0];
        // The same airframe yawed by 45° to the right: its nose is where the first sensor looked.
        let [n, l, u] = Attitude::from_degrees(roll, pitch).vertical();
        let h = 0.5_f64.sqrt();
        let (nose, left) = (h * (n - l), h * (n + l));
        let plain = seen(left.atan2(u).to_degrees(), nose.asin().to_degrees());
        for i in [NOSE, TAIL, LEFT, RIGHT] {
            assert!(near(object_c(frame, i), plain[i]), "sensor {i} at {roll}° {pitch}°");
        }
    }
}

#[test]
fn a_pair_channel_gives_the_difference_in_volts() {
    let pair = |name: &str, direction, neutral_v, kelvin_per_v| Sensor {
        name: name.into(),
        direction,
        kind: SensorKind::Pair { neutral_v, kelvin_per_v },
        bus: None,
    };
    let head = Head::new(
        vec![
            pair("long", Direction::NOSE, 1.65, 40.0),
            pair("lat", Direction::from_angles(45.0, 0.0).unwrap(), 1.60, -25.0),
            pair("vert", Direction::UP, 0.0, 40.0),
        ],
        vec![],
    );
    let plain = seen(0.0, 20.0);
    let mut source = SimulatedSource::new(&CALM, &head, FIELD).with_flight(Flight::steady(0.0, 20.0));
    let frame = frames(&mut source, 3, 50.0, 0.02).remove(0);
    assert!((volts(&frame, 0) - (1.65 + (plain[TAIL] - plain[NOSE]) / 40.0)).abs() < 1e-3);
    assert!(volts(&frame, 1) < 1.60, "wired inverted, nose up");
    assert!((volts(&frame, 2) - (plain[DOWN] - plain[UP]) / 40.0).abs() < 1e-3);
    for i in 0..3 {
        let counts = volts(&frame, i) / 62.5e-6;
        assert!((counts - counts.round()).abs() < 1e-6, "not a count of a 16-bit converter at ±2.048 V");
    }
    // Through neutral and gain the head gets the same kelvin back.
    assert!((head.signal_k(0, &frame).unwrap() - (plain[TAIL] - plain[NOSE])).abs() < 0.03);
    let mut coarse =
        SimulatedSource::new(&CALM, &head, FIELD).with_flight(Flight::steady(0.0, 20.0)).with_volts_step(0.1);
    let v = volts(&frames(&mut coarse, 3, 50.0, 0.02)[0], 2);
    assert!((v * 10.0 - (v * 10.0).round()).abs() < 1e-9);
}

#[test]
fn temperatures_come_in_steps_of_the_chip_with_a_plausible_die() {
    let mut source = six(&SimulationSettings { noise_c: 0.1, ..CALM });
    for frame in frames(&mut source, 6, 50.0, 2.0) {
        for reading in &frame.readings {
            let sample = reading.unwrap();
            assert_eq!(sample.time, frame.time);
            let Value::Absolute { object_c, ambient_c: Some(ambient_c) } = sample.value else { panic!("{sample:?}") };
            assert!((16.0..30.0).contains(&ambient_c));
            for c in [object_c, ambient_c] {
                let counts = (c + 273.15) / 0.02;
                assert!((counts - counts.round()).abs() < 1e-6, "{c} °C is no reading of an MLX90614");
            }
        }
    }
}

#[test]
fn noise_has_the_strength_asked_for_in_every_sensor_by_itself() {
    let mut source = six(&SimulationSettings { noise_c: 0.2, ..CALM }).with_flight(Flight::steady(0.0, 0.0));
    let quiet = seen(0.0, 0.0);
    let all = frames(&mut source, 6, 100.0, 200.0);
    let error = |f: &Frame, i: usize| object_c(f, i) - quiet[i];
    let n = all.len() as f64;
    for i in 0..6 {
        let mean = all.iter().map(|f| error(f, i)).sum::<f64>() / n;
        let rms = (all.iter().map(|f| error(f, i).powi(2)).sum::<f64>() / n).sqrt();
        // The quiet value is rounded: up to 0.01 K.
        assert!(mean.abs() < 0.016 && (rms - 0.2).abs() < 0.005, "sensor {i}: {mean} {rms}");
        let j = (i + 1) % 6;
        let shared = all.iter().map(|f| error(f, i) * error(f, j)).sum::<f64>() / n / 0.04;
        assert!(shared.abs() < 0.03, "sensors {i} and {j} share noise: {shared}");
    }
}

#[test]
fn a_step_of_the_weather_comes_through_the_lag() {
    let tau = 0.3;
    let step = |time_s, ground_c| Weather { time_s, ground_c, sky_max_k: 40.0 };
    let mut source = six(&SimulationSettings { lag_s: tau, ..CALM })
        .with_flight(Flight::steady(0.0, 0.0))
        .with_weather(vec![step(1.0, 0.0), step(1.0, 50.0)]);
    assert!(source.health().iter().all(|h| h.settling_s == tau && h.integrity == Integrity::None));
    for (i, frame) in frames(&mut source, 6, 1000.0, 3.0).iter().enumerate() {
        // The scan at 1.000 s is the first to see the step.
        let t = (i as f64 / 1000.0 - 0.9995).max(0.0);
        let expected = 50.0 * (1.0 - (-t / tau).exp());
        assert!((object_c(frame, DOWN) - expected).abs() < 0.02, "{t} s: {}", object_c(frame, DOWN));
    }
}

#[test]
fn the_lag_does_not_depend_on_the_rate() {
    let roll = vec![
        Waypoint { time_s: 0.5, roll_deg: 0.0, pitch_deg: 0.0 },
        Waypoint { time_s: 2.5, roll_deg: 60.0, pitch_deg: 0.0 },
    ];
    let run = |rate_hz| {
        let mut source = six(&SimulationSettings { lag_s: 0.2, ..CALM }).with_flight(Flight::scripted(roll.clone()));
        frames(&mut source, 6, rate_hz, 3.0)
    };
    let (slow, fast) = (run(50.0), run(500.0));
    for (i, frame) in slow.iter().enumerate() {
        for sensor in 0..6 {
            let difference = object_c(frame, sensor) - object_c(&fast[i * 10], sensor);
            assert!(difference.abs() < 0.045, "sensor {sensor} at {} s: {difference}", i as f64 / 50.0);
        }
    }
}

#[test]
fn the_same_seed_gives_the_same_bytes_whenever_it_is_started() {
    let settings = SimulationSettings { sky: SkyName::Durham, noise_c: 0.1, lag_s: 0.1, seed: 42, ..CALM };
    let bytes = |settings: &SimulationSettings| format!("{:?}", frames(&mut six(settings), 6, 50.0, 20.0));
    assert_eq!(bytes(&settings), bytes(&settings));
    assert_ne!(bytes(&settings), bytes(&SimulationSettings { seed: 43, ..settings.clone() }));
    // The flight begins with the first scan.
    let (mut a, mut b) = (six(&settings), six(&settings));
    let (mut fa, mut fb) = (Frame::new(6), Frame::new(6));
    for i in 0..200 {
        a.scan(Time::from_nanos(i * 20_000_000), &mut fa);
        b.scan(Time::from_nanos(7_000_000_000 + i * 20_000_000), &mut fb);
        let values = |f: &Frame| f.readings.iter().map(|r| r.unwrap().value).collect::<Vec<_>>();
        assert_eq!(values(&fa), values(&fb));
    }
    let origin = Time::from_secs_f64(50.0);
    let fixed = six(&settings).with_origin(origin);
    assert_eq!(fixed.truth_at(Time::from_secs_f64(60.0)), Flight::demo(42).attitude(10.0));
}

#[test]
fn an_outage_takes_out_one_sensor_and_changes_no_other() {
    let settings = SimulationSettings { noise_c: 0.1, lag_s: 0.1, ..CALM };
    let outage = |sensor, from_s, to_s, reason| Outage { sensor, from_s, to_s, reason };
    let outages = vec![outage(LEFT, 1.0, 2.0, Missing::BadPec), outage(UP, 1.5, 1.7, Missing::BusGone)];
    let mut head = Head::six();
    head.buses = vec!["/dev/i2c-1".into(), "/dev/i2c-2".into()];
    for (i, s) in head.sensors.iter_mut().enumerate() {
        s.bus = Some(usize::from(i == UP));
    }
    let mut whole = SimulatedSource::new(&settings, &head, FIELD);
    let mut hurt = SimulatedSource::new(&settings, &head, FIELD).with_outages(outages);
    let (mut a, mut b) = (Frame::new(6), Frame::new(6));
    for tick in 0..150_u64 {
        let time = Time::from_nanos(tick * 20_000_000);
        whole.scan(time, &mut a);
        hurt.scan(time, &mut b);
        for i in 0..6 {
            let expected = match i {
                LEFT if (50..100).contains(&tick) => Err(Missing::BadPec),
                UP if (75..85).contains(&tick) => Err(Missing::BusGone),
                _ => a.readings[i],
            };
            assert_eq!(b.readings[i], expected, "sensor {i} at tick {tick}");
        }
        let bus = (75..85).contains(&tick).then_some(Missing::BusGone);
        assert_eq!(hurt.buses_down(), [None, bus], "tick {tick}");
    }
    let counters = hurt.health()[LEFT].counters;
    assert_eq!((counters.reads, counters.bad_pec), (100, 50));
}

#[test]
fn a_cloud_arrives_and_hail_falls() {
    let head = Head::six();
    let w = |time_s, ground_c, sky_max_k| Weather { time_s, ground_c, sky_max_k };
    let mut source = six(&CALM).with_flight(Flight::steady(0.0, 0.0)).with_weather(vec![
        w(10.0, 16.0, 40.0),
        w(11.5, 16.0, 10.0),
        w(20.0, 3.0, 5.0),
        w(25.0, -4.0, -2.0),
    ]);
    let all = frames(&mut source, 6, 10.0, 30.0);
    let contrast = |t: f64| head.signal_k(2, &all[(t * 10.0) as usize]).unwrap();
    assert!((contrast(5.0) - 35.4).abs() < 0.05);
    assert!((contrast(11.5) - 35.4 / 4.0).abs() < 0.05);
    assert!((contrast(20.0) - 35.4 / 8.0).abs() < 0.05);
    assert!((contrast(29.0) + 35.4 / 20.0).abs() < 0.05);
    assert!(near(object_c(&all[290], DOWN), -4.0));
    assert_eq!(source.weather_at(Time::from_secs_f64(129.0)).sky_max_k, -2.0);
}

#[test]
fn other_skies_and_radiance() {
    let grey = Sky { ground_c: 20.0, sky_max_k: 45.0, shape: Shape::Grey { depth: 0.4 } };
    let head = Head::six();
    let signal = |averaging| {
        let mut source = six(&CALM).with_flight(Flight::steady(0.0, 0.0)).with_sky(grey, averaging);
        head.signal_k(2, &frames(&mut source, 6, 50.0, 0.02)[0]).unwrap()
    };
    let (t, r) = (signal(Averaging::Temperature), signal(Averaging::Radiance));
    assert!(r < t && t < 45.0 && r > 25.0, "{t} {r}");
}

#[test]
fn a_frame_of_another_size_or_a_clock_that_goes_back_is_borne() {
    let mut source = six(&SimulationSettings { lag_s: 0.1, noise_c: 0.1, ..CALM });
    for n in [0, 3, 9, 6] {
        source.scan(Time::from_secs_f64(5.0), &mut Frame::new(n));
        source.scan(Time::from_secs_f64(4.0), &mut Frame::new(n));
    }
    let mut frame = Frame::new(6);
    source.scan(Time::from_nanos(u64::MAX), &mut frame);
    assert!((0..6).all(|i| object_c(&frame, i).is_finite()));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn mirrored_attitudes_mirror_the_readings(roll in -180.0..180.0, pitch in -90.0..90.0) {
        let (plain, rolled, pitched) = (seen(roll, pitch), seen(-roll, pitch), seen(roll, -pitch));
        prop_assert!(near(plain[LEFT], rolled[RIGHT]) && near(plain[RIGHT], rolled[LEFT]));
        prop_assert!(near(plain[NOSE], rolled[NOSE]) && near(plain[UP], rolled[UP]));
        prop_assert!(near(plain[NOSE], pitched[TAIL]) && near(plain[TAIL], pitched[NOSE]));
        prop_assert!(near(plain[LEFT], pitched[LEFT]) && near(plain[DOWN], pitched[DOWN]));
    }
}
