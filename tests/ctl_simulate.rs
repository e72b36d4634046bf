//! `simulate`: the recordings that it makes, that `replay` takes them, and what it refuses.

use irhorizon::ctl::kit::Kit;
use irhorizon::ctl::run;
use std::path::PathBuf;

/// Exit code, standard output, standard error.
fn ctl(args: &[&str]) -> (u8, String, String) {
    let (mut out, mut err) = (Vec::new(), Vec::new());
    let code = run(["irhorizonctl"].iter().chain(args), &Kit::REAL, &mut out, &mut err);
    (code, String::from_utf8(out).unwrap(), String::from_utf8(err).unwrap())
}

fn simulate(args: &[&str]) -> (u8, String, String) {
    ctl(&[&["simulate"], args].concat())
}

fn path(name: &str) -> String {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name).to_str().unwrap().to_owned()
}

/// The column called `name` of a recording.
fn column<'a>(recording: &'a str, name: &str) -> Vec<&'a str> {
    let mut rows = recording.lines().filter(|l| !l.starts_with('#'));
    let place = rows.next().unwrap().split(',').position(|c| c == name).unwrap();
    rows.map(|r| r.split(',').nth(place).unwrap()).collect()
}

#[test]
fn a_recording_has_readings_aiding_and_truth() {
    let (code, out, err) = simulate(&["warm-side", "--seed", "7", "--seconds", "2"]);
    assert_eq!((code, err.as_str()), (0, "warm-side with seed 7: 100 frames over 2.0 s\n"));
    assert_eq!(column(&out, "time_s").last(), Some(&"1.980000"));
    for name in ["nose_obj_c", "up_amb_c", "gyro_x_deg_s", "ref_roll_deg", "ref_pitch_deg", "ref_yaw_deg"] {
        assert!(column(&out, name).iter().all(|c| c.parse::<f64>().is_ok()), "{name}");
    }
    assert_eq!(column(&out, "course_deg").iter().filter(|c| !c.is_empty()).count(), 10);
    assert_eq!(simulate(&["warm-side", "--seed", "7", "--seconds", "2"]).1, out);
    assert_ne!(simulate(&["warm-side", "--seed", "8", "--seconds", "2"]).1, out);
    assert!(!out.contains("method"));
}

#[test]
fn options_change_what_they_name() {
    let (_, out, _) = simulate(&["clear-dry", "--seconds", "1", "--rate", "100", "--no-aiding"]);
    assert_eq!(column(&out, "time_s")[1], "0.010000");
    assert_eq!(column(&out, "time_s").len(), 100);
    assert!(
        ["gyro_y_deg_s", "airspeed_m_s", "altitude_m"].iter().all(|n| column(&out, n).iter().all(|c| c.is_empty()))
    );
    for (scenario, has_a_script) in [("clear-dry", false), ("inverted", true), ("aerobatics", true)] {
        let [without, scripted] = [&[][..], &["--scripted"]].map(|more| {
            column(&simulate(&[&[scenario, "--seconds", "10"], more].concat()).1, "ref_roll_deg").join(" ")
        });
        assert_eq!(without == scripted, has_a_script, "{scenario}");
    }
}

#[test]
fn replay_takes_either_head() {
    for (head, options) in [("six", &[][..]), ("pairs", &["--differential"])] {
        let file = path(&format!("simulated-{head}.csv"));
        let args = [&["namibia", "--seconds", "4", "--output", &file], options].concat();
        let (code, out, err) = simulate(&args);
        assert_eq!((code, out.as_str()), (0, ""), "{err}");
        let (code, out, err) = ctl(&["replay", &file]);
        assert_eq!((code, err.as_str()), (0, "200 frames over 4.0 s, nominal 100.0 %\n"), "{head}");
        let truth = std::fs::read_to_string(&file).unwrap();
        let [got, truth] = [column(&out, "roll_deg"), column(&truth, "ref_roll_deg")]
            .map(|c| c.last().unwrap().parse::<f64>().unwrap());
        assert!((got - truth).abs() < 6.0, "{head}: {got} {truth}");
    }
}

#[test]
fn the_list_names_every_scenario() {
    let (code, out, _) = simulate(&["--list"]);
    assert_eq!(code, 0);
    assert_eq!(out.lines().next(), Some("clear-dry        a dry grey atmosphere, contrast 40 K"));
    for line in out.lines().take_while(|l| !l.is_empty()) {
        let name = line.split(' ').next().unwrap();
        assert_eq!(simulate(&[name, "--seconds", "0.02"]).0, 0, "{name}");
    }
}

#[test]
fn what_makes_no_sense_is_refused_with_the_next_step() {
    let (code, _, err) = simulate(&["cumulonimbus"]);
    assert_eq!(code, 64);
    assert!(err.contains("possible values: clear-dry") && err.contains("cumulus"), "{err}");
    assert_eq!(simulate(&[]).0, 64);
    for bad in
        [&["--seconds", "0"][..], &["--seconds", "1e9"], &["--rate", "nan"], &["--rate", "500"], &["--seed", "x"]]
    {
        assert_eq!(simulate(&[&["ridge"], bad].concat()).0, 64, "{bad:?}");
    }
    let (code, _, err) = simulate(&["ridge", "--seconds", "9", "--output", "/dev/full"]);
    assert_eq!(code, 1);
    assert!(err.contains("writing /dev/full failed: No space left"), "{err}");
    assert_eq!(simulate(&["ridge", "--output", "/nowhere/a.csv"]).0, 1);
}

#[test]
fn faults_go_wrong_in_either_head_and_no_other_column_changes() {
    let plain = simulate(&["clear-dry", "--seconds", "6"]).1;
    let args = ["clear-dry", "--seconds", "6", "--fault", "off:nose@1..2", "--fault", "wrong=30:left@2..4"];
    let (code, hurt, err) = simulate(&args);
    assert_eq!((code, err.as_str()), (0, "clear-dry with seed 1: 300 frames over 6.0 s\n"));
    assert_eq!(simulate(&args).1, hurt);
    let (header, other) = [&plain, &hurt].map(|r| r.lines().find(|l| !l.starts_with('#')).unwrap()).into();
    assert_eq!(header, other);
    for name in header.split(',') {
        let (a, b) = (column(&plain, name), column(&hurt, name));
        let differ: Vec<usize> = (0..300).filter(|i| a[*i] != b[*i]).collect();
        let expected: Vec<usize> = match name {
            "nose_obj_c" | "nose_amb_c" => (50..100).collect(),
            "left_obj_c" => (100..200).collect(),
            _ => Vec::new(),
        };
        assert_eq!(differ, expected, "{name}");
    }
    assert!(column(&hurt, "nose_obj_c")[50..100].iter().all(|c| c.is_empty()));
    let (code, pairs, _) = simulate(&[
        "clear-dry",
        "--seconds",
        "6",
        "--differential",
        "--fault",
        "ridge=60:left@0..",
        "--fault=wet:long@1..",
    ]);
    assert_eq!(code, 0);
    let long = |i: usize| column(&pairs, "long_v")[i].parse::<f64>().unwrap().abs();
    assert!(long(299) < 0.1, "{}", long(299));
}

#[test]
fn a_fault_that_cannot_be_is_a_wrong_command_line() {
    for (fault, more, told) in [
        ("wet:nose", &[][..], "does not say when"),
        ("wte:nose@1..", &[], "did you mean wet?"),
        ("wet:nsoe@1..", &[], "there is no sensor nsoe; did you mean nose?"),
        ("wet:nose@1..", &["--differential"], "there is no sensor nose; there are long, lat, vert"),
        ("wet:nose@1000..2000", &["--seconds", "3"], "begins when the flight of 3 s is over"),
    ] {
        let (code, out, err) = simulate(&[&["clear-dry", "--fault", fault], more].concat());
        assert_eq!((code, out.as_str()), (64, ""), "{fault}");
        assert!(err.contains(told), "{fault}: {err}");
    }
    let list = simulate(&["--list"]).1;
    let kinds: Vec<&str> = list.lines().skip_while(|l| !l.is_empty()).skip(3).collect();
    assert_eq!(kinds.len(), 14);
    for kind in kinds {
        let text = kind.split(' ').next().unwrap().replace("SENSOR", "nose").replace("SIDE", "left") + "@0..";
        assert_eq!(simulate(&["clear-dry", "--seconds", "0.1", "--fault", &text]).0, 0, "{text}");
    }
}
