//! `score` with a stand-in for the pipeline: whose rows count, and what is said of them.
//! `GOLDEN=write cargo test --test ctl_score` writes the expected answers anew.

use irhorizon::attitude::{Attitude, Estimate, Mode};
use irhorizon::config::Settings;
use irhorizon::ctl::kit::{Kit, Pipeline};
use irhorizon::ctl::run;
use irhorizon::frame::Frame;
use irhorizon::head::Head;
use std::fs;
use std::path::PathBuf;

const FLIGHT: &str = "tests/golden/score/flight.csv";
const OTHER: &str = "other=tests/golden/score/other.csv";

/// The full vector; nothing where a reading is missing. 5° more of roll where there is a ground speed.
fn vector(_: &Settings, head: &Head) -> Pipeline {
    let head = head.clone();
    Box::new(move |frame: &Frame, estimate: &mut Estimate| {
        let signals: Result<Vec<f64>, _> = (0..head.pairs.len()).map(|pair| head.signal_k(pair, frame)).collect();
        let Ok([x, y, z]) = signals.as_deref() else { return };
        let roll = y.atan2(*z) + if frame.aiding.ground_speed_m_s.is_some() { 5_f64.to_radians() } else { 0.0 };
        estimate.attitude = Some(Attitude { roll, pitch: (x / x.hypot(*y).hypot(*z)).asin() });
        estimate.sigma = Attitude::from_degrees(2.0, 0.5);
        estimate.time = frame.time;
        estimate.mode = Mode::Nominal;
    })
}

const KIT: Kit = Kit { pipeline: vector, ..Kit::REAL };

/// Exit code, standard output, standard error.
fn score(args: &[&str]) -> (u8, String, String) {
    let (mut out, mut err) = (Vec::new(), Vec::new());
    let code = run(["irhorizonctl", "score"].iter().chain(args), &KIT, &mut out, &mut err);
    (code, String::from_utf8(out).unwrap(), String::from_utf8(err).unwrap())
}

fn golden(name: &str, args: &[&str]) {
    let (code, out, err) = score(args);
    assert_eq!((code, err.as_str()), (0, ""));
    let path = PathBuf::from("tests/golden/score").join(name);
    if std::env::var_os("GOLDEN").is_some_and(|v| v == "write") {
        fs::write(&path, &out).unwrap();
    }
    assert_eq!(out, fs::read_to_string(&path).unwrap_or_default(), "{name}");
}

/// A file of this test alone.
fn file(name: &str, text: &str) -> String {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn a_flight_is_scored_as_it_was_before() {
    golden("plain.txt", &[FLIGHT, "--method", "inverse-sine", "--beside", OTHER]);
    golden("no-aiding.txt", &[FLIGHT, "--no-aiding", "--skip", "0", "--min-ground-speed", "8"]);
    golden("score.json", &[FLIGHT, "--format", "json", "--beside", OTHER, "--min-ground-speed", "2.5"]);
}

#[test]
fn a_method_named_twice_is_scored_once() {
    let names = ["--method", "inverse-sine", "--method", "inverse-sine"];
    let (_, out, _) = score(&[&[FLIGHT], &names[..]].concat());
    assert_eq!(out.matches("inverse-sine").count(), 1);
    let (_, all, _) = score(&[FLIGHT, "--method", "all", "--method", "inverse-sine"]);
    assert_eq!(all.matches("inverse-sine").count(), 1);
}

#[test]
fn what_cannot_be_scored_is_said_in_one_line() {
    let bare = file("bare.csv", "time_s,nose_obj_c,ref_roll_deg\n0,1,2\n");
    let later = file("later.csv", "time_s,roll_deg,pitch_deg\n9e9,1,2\n");
    for (args, words) in [
        (vec!["/nowhere.csv"], "opening the recording /nowhere.csv"),
        (vec![&bare], "bare.csv has no column ref_pitch_deg: a reference to score against is"),
        (vec![FLIGHT, "--skip", "1e6"], "none of the 120 rows of tests/golden/score/flight.csv is left to score"),
        (vec![FLIGHT, "--min-ground-speed", "99"], "rows not above 99 m/s (--min-ground-speed)"),
        (vec![FLIGHT, "--beside", "a=/nowhere.csv"], "opening the recording /nowhere.csv"),
        (vec![FLIGHT, "--beside", "a=tests/golden/score/flight.csv"], "no roll_deg column; expected the columns"),
        (vec![FLIGHT, "--beside", &format!("a={later}")], "no row of "),
    ] {
        let (code, out, err) = score(&args);
        assert_eq!((code, out.as_str(), err.lines().count()), (1, "", 1), "{args:?}: {err}");
        assert!(err.contains(words), "{args:?}: {err}");
    }
    assert_eq!(score(&[FLIGHT, "--method", "sine"]).0, 64);
}
