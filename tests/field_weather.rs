//! Fog and hail over a head whose method is `field`: withheld while it lasts, right again after it.

use irhorizon::attitude::{Attitude, Estimate, Mode};
use irhorizon::config::Settings;
use irhorizon::config::settings::SimulationSettings;
use irhorizon::frame::{Aiding, Frame, Sample, Value};
use irhorizon::head::Head;
use irhorizon::horizon::Horizon;
use irhorizon::simulation::{Flight, Scenario, SimulatedSource, Weather};
use irhorizon::sky::{Averaging, FieldOfView, Response, Shape};
use irhorizon::source::FrameSource;
use irhorizon::time::Time;
use std::collections::BTreeSet;
use std::f64::consts::TAU;

/// Flies for a minute; calls `look` with the seconds flown, the estimate and the larger error, °.
fn fly(weather: &[(f64, f64, f64)], mut look: impl FnMut(f64, &Estimate, f64)) {
    let head = Head::six();
    let weather = weather.iter().map(|&(time_s, ground_c, sky_max_k)| Weather { time_s, ground_c, sky_max_k });
    let field = FieldOfView::Gaussian { fwhm_deg: 90.0 };
    let mut source = SimulatedSource::new(&SimulationSettings::default(), &head, field)
        .with_flight(Flight::demo(3))
        .with_weather(weather.collect());
    let mut horizon = Horizon::new(&Settings::default(), head);
    let (mut frame, mut estimate) = (Frame::new(6), Estimate::default());
    for i in 0..3000 {
        let now = Time::from_secs_f64(100.0 + f64::from(i) * 0.02);
        source.scan(now, &mut frame);
        horizon.update(&frame, &[], &mut estimate);
        // As of when it is said to be: suspected weather leaves the last one standing.
        let truth = source.truth_at(estimate.time);
        let off = estimate
            .attitude
            .map_or(f64::NAN, |a| (a.roll - truth.roll).abs().max((a.pitch - truth.pitch).abs()).to_degrees());
        look(f64::from(i) * 0.02, &estimate, off);
    }
}

fn names(estimate: &Estimate) -> Vec<String> {
    estimate.faults.iter().map(|f| f.kind.display(&Head::six()).to_string()).collect()
}

#[test]
fn fog_withholds_the_attitude_and_lets_it_go_again() {
    let fog = [(0.0, 15.0, 38.0), (20.0, 15.0, 38.0), (23.0, 15.0, 0.5), (40.0, 15.0, 0.5), (43.0, 15.0, 38.0)];
    fly(&fog, |s, e, off| {
        if (2.0..20.0).contains(&s) || s > 47.0 {
            assert!(e.mode == Mode::Nominal && off < 3.0, "{s} s: {off}° {e:?}");
        }
        if (24.0..40.0).contains(&s) {
            assert!(e.mode == Mode::Faulted && e.attitude.is_none(), "{s} s: {e:?}");
            assert!(names(e).contains(&"low-contrast".to_owned()), "{s} s: {e:?}");
        }
        // At no time a wrong one.
        assert!(off.is_nan() || off < 8.0, "{s} s: {off}° {e:?}");
    });
}

#[test]
fn hail_withholds_the_attitude_and_lets_it_go_again() {
    let hail = [(0.0, 15.0, 38.0), (20.0, 15.0, 38.0), (24.0, 4.0, -6.0), (40.0, 4.0, -6.0), (44.0, 15.0, 38.0)];
    fly(&hail, |s, e, off| {
        if (26.0..40.0).contains(&s) {
            assert!(e.mode == Mode::Faulted && e.attitude.is_none(), "{s} s: {e:?}");
        }
        if (30.0..40.0).contains(&s) {
            assert!(names(e).contains(&"inverted-contrast".to_owned()), "{s} s: {e:?}");
        }
        if s > 48.0 {
            assert!(e.mode == Mode::Nominal && off < 3.0, "{s} s: {off}° {e:?}");
        }
        assert!(off.is_nan() || off < 8.0, "{s} s: {off}° {e:?}");
    });
}

/// Six sensors in a flight that never stops turning, under a sky that is gone from one frame to the next, the frames before
/// it having been late: what nobody saw happen is not taken for hail.
#[test]
fn fog_that_is_there_at_once_is_fog() {
    let sky =
        Response::new(Shape::Grey { depth: 0.3 }, FieldOfView::Gaussian { fwhm_deg: 90.0 }, Averaging::Temperature);
    let swing = |most_deg: f64, period_s: f64, time_s: f64| most_deg * (TAU * time_s / period_s).sin();
    let chance = |of: f64| (of.sin() * 43_758.545_3).rem_euclid(1.0);
    let mut unlike = Vec::new();
    for begins in 0..150 {
        let (begins_s, fog_s) = (1000.0 + 1.37 * f64::from(begins), 1006.0 + 1.37 * f64::from(begins));
        let mut horizon = Horizon::new(&Settings::default(), Head::six());
        let (mut frame, mut estimate) = (Frame::new(6), Estimate::default());
        let mut told = BTreeSet::new();
        for i in 0..200 {
            let late_s = 0.035 * chance(91.17 * f64::from(i) + f64::from(begins)).powi(3);
            let time_s = begins_s + 0.04 * f64::from(i) + late_s;
            if (fog_s - 0.1..fog_s).contains(&time_s) {
                continue;
            }
            let [nose, left, up] = Attitude::from_degrees(swing(25.0, 5.0, time_s), swing(8.0, 3.1, time_s)).vertical();
            frame.time = Time::from_secs_f64(time_s);
            for (k, sine) in [nose, -nose, left, -left, up, -up].into_iter().enumerate() {
                let noise_k = 0.2 * chance(12.9898 * f64::from(i) + 78.233 * k as f64 + f64::from(begins)) - 0.1;
                let seen_c = if time_s < fog_s { sky.sensor_c(sine, 16.0, 45.0) + noise_k } else { 16.0 };
                let value = Value::Absolute { object_c: (50.0 * seen_c).round() / 50.0, ambient_c: Some(24.0) };
                frame.readings[k] = Ok(Sample { value, time: frame.time });
            }
            horizon.update(&frame, &[], &mut estimate);
            told.extend(names(&estimate));
        }
        assert!(told.contains("low-contrast"), "{begins}: {told:?}");
        if told.contains("inverted-contrast") {
            unlike.push(begins);
        }
    }
    assert!(unlike.is_empty(), "{unlike:?}");
}

/// How `field` fares in three minutes after the sky above has become another within half a minute: the share of time in which it
/// gives no attitude, and its rms error, °; without instruments, with a gyro.
fn under_another_sky(from: &str, to: &str) -> [(f64, f64); 2] {
    const BEGINS_S: f64 = 60.0;
    const LASTS_S: f64 = 30.0;
    let flights = [from, to].map(|sky| Scenario::named(sky).unwrap().lasting(BEGINS_S + LASTS_S + 180.0));
    let head = flights[0].head();
    [false, true].map(|gyro| {
        let mut sources = [flights[0].source(7), flights[1].source(7)];
        let mut horizon = Horizon::new(&Settings::default(), head.clone());
        let (mut frame, mut other, mut estimate) = (Frame::new(6), Frame::new(6), Estimate::default());
        let (mut frames, mut withheld, mut squared, mut said) = (0.0, 0.0, 0.0, 0.0);
        for i in 0..(50.0 * flights[0].seconds()) as u32 {
            let time_s = f64::from(i) * 0.02;
            let now = Time::from_secs_f64(100.0 + time_s);
            sources[0].scan(now, &mut frame);
            sources[1].scan(now, &mut other);
            let share = ((time_s - BEGINS_S) / LASTS_S).clamp(0.0, 1.0);
            for (reading, other) in frame.readings.iter_mut().zip(&other.readings) {
                let (Ok(Sample { value: Value::Absolute { object_c, .. }, .. }), Ok(other)) = (reading, other) else {
                    continue;
                };
                let Value::Absolute { object_c: becomes, .. } = other.value else { continue };
                *object_c += share * (becomes - *object_c);
            }
            frame.aiding =
                Aiding { gyro_deg_s: frame.aiding.gyro_deg_s.map(|r| r.filter(|_| gyro)), ..Aiding::default() };
            horizon.update(&frame, &[], &mut estimate);
            if share < 1.0 {
                continue;
            }
            frames += 1.0;
            said += f64::from(u8::from(names(&estimate).contains(&"obstructed".to_owned())));
            let Some(Attitude { roll, pitch }) = estimate.attitude else {
                withheld += 1.0;
                continue;
            };
            let truth = sources[0].truth_at(estimate.valid_at);
            squared += (roll - truth.roll).powi(2) + (pitch - truth.pitch).powi(2);
        }
        let rms_deg = (squared / (2.0 * (frames - withheld))).sqrt().to_degrees();
        println!("{from} to {to}, gyro {gyro}: {withheld} of {frames} withheld, {rms_deg:.2}°, obstructed {said}");
        (withheld / frames, rms_deg)
    })
}

/// What is learnt of a sky's depth in a minute is soon sure, and a sky that changed was taken for walls all around: withheld for
/// minutes, or with a sigma of 15° and banks shown larger for it.
#[test]
fn a_sky_that_changes_is_followed() {
    for (from, to) in [("clear-dry", "clear-humid"), ("clear-humid", "clear-dry"), ("clear-dry", "overcast")] {
        let [alone, gyro] = under_another_sky(from, to);
        assert!(gyro.0 == 0.0 && gyro.1 < 1.5, "{from} to {to}, with a gyro");
        assert!(alone.0 < 0.6 && alone.1 < 3.0, "{from} to {to}, without");
    }
}
