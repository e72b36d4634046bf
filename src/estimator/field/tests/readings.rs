//! Readings and body rates as they come: wild, by turns, seldom.

use super::super::state::{LAG, LAGGED};
use super::*;
use crate::estimator::Standing;
use crate::frame::{Missing, Value};

/// Adds to a reading of an absolute sensor.
fn add_k(frame: &mut Frame, i: usize, more_k: f64) {
    if let Ok(Sample { value: Value::Absolute { object_c, .. }, .. }) = &mut frame.readings[i] {
        *object_c += more_k;
    }
}

/// Now and then two of them in one frame.
#[test]
fn wild_readings_speak_against_no_gyro() {
    let mut noise = Noise::new(4);
    let off = worst("clear-dry", 60.0, |f, s| {
        for i in 0..6 {
            let wild = (s * 50.0).round() as usize % 100;
            if wild == 7 * i || wild == 7 * i + 50 || (wild == 99 && i < 2) {
                add_k(f, i, 8.0 * noise.normal());
            }
        }
    });
    assert!(off < 0.4, "{off}°");
}

#[test]
fn sensors_that_take_turns_are_heard() {
    let mut frames = 0_usize;
    let off = worst("clear-dry", 60.0, |f, _| {
        frames += 1;
        for i in 0..6 {
            if !(i + frames).is_multiple_of(3) {
                f.readings[i] = Err(Missing::NotReady);
            }
        }
    });
    assert!(off > 0.0 && off < 0.6, "{off}°");
}

/// One of them a tenth of a second late, while the others go on: not a bit of the attitude is another for it.
#[test]
fn a_reading_that_comes_late_is_left_out_and_nothing_begins_anew() {
    let scenario = Scenario::named("clear-dry").unwrap();
    let mut source = scenario.source(5);
    let new = || FieldEstimator::new(&scenario.head(), scenario.field(), Tuning::default());
    let (mut without, mut with) = (new(), new());
    let (mut frame, mut late) = (Frame::new(6), Frame::new(6));
    for i in 0..1500 {
        source.scan(Time::from_secs_f64(100.0 + 0.02 * f64::from(i)), &mut frame);
        if i % 50 == 20 {
            late.readings[5] = frame.readings[5];
        }
        if (20..=25).contains(&(i % 50)) {
            frame.readings[5] = Err(Missing::NotReady);
        }
        let expected = without.update(&frame).attitude;
        assert_eq!(with.update(&frame).attitude, expected, "frame {i}");
        if i % 50 == 25 {
            late.time = frame.time;
            assert_eq!(with.update(&late).attitude, None);
        }
    }
}

/// What they did from one to the next is the mean of both.
#[test]
fn body_rates_may_come_more_seldom_than_readings() {
    let mut frames = 0_usize;
    let off = worst("clear-dry", 60.0, |f, _| {
        frames += 1;
        if !frames.is_multiple_of(5) {
            f.aiding.gyro_deg_s = [None; 3];
        }
    });
    assert!(off < 1.2, "{off}°");
}

/// All of them, or the left one.
#[test]
fn readings_may_be_noisier_than_expected() {
    for (noise_k, sensors, most) in [(0.2, 0..6, 0.4), (0.5, 0..6, 0.8), (0.3, 2..3, 0.4)] {
        let mut noise = Noise::new(4);
        let off = worst("clear-dry", 120.0, |f, _| sensors.clone().for_each(|i| add_k(f, i, noise_k * noise.normal())));
        assert!(off < most, "{off}° at {noise_k} K");
    }
}

/// Where pairs' noise is told by nothing else, it is by a gyro. 0.01 V are 0.4 K.
#[test]
fn pairs_may_be_noisier_than_expected() {
    let (mut noise, scenario) = (Noise::new(4), Scenario::named("clear-dry").unwrap().lasting(120.0).differential());
    let off = worst_of(&scenario, |f, _| {
        for sample in f.readings.iter_mut().flatten() {
            if let Value::Volts(volts) = &mut sample.value {
                *volts += 0.01 * noise.normal();
            }
        }
    });
    assert!(off > 0.0 && off < 0.6, "{off}°");
}

/// One that is off by 20 K is left out; that the others see by what is no sky's, for two seconds, speaks for it, but not where
/// all are heard.
#[test]
fn what_is_left_out_is_heard_again_where_the_others_tell_of_no_sky() {
    let scenario = Scenario::named("clear-dry").unwrap();
    for (off_k, acquitted) in [(20.0, true), (0.0, false)] {
        let mut filter = after(&scenario, 3, 500, |f| {
            f.aiding = Aiding::default();
            add_k(f, 1, off_k);
        });
        let standing = if off_k > 0.0 { Standing::LeftOut } else { Standing::Heard };
        assert_eq!(filter.hearing(1).standing, standing);
        assert!((0..500).all(|_| !filter.misjudged(0.02)), "all is well");
        let doubt_deg = |depth: f64, view: f64| {
            let mut other = filter.clone();
            (other.state.x[state::DEPTH], other.state.x[state::VIEW]) = (depth, view);
            other.astray().roll.to_degrees()
        };
        // Usual, an overcast, and skies that are none.
        assert_eq!([doubt_deg(-1.2, 0.0), doubt_deg(0.3, 0.6)], [0.0; 2]);
        let none = [doubt_deg(-4.8, 0.0), doubt_deg(-1.2, -1.6)];
        assert!(if acquitted { none[0] > 45.0 && none[1] > 35.0 } else { none == [0.0; 2] }, "{none:?}");
        filter.state.x[state::VIEW] = -1.5;
        assert!((0..95).all(|_| !filter.misjudged(0.02)), "for 1.9 s");
        assert_eq!((0..10).any(|_| filter.misjudged(0.02)), acquitted);
    }
}

/// Rates that are not of their frames' time were taken for sensors of a time constant of minutes: the attitude was what the
/// rates said, whatever the readings showed, and as sure as ever.
#[test]
fn rates_that_come_too_late_make_no_sensors_that_never_follow() {
    for name in ["clear-dry", "namibia", "lag-0.3"] {
        let scenario = Scenario::named(name).unwrap();
        let (mut source, mut e) =
            (scenario.source(5), FieldEstimator::new(&scenario.head(), scenario.field(), Tuning::default()));
        let mut frame = Frame::new(6);
        let mut late = std::collections::VecDeque::new();
        let (mut least, mut most) = (0.0_f64, 0.0_f64);
        for i in 0..3000 {
            source.scan(Time::from_secs_f64(100.0 + 0.02 * f64::from(i)), &mut frame);
            late.push_back(frame.aiding.gyro_deg_s);
            frame.aiding = Aiding::default();
            if late.len() > 15 {
                frame.aiding.gyro_deg_s = late.pop_front().unwrap_or_default();
            }
            e.update(&frame);
            (least, most) = (least.min(e.state.x[LAG]), most.max(e.state.x[LAG]));
        }
        // Other bounds pull it along.
        assert!(LAGGED.0 - 0.1 < least && most < LAGGED.1 + 0.1, "{name}: {least}, {most}");
    }
}
