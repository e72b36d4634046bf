//! Flights of another simulator, in another language and by other formulas of the same physics: what this one takes for
//! granted of sky, sensors and instruments is not taken for granted there.

use irhorizon::ctl::kit::Kit;
use std::fs;
use std::path::PathBuf;
use std::process::Command;

const SEEDS: std::ops::RangeInclusive<u64> = 1..=3;
/// Of roll and of pitch, rms; of the larger error and of rolls beyond 20° that are underestimated, 99th percentile; °.
type Figures = [f64; 4];
const NAMES: [&str; 4] = ["roll_rms_deg", "pitch_rms_deg", "error_p99_deg", "underestimated_p99_deg"];

/// A recording under `scene`.
fn fly(scene: &str, seed: u64) -> String {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("second-{scene}-{seed}.csv"));
    let file = fs::File::create(&path).unwrap();
    let script = ["tests/second_simulator/fly.py", scene, &seed.to_string()];
    let status = Command::new("python3").args(script).stdout(file).status().expect("python3: apt-get install python3");
    assert!(status.success(), "{scene}, seed {seed}");
    path.to_str().unwrap().to_owned()
}

/// What `score` says of a recording: the figures, and how many of roll's errors and of pitch's are within 2σ, %.
fn scored(recording: &str, options: &[&str]) -> (Figures, [f64; 2]) {
    let args = [&["irhorizonctl", "score", recording, "--format", "json"], options].concat();
    let (mut out, mut err) = (Vec::new(), Vec::new());
    assert_eq!(irhorizon::ctl::run(args, &Kit::REAL, &mut out, &mut err), 0, "{}", String::from_utf8_lossy(&err));
    let said: serde_json::Value = serde_json::from_slice(&out).unwrap();
    let method = &said["methods"][0];
    assert_eq!((&method["name"], method["withheld_percent"].as_f64()), (&"field".into(), Some(0.0)));
    let number = |name: &str| method[name].as_f64().unwrap();
    (NAMES.map(number), ["roll_in_2_sigma_percent", "pitch_in_2_sigma_percent"].map(number))
}

/// The root mean square over the flights of each figure, and the mean of what is within 2σ, is no worse than this: of the
/// thermopiles alone, then with all instruments.
fn holds(scene: &str, limits: [Figures; 2]) {
    let recordings: Vec<String> = SEEDS.map(|seed| fly(scene, seed)).collect();
    for (options, limits) in [&["--no-aiding"][..], &[]].into_iter().zip(limits) {
        let flights = recordings.iter().map(|recording| scored(recording, options));
        let (mut figures, mut within) = (Figures::default(), [0.0; 2]);
        for (of_one, within_one) in flights {
            figures.iter_mut().zip(of_one).for_each(|(sum, one)| *sum += one * one / recordings.len() as f64);
            within.iter_mut().zip(within_one).for_each(|(sum, one)| *sum += one / recordings.len() as f64);
        }
        let figures = figures.map(f64::sqrt);
        println!("{scene} {options:?}: {figures:.2?}; within 2 sigma {within:.0?} %");
        assert!(figures.iter().zip(limits).all(|(f, limit)| *f <= limit), "{scene} {options:?}: {figures:?}");
        assert!(within.iter().all(|w| *w >= 92.0), "{scene} {options:?}: {within:?}");
    }
}

const AIDED: Figures = [0.1, 0.1, 0.35, 0.2];

#[test]
fn clear_and_dry_seen_in_radiance() {
    holds("dry", [[0.5, 0.35, 1.3, 1.0], AIDED]);
}

#[test]
fn the_reports_sky() {
    holds("report", [[0.5, 0.35, 1.3, 1.0], AIDED]);
}

#[test]
fn overcast() {
    holds("overcast", [[1.2, 0.9, 3.5, 2.2], [0.25, 0.25, 0.7, 0.4]]);
}

#[test]
fn one_side_of_the_sky_is_warmer() {
    holds("warm-sky", [[2.6, 2.3, 4.5, 3.5], [1.2, 1.0, 3.5, 2.0]]);
}

#[test]
fn one_side_of_the_ground_is_warmer() {
    holds("warm-ground", [[3.3, 2.5, 7.5, 4.5], [1.2, 1.0, 3.6, 2.1]]);
}
