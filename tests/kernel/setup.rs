//! doctor, set-address and record --offline on a kernel's bus, without a daemon; a covered head calibrated with one.

use crate::adapter::{Adapter, Chip};
use crate::mlx::{ADDRESSES, NAMES, SixMlx, word};
use crate::rig::{CTL, Daemon, Folder};
use crate::sky::six_c;
use irhorizon::frame::{self, Frame};
use irhorizon::recording::Recording;
use rustix::process::Signal;
use serde_json::Value;
use std::fs;
use std::process::{Command, Output};

/// Nobody is asked on D-Bus: there is no such bus.
fn ctl(args: &[&str]) -> Output {
    Command::new(CTL).args(["--bus", "unix:path=/nonexistent/bus"]).args(args).output().unwrap()
}

/// A sensor as it leaves the factory, but at `address`.
fn fresh(bus: &Adapter, address: u16) -> Chip {
    let mut chip = bus.chip(address);
    for (cell, value) in [(0x06, word(21.0)), (0x07, word(9.0)), (0x2E, 0xBE00 | address), (0x3C, 0x1234)] {
        chip.write(cell, value);
    }
    chip
}

fn findings(bus: &Adapter) -> Vec<Value> {
    let folder = Folder::new();
    let file = folder.path("irhorizon.toml");
    fs::write(&file, SixMlx::config(bus)).unwrap();
    let output = ctl(&["doctor", "--json", &file.display().to_string()]);
    let value: Value = serde_json::from_slice(&output.stdout).unwrap();
    value["findings"].as_array().unwrap().clone()
}

/// The findings of `check`: on what, and how it stands.
fn of(found: &[Value], check: &str) -> Vec<(String, String)> {
    let text = |f: &Value, key: &str| f[key].as_str().unwrap().to_owned();
    found.iter().filter(|f| f["check"] == check).map(|f| (text(f, "on"), text(f, "verdict"))).collect()
}

#[test]
fn a_sensor_gets_its_address_through_the_kernel() {
    for (bus, pec) in [(Adapter::fault as fn(&[u16]) -> Adapter, "pec"), (Adapter::stub, "no pec")] {
        let bus = bus(&[0x5a]);
        let mut chip = fresh(&bus, 0x5a);
        let output = ctl(&["set-address", "0x5b", "--yes", "--i2c-bus", &bus.path]);
        let said = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{pec}: {said}");
        assert!(said.contains("0x5a  MLX90614"), "{said}");
        assert_eq!(chip.read(0x2E), 0xBE5B, "{pec}");
    }
}

#[test]
fn two_sensors_are_left_as_they_are() {
    let bus = Adapter::fault(&[0x5a, 0x5c]);
    let mut chips = [0x5a, 0x5c].map(|a| fresh(&bus, a));
    let output = ctl(&["set-address", "0x5b", "--yes", "--i2c-bus", &bus.path]);
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(chips.each_mut().map(|c| c.read(0x2E)), [0xBE5A, 0xBE5C]);
}

#[test]
fn doctor_reads_what_there_is_and_writes_nothing() {
    let bus = Adapter::fault(&[0x5b, 0x5c, 0x5d, 0x5e, 0x5f, 0x60]);
    let _six = SixMlx::new(&bus);
    let mut chip = bus.chip(0x5b);
    let before: Vec<u16> = (0x20..0x40).map(|cell| chip.read(cell)).collect();
    let found = findings(&bus);
    let (all, ok) = (NAMES.join(", "), "ok".to_owned());
    assert_eq!(of(&found, "answers"), NAMES.map(|n| (n.to_owned(), ok.clone())));
    assert_eq!(of(&found, "pec"), [(all.clone(), ok.clone())]);
    assert_eq!(of(&found, "settling"), [(all, ok.clone())]);
    assert_eq!(of(&found, "adapter"), [(bus.path.clone(), ok)]);
    assert_eq!((0x20..0x40).map(|cell| chip.read(cell)).collect::<Vec<_>>(), before);
}

#[test]
fn doctor_says_what_is_missing() {
    let bus = Adapter::stub(&[0x5b, 0x5c, 0x5d, 0x5e, 0x5f, 0x60]);
    let mut six = SixMlx::new(&bus);
    six.write([0x8000, word(10.0), word(10.0), word(10.0), word(-20.0), word(15.0)]);
    let found = findings(&bus);
    assert_eq!(of(&found, "adapter"), [(bus.path.clone(), "warn".to_owned())]);
    assert_eq!(of(&found, "error-flag"), [("nose".to_owned(), "fail".to_owned())]);
    drop(six);
    let path = bus.path.clone();
    drop(bus);
    let bus = Adapter::stub(&[0x5b]);
    assert_eq!(bus.path, path);
    let silent = of(&findings(&bus), "answers");
    assert_eq!(silent.iter().filter(|(_, verdict)| verdict == "fail").count(), 5, "{silent:?}");
}

#[test]
fn a_recording_without_the_daemon() {
    let bus = Adapter::stub(&ADDRESSES);
    let _six = SixMlx::new(&bus);
    let mut daemon = Daemon::start(&SixMlx::config(&bus));
    let config = daemon.folder.path("irhorizon.toml").display().to_string();
    let file = daemon.folder.path("bench.csv");
    let record = || ctl(&["record", &file.display().to_string(), "--offline", "--config", &config, "--seconds", "1"]);
    let output = record();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(1) && said.contains(&format!("pid {}", daemon.pid())), "{said}");
    assert!(!file.exists());
    daemon.signal(Signal::TERM);
    assert!(daemon.ended().success(), "{}", daemon.said());
    // As a second one of these programs would.
    let held = fs::OpenOptions::new().write(true).open(&bus.path).unwrap();
    held.try_lock().unwrap();
    let said = String::from_utf8(record().stderr).unwrap();
    assert!(said.contains(&format!("another irhorizond or irhorizonctl is at {}", bus.path)), "{said}");
    drop(held);
    let output = record();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{said}");
    let mut frames = Recording::open(&file).unwrap().frames(None).unwrap();
    let (mut row, mut rows) = (Frame::default(), 0);
    while frames.next_frame(&mut row).unwrap() {
        rows += 1;
        for (reading, seen_c) in row.readings.iter().zip(six_c(0.0, 0.0)) {
            let Ok(frame::Value::Absolute { object_c, ambient_c: Some(_) }) = reading.map(|s| s.value) else {
                panic!("row {rows}: {:?}", row.readings)
            };
            assert!((object_c - seen_c).abs() < 0.011, "row {rows}: {object_c} of {seen_c}");
        }
    }
    println!("{rows} rows");
    assert!((10..=51).contains(&rows), "{rows} rows: {said}");
}

/// From the start on there is nothing to be seen: what is compared are the sensors, not the attitude.
#[test]
fn a_covered_head_tells_what_each_sensor_shows_too_much() {
    let bus = Adapter::stub(&ADDRESSES);
    let mut six = SixMlx::new(&bus);
    let too_much = [0.6, -0.6, -0.4, 0.4, 0.3, -0.3];
    let show = |six: &mut SixMlx, scene_c: [f64; 6]| six.write(std::array::from_fn(|i| word(scene_c[i] + too_much[i])));
    // In whole steps of 0.02 K.
    show(&mut six, [20.85; 6]);
    let mut daemon = Daemon::start(&SixMlx::config(&bus));
    let config = daemon.folder.path("irhorizon.toml").display().to_string();
    let output = daemon.ctl(&["calibrate", "neutral", "--yes", "--seconds", "4", "--config", &config]);
    let said = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}\n{}", daemon.said());
    let saved = fs::read_to_string(daemon.folder.path("irhorizon.toml.d/50-neutral.toml")).unwrap();
    for (name, offset) in NAMES.iter().zip(too_much) {
        assert!(saved.contains(&format!("name = \"{name}\"\noffset-c = {offset:.2}\n")), "{saved}");
    }
    // Taken up at once: level is level.
    show(&mut six, six_c(0.0, 0.0));
    let status =
        daemon.until("level", |s| s["mode"] == "nominal" && s["roll_deg"].as_f64().is_some_and(|d| d.abs() < 0.3));
    assert!(status["pitch_deg"].as_f64().unwrap().abs() < 0.3, "{status}");
    daemon.signal(Signal::TERM);
    assert!(daemon.ended().success(), "{}", daemon.said());
}
