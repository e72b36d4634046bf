//! What doctor makes of facts, word for word, and of the daemon and of a machine without one.
//! `UPDATE_GOLDEN=1` writes the expected texts.

mod dbus_bus;
mod doctor_scenes;
mod golden_file;
mod process;

use dbus_bus::Bus;
use doctor_scenes::{SCENES, scene, six, well};
use irhorizon::bus::{BusError, Functions};
use irhorizon::ctl::doctor::facts::{Lateness, Service, Silence};
use irhorizon::ctl::doctor::{Check, Verdict, findings, report};
use irhorizon::ctl::kit::Kit;
use irhorizon::ctl::run;
use irhorizon::ctl::view::Status;
use process::{CTL, Daemon, Folder};
use proptest::prelude::*;
use std::path::Path;
use std::process::{Command, Output};

fn golden(name: &str, text: &str) {
    assert_eq!(golden_file::difference(format!("tests/golden/ctl/{name}"), text), None);
}

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
fn scans_without_a_measurement_are_not_well() {
    let mut f = well();
    f.daemon = f.daemon.map(|status| Status { sample_age_s: f64::NAN, ..status });
    let found = findings(&f);
    let timing = found.iter().find(|f| f.check == Check::Timing).unwrap();
    assert_eq!((timing.verdict, &*timing.evidence), (Verdict::Warn, "50.0 scans a second, and no measurement yet"));
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
