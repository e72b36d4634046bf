//! What doctor makes of facts, word for word, and of the daemon and of a machine without one.
//! `UPDATE_GOLDEN=1` writes the expected texts.

#[path = "dbus_bus/mod.rs"]
mod dbus_bus;
mod process;

use dbus_bus::Bus;
use irhorizon::bus::{BusError, Functions, explain};
use irhorizon::config::settings::BusAddress;
use irhorizon::config::{Loaded, parse};
use irhorizon::ctl::doctor::facts::{Facts, Lateness, Line, Node, Seen, Service, Silence};
use irhorizon::ctl::doctor::{Check, Verdict, findings, report};
use irhorizon::ctl::kit::Kit;
use irhorizon::ctl::run;
use irhorizon::ctl::view::{Endpoint, Fault, Sensor, Status};
use process::{CTL, Daemon, Folder};
use proptest::prelude::*;
use std::path::Path;
use std::process::{Command, Output};

const SIX: [&str; 6] = ["nose", "tail", "left", "right", "up", "down"];

fn golden(name: &str, text: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/ctl").join(name);
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(&path, text).unwrap();
    }
    let expected = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(expected == text, "{name} differs; expected:\n{expected}\ngot:\n{text}");
}

fn loaded(text: &str) -> Loaded {
    parse(&[("irhorizon.toml".into(), text.into())]).unwrap()
}

fn six() -> String {
    let mlx = |(name, address)| {
        format!("[[sensor]]\nname = \"{name}\"\nkind = \"mlx90614\"\nbus = \"/dev/i2c-1\"\naddress = {address:#04x}\n")
    };
    SIX.iter().zip(0x5b..).map(mlx).collect()
}

/// A pair for each axis on one ADC whose ALERT/RDY is wired.
fn pairs() -> String {
    let pair = |(name, looks, input)| {
        format!(
            "[[sensor]]\nname = \"{name}\"\nkind = \"ads1115\"\nbus = \"/dev/i2c-1\"\naddress = 0x48\ninput = \
             \"{input}\"\nkelvin-per-v = 40.0\ndirection = \"{looks}\"\ndata-ready = {{ chip = \
             \"pinctrl-bcm2711\", line = 17 }}\n"
        )
    };
    [("long", "nose", "ain0"), ("lat", "left", "ain1"), ("vert", "up", "ain2")].map(pair).concat()
}

fn sensor(i: usize) -> Sensor {
    Sensor {
        name: SIX[i].into(),
        kind: "mlx90614".into(),
        bus: "/dev/i2c-1".into(),
        address: 0x5b + i as u8,
        direction: SIX[i].into(),
        state: "ok".into(),
        object_c: Some([-3.25, 11.5, 4.0, 4.62, -21.48, 15.3][i]),
        ambient_c: Some(21.5),
        integrity: "pec".into(),
        settling_s: 0.10,
        emissivity: Some(1.0),
        identity: format!("{:016x}", 0x1234_5678_9abc_def0_u64 + i as u64),
        counters: vec![("reads".into(), 180_000)],
        ..Sensor::default()
    }
}

fn pair(name: &str, volts: f64) -> Sensor {
    let integrity = "unchecked: sensor has no PEC".into();
    let (kind, bus, state) = ("ads1115".into(), "/dev/i2c-1".into(), "ok".into());
    Sensor { name: name.into(), kind, bus, address: 0x48, state, volts: Some(volts), integrity, ..Sensor::default() }
}

fn seen(sensors: Vec<Sensor>) -> Vec<Seen> {
    let system = |s: &Sensor| explain::Facts {
        buses: vec!["/dev/i2c-1".into(), "/dev/i2c-20".into()],
        device: Some(format!("1-{:04x}", s.address)),
        driver: None,
        group: Some(("i2c".into(), 0o660)),
        user: Some("pilot".into()),
    };
    sensors.into_iter().map(|sensor| Seen { system: system(&sensor), sensor }).collect()
}

fn nominal(sensors: Vec<Sensor>) -> Status {
    Status {
        version: env!("CARGO_PKG_VERSION").into(),
        method: "field".into(),
        mode: "nominal".into(),
        roll_deg: Some(1.0),
        pitch_deg: Some(2.0),
        roll_sigma_deg: Some(0.8),
        pitch_sigma_deg: Some(0.9),
        sample_time_usec: 3_600_000_000,
        sample_age_s: 0.0123,
        rate_hz: 50.02,
        sensors,
        endpoints: vec![Endpoint { address: "udpout:127.0.0.1:14550".into(), sent: 184_321, ..Endpoint::default() }],
        ..Status::default()
    }
}

fn node() -> Node {
    Node {
        path: "/dev/i2c-1".into(),
        present: true,
        allowed: true,
        group: Some(("i2c".into(), 0o660)),
        user: "pilot".into(),
        member: true,
    }
}

/// Everything as it should be.
fn well() -> Facts {
    let sensors: Vec<Sensor> = (0..6).map(sensor).collect();
    Facts {
        file: "/etc/irhorizon/irhorizon.toml".into(),
        configuration: Ok(loaded(&six())),
        asked: BusAddress::System,
        daemon: Ok(nominal(sensors.clone())),
        process: Some(812),
        policy: Some("/usr/share/dbus-1/system.d/org.irhorizon1.conf".into()),
        service: Some(Service {
            load: "loaded".into(),
            active: "active".into(),
            result: "success".into(),
            restarts: 0,
        }),
        nodes: vec![node()],
        adapters: vec![("/dev/i2c-1".into(), Ok(Functions(0x0eff_0009)))],
        sensors: seen(sensors),
        lines: vec![],
        lateness: None,
    }
}

const ABSENT: &str =
    "no irhorizond on the system bus: start it with `systemctl start irhorizond`, or give --bus session";

fn scene(name: &str) -> Facts {
    let mut f = well();
    let absent = |f: &mut Facts| {
        (f.daemon, f.process) = (Err(Silence::Absent(ABSENT.into())), None);
        f.lateness = Some(Lateness { waits: 40, mean_ms: 0.071, most_ms: 0.32 });
    };
    match name {
        "well" => {}
        // Straight after unpacking.
        "new" => {
            absent(&mut f);
            f.configuration = Err("/etc/irhorizon/irhorizon.toml: there is no such file. Copy the example \
                                   /usr/share/irhorizon/irhorizon.toml there and fit it to your sensors, or name \
                                   another file with --config"
                .into());
            (f.policy, f.lateness) = (None, None);
            f.service = Some(Service { load: "not-found".into(), active: "inactive".into(), ..Service::default() });
            (f.nodes, f.adapters, f.sensors) = (vec![], vec![], vec![]);
        }
        // Wired for the first time: nearly everything that can be wrong is.
        "wiring" => {
            absent(&mut f);
            f.service = Some(Service { load: "loaded".into(), active: "inactive".into(), ..Service::default() });
            f.adapters = vec![("/dev/i2c-1".into(), Ok(Functions(0x0c7f_0000)))];
            f.lateness = Some(Lateness { waits: 40, mean_ms: 1.4, most_ms: 6.25 });
            for x in &mut f.sensors {
                x.sensor.integrity = "unchecked: adapter has no PEC".into();
                x.sensor.counters = vec![("reads".into(), 10)];
            }
            let gone = |s: &mut Sensor, state: &str| {
                *s = Sensor { state: state.into(), object_c: None, ambient_c: None, settling_s: 0.0, ..s.clone() };
                (s.identity, s.integrity) = (String::new(), "none".into());
            };
            gone(&mut f.sensors[0].sensor, "no answer");
            gone(&mut f.sensors[1].sensor, "claimed by a kernel driver");
            f.sensors[1].system.driver = Some("mlx90614".into());
            gone(&mut f.sensors[2].sensor, "error bit set");
            f.sensors[2].sensor.settling_s = 1.33;
            f.sensors[3].sensor.emissivity = Some(0.3);
            f.sensors[4].sensor.counters.push(("out-of-range".into(), 2));
            f.sensors[5].sensor.identity = f.sensors[4].sensor.identity.clone();
            f.sensors[5].sensor.address = 0x70;
        }
        // This user may not open the bus.
        "denied" => {
            absent(&mut f);
            f.nodes = vec![Node { allowed: false, member: false, ..node() }];
            f.adapters = vec![("/dev/i2c-1".into(), Err(BusError::Denied))];
            for x in &mut f.sensors {
                let s = &mut x.sensor;
                *s =
                    Sensor { state: "permission denied".into(), identity: String::new(), settling_s: 0.0, ..s.clone() };
                (s.object_c, s.ambient_c, s.integrity) = (None, None, "none".into());
            }
        }
        // An analogue head with a daemon that has trouble.
        "degraded" => {
            f.configuration = Ok(loaded(&pairs()));
            let mut sensors = vec![pair("long", 0.1), pair("lat", -0.0525), pair("vert", 2.048)];
            sensors[0].counters = vec![("reads".into(), 9_000), ("not-ready".into(), 41)];
            sensors[1].counters = vec![("reads".into(), 9_000)];
            sensors[2].counters = vec![("reads".into(), 8_000), ("out-of-range".into(), 1_000)];
            (sensors[2].state, sensors[2].volts) = ("saturated".into(), None);
            let mut status = nominal(sensors.clone());
            (status.mode, status.rate_hz) = ("faulted".into(), 31.4);
            status.faults = vec![Fault {
                name: "sensor-saturated:vert".into(),
                for_s: 3.0,
                evidence: "saturated, 150 reads in a row".into(),
                advice: irhorizon::ctl::advice::of("sensor-saturated"),
            }];
            status.endpoints[0].last_error = "connection refused".into();
            status.endpoints.push(Endpoint { address: "udpin:127.0.0.1:14551".into(), ..Endpoint::default() });
            (f.daemon, f.sensors) = (Ok(status), seen(sensors));
            f.service.as_mut().unwrap().restarts = 3;
            let settings = |line| irhorizon::config::settings::LineSettings {
                chip: "pinctrl-bcm2711".into(),
                line,
                active_low: false,
            };
            f.lines = vec![
                Line {
                    purpose: "data-ready of long".into(),
                    settings: settings(17),
                    used_by: Ok(Some("irhorizon".into())),
                },
                Line { purpose: "lamp".into(), settings: settings(27), used_by: Ok(Some("fan0".into())) },
            ];
        }
        "simulated" => {
            f.configuration = Ok(loaded("[simulation]\nenabled = true\n[dbus]\nbus = \"session\"\n"));
            let simulated = |s: Sensor| Sensor { kind: "simulated".into(), bus: String::new(), address: 0, ..s };
            f.daemon = Ok(nominal((0..6).map(sensor).map(simulated).collect()));
            (f.asked, f.service, f.policy) = (BusAddress::Session, None, None);
            (f.nodes, f.adapters, f.sensors) = (vec![], vec![], vec![]);
        }
        // It runs, but not where it is asked.
        "elsewhere" => {
            absent(&mut f);
            f.process = Some(812);
            f.configuration = Ok(loaded(&format!("[dbus]\nbus = \"session\"\n{}", six())));
            (f.nodes, f.adapters, f.sensors, f.policy) = (vec![], vec![], vec![], None);
        }
        other => panic!("no scene {other}"),
    }
    f
}

const SCENES: [&str; 7] = ["well", "new", "wiring", "denied", "degraded", "simulated", "elsewhere"];

#[test]
fn findings_word_for_word() {
    for name in SCENES {
        golden(&format!("doctor-{name}.txt"), &report::plain(&findings(&scene(name))));
    }
    for name in ["well", "degraded"] {
        let json = report::json(&findings(&scene(name))).unwrap();
        golden(&format!("doctor-{name}.json"), &json);
        let value: serde_json::Value = serde_json::from_str(&json).unwrap();
        assert_eq!(value["failures"].as_u64().unwrap() > 0, name != "well");
    }
}

#[test]
fn a_well_installation_has_nothing_to_be_done() {
    let found = findings(&well());
    assert!(found.iter().all(|f| matches!(f.verdict, Verdict::Ok | Verdict::Skipped)), "{found:?}");
}

#[test]
fn every_check_is_made_in_some_scene_and_is_explained() {
    let page = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/troubleshooting.md")).unwrap();
    let told: Vec<Check> = SCENES.iter().flat_map(|s| findings(&scene(s))).map(|f| f.check).collect();
    for check in Check::ALL {
        assert!(told.contains(&check), "{}", check.as_str());
        assert_eq!(serde_json::to_value(check).unwrap(), check.as_str());
        assert!(
            page.contains(&format!("\n## {}\n", check.as_str())),
            "docs/troubleshooting.md lacks {}",
            check.as_str()
        );
    }
    assert_eq!(page.matches("\n## ").count(), Check::ALL.len(), "docs/troubleshooting.md has other headings");
}

proptest! {
    #[test]
    fn what_is_wrong_has_one_next_step(
        which in 0..SCENES.len(), state in "\\PC{0,20}", integrity in "\\PC{0,20}", mode in "\\PC{0,12}",
        text in "(?s).{0,80}", number: f64, count: u64, bits: u64, errno in 0_i32..140, pid: Option<u32>,
    ) {
        let mut f = scene(SCENES[which]);
        f.process = pid;
        for (i, x) in f.sensors.iter_mut().enumerate() {
            let s = &mut x.sensor;
            if bits >> i & 1 == 1 { s.state = state.clone() }
            if bits >> (i + 8) & 1 == 1 { s.integrity = integrity.clone() }
            if bits >> (i + 16) & 1 == 1 { s.identity = text.clone() }
            (s.emissivity, s.settling_s) = (Some(number), number);
            s.counters = vec![("reads".into(), count), ("bad-pec".into(), bits), ("error-flag".into(), count)];
        }
        if bits >> 40 & 1 == 1 { f.configuration = Err(text.clone()) }
        if let Ok(status) = &mut f.daemon {
            (status.mode, status.rate_hz, status.sample_age_s) = (mode.clone(), number, number);
            for fault in &mut status.faults { fault.evidence = text.clone() }
        } else if bits >> 41 & 1 == 1 {
            f.daemon = Err(Silence::Refused(text.clone()));
        }
        for (i, adapter) in f.adapters.iter_mut().enumerate() {
            adapter.1 = if bits >> (i + 42) & 1 == 1 { Ok(Functions(bits)) } else { Err(BusError::Other(errno)) };
        }
        for line in &mut f.lines { line.used_by = Err(text.clone()) }
        f.lateness = f.lateness.map(|_| Lateness { waits: 1, mean_ms: number, most_ms: number });
        f.service = Some(Service { load: text.clone(), active: state.clone(), result: text, restarts: count as u32 });
        let found = findings(&f);
        prop_assert!(!found.is_empty());
        for finding in &found {
            let wrong = matches!(finding.verdict, Verdict::Warn | Verdict::Fail);
            prop_assert_eq!(finding.next.as_ref().is_some_and(|n| !n.is_empty() && !n.contains('\n')), wrong, "{:?}", finding);
            prop_assert!(!finding.evidence.contains('\n'), "{:?}", finding);
        }
        prop_assert!(report::json(&found).is_ok());
        report::plain(&found);
    }
}

fn doctor(bus: &str, args: &[&str]) -> Output {
    Command::new(CTL).args(["--bus", bus, "doctor"]).args(args).output().unwrap()
}

#[test]
fn a_daemon_that_flies_a_simulation_is_well() {
    let (bus, folder) = (Bus::new(), Folder::new());
    let text = format!("[simulation]\nenabled = true\n[dbus]\nbus = \"{}\"\n", bus.address());
    let _daemon = Daemon::start(&folder, &text);
    let ready = Command::new(CTL).args(["--bus", &bus.address(), "wait-ready", "--timeout", "20"]).status().unwrap();
    assert!(ready.success());
    let file = folder.path("irhorizon.toml").display().to_string();
    let output = doctor(&bus.address(), &[&file]);
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{said}");
    for line in [
        "ok    attitude: nominal, σ ",
        "ok    dbus org.irhorizon1: irhorizond ",
        "-     permissions, bus, adapter, gpio, answers: the flight is simulated",
    ] {
        assert!(said.lines().any(|l| l.starts_with(line)), "{line:?} is not in\n{said}");
    }
}

/// What doctor says in JSON of a machine on which nothing is plugged in, and its exit code.
fn nothing_plugged_in(kit: &Kit) -> (u8, serde_json::Value) {
    let folder = Folder::new();
    let file = folder.write("irhorizon.toml", six().replace("/dev/i2c-1", "/dev/i2c-none")).display().to_string();
    let (mut out, mut err) = (Vec::new(), Vec::new());
    let args = ["irhorizonctl", "--bus", "unix:path=/nonexistent/bus", "doctor", "--json", &file];
    let code = run(args, kit, &mut out, &mut err);
    assert!(err.is_empty());
    (code, serde_json::from_slice(&out).unwrap())
}

#[test]
fn a_machine_without_a_bus_is_told_so() {
    let (code, value) = nothing_plugged_in(&Kit { daemon_process: || None, ..Kit::REAL });
    let of = |check: &str| value["findings"].as_array().unwrap().iter().find(|f| f["check"] == check).unwrap().clone();
    assert_eq!((code, &of("configuration")["verdict"]), (1, &"ok".into()));
    assert_eq!((&of("bus")["verdict"], &of("bus")["on"]), (&"fail".into(), &"/dev/i2c-none".into()));
    assert_eq!(of("answers")["on"], "nose, tail, left, right, up, down");
}

#[test]
fn a_daemon_that_does_not_answer_keeps_its_hardware_to_itself() {
    let (code, value) = nothing_plugged_in(&Kit { daemon_process: || Some(812), ..Kit::REAL });
    let found = value["findings"].as_array().unwrap();
    let touched = found.iter().any(|f| f["check"] == "bus" && f["verdict"] != "skipped");
    assert!(code == 0 && !touched && value.to_string().contains("pid 812"), "{value}");
}
