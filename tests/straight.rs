//! Straight flight, in which a warm side is always on the same side: nothing tells it from an attitude, from sensors that are
//! off, or from what turns and climb say too much.

#[path = "events/heard.rs"]
mod heard;

use heard::{Way, fly};
use irhorizon::attitude::Attitude;
use irhorizon::frame::Aiding;
use irhorizon::simulation::aircraft::Aircraft;
use irhorizon::simulation::flight::{Flight, Waypoint};
use irhorizon::simulation::manoeuvre::Style;
use irhorizon::simulation::trajectory::Trajectory;
use irhorizon::simulation::{Scenario, SimulatedSource};

/// Without instruments, with a gyro, with all.
const WAYS: [Way; 3] =
    [|_| Aiding::default(), |all| Aiding { gyro_deg_s: all.gyro_deg_s, ..Aiding::default() }, |all| all];
const SECONDS: f64 = 300.0;

/// A bank that is off the usual one by less is that, rad.
const STRAIGHT: f64 = 0.2;

/// What became of it from the twentieth second on, where it went straight on, or with the same bank.
#[derive(Clone, Copy, Debug, Default)]
struct Flown {
    count: f64,
    squared: f64,
    /// Angles within two standard deviations.
    covered: f64,
    /// Some sensor was said to be wet, lost or stuck.
    blamed: bool,
}

impl Flown {
    fn rms_deg(self) -> f64 {
        (self.squared / self.count).sqrt().to_degrees()
    }
}

/// After `turns_s` of circles straight on, in gusts.
fn source(scene: &str, turns_s: f64, seed: u64) -> SimulatedSource {
    let at = |time_s, roll_deg| Waypoint { time_s, roll_deg, pitch_deg: 2.0 };
    let mut waypoints = vec![at(0.0, 0.0)];
    if turns_s > 0.0 {
        waypoints.extend([at(3.0, 0.0), at(6.0, 30.0), at(turns_s - 3.0, 30.0), at(turns_s, 0.0)]);
    }
    let style = Style::Scripted(Flight::scripted(waypoints).with_turbulence(1.5, 0.8, seed));
    let trajectory = Trajectory::fly(&Aircraft::default(), &style, SECONDS + 1.0, seed);
    Scenario::named(scene).unwrap().lasting(1.0).source(seed).with_trajectory(trajectory)
}

/// Four flights together.
fn flown(scene: &str, turns_s: f64) -> [Flown; 3] {
    measured(&format!("{scene}, {turns_s} s of turns"), 0.0, |seed| source(scene, turns_s, seed))
}

/// Four flights of `source` together, while banked by `bank_deg`.
fn measured(what: &str, bank_deg: f64, source: impl Fn(u64) -> SimulatedSource) -> [Flown; 3] {
    let mut all = [Flown::default(); 3];
    for seed in 31..35 {
        fly(source(seed), (SECONDS, 50.0), WAYS, |way, now| {
            let straight = now.time_s > 20.0 && (now.truth.roll - bank_deg.to_radians()).abs() < STRAIGHT;
            let Some((said, truth)) = now.given.filter(|_| straight) else { return };
            let flown = &mut all[way];
            flown.blamed |= now.names().any(|name| name.contains("sensor"));
            let Attitude { roll, pitch } = now.estimate.sigma;
            for (error, sigma) in [(said.roll - truth.roll, roll), (said.pitch - truth.pitch, pitch)] {
                flown.count += 1.0;
                flown.squared += error * error;
                flown.covered += f64::from(u8::from(error.abs() < 2.0 * sigma));
            }
        });
    }
    for (way, flown) in ["nothing", "a gyro", "all"].iter().zip(&all) {
        let share = 100.0 * flown.covered / flown.count;
        println!("{what}, {way}: {:.2}°, {share:.0} %", flown.rms_deg());
    }
    all
}

/// Clouds on one side, for minutes on end, were taken for sensors that show too much, and half of the attitude went with them.
#[test]
fn among_clouds_a_gyro_makes_nothing_worse() {
    for turns_s in [0.0, 60.0] {
        let [alone, gyro, all] = flown("scattered", turns_s);
        assert!(![alone, gyro, all].iter().any(|f| f.blamed));
        assert!(gyro.rms_deg() < 1.25 * alone.rms_deg() && all.rms_deg() < 1.25 * alone.rms_deg());
    }
}

/// What the circles showed of a warm side is still there when nothing shows it any more.
#[test]
fn a_warm_side_is_remembered() {
    for scene in ["warm-sky", "warm-slope"] {
        let flown = flown(scene, 60.0);
        assert!(flown.iter().all(|f| !f.blamed && f.covered > 0.8 * f.count), "{flown:?}");
    }
}

/// What nothing has shown is held by sigma, in nineteen flights of twenty: this one is rare.
#[test]
fn a_warm_side_that_no_turn_shows_is_within_sigma() {
    for scene in ["warm-sky", "warm-slope"] {
        let flown = flown(scene, 0.0);
        assert!(flown.iter().all(|f| !f.blamed && f.covered > 0.7 * f.count), "{flown:?}");
    }
}

/// What each sensor shows too much in each flight, K: a third of what the datasheet of the MLX90614 allows.
const OFF_K: [[f64; 6]; 4] = [
    [-0.2, 0.1, -0.25, -0.15, 0.0, -0.25],
    [0.3, -0.1, -0.1, -0.3, 0.15, 0.2],
    [0.25, 0.1, 0.0, -0.25, -0.05, 0.0],
    [0.05, 0.3, 0.05, 0.0, 0.05, 0.0],
];

/// Four calm flights with these, with this bank all along.
fn off(what: &str, bank_deg: f64) -> [Flown; 3] {
    measured(what, bank_deg, |seed| {
        let off_k = OFF_K[seed as usize % 4].iter().zip(["nose", "tail", "left", "right", "up", "down"]);
        let faults = off_k.map(|(k, who)| format!("wrong={k}:{who}@0..").parse().unwrap());
        let calm = Style::Scripted(Flight::steady(bank_deg, 2.0));
        let trajectory = Trajectory::fly(&Aircraft::default(), &calm, SECONDS + 1.0, seed);
        source("clear-dry", 0.0, seed).with_trajectory(trajectory).with_faults(faults.collect())
    })
}

/// It looks like a scene that is always on the same side. The heading was learnt by that, and walked off by 80°; with it went
/// what a horizon may lean by, and up to 9° of bank that nobody flew: all instruments together were worse than none.
#[test]
fn sensors_that_are_off_make_of_no_heading_a_bank() {
    let [alone, _, all] = off("sensors that are off", 0.0);
    assert!(all.rms_deg() < 1.6 && all.covered > 0.95 * all.count, "{all:?}, without {alone:?}");
}

/// A circle shows all sides, but not what its one bank would be without these.
#[test]
fn a_circle_with_one_bank_shows_no_sensors_that_are_off() {
    for flown in off("circling, sensors that are off", 30.0) {
        assert!(flown.covered > 0.95 * flown.count, "{flown:?}");
    }
}

/// At rest any lag explains the noise, and a long one is smoothest: after minutes it was taken for seven times as long, and the
/// first turns under an overcast were off by 10°.
#[test]
fn a_long_stand_teaches_no_lag() {
    let at = |time_s, roll_deg, pitch_deg| Waypoint { time_s, roll_deg, pitch_deg };
    let stand = [at(0.0, 3.0, 10.0), at(200.0, 3.0, 10.0)];
    let turns = (0..5).flat_map(|i| {
        let (time_s, roll_deg) = (203.0 + 20.0 * f64::from(i), if i % 2 == 0 { 40.0 } else { -30.0 });
        [at(time_s, roll_deg, 3.0), at(time_s + 16.0, roll_deg, 3.0)]
    });
    let style = Style::Scripted(Flight::scripted(stand.into_iter().chain(turns).collect()));
    let trajectory = Trajectory::fly(&Aircraft::default(), &style, SECONDS + 1.0, 1);
    let source = Scenario::named("overcast").unwrap().lasting(1.0).source(1).with_trajectory(trajectory);
    let mut largest_deg = [0.0_f64; 3];
    fly(source, (SECONDS, 50.0), WAYS, |way, now| {
        if let Some((said, truth)) = now.given.filter(|_| now.time_s > 200.0) {
            let off = (said.roll - truth.roll).abs().max((said.pitch - truth.pitch).abs());
            largest_deg[way] = largest_deg[way].max(off.to_degrees());
        }
    });
    println!("overcast, after 200 s at rest, at most: {largest_deg:.1?}°");
    assert!(largest_deg[1] < 2.0 && largest_deg[2] < 2.0, "{largest_deg:?}");
}

/// Minutes of calm teach that nothing moves. Without a gyro the first quick bank was taken for noise then, up to 35° of it.
#[test]
fn the_first_bank_after_calm_is_shown() {
    let at = |time_s, roll_deg| Waypoint { time_s, roll_deg, pitch_deg: 2.0 };
    // What the sensors' lag alone hides is 3°, and 6°; a low contrast, as much again and more.
    for (scene, limits_deg) in [("clear-dry", [2.5, 5.0]), ("overcast", [8.0, 13.0])] {
        for (rate_deg_s, limit_deg) in [30.0, 60.0].into_iter().zip(limits_deg) {
            let (mut too_little_deg, steepest_deg) = (0.0_f64, 45.0);
            let banked = 150.0 + steepest_deg / rate_deg_s;
            for seed in 0..4 {
                let roll_deg = if seed % 2 == 0 { steepest_deg } else { -steepest_deg };
                let circle = [at(0.0, 0.0), at(10.0, 0.0), at(12.0, 30.0), at(30.0, 30.0), at(32.0, 0.0)];
                let bank = [at(150.0, 0.0), at(banked, roll_deg), at(160.0, roll_deg)];
                let flight =
                    Flight::scripted(circle.into_iter().chain(bank).collect()).with_turbulence(0.1, 0.05, seed);
                let trajectory = Trajectory::fly(&Aircraft::default(), &Style::Scripted(flight), 161.0, seed);
                let source = Scenario::named(scene).unwrap().lasting(1.0).source(seed).with_trajectory(trajectory);
                fly(source, (160.0, 50.0), [|_| Aiding::default()], |_, now| {
                    if let Some((said, truth)) = now.given.filter(|_| now.time_s > 150.0) {
                        let too_little = (truth.roll - said.roll) * roll_deg.signum();
                        too_little_deg = too_little_deg.max(too_little.to_degrees());
                    }
                });
            }
            println!("{scene}, after two minutes of calm {rate_deg_s}°/s: at most {too_little_deg:.1}° too little");
            assert!(too_little_deg < limit_deg, "{scene}, {rate_deg_s}°/s: {too_little_deg}°");
        }
    }
}

/// The first bank after straight flight shows the sky's shape. In one flight of 400, this one, that was taken for a wall.
#[test]
fn what_the_first_bank_shows_is_no_wall() {
    let source = Scenario::named("durham").unwrap().with_contrast(20.0).lasting(40.0).source(3360);
    fly(source, (40.0, 50.0), WAYS, |way, now| {
        let names: Vec<String> = now.names().collect();
        assert!(names.is_empty(), "{way}, {} s: {names:?}", now.time_s);
    });
}
