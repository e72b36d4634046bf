//! `plot`: the report's figures are those of docs/figures, a flight is drawn as it was before.
//! `UPDATE_GOLDEN=1 cargo test --test ctl_plot` draws them anew.

mod ctl_kit;
mod golden_file;

use ctl_kit::{FLIGHT, file, golden, refused, run};
use std::fs;
use std::path::PathBuf;

fn drawn(args: &[&str]) -> String {
    let (code, out, err) = run(&[&["plot"], args].concat());
    assert_eq!((code, err.as_str()), (0, ""), "{args:?}");
    out
}

#[test]
fn the_report_s_figures_are_those_in_the_documentation() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("figures");
    let said = drawn(&["report", "--output-dir", folder.to_str().unwrap()]);
    assert_eq!(said.lines().count(), 4);
    for number in 6..=9 {
        let name = format!("figure-{number}.svg");
        let svg = fs::read_to_string(folder.join(&name)).unwrap();
        assert!(svg.contains(&format!("Figure {number}. ")));
        golden(PathBuf::from("docs/figures").join(name), &svg);
    }
}

/// The places of a curve of its dashes and colour, in the panel of a figure of 560 by 364 at (70, 62).
fn curve(number: u32, dash: &str, colour: &str) -> Vec<(f64, f64)> {
    let svg = fs::read_to_string(format!("docs/figures/figure-{number}.svg")).unwrap();
    let ends = if dash.is_empty() { "\" d=\"M".to_owned() } else { format!("\" stroke-dasharray=\"{dash}\" d=\"M") };
    let line = svg.lines().find(|l| l.contains(colour) && l.contains(&ends)).unwrap();
    let path = line.split(" d=\"M").nth(1).unwrap().trim_end_matches("\"/>").replace('L', " ");
    let share = |p: &str| {
        let (x, y) = p.split_once(',').unwrap();
        ((x.parse::<f64>().unwrap() - 70.0) / 560.0, 1.0 - (y.parse::<f64>().unwrap() - 62.0) / 364.0)
    };
    path.split(' ').map(share).collect()
}

#[test]
fn the_figures_show_what_the_report_s_formulas_say() {
    // Sky = SkyMax·exp(−E/90·5.5) − (SkyMax − Ground), from −30 to 20 °C.
    for (dash, colour, ground, sky_max) in [("", "#10508f", 16.0, 40.0), ("8 4", "#c8501e", 5.0, 30.0)] {
        for (x, y) in curve(6, dash, colour) {
            let sky = sky_max * (-x * 5.5).exp() - (sky_max - ground);
            assert!((y * 50.0 - 30.0 - sky).abs() < 0.05, "{x}: {y}");
        }
    }
    // A quarter round, the pair of figure 7 gives the 38.92 K that an integral of its own gave.
    let difference = curve(7, "", "#10508f");
    let top = difference.iter().fold((0.0, 0.0), |a: (f64, f64), b| if b.1 > a.1 { *b } else { a });
    assert!((top.1 * 80.0 - 40.0 - 38.92).abs() < 0.05 && (top.0 - 0.25).abs() < 0.01, "{top:?}");
    // The sine never gives less than the angle.
    let (pair, sine) = (curve(9, "", "#10508f"), curve(9, "2 3", "#3a3a3a"));
    assert!(pair.iter().zip(&sine).all(|(p, s)| (p.1 - 0.5).abs() >= (s.1 - 0.5).abs() - 1e-3));
}

#[test]
fn a_flight_is_drawn_as_it_was_before() {
    golden("tests/golden/plot/flight.svg", &drawn(&["flight", FLIGHT, "--method", "inverse-sine"]));
    golden(
        "tests/golden/plot/residuals.svg",
        &drawn(&["residuals", FLIGHT, "--method", "inverse-sine", "--no-aiding"]),
    );
}

#[test]
fn a_part_goes_to_a_file_but_never_over_the_recording() {
    let svg = file("part.svg", "old");
    assert_eq!(drawn(&["flight", FLIGHT, "--from", "110", "--to", "120", "--output", &svg]), "");
    let part = fs::read_to_string(&svg).unwrap();
    assert!(part.contains(">112<") && !part.contains(">108<") && !part.contains(">122<"), "{part}");
    let own = file("own.csv", &fs::read_to_string(FLIGHT).unwrap());
    refused(&["plot", "flight", &own, "--output", &own], "is the recording itself");
    assert_eq!(fs::read_to_string(&own).unwrap(), fs::read_to_string(FLIGHT).unwrap());
}

#[test]
fn what_cannot_be_drawn_is_said_in_one_line() {
    let bare = file("plain.csv", "time_s,nose_obj_c\n0,1\n");
    let none = file("none.csv", "time_s,nose_obj_c\n");
    // The first attitude has no reference, and the row with a reference gives none.
    let header = "time_s,nose_obj_c,tail_obj_c,left_obj_c,right_obj_c,up_obj_c,down_obj_c,ref_roll_deg,ref_pitch_deg\n";
    let apart = file("apart.csv", &format!("{header}0.123456,0,0,0,0,-20,15,,\n0.5,0,0,0,0,,15,1,1\n"));
    for (args, words) in [
        (["flight", "/nowhere.csv"].as_slice(), "opening the recording /nowhere.csv"),
        (&["flight", &none], "is left to draw: it has no usable row"),
        (&["flight", FLIGHT, "--from", "120", "--to", "110"], "its times are 100 to 129.75 s; see --from and --to"),
        (&["residuals", &bare], "plain.csv has no column ref_roll_deg"),
        (&["residuals", FLIGHT, "--to", "50"], "is left to draw: its times are 100 to 129.75 s"),
        (&["residuals", &apart], "none of the 2 rows of "),
        (&["residuals", &apart], "has both an attitude and a reference"),
        (&["residuals", &apart, "--from", "9"], "its times are 0.12 to 0.5 s; see --from and --to"),
        (&["flight", FLIGHT, "--output", "/dev/full"], "writing /dev/full failed: No space left"),
        (&["report", "--output-dir", "/dev/null/figures"], "writing /dev/null/figures failed: Not a directory"),
    ] {
        refused(&[&["plot"], args].concat(), words);
    }
}
