//! Sensors that tell of one sky, and some that do not.

use super::*;
use crate::attitude::Attitude;
use crate::estimator::vector::{cross, unit};
use crate::head::Head;
use crate::simulation::noise::Noise;
use crate::sky::FieldOfView;
use std::f64::consts::TAU;

const SKY: Scene = Scene {
    ground_c: 15.0,
    contrast_k: 35.0,
    ln_depth: -1.2,
    radiance: 0.0,
    view: [0.0; 3],
    lean: [0.0; 2],
    beneath: 0.35,
};
const NOISE_K: f64 = 0.08;
const PACE: Pace = Pace { scene_k2: 0.0225, ..Pace::USUAL };

type Readings = [Option<f64>; MAX_SENSORS];

/// The level axes of a flight that swings from side to side with its nose to the north.
fn axes(time_s: f64) -> [Vector; 3] {
    let (roll, pitch) = (25.0 * (TAU * time_s / 5.0).sin(), 8.0 * (TAU * time_s / 3.1).sin());
    let up = Attitude::from_degrees(roll, pitch).vertical();
    let north = unit(add_scaled([1.0, 0.0, 0.0], -up[0], up)).unwrap();
    [north, cross(up, north), up]
}

/// The body's rates: what is fixed in the world goes by a × ω, and a × (a × ω) of three axes is −2ω.
fn rates(time_s: f64) -> Vector {
    let h = 1e-4;
    let (now, before, after) = (axes(time_s), axes(time_s - h), axes(time_s + h));
    (0..3).fold([0.0; 3], |sum, i| {
        let slope: Vector = std::array::from_fn(|k| (after[i][k] - before[i][k]) / (2.0 * h));
        add_scaled(sum, -0.5, cross(now[i], slope))
    })
}

struct Court {
    model: Model,
    witnesses: Witnesses,
    noise: Noise,
    gyro: bool,
    scan: u32,
    pace: Pace,
    usual_k: f64,
    even: bool,
    ambient_c: [Option<f64>; MAX_SENSORS],
}

impl Court {
    fn new(head: &Head, gyro: bool) -> Self {
        let model = Model::new(head, FieldOfView::Gaussian { fwhm_deg: 90.0 });
        let witnesses = Witnesses::new(model.sensors());
        Self {
            model,
            witnesses,
            noise: Noise::new(17),
            gyro,
            scan: 0,
            pace: PACE,
            usual_k: 0.1,
            even: false,
            ambient_c: [None; MAX_SENSORS],
        }
    }

    /// Of the first `count` of six sensors.
    fn of(count: usize, gyro: bool) -> Self {
        let mut sensors = Head::six().sensors;
        sensors.truncate(count);
        Self::new(&Head::new(sensors, vec![]), gyro)
    }

    fn due_k(&self, i: usize) -> f64 {
        self.model.seen(i, &axes(f64::from(self.scan) * 0.02), &SKY).value
    }

    /// So many seconds of readings that `spoil` changes; which sensors were left out meanwhile.
    fn hear(&mut self, seconds: f64, spoil: impl Fn(&mut Readings)) -> Vec<usize> {
        let mut out = [false; MAX_SENSORS];
        for _ in 0..(seconds * 50.0).round() as u32 {
            self.scan += 1;
            let time_s = f64::from(self.scan) * 0.02;
            let mut readings = Readings::default();
            for (i, reading) in readings.iter_mut().enumerate().take(self.model.sensors()) {
                *reading = Some(self.due_k(i) + NOISE_K * self.noise.normal());
            }
            spoil(&mut readings);
            let gyro = self.gyro.then(|| rates(time_s - 0.01));
            let known = Known {
                axes: axes(time_s),
                sky: SKY,
                pace: &self.pace,
                gyro,
                proven: gyro.is_some(),
                usual_k: self.usual_k,
                even: self.even,
                noise_k: 0.085,
                lag_s: 0.0,
                ambient_c: self.ambient_c,
            };
            self.witnesses.update(&self.model, &Tuning::default(), &known, &readings, 0.02);
            for (i, out) in out.iter_mut().enumerate() {
                *out |= self.witnesses.standing(i) == Standing::LeftOut;
            }
        }
        (0..MAX_SENSORS).filter(|i| out[*i]).collect()
    }
}

/// What a sensor shows in a step, of which nobody knows its die.
fn heard(reading: f64) -> Heard {
    Heard { reading: Some(reading), ambient_c: None, dt_s: 0.05, contrast: 25.0, ground_c: 15.0, second: false }
}

/// These sensors show so much more.
fn off(which: &[usize], by_k: f64) -> impl Fn(&mut Readings) {
    let which = which.to_vec();
    move |readings| which.iter().for_each(|i| readings[*i] = readings[*i].map(|k| k + by_k))
}

#[test]
fn while_all_tell_of_one_sky_all_are_heard() {
    for gyro in [false, true] {
        let mut court = Court::of(6, gyro);
        assert_eq!(court.hear(60.0, |_| {}), [0; 0]);
        // A scene that is a little unlike: not worth a sensor.
        assert_eq!(court.hear(30.0, off(&[1], 0.5)), [0; 0]);
        assert!((0..6).all(|i| court.witnesses.standing(i) == Standing::Heard));
    }
}

#[test]
fn one_that_goes_its_own_way_is_left_out_alone_and_told_what_it_should_show() {
    for gyro in [false, true] {
        for (sensor, by_k) in [(0, 8.0), (1, -8.0), (2, 12.0), (3, -8.0), (4, 15.0), (5, -10.0)] {
            let mut court = Court::of(6, gyro);
            assert_eq!(court.hear(10.0, |_| {}), [0; 0]);
            let what = format!("sensor {sensor} by {by_k} K, gyro {gyro}");
            assert_eq!(court.hear(10.0, off(&[sensor], by_k)), [sensor], "{what}");
            let (Some(expected_k), Some(residual_k)) = court.witnesses.of(sensor) else { panic!("{what}") };
            let due_k = court.due_k(sensor);
            assert!((expected_k - due_k).abs() < 3.0, "{what}: {expected_k} K is not {due_k} K");
            assert!((residual_k - by_k).abs() < 3.0, "{what}: {residual_k} K");
            // In accord again for long: heard again, if that could be seen. What looks at the ground hardly changes.
            court.hear(20.0, |_| {});
            assert!(sensor == 5 || court.witnesses.standing(sensor) == Standing::Heard, "{what}");
        }
    }
}

/// What one sensor shows may be learnt as the strength of scenes before it surprises. Where scenes are usually weak that
/// speaks against it as before; where they have always been as strong it does not.
#[test]
fn scenes_that_have_just_become_strong_hide_no_sensor() {
    for (usual_k, out) in [(0.1, vec![2]), (2.0, vec![])] {
        let mut court = Court::of(6, true);
        court.hear(10.0, |_| {});
        (court.pace.scene_k2, court.usual_k) = (4.0, usual_k);
        court.hear(10.0, |_| {});
        assert_eq!(court.hear(8.0, off(&[2], 4.0)), out, "{usual_k} K");
    }
}

/// As much as can be counted may be against two: the one without which all others fit stays ahead, and where none is that
/// nobody is.
#[test]
fn who_is_ahead_is_seen_however_much_surprises() {
    for (others_fit, apart) in [(0.1, 100.0), (2.0, 0.0)] {
        let mut court = Court::of(6, false);
        court.hear(1.0, |_| {});
        let w = &mut court.witnesses;
        w.cases[0].others_fit = others_fit;
        (w.cases[0].surprise, w.cases[1].surprise) = (BOUNDS.1 + 200.0, BOUNDS.1 + 100.0);
        w.bound();
        assert_eq!(w.cases[0].surprise, BOUNDS.1);
        assert!((w.cases[0].surprise - w.cases[1].surprise - apart).abs() < 1e-9, "{others_fit}");
        assert!(w.cases[2..6].iter().all(|c| c.surprise >= BOUNDS.0));
    }
}

/// Walls on both sides, one of them nearer, that close ahead: four sensors show too much of what none of them is to blame for.
#[test]
fn where_many_are_as_suspect_none_is_left_out() {
    let mut court = Court::of(6, false);
    court.hear(10.0, |_| {});
    let valley = |readings: &mut Readings| {
        for (i, more_k) in [(0, 3.0), (2, 6.0), (3, 2.0), (4, 2.0)] {
            off(&[i], more_k)(readings);
        }
    };
    assert_eq!(court.hear(8.0, valley), [0; 0]);
}

/// This sensor is under a film at 24 °C, K above the mean.
fn under_a_film(i: usize) -> impl Fn(&mut Readings) {
    move |readings| readings[i] = readings[i].map(|k| 0.92 * 24.0 + 0.08 * k)
}

#[test]
fn if_the_one_on_the_other_side_was_left_out_that_shows_and_is_mended() {
    for (wet, innocent) in [(0, 1), (1, 0), (2, 3), (3, 2)] {
        let mut court = Court::of(6, false);
        court.hear(10.0, |_| {});
        let w = &mut court.witnesses;
        let all = w.without[innocent].clone();
        w.cases[innocent].standing = Standing::LeftOut;
        w.rival = w.rival_to(innocent, &court.model);
        w.swear(&court.model, all);
        court.hear(1.0, under_a_film(wet));
        let (spread, up) = (court.witnesses.spread(), axes(f64::from(court.scan) * 0.02)[2]);
        let believed = Attitude::from_vertical(court.witnesses.all.as_ref().unwrap().up());
        let truth = Attitude::from_vertical(up);
        let off = f64::hypot(believed.roll - truth.roll, believed.pitch - truth.pitch);
        assert!(off < 2.0 * f64::hypot(spread.roll, spread.pitch) + 0.1, "{wet}: {off} beside {spread:?}");
        court.hear(9.0, under_a_film(wet));
        let left_out = (0..6).filter(|i| court.witnesses.standing(*i) == Standing::LeftOut);
        assert_eq!(left_out.collect::<Vec<_>>(), [wet]);
        assert!(court.witnesses.revised().is_some() && court.witnesses.revised().is_none());
    }
}

#[test]
fn a_verdict_that_was_right_stands_and_is_soon_undoubted() {
    for (wet, gyro) in [(0, false), (1, true), (2, false), (3, true)] {
        let mut court = Court::of(6, gyro);
        court.hear(10.0, |_| {});
        assert_eq!(court.hear(30.0, under_a_film(wet)), [wet]);
        assert!(court.witnesses.revised().is_none() && court.witnesses.rival.is_none());
        assert_eq!(court.witnesses.spread(), Attitude::default());
    }
}

#[test]
fn what_is_far_off_is_not_heard_again_however_little_the_others_know_of_it() {
    for (off_k, back) in [(0.3, true), (9.0, false), (-9.0, false)] {
        let mut case = Case::default();
        case.standing = Standing::LeftOut;
        for step in 0..200 {
            let due_k = 2.0 * (0.1 * f64::from(step)).sin();
            let testimony = filter::Testimony {
                expected: [due_k; MAX_SENSORS],
                sigma_k: [4.0; MAX_SENSORS],
                ..filter::Testimony::default()
            };
            case.hear(0, &heard(due_k + off_k), &testimony);
        }
        assert_eq!(case.is_acquitted(), back, "{off_k} K");
    }
}

/// A film makes what looks at the sky warmer. What shows it colder is to blame as well, but a wall that the others see comes
/// first to mind.
#[test]
fn one_that_shows_the_sky_too_cold_is_left_out_later() {
    let steps = |due_k: f64, off_k: f64| {
        let mut case = Case::default();
        let testimony = filter::Testimony { expected: [due_k; MAX_SENSORS], ..filter::Testimony::default() };
        case.hear(0, &heard(due_k + off_k), &testimony);
        (1..20).find(|_| case.leads(true))
    };
    let (sky_c, ground_c) = (0.0, 14.0);
    let [film, colder] = [steps(sky_c, 9.0), steps(sky_c, -9.0)];
    assert!(film < colder, "{film:?} and {colder:?} steps");
    assert!(colder.is_some() && steps(ground_c, -9.0) == film && steps(ground_c, 9.0) == film);
}

#[test]
fn too_few_witnesses_convict_nobody() {
    for (count, gyro) in [(3, true), (4, true), (4, false), (5, false)] {
        let mut court = Court::of(count, gyro);
        court.hear(10.0, |_| {});
        assert_eq!(court.hear(20.0, off(&[1], 12.0)), [0; 0], "{count} sensors, gyro {gyro}");
    }
}

#[test]
fn a_sky_that_changes_for_all_is_no_sensors_matter() {
    for gyro in [false, true] {
        let mut court = Court::of(6, gyro);
        court.hear(10.0, |_| {});
        assert_eq!(court.hear(10.0, off(&[0, 1, 2, 3, 4, 5], 6.0)), [0; 0], "gyro {gyro}");
    }
}

#[test]
fn what_is_no_number_begins_anew_and_convicts_nobody() {
    for bad in [f64::NAN, f64::INFINITY, 1e308] {
        let mut court = Court::of(6, true);
        court.hear(5.0, |_| {});
        assert_eq!(court.hear(0.2, |r| r[2] = Some(bad)), [0; 0], "{bad}");
        assert_eq!(court.hear(20.0, |_| {}), [0; 0], "{bad}");
        assert!((0..6).all(|i| court.witnesses.standing(i) == Standing::Heard), "{bad}");
        // And goes on to see.
        assert_eq!(court.hear(10.0, off(&[3], 10.0)), [3], "{bad}");
    }
}

/// What grows on one sensor, 1 K a second: how much it is when none but that is not heard.
fn doubted_at_k(even: bool, gyro: bool) -> f64 {
    let mut court = Court::of(6, gyro);
    court.even = even;
    court.hear(20.0, |_| {});
    (1..=300)
        .map(|scan| f64::from(scan) * 0.02)
        .find(|k| {
            court.hear(0.02, off(&[1], *k));
            court.witnesses.standing(1) != Standing::Heard
        })
        .unwrap()
}

#[test]
fn under_an_even_sky_a_film_is_doubted_sooner_without_a_gyro() {
    let [even, uneven] = [true, false].map(|even| doubted_at_k(even, false));
    assert!(even < 0.8 * uneven, "{even} K, {uneven} K");
    // Beside one a wall must not be taken for a film.
    assert_eq!(doubted_at_k(true, true), doubted_at_k(false, true));
}

#[test]
fn without_readings_without_sensors_and_with_gaps_nothing_is_decided() {
    for count in [0, 1, 6] {
        let mut court = Court::of(count, false);
        assert_eq!(court.hear(5.0, |r| *r = Readings::default()), [0; 0]);
        let known = Known {
            axes: axes(0.0),
            sky: SKY,
            pace: &PACE,
            gyro: None,
            proven: false,
            usual_k: 0.1,
            even: false,
            noise_k: 0.085,
            lag_s: 0.0,
            ambient_c: [None; MAX_SENSORS],
        };
        for dt_s in [0.0, -1.0, 5.0, f64::NAN, f64::INFINITY] {
            court.witnesses.update(&court.model, &Tuning::default(), &known, &[Some(3.0); MAX_SENSORS], dt_s);
        }
        assert!((0..MAX_SENSORS).all(|i| court.witnesses.standing(i) == Standing::Heard));
    }
}

#[test]
fn two_that_look_apart_and_are_off_alike_convict_no_third() {
    for gyro in [false, true] {
        for pair in [[0, 1], [2, 3], [4, 5]] {
            for by_k in [8.0, -8.0] {
                let mut court = Court::of(6, gyro);
                court.hear(10.0, |_| {});
                let out = court.hear(20.0, off(&pair, by_k));
                assert!(out.iter().all(|i| pair.contains(i)), "{pair:?} by {by_k} K, gyro {gyro}: {out:?}");
            }
        }
    }
}

/// A film of 92 % on one sensor, that grows for 3 s.
fn film_on(court: &mut Court, sensor: usize, seconds: f64) -> Vec<usize> {
    let (begin, die_c) = (court.scan, court.ambient_c[sensor].unwrap());
    let mut out = Vec::new();
    for k in 1..=(seconds * 50.0) as u32 {
        let share = 0.92 * (f64::from(begin + k) - f64::from(begin)).min(150.0) / 150.0;
        let filmed = |readings: &mut Readings| {
            readings[sensor] = readings[sensor].map(|shown| shown + share * (die_c - shown));
        };
        out.extend(court.hear(0.02, filmed));
    }
    out.dedup();
    out
}

/// What looks at the ground changes little, and a film leaves it near what it was: its die tells.
#[test]
fn a_film_below_is_found_by_its_die() {
    for gyro in [false, true] {
        let mut court = Court::of(6, gyro);
        court.ambient_c = [Some(SKY.ground_c + 2.0); MAX_SENSORS];
        assert_eq!(court.hear(10.0, |_| {}), [0; 0]);
        assert_eq!(film_on(&mut court, 5, 7.0), [5], "gyro {gyro}");
    }
}

/// What is as far off elsewhere, or with a die that nobody reads, is a scene.
#[test]
fn what_is_as_far_off_without_a_film_is_a_scene() {
    for (die_c, by_k) in [(None, 2.5), (Some(SKY.ground_c + 8.0), 2.5), (Some(SKY.ground_c + 3.0), -2.5)] {
        let mut court = Court::of(6, true);
        court.ambient_c = [die_c; MAX_SENSORS];
        assert_eq!(court.hear(10.0, |_| {}), [0; 0]);
        assert_eq!(court.hear(10.0, off(&[5], by_k)), [0; 0], "{die_c:?}, {by_k} K");
    }
}

/// A film above is a cloud to who does not hear the one below, which is a little off then: not that one is to blame.
#[test]
fn what_one_does_the_others_do_not_take_upon_them() {
    for (off_k, left_out) in [([9.0, 1.5], Some(4)), ([9.0, 4.0], None)] {
        let mut court = Court::of(6, false);
        court.hear(1.0, |_| {});
        let w = &mut court.witnesses;
        for (case, (off_k, surprise)) in w.cases[4..6].iter_mut().zip(off_k.into_iter().zip([50.0, 53.0])) {
            for step in 0..100 {
                let testimony =
                    filter::Testimony { expected: [0.1 * f64::from(step); MAX_SENSORS], ..Default::default() };
                let heard = Heard { contrast: 10.0, ..heard(0.1 * f64::from(step) + off_k) };
                case.hear(0, &heard, &testimony);
            }
            case.surprise = surprise;
        }
        for _ in 0..20 {
            let surprise: [f64; 2] = [50.0, 53.0];
            let open = w.cases[4..6].iter_mut().zip(surprise).filter(|(c, _)| c.standing != Standing::LeftOut);
            open.for_each(|(case, surprise)| case.surprise = surprise);
            w.judge(&court.model, 0.25, true, false);
            if (4..6).any(|i| w.standing(i) == Standing::LeftOut) {
                break;
            }
        }
        assert_eq!((4..6).find(|i| w.standing(*i) == Standing::LeftOut), left_out, "{off_k:?}");
    }
}

/// A film that grows for half a minute is small beside what ground and contrast may do meanwhile. Beside a sky that stays as it
/// is it is not: only who does not hear it is not surprised.
#[test]
fn a_sky_that_is_as_it_was_spares_all_but_one() {
    for (sensor, opposite) in [(4, 5), (2, 3)] {
        let mut court = Court::of(6, false);
        court.ambient_c = [Some(24.0); MAX_SENSORS];
        let spared = |court: &Court| [sensor, opposite].map(|i| court.witnesses.steady.spares(&court.model, i));
        assert_eq!(court.hear(70.0, |_| {}), [0; 0]);
        assert_eq!(spared(&court), [false; 2], "nothing has changed");
        for second in 1..=35 {
            let share = 0.93 * f64::from(second) / 35.0;
            let out = court.hear(1.0, |readings| {
                readings[sensor] = readings[sensor].map(|k| k + share * (24.0 - k));
            });
            assert!(out.iter().all(|i| *i == sensor), "{out:?} after {second} s");
        }
        assert_eq!(spared(&court), [false, true]);
        assert_eq!(court.witnesses.standing(sensor), Standing::LeftOut);
        // A pause ends what is known of before.
        court.witnesses.steady.forget();
        assert_eq!(spared(&court), [false; 2]);
    }
}

/// What changes for all is no sensor's doing, however slowly.
#[test]
fn a_sky_that_changes_blames_nobody() {
    let mut court = Court::of(6, false);
    court.ambient_c = [Some(24.0); MAX_SENSORS];
    court.hear(70.0, |_| {});
    for second in 1..=35 {
        // Ground and sky come nearer to each other by half.
        let warmer = |k: Option<f64>| k.map(|k| k + 0.5 * f64::from(second) / 35.0 * (SKY.ground_c - k));
        let out = court.hear(1.0, |readings| readings.iter_mut().for_each(|r| *r = warmer(*r)));
        assert_eq!(out, [0; 0], "after {second} s");
        assert!(court.witnesses.steady.blames(&court.model).is_none());
    }
}
