//! Fog and hail over a head whose method is `field`: withheld while it lasts, right again after it.

use irhorizon::attitude::{Attitude, Estimate, Mode};
use irhorizon::config::Settings;
use irhorizon::config::settings::SimulationSettings;
use irhorizon::frame::{Frame, Sample, Value};
use irhorizon::head::Head;
use irhorizon::horizon::Horizon;
use irhorizon::simulation::{Flight, SimulatedSource, Weather};
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
