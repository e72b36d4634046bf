//! The commands against a fake daemon, word for word. `UPDATE_GOLDEN=1` writes the expected texts.

mod golden_file;

use irhorizon::config::settings::BusAddress;
use irhorizon::ctl::advice;
use irhorizon::ctl::kit::{Daemon, DaemonError, Kit};
use irhorizon::ctl::run;
use irhorizon::ctl::view::{Autopilot, Endpoint, Fault, Hint, Sensor, Status, Trim};
use irhorizon::ctl::watch::{Palette, Seen, draw};
use irhorizon::recording::Taps;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use std::os::fd::OwnedFd;

/// A daemon whose bus address says what it answers.
struct Fake(&'static str);

impl Daemon for Fake {
    fn status(&mut self) -> Result<Status, DaemonError> {
        Ok(scene(self.0))
    }

    fn frames(&mut self) -> Result<OwnedFd, DaemonError> {
        let taps = Taps::new("# irhorizon 0.1.0\ntime_s,nose_obj_c\n");
        let fd = taps.subscribe().map_err(|e| DaemonError::Refused(e.into()))?;
        for row in ["0.02,1.00\n", "0.04,1.02\n"] {
            taps.offer(&mut String::new(), |line| line.push_str(row));
        }
        Ok(fd)
    }

    fn reload(&mut self) -> Result<(), DaemonError> {
        Ok(())
    }
}

const SCENES: [&str; 13] = [
    "back",
    "wet",
    "held",
    "level",
    "trimmed",
    "nominal",
    "degraded",
    "faulted",
    "starting",
    "right-bank",
    "nose-up",
    "inverted",
    "pairs",
];

const KIT: Kit = Kit {
    connect: |bus| match bus {
        BusAddress::Address(a) => match SCENES.iter().find(|s| a.strip_prefix("fake:") == Some(**s)) {
            Some(scene) => Ok(Box::new(Fake(scene))),
            None => Err(DaemonError::Absent("no irhorizond on the system bus: start it".into())),
        },
        _ => Err(DaemonError::Absent("no irhorizond on the system bus: start it".into())),
    },
    load: |path| match path.to_str() {
        Some("bad.toml") => Err("bad.toml:3: unknown key rate; did you mean rate-hz?\nbad.toml:9: no name".into()),
        _ => Err("no such file".into()),
    },
    ..Kit::REAL
};

fn scene(name: &str) -> Status {
    let named = ["nose", "tail", "left", "right", "up", "down"];
    let sensors = named.iter().enumerate().map(|(i, name)| Sensor {
        name: (*name).into(),
        kind: "mlx90614".into(),
        bus: "/dev/i2c-1".into(),
        address: 0x5a + i as u8,
        direction: (*name).into(),
        state: "ok".into(),
        object_c: Some([-3.25, 11.5, 4.0, 4.62, -21.48, 15.3][i]),
        ambient_c: Some(21.5 + i as f64 / 10.0),
        integrity: "pec".into(),
        settling_s: 0.14,
        emissivity: Some(1.0),
        identity: format!("{:016x}", 0x1234_5678_9abc_def0_u64 + i as u64),
        counters: vec![("reads".into(), 180_000), ("retries".into(), i as u64), ("bad-pec".into(), 0)],
        ..Sensor::default()
    });
    let mut s = Status {
        version: "0.1.0".into(),
        method: "inverse-sine".into(),
        mode: "nominal".into(),
        roll_deg: Some(0.0),
        pitch_deg: Some(0.0),
        roll_sigma_deg: Some(0.8),
        pitch_sigma_deg: Some(0.9),
        measured: true,
        trim: Trim::default(),
        contrast_c: Some(36.78),
        hint: None,
        sample_time_usec: 3_600_000_000,
        sample_age_s: 0.0123,
        rate_hz: 50.02,
        faults: vec![],
        sensors: sensors.collect(),
        autopilot: None,
        endpoints: vec![Endpoint { address: "udpout:127.0.0.1:14550".into(), sent: 184_321, ..Endpoint::default() }],
    };
    let fault = |name: &str, for_s, evidence: &str| Fault {
        name: name.into(),
        for_s,
        evidence: evidence.into(),
        advice: advice::of(name),
    };
    let withhold = |s: &mut Status, mode: &str| {
        s.mode = mode.into();
        (s.roll_deg, s.pitch_deg, s.roll_sigma_deg, s.pitch_sigma_deg) = (None, None, None, None);
        s.measured = false;
    };
    match name {
        "nominal" => {}
        "degraded" => {
            (s.mode, s.roll_deg, s.pitch_deg) = ("degraded".into(), Some(-12.34), Some(4.2));
            s.faults = vec![fault("sensor-lost:nose", 12.04, "no answer, 602 reads in a row")];
            s.sensors[0].state = "no answer".into();
            (s.sensors[0].object_c, s.sensors[0].ambient_c) = (None, None);
            s.sensors[0].counters.push(("no-answer".into(), 602));
        }
        "back" => {
            s.mode = "degraded".into();
            s.faults = vec![fault("sensor-lost:nose", 12.04, "no answer, 602 reads in a row")];
        }
        "faulted" => {
            withhold(&mut s, "faulted");
            s.contrast_c = Some(1.24);
            s.faults = vec![
                fault("low-contrast", 605.0, "1.24 K, limit 3.00 K"),
                fault("bus-down:/dev/i2c-1", 0.4, "bus held, 20 reads in a row"),
            ];
            s.endpoints[0].failed = 3;
            s.endpoints[0].last_error = "network is unreachable".into();
        }
        "starting" => {
            withhold(&mut s, "starting");
            s.contrast_c = None;
            (s.sample_time_usec, s.sample_age_s, s.rate_hz) = (0, f64::NAN, 0.0);
            for sensor in &mut s.sensors {
                (sensor.object_c, sensor.ambient_c, sensor.state) = (None, None, "not read yet".into());
                sensor.counters.clear();
            }
        }
        "wet" => {
            s.mode = "degraded".into();
            s.faults = vec![fault("wet-sensor:left", 3.4, "71.00 %, limit 50.00 %")];
            s.hint = Some(Hint { bearing_deg: 112.4, strength_c: 6.25 });
            s.autopilot = Some(Autopilot {
                system_id: 1,
                rates_hz: 49.2,
                late_s: Some(0.0381),
                used: true,
                synced: true,
                gps_hz: 4.9,
                airspeed_hz: 5.0,
                roll_difference_deg: Some(-0.84),
                pitch_difference_deg: Some(0.25),
            });
            for (i, sensor) in s.sensors.iter_mut().enumerate() {
                sensor.residual_c = Some([0.124, -0.003, 9.5, -0.8, 0.0, 0.31][i]);
            }
        }
        "held" => {
            (s.mode, s.measured) = ("degraded".into(), false);
            (s.roll_deg, s.pitch_deg) = (Some(3.2), Some(-0.4));
            (s.roll_sigma_deg, s.pitch_sigma_deg) = (Some(42.2), Some(42.3));
            s.faults = vec![fault("low-contrast", 7.0, "0.30 K, limit 2.00 K")];
        }
        "level" => {
            (s.mode, s.measured) = ("faulted".into(), false);
            (s.roll_deg, s.pitch_deg) = (Some(3.2), Some(-0.4));
            (s.roll_sigma_deg, s.pitch_sigma_deg) = (Some(31.0), Some(31.0));
            s.faults = vec![fault("obstructed", 5.0, "25.00 °, limit 20.00 °")];
        }
        "trimmed" => {
            s.trim = Trim { roll_deg: -1.254, pitch_deg: 8.0, roll_learnt_deg: -0.004, pitch_learnt_deg: 5.5 };
        }
        "right-bank" => s.roll_deg = Some(30.0),
        "nose-up" => s.pitch_deg = Some(15.0),
        "inverted" => (s.roll_deg, s.pitch_deg) = (Some(175.0), Some(-5.0)),
        "pairs" => {
            s.sensors.truncate(3);
            for (sensor, (name, looks, v)) in
                s.sensors.iter_mut().zip([("long", "nose", 0.1), ("lat", "left", -0.0525), ("vert", "up", -1.2)])
            {
                (sensor.name, sensor.direction, sensor.kind) = (name.into(), looks.into(), "ads1115".into());
                (sensor.object_c, sensor.ambient_c, sensor.volts) = (None, None, Some(v));
                sensor.integrity = "unchecked: sensor has no PEC".into();
                sensor.settling_s = 0.0;
            }
        }
        other => panic!("no scene {other}"),
    }
    s
}

/// Exit code, standard output, standard error.
fn ctl(line: &str) -> (u8, String, String) {
    let (mut out, mut err) = (Vec::new(), Vec::new());
    let args = std::iter::once("irhorizonctl").chain(line.split_whitespace());
    let code = run(args, &KIT, &mut out, &mut err);
    (code, String::from_utf8(out).unwrap(), String::from_utf8(err).unwrap())
}

fn golden(name: &str, text: &str) {
    assert_eq!(golden_file::difference(format!("tests/golden/ctl/{name}"), text), None);
}

#[test]
fn status_in_every_format_and_mode() {
    for (mode, exit) in [("nominal", 0), ("degraded", 1), ("faulted", 2), ("starting", 2), ("wet", 1)] {
        for (format, end) in [("plain", "txt"), ("json", "json"), ("prometheus", "prom")] {
            let (code, out, err) = ctl(&format!("--bus fake:{mode} status --format {format}"));
            assert_eq!((code, err.as_str()), (exit, ""), "{mode} {format}");
            golden(&format!("status-{mode}.{end}"), &out);
        }
    }
}

#[test]
fn a_learnt_trim_is_shown_and_saved_over_nothing() {
    golden("status-level.txt", &ctl("--bus fake:level status").1);
    golden("status-trimmed.txt", &ctl("--bus fake:trimmed status").1);
    let (_, json, _) = ctl("--bus fake:trimmed status --format json");
    let value: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(value["trim"]["pitch_learnt_deg"], 5.5);
    let (code, out, err) = ctl("--bus fake:trimmed trim");
    assert_eq!((code, err.as_str()), (0, ""));
    golden("trim.toml", &out);
    let file = std::env::temp_dir().join(format!("irhorizon-trim-{}.toml", std::process::id()));
    let line = format!("--bus fake:trimmed trim --save {}", file.display());
    let (code, said, err) = ctl(&line);
    assert_eq!((code, said.as_str()), (0, ""));
    assert!(err.contains("systemctl reload irhorizond"), "{err}");
    assert_eq!(std::fs::read_to_string(&file).unwrap(), out);
    let (code, _, err) = ctl(&line);
    assert!(code == 1 && err.contains("--force"), "{err}");
    assert_eq!(ctl(&format!("{line} --force")).0, 0);
    std::fs::remove_file(file).unwrap();
    assert_eq!((ctl("trim").0, ctl("--bus fake:trimmed trim --force").0), (3, 64));
    let (code, _, err) = ctl("--bus fake:trimmed trim --save /nowhere/trim.toml");
    assert!(code == 1 && err.contains("writing /nowhere/trim.toml failed: No such file"), "{err}");
}

#[test]
fn json_has_null_where_there_is_no_number() {
    let (_, out, _) = ctl("status --bus fake:starting --format json");
    let value: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert!(value["roll_deg"].is_null() && value["sample_age_s"].is_null());
}

#[test]
fn no_daemon_is_exit_3_in_one_line() {
    for command in ["status", "sensors", "watch --once", "watch --json --once", "record -"] {
        let (code, out, err) = ctl(command);
        assert_eq!((code, out.as_str()), (3, ""), "{command}");
        assert_eq!(err, "irhorizonctl: no irhorizond on the system bus: start it\n");
    }
    let (code, out, _) = ctl("status --format prometheus");
    assert_eq!(code, 3);
    assert!(out.ends_with("irhorizon_up 0\n"));
}

#[test]
fn wrong_usage_is_exit_64_and_help_is_not() {
    for line in
        ["", "statsu", "status --format xml", "--bus nowhere status", "watch --size 80x24", "record --seconds 0"]
    {
        let (code, out, err) = ctl(line);
        assert_eq!((code, out.as_str()), (64, ""), "{line}");
        assert!(!err.is_empty());
    }
    assert_eq!(ctl("--help").0, 0);
    assert!(ctl("--version").1.starts_with("irhorizonctl "));
}

#[test]
fn sensors_as_a_table_and_as_json() {
    for scene in ["nominal", "degraded", "pairs", "wet", "back"] {
        golden(&format!("sensors-{scene}.txt"), &ctl(&format!("--bus fake:{scene} sensors")).1);
    }
    let out = ctl("--bus fake:pairs sensors --format json").1;
    let value: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert_eq!(value[1]["volts"], -0.0525);
}

#[test]
fn validate_says_each_error_on_its_line() {
    let (code, out, err) = ctl("validate bad.toml");
    assert_eq!((code, out.as_str()), (1, ""));
    assert_eq!(err.lines().count(), 2);
}

#[test]
fn record_writes_a_whole_file_and_overwrites_none() {
    let dir = std::env::temp_dir().join(format!("irhorizon-ctl-{}", std::process::id()));
    std::fs::create_dir_all(&dir).unwrap();
    let file = dir.join("flight.csv");
    let line = format!("--bus fake:nominal record {}", file.display());
    let (code, _, err) = ctl(&line);
    assert_eq!(code, 1);
    assert!(err.contains("ended the stream of frames after 2 rows"), "{err}");
    let whole = "# irhorizon 0.1.0\ntime_s,nose_obj_c\n0.02,1.00\n0.04,1.02\n";
    assert_eq!(std::fs::read_to_string(&file).unwrap(), whole);
    let (code, _, err) = ctl(&line);
    assert_eq!(code, 1);
    assert!(err.contains("--force"), "{err}");
    assert_eq!(ctl(&format!("{line} --force")).0, 1);
    assert_eq!(ctl("--bus fake:nominal record -").1, whole);
    let (_, _, err) = ctl("--bus fake:nominal record /dev/full --force");
    assert!(err.contains("writing /dev/full failed; the file ends whole after 0 rows: No space left"), "{err}");
    std::fs::remove_dir_all(dir).unwrap();
}

#[test]
fn watch_draws_what_a_pilot_knows() {
    for scene in
        ["nominal", "right-bank", "nose-up", "inverted", "faulted", "starting", "degraded", "wet", "level", "held"]
    {
        let (code, out, _) = ctl(&format!("--bus fake:{scene} watch --once --size 80x24"));
        assert_eq!(code, 0);
        golden(&format!("watch-{scene}.txt"), &out);
    }
    golden("watch-least.txt", &ctl("--bus fake:degraded watch --once --size 60x20").1);
    golden("watch-line.txt", &ctl("--bus fake:degraded watch --once --size 40x5").1);
    golden("watch-pairs.txt", &ctl("--bus fake:pairs watch --once --size 100x31").1);
    let mut buf = Buffer::empty(Rect::new(0, 0, 60, 20));
    let reason = "org.irhorizon1 is not on the bus".to_owned();
    draw(&Seen::Silent { reason, for_s: 3.0 }, Palette { colours: false }, &mut buf);
    golden("watch-silent.txt", &irhorizon::ctl::watch::text(&buf));
}

#[test]
fn no_size_and_no_state_makes_the_picture_panic() {
    let mut states = vec![Seen::Nothing, Seen::Silent { reason: "x ".repeat(400), for_s: f64::NAN }];
    for name in SCENES {
        let mut s = scene(name);
        states.push(Seen::Status(Box::new(s.clone())));
        let long = Fault { name: "f".repeat(300), for_s: f64::INFINITY, evidence: "é ".repeat(300), advice: "" };
        s.faults = vec![long; 40];
        s.sensors = vec![s.sensors[0].clone(); 40];
        (s.roll_deg, s.pitch_deg, s.mode) = (Some(1e300), Some(-1e300), "日本".repeat(50));
        (s.contrast_c, s.sample_age_s) = (Some(f64::NAN), -1.0);
        s.hint =
            Some(Hint { bearing_deg: if s.version.is_empty() { f64::NAN } else { -90.0 }, strength_c: f64::INFINITY });
        states.push(Seen::Status(Box::new(s)));
    }
    for state in &states {
        for (width, height) in [(0, 0), (1, 1), (7, 3), (60, 20), (61, 21), (80, 24), (300, 20), (60, 100)] {
            for colours in [true, false] {
                draw(state, Palette { colours }, &mut Buffer::empty(Rect::new(0, 0, width, height)));
            }
        }
    }
}

/// A place that takes nothing.
struct Refusing(std::io::ErrorKind);

impl std::io::Write for Refusing {
    fn write(&mut self, _: &[u8]) -> std::io::Result<usize> {
        Err(self.0.into())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

#[test]
fn help_that_cannot_be_printed_has_failed_and_one_that_nobody_reads_on_has_not() {
    use std::io::ErrorKind::{BrokenPipe, StorageFull};
    for (kind, expected) in [(StorageFull, 1), (BrokenPipe, 0)] {
        for line in [&["irhorizonctl", "--help"][..], &["irhorizonctl", "--version"], &["irhorizonctl", "status", "-h"]]
        {
            let mut err = Vec::new();
            assert_eq!(run(line, &KIT, &mut Refusing(kind), &mut err), expected, "{line:?}");
            assert_eq!(err.is_empty(), expected == 0, "{}", String::from_utf8_lossy(&err));
        }
    }
}
