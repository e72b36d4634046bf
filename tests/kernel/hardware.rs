//! The hardware source, scan by scan, against the kernel's own I²C: i2c-fault and i2c-stub.

use crate::rig::require_kernel;
use crate::stalls::{Span, Watch};
use irhorizon::bus::explain::{Facts, Place, explain};
use irhorizon::bus::generic::GenericBus;
use irhorizon::bus::linux::LinuxBus;
use irhorizon::bus::{BusError, PecBus, WordBus};
use irhorizon::clock;
use irhorizon::config::{self, Settings};
use irhorizon::frame::{Frame, Missing, Reading, Value};
use irhorizon::sensor::hardware::HardwareSource;
use irhorizon::sensor::mlx90614::Mlx90614;
use irhorizon::sensor::mlx90614::eeprom::{Change, EepromError};
use irhorizon::source::{FrameSource, Integrity};
use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

const FAULT: &str = "/dev/i2c-9";
/// 26.85 °C, 10.01 °C.
const NOSE_WORD: u16 = 15_000;
const TAIL_WORD: u16 = 14_158;

fn run(line: &str) {
    let status = Command::new("sh").args(["-c", line]).status().unwrap();
    assert!(status.success(), "{line}: {status}");
}

fn fault(parameter: &str, value: &str) {
    fs::write(format!("/sys/module/i2c_fault/parameters/{parameter}"), value).unwrap();
}

/// These sensors, looking along the nose and the tail. The configuration insists on a whole head:
/// the others are left out again.
fn settings(sensors: &[(&str, &str, u8, &str)]) -> Settings {
    let mut text = String::from("[daemon]\nrate-hz = 50\nquiet-ms = 0\n");
    let others = [("nose", 0x60), ("tail", 0x61), ("left", 0x62), ("right", 0x63), ("up", 0x64), ("down", 0x65)];
    let others = others.iter().map(|(name, address)| (*name, FAULT, *address, ""));
    let others = others.filter(|(name, ..)| sensors.iter().all(|s| s.0 != *name));
    for (name, bus, address, more) in sensors.iter().copied().chain(others) {
        text += &format!(
            "[[sensor]]\nname = \"{name}\"\nkind = \"mlx90614\"\nbus = \"{bus}\"\naddress = {address}\n\
             direction = \"{name}\"\n{more}\n"
        );
    }
    let mut settings = config::parse(&[("test.toml".into(), text)]).unwrap().settings;
    settings.sensors.truncate(sensors.len());
    settings
}

struct Rig {
    source: HardwareSource,
    frame: Frame,
    longest: Duration,
}

impl Rig {
    fn new(settings: &Settings) -> Self {
        let head = settings.head();
        let frame = Frame::new(head.sensors.len());
        Self { source: HardwareSource::open(settings, &head).unwrap(), frame, longest: Duration::ZERO }
    }

    fn scan(&mut self) {
        let (tick, begun) = (clock::now(), Instant::now());
        self.source.scan(tick, &mut self.frame);
        self.longest = self.longest.max(begun.elapsed());
        clock::sleep_until(tick + Duration::from_millis(20));
    }

    /// Scans until the readings are as wanted; gives the time it took.
    fn until(&mut self, what: &str, mut wanted: impl FnMut(&[Reading]) -> bool) -> Span {
        let (watch, begun) = (Watch::start(), Instant::now());
        while begun.elapsed() < Duration::from_secs(5) {
            self.scan();
            if wanted(&self.frame.readings) {
                let took = watch.stop();
                println!("{what}: after {took}");
                return took;
            }
        }
        panic!("{what}: {:?}, down: {:?}", self.frame.readings, self.source.buses_down());
    }

    fn object_c(&self, sensor: usize) -> f64 {
        match self.frame.readings[sensor].map(|s| s.value) {
            Ok(Value::Absolute { object_c, .. }) => object_c,
            other => panic!("sensor {sensor}: {other:?}"),
        }
    }
}

fn well(readings: &[Reading]) -> bool {
    readings.iter().all(Result::is_ok)
}

/// Two sensors with plausible words.
fn plug_in() {
    run("modprobe i2c-fault chip_addr=0x5a,0x5b nr=9");
    for (address, object) in [(0x5a, NOSE_WORD), (0x5b, TAIL_WORD)] {
        let mut bus = LinuxBus::open(Path::new(FAULT), address).unwrap();
        for (cell, word) in [(0x06, 14_908), (0x07, object), (0x24, 0xFFFF), (0x25, 0x9FB4), (0x3F, u16::from(address))]
        {
            bus.write_word(cell, word).unwrap();
        }
    }
}

#[test]
fn a_source_on_the_kernels_buses() {
    require_kernel();
    run("modprobe i2c-dev");
    plug_in();
    let settings = settings(&[("nose", FAULT, 0x5a, ""), ("tail", FAULT, 0x5b, "")]);
    let mut rig = Rig::new(&settings);
    readings(&mut rig);
    faults_of_transfers(&mut rig);
    a_held_bus(&mut rig);
    unplugged(&mut rig);
    drop(rig);
    claimed(&settings);
    eeprom();
    generic();
    run("rmmod i2c-fault");
    without_pec();
}

fn readings(rig: &mut Rig) {
    rig.scan();
    assert!((rig.object_c(0) - 26.85).abs() < 1e-9);
    assert!((rig.object_c(1) - 10.01).abs() < 1e-9);
    let Ok(Value::Absolute { ambient_c: Some(ambient_c), .. }) = rig.frame.readings[0].map(|s| s.value) else {
        panic!("{:?}", rig.frame.readings[0]);
    };
    assert!((ambient_c - 25.01).abs() < 1e-9);
    let health = rig.source.health()[1];
    assert_eq!((health.integrity, health.settling_s), (Integrity::Pec, 0.10));
    assert_eq!((health.emissivity, health.identity), (Some(1.0), Some(0x5b)));
}

fn faults_of_transfers(rig: &mut Rig) {
    let watch = Watch::start();
    for (parameter, why) in [("bad_pec", Missing::BadPec), ("nak", Missing::NoAnswer)] {
        fault(parameter, "0x5a");
        rig.until(parameter, |r| r[0] == Err(why) && r[1].is_ok());
        (0..60).for_each(|_| rig.scan());
        assert!(rig.frame.readings[0] == Err(why) && rig.frame.readings[1].is_ok(), "{parameter}");
        fault(parameter, "0");
        let back = rig.until("it ends", well);
        assert!(back.within(Duration::from_millis(600)), "{parameter}: {back:?}");
    }
    // Every tenth transfer damaged: trying again hides nearly all of it.
    fault("bad_pec", "0x5a,0x5b");
    fault("every", "10");
    let good = (0..200).filter(|_| {
        rig.scan();
        well(&rig.frame.readings)
    });
    let good = good.count();
    fault("bad_pec", "0");
    fault("every", "0");
    assert!(good > 190, "{good} of 200");
    assert!(rig.source.health()[0].counters.retries > 0);
    let still = watch.stop().still;
    assert!(rig.longest < Duration::from_millis(40) + still, "{:?}, {still:?}", rig.longest);
}

fn a_held_bus(rig: &mut Rig) {
    rig.longest = Duration::ZERO;
    fault("held", "1");
    rig.until("held", |r| r.iter().all(|r| *r == Err(Missing::BusHeld)));
    (0..50).for_each(|_| rig.scan());
    assert_eq!(rig.source.buses_down(), [Some(Missing::BusHeld)]);
    fault("held", "0");
    let back = rig.until("let go", well);
    assert!(back.within(Duration::from_millis(500)), "{back:?}");
}

fn unplugged(rig: &mut Rig) {
    rig.scan();
    let mut unload = Command::new("rmmod").arg("i2c-fault").spawn().unwrap();
    let gone = rig.until("unplugged", |r| r.iter().all(|r| *r == Err(Missing::BusGone)));
    assert!(gone.within(Duration::from_millis(500)), "{gone:?}");
    assert_eq!(rig.source.buses_down(), [Some(Missing::BusGone)]);
    assert!(unload.wait().unwrap().success(), "nobody holds the adapter");
    (0..20).for_each(|_| rig.scan());
    plug_in();
    let back = rig.until("plugged in", well);
    assert!(back.within(Duration::from_secs(1)), "{back:?}");
    assert_eq!(rig.source.buses_down(), [None]);
    assert_eq!(rig.source.health()[0].integrity, Integrity::Pec);
}

fn claimed(settings: &Settings) {
    run("modprobe mlx90614; echo mlx90614 0x5a >/sys/bus/i2c/devices/i2c-9/new_device");
    let mut rig = Rig::new(settings);
    rig.until("claimed", |r| r[0] == Err(Missing::Claimed) && r[1].is_ok());
    assert_eq!(rig.source.buses_down(), [None]);
    let place = Place { name: "nose".into(), chip: "MLX90614", bus: FAULT.into(), address: 0x5a };
    let advice = explain(&place, BusError::Claimed, &Facts::gather(Path::new("/"), Path::new(FAULT), 0x5a));
    // What is advised does free it.
    let command = advice.split("free it with: ").nth(1).unwrap_or_else(|| panic!("{advice}"));
    run(&command.replace("sudo ", ""));
    let back = rig.until("freed", well);
    assert!(back.within(Duration::from_millis(500)), "{back:?}");
    run("echo 0x5a >/sys/bus/i2c/devices/i2c-9/delete_device");
}

fn eeprom() {
    let mut pause = |time| std::thread::sleep(time);
    fault("eeprom", "1");
    let chip = |address| Mlx90614::new(LinuxBus::open(Path::new(FAULT), address).unwrap());
    let error = chip(0x5a).set_address(0x5c, &mut pause).unwrap_err();
    assert!(matches!(error, EepromError::Refused { holds: 0xbe5a, .. }), "without PEC: {error}");
    let mut checked = chip(0x5a);
    checked.bus().set_pec(true).unwrap();
    assert_eq!(checked.set_address(0x5c, &mut pause), Ok(Change { from: 0xbe5a, to: 0xbe5c }));
    fault("power_cycle", "1");
    assert!(chip(0x5c).configuration().is_ok());
    assert_eq!(chip(0x5a).configuration(), Err(BusError::NoAnswer));
    // Address 0 reaches it too.
    let mut any = chip(0);
    any.bus().set_pec(true).unwrap();
    assert_eq!(any.set_address(0x5a, &mut pause), Ok(Change { from: 0xbe5c, to: 0xbe5a }));
    fault("power_cycle", "1");
    assert!(chip(0x5a).configuration().is_ok());
    fault("eeprom", "0");
}

fn generic() {
    let i2c = linux_embedded_hal::I2cdev::new(FAULT).unwrap();
    let mut bus = GenericBus::new(i2c, 0x5b);
    bus.set_pec(true).unwrap();
    bus.write_word(0x10, 0x1234).unwrap();
    assert_eq!(bus.read_word(0x10), Ok(0x1234));
    fault("bad_pec", "0x5b");
    assert_eq!(bus.read_word(0x10), Err(BusError::Pec));
    fault("bad_pec", "0");
    fault("nak", "0x5b");
    assert_eq!(bus.read_word(0x10), Err(BusError::NoAnswer));
    fault("nak", "0");
}

fn without_pec() {
    run("modprobe i2c-stub chip_addr=0x5a");
    let bus = fs::read_dir("/sys/bus/i2c/devices").unwrap().flatten().find_map(|e| {
        let name = fs::read_to_string(e.path().join("name")).ok()?;
        name.contains("stub").then(|| format!("/dev/{}", e.file_name().to_string_lossy()))
    });
    let bus = bus.unwrap();
    let mut words = LinuxBus::open(Path::new(&bus), 0x5a).unwrap();
    assert_eq!((words.functions().words(), words.functions().pec()), (true, false));
    words.write_word(0x07, NOSE_WORD).unwrap();
    let sensors = [("nose", bus.as_str(), 0x5a, ""), ("tail", &bus, 0x5b, "")];
    let mut rig = Rig::new(&settings(&sensors));
    rig.scan();
    assert!((rig.object_c(0) - 26.85).abs() < 1e-9);
    assert_eq!(rig.frame.readings[1], Err(Missing::NoAnswer));
    assert_eq!(rig.source.health()[0].integrity, Integrity::AdapterWithout);
    let mut strict = Rig::new(&settings(&[("nose", &bus, 0x5a, "pec = \"required\"")]));
    strict.scan();
    assert_eq!(strict.frame.readings[0], Err(Missing::BadPec));
    drop((words, rig, strict));
    run("rmmod i2c-stub");
}
