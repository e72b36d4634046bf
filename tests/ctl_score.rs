//! `score` with a stand-in for the pipeline: whose rows count, and what is said of them.
//! `UPDATE_GOLDEN=1 cargo test --test ctl_score` writes the expected answers anew.

mod ctl_kit;
mod golden_file;

use ctl_kit::{FLIGHT, file, golden, refused, run};

const OTHER: &str = "other=tests/golden/score/other.csv";

fn scored(name: &str, args: &[&str]) {
    let (code, out, err) = run(&[&["score", FLIGHT], args].concat());
    assert_eq!((code, err.as_str()), (0, ""));
    golden(format!("tests/golden/score/{name}"), &out);
}

#[test]
fn a_flight_is_scored_as_it_was_before() {
    scored("plain.txt", &["--method", "inverse-sine", "--beside", OTHER]);
    scored("no-aiding.txt", &["--method", "inverse-sine", "--no-aiding", "--skip", "0", "--min-ground-speed", "8"]);
    scored(
        "score.json",
        &["--method", "inverse-sine", "--format", "json", "--beside", OTHER, "--min-ground-speed", "2.5"],
    );
}

#[test]
fn a_method_named_twice_is_scored_once() {
    let twice = ["score", FLIGHT, "--method", "inverse-sine", "--method", "inverse-sine"];
    assert_eq!(run(&twice).1.matches("inverse-sine").count(), 1);
    let all = ["score", FLIGHT, "--method", "all", "--method", "inverse-sine"];
    assert_eq!(run(&all).1.matches("inverse-sine").count(), 1);
}

#[test]
fn each_score_has_a_name_of_its_own() {
    let same = OTHER.replace("other=", "inverse-sine=");
    for (beside, said) in [([OTHER, OTHER], "other"), ([OTHER, &same], "inverse-sine")] {
        let [first, second] = beside;
        let args = ["score", FLIGHT, "--method", "inverse-sine", "--beside", first, "--beside", second];
        let (code, _, err) = run(&args);
        assert!(code == 64 && err.contains(&format!("two are called {said}: give each --beside")), "{code} {err}");
    }
}

#[test]
fn kelvin_are_noticed() {
    let text = std::fs::read_to_string(FLIGHT).unwrap();
    let header = text.lines().find(|l| l.starts_with("time_s")).unwrap();
    let seen: Vec<bool> = header.split(',').map(|c| c.ends_with("_obj_c")).collect();
    let cell = |(cell, seen): (&str, &bool)| match cell.parse::<f64>() {
        Ok(c) if *seen => (c + 273.15).to_string(),
        _ => cell.to_owned(),
    };
    let row = |line: &str| line.split(',').zip(&seen).map(cell).collect::<Vec<_>>().join(",") + "\n";
    let kelvin = file("kelvin.csv", &text.lines().filter(|l| !l.starts_with('#')).map(row).collect::<String>());
    for (flight, noticed) in [(kelvin.as_str(), true), (FLIGHT, false)] {
        let (_, _, err) = run(&["score", flight]);
        assert_eq!(err.contains("are they in kelvin? Subtract 273.15"), noticed, "{flight}: {err}");
    }
}

#[test]
fn a_name_and_a_file_beside_control_no_terminal() {
    let (code, out, _) = run(&["score", FLIGHT, "--beside", &OTHER.replace("other=", "\u{1b}[2J=")]);
    assert!(code == 0 && out.contains("\u{fffd}[2J ") && !out.contains('\u{1b}'), "{out:?}");
    let bytes = file("bytes.csv", "\u{1b}[2J\0\n");
    refused(&["score", FLIGHT, "--beside", &format!("a={bytes}")], "bytes.csv:1: not text, expected a header line");
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
        refused(&[&["score"], &args[..]].concat(), words);
    }
    assert_eq!(run(&["score", FLIGHT, "--method", "sine"]).0, 64);
}
