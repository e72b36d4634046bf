//! Slow references as small aircraft have them: no airspeed in a wind, a slack tail, air that rises and sinks. They must
//! never pull a good attitude away, whatever else they are good for.

mod field;
mod flights;
#[path = "events/heard.rs"]
mod heard;

use field::field;
use flights::{Flown, hear, said, score};
use heard::{Way, fly};
use irhorizon::frame::{Aiding, Frame};
use irhorizon::simulation::Scenario;
use irhorizon::simulation::aircraft::Aircraft;
use irhorizon::simulation::flight::{Flight, Waypoint};
use irhorizon::simulation::instruments::Fitted;
use irhorizon::simulation::manoeuvre::Style;
use irhorizon::simulation::trajectory::Trajectory;
use std::cell::RefCell;
use std::collections::VecDeque;

const FLIGHTS: u64 = 8;

/// Without airspeed; with a heading that lags the turn and yaws about it; in air that rises and sinks by 1.2 m/s rms; all.
const WORSE: [(&str, [bool; 3]); 4] = [
    ("no airspeed", [true, false, false]),
    ("uncoordinated", [false, true, false]),
    ("updraughts", [false, false, true]),
    ("all of these", [true, true, true]),
];

/// Flies `scene` with each of [`WORSE`]; no rms beyond `rms_deg`, and within 2σ at least `percent`.
fn flown(scene: &str, rms_deg: f64, percent: f64) {
    for (what, [blind, uncoordinated, updraughts]) in WORSE {
        let updraught_m_s = if updraughts { 1.2 } else { 0.4 };
        let aircraft = Aircraft { wind_m_s: [3.0, -4.0], uncoordinated, updraught_m_s, ..Aircraft::default() };
        let fitted = Fitted { airspeed: !blind, ..Fitted::default() };
        let scenario = Scenario::named(scene).unwrap().with_aircraft(aircraft).with_instruments(Some(fitted));
        let flights = Flown::all(&scenario, FLIGHTS);
        let score = score(&flights, hear(true), || said(field(&scenario.head(), 0.1)));
        let [roll, pitch] = [score.roll_rms_deg, score.pitch_rms_deg].map(|v| v.unwrap());
        let covered = [score.roll_in_2_sigma_percent, score.pitch_in_2_sigma_percent].map(|v| v.unwrap());
        println!("{scene}, {what}: {roll:.3} / {pitch:.3}; 2 sigma {covered:.1?} %");
        assert_eq!(score.withheld_percent, Some(0.0), "{scene}, {what}");
        assert!(roll <= rms_deg && pitch <= rms_deg, "{scene}, {what}: {roll} / {pitch}");
        assert!(covered.iter().all(|c| *c >= percent), "{scene}, {what}: {covered:?}");
    }
}

/// As with the best of instruments.
#[test]
fn none_pulls_a_good_attitude_away() {
    flown("clear-dry", 0.1, 92.0);
}

/// What they tell is told more slowly.
#[test]
fn a_leaning_horizon_is_found_all_the_same() {
    flown("warm-slope", 1.3, 90.0);
}

/// Leaves out of a frame those of gyro, GPS and airspeed that are not `there`.
fn leave(frame: &mut Frame, there: [bool; 3]) {
    let all = frame.aiding;
    frame.aiding = Aiding {
        gyro_deg_s: if there[0] { all.gyro_deg_s } else { [None; 3] },
        airspeed_m_s: all.airspeed_m_s.filter(|_| there[2]),
        ..if there[1] { all } else { Aiding::default() }
    };
}

/// Under an even sky, whichever of them are heard: as good as without any, and with a gyro better.
#[test]
fn some_of_them_are_no_worse_than_none() {
    let scenario = Scenario::named("clear-dry").unwrap();
    let flights = Flown::all(&scenario, 3);
    for i in 0..9 {
        let come_and_go = i == 8;
        let there = [i & 1 != 0, i & 2 != 0, i & 4 != 0];
        let change = |frame: &mut Frame| {
            let time_s = frame.time.as_secs_f64();
            let coming = [7.0, 11.0, 17.0].map(|s| ((time_s / s) as u32).is_multiple_of(2));
            leave(frame, if come_and_go { coming } else { there });
        };
        let score = score(&flights, change, || said(field(&scenario.head(), 0.1)));
        let [roll, pitch] = [score.roll_rms_deg, score.pitch_rms_deg].map(|v| v.unwrap());
        let (p99, worst) = (score.error_p99_deg.unwrap(), score.underestimated_worst_deg.unwrap());
        println!("gyro, GPS, airspeed {there:?}, {come_and_go}: {roll:.2} / {pitch:.2} / {p99:.2}, worst {worst:.2}");
        let limits = if there[0] { [0.1, 0.35, 1.0] } else { [0.4, 1.1, 3.0] };
        assert_eq!(score.withheld_percent, Some(0.0));
        assert!(roll.max(pitch) <= limits[0] && p99 <= limits[1] && worst <= limits[2], "{there:?}: {score:?}");
    }
}

/// A receiver that says anything for three seconds, first of all and every forty seconds: no heading that leaps moves the
/// attitude, nor teaches a horizon that leans.
#[test]
fn a_course_that_leaps_is_no_lean() {
    let aircraft = Aircraft { wind_m_s: [3.0, -4.0], updraught_m_s: 0.8, ..Aircraft::default() };
    let scenario = Scenario::named("clear-dry").unwrap().with_aircraft(aircraft);
    let flights = Flown::all(&scenario, FLIGHTS);
    let change = |frame: &mut Frame| {
        let time_s = frame.time.as_secs_f64();
        if time_s % 40.0 < 3.0 {
            let any = (7919.0 * time_s).sin();
            frame.aiding.course_deg = frame.aiding.course_deg.map(|_| 180.0 * any.abs());
            frame.aiding.climb_m_s = frame.aiding.climb_m_s.map(|_| 6.0 * any);
        }
    };
    let score = score(&flights, change, || said(field(&scenario.head(), 0.1)));
    let [roll, pitch] = [score.roll_rms_deg, score.pitch_rms_deg].map(|v| v.unwrap());
    println!("{roll:.3} / {pitch:.3}, p99 {:.2}", score.error_p99_deg.unwrap());
    assert!(roll.max(pitch) <= 0.1 && score.error_p99_deg.unwrap() <= 0.35, "{score:?}");
}

/// A horizon that leans is known by GPS, which is silent then for a minute: that it leans still is no wonder when it is back.
#[test]
fn gps_that_comes_back_finds_the_lean_that_it_taught() {
    let scenario = Scenario::named("patchwork").unwrap();
    let flights = Flown::all(&scenario, 2);
    let change = |frame: &mut Frame| {
        let heard = !(90.0..150.0).contains(&frame.time.as_secs_f64());
        leave(frame, [true, heard, heard]);
    };
    let widest_deg = RefCell::new(0.0_f64);
    let watched = || {
        let mut said = said(field(&scenario.head(), 0.1));
        let widest_deg = &widest_deg;
        move |frame: &Frame| {
            let said = said(frame);
            if let Some(said) = said.filter(|_| frame.time.as_secs_f64() > 60.0) {
                let both = said.roll_sigma_deg.zip(said.pitch_sigma_deg);
                let sigma_deg = both.map_or(f64::INFINITY, |(roll, pitch)| roll.max(pitch));
                widest_deg.replace_with(|widest| widest.max(sigma_deg));
            }
            said
        }
    };
    let score = score(&flights, change, watched);
    println!("sigma up to {widest_deg:?}; {score:?}");
    assert!(*widest_deg.borrow() < 10.0, "{widest_deg:?}");
}

/// Rates that come with every second scan, every fifth, every twelfth: rougher the rarer, said so by σ, and worse than none
/// in no case.
#[test]
fn a_slow_gyro_is_no_worse_than_none() {
    let scenario = Scenario::named("clear-dry").unwrap();
    let flights = Flown::all(&scenario, 3);
    let rms = |every: u64| {
        let change =
            |frame: &mut Frame| leave(frame, [(frame.time.as_nanos() / 20_000_000).is_multiple_of(every), true, true]);
        let score = score(&flights, change, || said(field(&scenario.head(), 0.1)));
        let [roll, pitch] = [score.roll_rms_deg, score.pitch_rms_deg].map(|v| v.unwrap());
        let covered = [score.roll_in_2_sigma_percent, score.pitch_in_2_sigma_percent].map(|v| v.unwrap());
        println!("every {every}. scan: {roll:.3} / {pitch:.3}; 2 sigma {covered:.1?} %");
        assert!(covered.iter().all(|c| *c > 92.0), "every {every}. scan: {covered:?}");
        roll.max(pitch)
    };
    let none = rms(u64::MAX);
    for (every, most) in [(2, 0.2), (5, 0.6), (12, 1.05)] {
        assert!(rms(every) < most * none, "every {every}. scan");
    }
}

/// Rates that come late with nothing that says so: the attitude would be off by that, 0.3 and 0.7 degrees of roll.
#[test]
fn a_gyro_that_is_late_is_made_up_for() {
    let scenario = Scenario::named("clear-dry").unwrap();
    let flights = Flown::all(&scenario, 3);
    for (frames, most_deg) in [(2, 0.15), (5, 0.3)] {
        let waiting = RefCell::new(VecDeque::from(vec![[None; 3]; frames]));
        let change = |frame: &mut Frame| {
            let mut waiting = waiting.borrow_mut();
            waiting.push_back(frame.aiding.gyro_deg_s);
            frame.aiding.gyro_deg_s = waiting.pop_front().unwrap_or_default();
        };
        let score = score(&flights, change, || said(field(&scenario.head(), 0.1)));
        let covered = [score.roll_in_2_sigma_percent, score.pitch_in_2_sigma_percent].map(|v| v.unwrap());
        let roll_deg = score.roll_rms_deg.unwrap();
        println!("{frames} frames: roll {roll_deg:.2}; 2 sigma {covered:.1?} %");
        assert!(roll_deg < most_deg && covered.iter().all(|c| *c > 92.0), "{frames} frames: {roll_deg} {covered:?}");
    }
}

/// What a gyro says of the true rates, °/s about nose, right, down.
type Says = fn([f64; 3]) -> [f64; 3];

/// One that is wrong.
const WRONG: [(&str, Says); 5] = [
    ("dead", |_| [0.0; 3]),
    ("pitch and yaw the other way round", |[p, q, r]| [p, -q, -r]),
    ("roll the other way round", |[p, q, r]| [-p, q, r]),
    ("yaw the other way round", |[p, q, r]| [p, q, -r]),
    ("degrees taken for radians", |rates| rates.map(f64::to_degrees)),
];

/// A gyro that is wrong is found out, and is about as good as none from then on; where least is seen to turn, that takes longest.
#[test]
fn a_gyro_that_is_wrong_is_found_out() {
    for (scene, most_deg) in [("clear-dry", 0.6), ("overcast", 3.5), ("warm-slope", 2.2)] {
        let scenario = Scenario::named(scene).unwrap();
        let flights = Flown::all(&scenario, 3);
        for (what, says) in WRONG {
            let change = |frame: &mut Frame| {
                let true_deg_s = frame.aiding.gyro_deg_s.map(|r| r.unwrap_or_default());
                frame.aiding.gyro_deg_s = says(true_deg_s).map(Some);
            };
            let score = score(&flights, change, || said(field(&scenario.head(), 0.1)));
            let [roll, pitch] = [score.roll_rms_deg, score.pitch_rms_deg].map(|v| v.unwrap());
            let covered = [score.roll_in_2_sigma_percent, score.pitch_in_2_sigma_percent].map(|v| v.unwrap());
            println!("{scene}, {what}: {roll:.2} / {pitch:.2}; 2 sigma {covered:.0?} %");
            assert!(roll.max(pitch) <= most_deg, "{scene}, {what}: {roll} / {pitch}");
            assert!(covered.iter().all(|c| *c >= 90.0), "{scene}, {what}: {covered:?}");
        }
    }
}

/// What a tube says of the true airspeed, m/s.
type Tube = fn(f64) -> f64;

/// A tube that shows too little or too much, and none that counts: an airspeed that never changes. With turns all around the
/// ground speeds tell how far it is off; what they tell comes later than what a right one does.
#[test]
fn an_airspeed_that_is_off_is_set_right() {
    let aircraft = Aircraft { wind_m_s: [3.0, -4.0], ..Aircraft::default() };
    let scenario = Scenario::named("warm-slope").unwrap().with_aircraft(aircraft);
    let flights = Flown::all(&scenario, FLIGHTS);
    let tubes: [(&str, Tube); 4] =
        [("right", |v| v), ("20 % too low", |v| 0.8 * v), ("20 % too high", |v| 1.2 * v), ("always 15 m/s", |_| 15.0)];
    for (what, says) in tubes {
        let change = |frame: &mut Frame| frame.aiding.airspeed_m_s = frame.aiding.airspeed_m_s.map(says);
        let score = score(&flights, change, || said(field(&scenario.head(), 0.1)));
        let [roll, pitch] = [score.roll_rms_deg, score.pitch_rms_deg].map(|v| v.unwrap());
        let covered = [score.roll_in_2_sigma_percent, score.pitch_in_2_sigma_percent].map(|v| v.unwrap());
        println!("airspeed {what}: {roll:.2} / {pitch:.2}; 2 sigma {covered:.1?} %");
        assert!(roll.max(pitch) <= 1.0 && covered.iter().all(|c| *c > 92.0), "{what}: {score:?}");
    }
}

/// A glider's instruments without airspeed: it rises by 3.5 m/s where it circles and sinks in between.
fn in_lift(all: Aiding) -> Aiding {
    let circles = all.gyro_deg_s[2].is_some_and(|yaw| yaw.abs() > 10.0);
    let climb_m_s = all.climb_m_s.map(|climb| climb + if circles { 3.5 } else { -0.7 });
    Aiding { climb_m_s, airspeed_m_s: None, ..all }
}

/// A glider at 12 m/s climbs by 16° with its nose a little down. That was taken for a pitch that is wrong for the whole climb, and
/// with a gyro for a horizon that leans: up to 6° of roll and pitch that nobody flew, and on all the way home.
#[test]
fn a_thermal_is_no_pitch() {
    let at = |time_s, roll_deg| Waypoint { time_s, roll_deg, pitch_deg: -1.0 };
    let circles = |from_s, bank_deg| {
        [(0.0, 0.0), (3.0, bank_deg), (87.0, bank_deg), (90.0, 0.0)].map(|(s, roll_deg)| at(from_s + s, roll_deg))
    };
    let waypoints: Vec<_> = [(60.0, 30.0), (200.0, -30.0)].into_iter().flat_map(|(s, bank)| circles(s, bank)).collect();
    let (airspeed_m_s, seconds) = (12.0, 400.0);
    let glider = Aircraft { airspeed_m_s, wind_m_s: [5.0, 0.0], updraught_m_s: 0.8, ..Aircraft::default() };
    let ways: [Way; 2] = [|all| Aiding { gyro_deg_s: [None; 3], ..in_lift(all) }, in_lift];
    // The squares of the errors, °², and the standard deviations, °; their number, and how many errors are within two.
    let mut flown = [(0.0, 0.0, 0.0, 0.0); 2];
    for seed in 0..6 {
        let style = Style::Scripted(Flight::scripted(waypoints.clone()).with_turbulence(3.0, 2.0, seed));
        let trajectory = Trajectory::fly(&glider, &style, seconds + 1.0, seed);
        let source = Scenario::named("clear-dry").unwrap().lasting(1.0).source(seed).with_trajectory(trajectory);
        fly(source, (seconds, 50.0), ways, |way, now| {
            assert_eq!(now.names().next(), None, "flight {seed}, way {way}, {} s: {:?}", now.time_s, now.truth);
            let Some((said, truth)) = now.given.filter(|_| now.time_s > 20.0) else { return };
            let sigma = now.estimate.sigma;
            for (error, sigma) in [(said.roll - truth.roll, sigma.roll), (said.pitch - truth.pitch, sigma.pitch)] {
                let (squares, sigmas, count, covered) = &mut flown[way];
                *squares += error.to_degrees().powi(2);
                *sigmas += sigma.to_degrees();
                *count += 1.0;
                *covered += f64::from(u8::from(error.abs() < 2.0 * sigma));
            }
        });
    }
    for (what, most_deg, (squares, sigmas, count, covered)) in
        [("GPS", 0.5, flown[0]), ("GPS and a gyro", 0.3, flown[1])]
    {
        let (rms_deg, sigma_deg, percent) = (f64::sqrt(squares / count), sigmas / count, 100.0 * covered / count);
        println!("in lift, {what}: {rms_deg:.2}°, sigma {sigma_deg:.2}°, 2 sigma {percent:.1} %");
        assert!(
            rms_deg < most_deg && sigma_deg < 1.0 && percent > 92.0,
            "{what}: {rms_deg}°, {sigma_deg}°, {percent} %"
        );
    }
}
