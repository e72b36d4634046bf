//! The commands on recordings with a stand-in for the pipeline, and answers kept in files.

use irhorizon::attitude::{Attitude, Estimate, Mode};
use irhorizon::config::Settings;
use irhorizon::ctl::kit::{Kit, Pipeline};
use irhorizon::frame::Frame;
use irhorizon::head::Head;
use std::fs;
use std::path::{Path, PathBuf};

/// A flight with a reference.
pub const FLIGHT: &str = "tests/golden/score/flight.csv";

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
        estimate.valid_at = estimate.time;
        estimate.mode = Mode::Nominal;
    })
}

const KIT: Kit = Kit { pipeline: vector, ..Kit::REAL };

/// Exit code, standard output, standard error of a command line.
pub fn run(args: &[&str]) -> (u8, String, String) {
    let (mut out, mut err) = (Vec::new(), Vec::new());
    let code = irhorizon::ctl::run(["irhorizonctl"].iter().chain(args), &KIT, &mut out, &mut err);
    (code, String::from_utf8(out).unwrap(), String::from_utf8(err).unwrap())
}

/// Compares a text with the file.
pub fn golden(path: impl AsRef<Path>, text: &str) {
    assert_eq!(super::golden_file::difference(path, text), None);
}

/// A file of one test alone.
pub fn file(name: &str, text: &str) -> String {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}

/// The command fails, gives nothing, and says these words in one line.
pub fn refused(args: &[&str], words: &str) {
    let (code, out, err) = run(args);
    assert_eq!((code, out.as_str(), err.lines().count()), (1, "", 1), "{args:?}: {err}");
    assert!(err.contains(words), "{args:?}: {err}");
}
