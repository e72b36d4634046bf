//! `replay` with a stand-in for the pipeline: what goes into it, and what is written of what it says.

use irhorizon::attitude::{Attitude, Estimate, Mode};
use irhorizon::config::Settings;
use irhorizon::config::settings::{
    BusAddress, DbusSettings, DeviceSettings, EstimatorSettings, FaultSettings, HeadSettings, MavlinkSettings,
    Mlx90614Settings, OnFault, PecPolicy, SensorSettings,
};
use irhorizon::ctl::kit::{DaemonError, Kit, Pipeline};
use irhorizon::ctl::run;
use irhorizon::direction::Direction;
use irhorizon::fault::{ActiveFault, Evidence, FaultKind};
use irhorizon::frame::Frame;
use irhorizon::head::Head;
use std::path::{Path, PathBuf};
use std::time::Duration;

fn settings() -> Settings {
    let (roll_trim_deg, pitch_trim_deg, learn_trim, field_of_view_deg) = (0.0, 0.0, false, 90.0);
    Settings {
        rate_hz: 50.0,
        quiet: Duration::ZERO,
        sensors: Vec::new(),
        head: HeadSettings { roll_trim_deg, pitch_trim_deg, learn_trim, field_of_view_deg, lag_s: None },
        estimator: EstimatorSettings { method: None, range_time_constant_s: 3.0, roll_limit_deg: None },
        faults: FaultSettings {
            on_fault: OnFault::Withhold,
            low_contrast_c: 3.0,
            lost_after_s: 0.5,
            back_after_s: 0.5,
            ..Settings::default().faults
        },
        mavlink: MavlinkSettings { system_id: Some(1), ..Settings::default().mavlink },
        dbus: DbusSettings { bus: Some(BusAddress::System), update_hz: 10.0 },
        simulation: None,
    }
}

/// A configuration of one sensor, whose name is not a direction's.
fn with_sensor() -> Settings {
    let device =
        Mlx90614Settings { bus: "/dev/i2c-1".into(), address: 0x5a, object: 1, pec: PecPolicy::Auto, offset_c: 0.0 };
    let device = DeviceSettings::Mlx90614(device);
    let belly = SensorSettings { name: "belly".into(), direction: Direction::DOWN, device, power: None };
    Settings { sensors: vec![belly], ..settings() }
}

/// The sine over the vertical pair as it stands; low contrast below 3 K; nothing where a reading is
/// missing; 100 added to pitch where there is an airspeed.
fn stand_in(_: &Settings, head: &Head) -> Pipeline {
    let head = head.clone();
    Box::new(move |frame: &Frame, estimate: &mut Estimate| {
        let [x, y, z] = [0, 1, 2].map(|pair| head.pairs.get(pair).and_then(|_| head.signal_k(pair, frame).ok()));
        let (Some(x), Some(y), Some(z)) = (x, y, z) else { return };
        estimate.time = frame.sample_time().unwrap();
        estimate.valid_at = estimate.time;
        estimate.contrast_k = Some(z);
        estimate.faults.clear();
        if z < 3.0 {
            estimate.attitude = None;
            estimate.mode = Mode::Faulted;
            let evidence = Evidence::Limit { value: z, limit: 3.0, unit: "K" };
            for kind in [FaultKind::LowContrast, FaultKind::SensorLost(1)] {
                estimate.faults.push(ActiveFault { kind, since: frame.time, evidence });
            }
            return;
        }
        let aided = if frame.aiding.airspeed_m_s.is_some() { 100.0 } else { 0.0 };
        let degrees = |s: f64| (s / z).asin().to_degrees();
        estimate.attitude = Some(Attitude::from_degrees(degrees(y), degrees(x) + aided));
        estimate.sigma = Attitude::from_degrees(1.0, 2.0);
        estimate.mode = Mode::Nominal;
    })
}

const KIT: Kit = Kit {
    connect: |_| Err(DaemonError::Absent("replay asks no daemon".into())),
    load_for_replay: |path| match path.to_str() {
        Some("sensor.toml") => Ok(with_sensor()),
        Some("none.toml") => Ok(settings()),
        _ => Err("bad.toml:1: unknown key".into()),
    },
    parse: |text| if text.contains("belly") { Ok(with_sensor()) } else { Err("carried:1: unknown key".into()) },
    defaults: || Ok(settings()),
    pipeline: stand_in,
    ..Kit::REAL
};

/// Exit code, standard output, standard error.
fn replay(args: &[&str]) -> (u8, String, String) {
    let (mut out, mut err) = (Vec::new(), Vec::new());
    let code = run(["irhorizonctl", "replay"].iter().chain(args), &KIT, &mut out, &mut err);
    (code, String::from_utf8(out).unwrap(), String::from_utf8(err).unwrap())
}

fn golden(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/recording").join(name)
}

/// A file of this test alone.
fn file(name: &str, text: &str) -> String {
    let dir = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let path = dir.join(name);
    std::fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn a_rough_recording_is_replayed_row_by_row() {
    let rough = golden("rough.csv");
    let (code, out, err) = replay(&[rough.to_str().unwrap()]);
    assert_eq!(code, 0, "{err}");
    let expected = golden("rough.out.csv");
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(&expected, &out).unwrap();
    }
    assert_eq!(out, std::fs::read_to_string(expected).unwrap());
    assert_eq!(
        err,
        "notice: 1 column not known and ignored: battery_v\n\
         notice: 3 of 9 rows were unusable: 1 not after the row before (line 9), \
         1 with too many or too few cells (line 6), 1 truncated (line 12); 1 cell held no usable number\n\
         6 frames over 0.1 s, nominal 83.3 %, faulted 16.7 %\n"
    );
}

#[test]
fn without_aiding_nothing_of_it_reaches_the_pipeline() {
    let rough = golden("rough.csv");
    let (_, out, _) = replay(&[rough.to_str().unwrap(), "--no-aiding"]);
    assert!(out.contains("100.000000,0.000,0.000,"), "{out}");
}

#[test]
fn the_configuration_is_the_given_one_or_the_carried_one_or_none() {
    let six = file("six.csv", "time_s,nose_obj_c,belly_obj_c\n0,1,2\n");
    let ignored = |err: &str, column: &str| err.contains(&format!("not known and ignored: {column}\n"));
    assert!(ignored(&replay(&[&six]).2, "belly_obj_c"));
    assert!(ignored(&replay(&[&six, "--config", "none.toml"]).2, "belly_obj_c"));
    assert!(ignored(&replay(&[&six, "--config", "sensor.toml"]).2, "nose_obj_c"));
    let (code, out, err) = replay(&[&six, "--config", "bad.toml"]);
    assert_eq!((code, out.as_str()), (1, ""));
    assert!(err.ends_with("irhorizonctl validate: bad.toml:1: unknown key\n"), "{err}");

    let carried = "# irhorizon 0.1.0\n# [[sensor]]\n# name = \"belly\"\ntime_s,nose_obj_c,belly_obj_c\n0,1,2\n";
    assert!(ignored(&replay(&[&file("carried.csv", carried)]).2, "nose_obj_c"));
    let spoilt = file("spoilt.csv", &carried.replace("\"belly\"", "?"));
    let (code, _, err) = replay(&[&spoilt]);
    assert_eq!(code, 0);
    assert!(err.starts_with("notice: the recording's own configuration is not used: carried:1"), "{err}");
}

#[test]
fn output_goes_to_a_file_but_never_over_the_recording() {
    let text = "time_s,nose_obj_c\n0,1\n";
    let input = file("input.csv", text);
    let output = file("output.csv", "old");
    assert_eq!(replay(&[&input, "--output", &output]).0, 0);
    assert!(std::fs::read_to_string(&output).unwrap().starts_with("time_s,roll_deg,pitch_deg,"));
    let (code, _, err) = replay(&[&input, "--output", &input]);
    assert_eq!(code, 1);
    assert!(err.contains("is the recording itself"), "{err}");
    assert_eq!(std::fs::read_to_string(&input).unwrap(), text);
    let (code, _, err) = replay(&[&input, "--output", "/dev/full"]);
    assert_eq!(code, 1);
    assert!(err.contains("writing /dev/full failed: No space left"), "{err}");
}

#[test]
fn nothing_usable_is_a_failure_and_leaves_the_output_alone() {
    let output = file("kept.csv", "old");
    for (name, rows) in [("header.csv", ""), ("nan.csv", "nan,1\nnan,2\n"), ("below.csv", "-2,1\n-1,2\n")] {
        let input = file(name, &format!("time_s,nose_obj_c\n{rows}"));
        let (code, out, err) = replay(&[&input, "--output", &output]);
        assert_eq!((code, out.as_str()), (1, ""), "{name}");
        assert!(err.ends_with(&format!("{input} has no usable row: nothing was replayed, nothing written\n")), "{err}");
        assert_eq!(std::fs::read_to_string(&output).unwrap(), "old", "{name}");
        assert_eq!(err.contains("2 with a time below 0 (first at line 2)"), name == "below.csv", "{err}");
    }
}

#[test]
fn a_time_in_another_unit_is_asked_about() {
    for (step, asked) in [(0.02, false), (1.0, false), (20.0, true), (20_000.0, true), (2e9, true)] {
        let rows: String = (1..50).map(|i| format!("{},1\n", f64::from(i) * step)).collect();
        let (_, _, err) = replay(&[&file("unit.csv", &format!("time_s,nose_obj_c\n{rows}"))]);
        assert_eq!(err.contains("is time_s in seconds?"), asked, "{step}: {err}");
    }
}

#[test]
fn nothing_in_a_recording_controls_the_terminal() {
    let evil = "\u{1b}[2J\u{1b}]0;evil\u{7}";
    for (name, text) in [
        ("no-time.csv", format!("{evil}time_s,roll\n1,2\n")),
        ("unknown.csv", format!("time_s,nose_obj_c,{evil}\n0,1,2\n")),
        ("twice.csv", format!("# [[sensor]]\n# name = \"{evil}\"\ntime_s,nose_obj_c\n0,1\n")),
    ] {
        let (_, out, err) = replay(&[&file(name, &text)]);
        assert!(!(out + &err).chars().any(|c| c.is_control() && c != '\n'), "{name}: {err:?}");
    }
}

#[test]
fn what_cannot_be_read_is_said_in_one_line() {
    for path in ["/nowhere.csv", "/", &file("empty.csv", ""), &file("volts.csv", "time_s,long_v\n")] {
        let (code, out, err) = replay(&[path]);
        assert_eq!((code, out.as_str(), err.lines().count()), (1, "", 1), "{path}: {err}");
    }
}
