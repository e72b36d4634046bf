//! What goes wrong in a flight that turns, by way of real registers and transfers: which name D-Bus gives it and MAVLink
//! tells, and whether the attitude goes on. By the default method, which hears each sensor by itself.

use crate::adapter::Adapter;
use crate::mlx::{ADDRESSES, NAMES, SixMlx};
use crate::radio::{ACTIVE, CRITICAL, Radio, SEVERITY_CRITICAL, SEVERITY_ERROR, SEVERITY_NOTICE};
use crate::rig::{Daemon, wait_for};
use crate::turning::{Turning, Wrong, attitude};
use irhorizon::clock;
use irhorizon::ctl::client::Client;
use irhorizon::ctl::view::Status;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

const LEFT: usize = 2;
const UP: usize = 4;
/// The largest error of roll and pitch while an attitude is given, °.
const TOLERANCE_DEG: f64 = 5.0;

/// A film is told so long after it began to come, s.
const FILM_SEEN_S: f64 = 2.75;

/// A daemon in the flight, with who asks it and who listens.
struct Aloft {
    eye: Client,
    radio: Radio,
    daemon: Daemon,
    flight: Option<Turning>,
    bus: Adapter,
}

impl Aloft {
    fn new() -> Self {
        let bus = Adapter::fault(&ADDRESSES);
        let (flight, radio) = (Turning::start(&bus), Radio::new());
        // The registers follow at once.
        let text = format!("[daemon]\nrate-hz = 25\n[head]\nlag-s = 0\n{}{}", SixMlx::config(&bus), radio.config());
        let daemon = Daemon::start(&text);
        let mut aloft = Self { eye: daemon.bus.client(), radio, daemon, flight: Some(flight), bus };
        aloft.well(0);
        // Long enough to know the sky.
        std::thread::sleep(Duration::from_secs(3));
        aloft
    }

    fn wrong(&self, wrong: Wrong) {
        self.flight.as_ref().unwrap().set(wrong);
    }

    /// The first status in which `done`.
    fn until(&mut self, what: &str, done: impl Fn(&Status) -> bool) -> Status {
        wait_for(what, || self.eye.status().ok().filter(&done))
    }

    /// Waits until `fault` is there for `why`, alone but for those that it `brings`: on D-Bus and by MAVLink, for the
    /// `times`th time. Attitude goes on or does not, as `given` says.
    fn told(&mut self, fault: &str, why: &str, brings: &[&str], given: bool, times: usize) {
        let cause = Instant::now();
        let status = self.until(fault, |s| s.faults.iter().any(|f| f.name == fault));
        let seen = cause.elapsed().as_secs_f64();
        let evidence = &status.faults.iter().find(|f| f.name == fault).unwrap().evidence;
        assert!(evidence.contains(why), "{fault}: {evidence}");
        let severity = if given { SEVERITY_ERROR } else { SEVERITY_CRITICAL };
        let text = self.radio.text(severity, &format!("irhorizon: {fault} ("), times);
        let mode = if given { "degraded" } else { "faulted" };
        let names = [&[fault], brings].concat();
        self.until(mode, |s| s.mode == mode && s.faults.len() >= names.len());
        assert_eq!(self.daemon.property("Faults"), format!("as {} \"{}\"", names.len(), names.join("\" \"")));
        assert_eq!(self.daemon.property("Mode"), format!("s \"{mode}\""));
        let moment = Instant::now();
        assert_eq!(self.radio.state_after(moment), if given { ACTIVE } else { CRITICAL }, "{fault}");
        assert_eq!(self.radio.attitudes_since(moment) > 0, given, "{fault}");
        let worst = given.then(|| self.follows());
        println!("{fault}: on D-Bus {seen:.2} s after its cause; {text:?}; {mode}, worst error {worst:.2?}°");
    }

    /// The largest error of a second; panics where it is too large or nothing is given.
    fn follows(&mut self) -> f64 {
        let (begun, mut worst) = (Instant::now(), 0.0_f64);
        while begun.elapsed() < Duration::from_secs(1) {
            let s = self.eye.status().unwrap();
            let (roll, pitch) = attitude(s.sample_time_usec as f64 * 1e-6);
            let (Some(r), Some(p)) = (s.roll_deg, s.pitch_deg) else { panic!("no attitude: {s:?}") };
            worst = worst.max((r - roll).abs()).max((p - pitch).abs());
            assert!(worst < TOLERANCE_DEG, "{r} {p} is not {roll} {pitch}: {s:?}");
        }
        worst
    }

    /// Waits until all is well; `over` faults have gone by then, as MAVLink tells.
    fn well(&mut self, over: usize) {
        self.until("all is well", |s| s.mode == "nominal" && s.faults.is_empty());
        if over > 0 {
            self.radio.text(SEVERITY_NOTICE, "irhorizon: ", over);
        }
        wait_for("no fault", || (self.daemon.property("Faults") == "as 0").then_some(()));
        assert_eq!(self.radio.state_after(Instant::now()), ACTIVE);
    }
}

/// The error bit, a wrong PEC and no acknowledge: one name, three reasons.
#[test]
fn a_sensor_is_lost_in_three_ways() {
    let mut aloft = Aloft::new();
    let fault = format!("sensor-lost:{}", NAMES[LEFT]);
    aloft.wrong(Wrong::Error(LEFT));
    aloft.told(&fault, "error bit set", &[], true, 1);
    aloft.wrong(Wrong::Nothing);
    aloft.well(1);
    for (times, parameter, why) in [(2, "bad_pec", "PEC mismatch"), (3, "nak", "no answer")] {
        aloft.bus.module.set(parameter, &format!("{:#04x}", ADDRESSES[LEFT]));
        aloft.told(&fault, why, &[], true, times);
        aloft.bus.module.set(parameter, "0");
        aloft.well(times);
    }
}

/// A register that keeps its word while all others move.
#[test]
fn a_frozen_word_is_a_stuck_sensor() {
    let mut aloft = Aloft::new();
    aloft.wrong(Wrong::Frozen(LEFT));
    aloft.told("sensor-stuck:left", " s, limit ", &[], true, 1);
    aloft.wrong(Wrong::Nothing);
    aloft.well(1);
}

/// Water that comes over three seconds: the object's register goes to the die's.
#[test]
fn a_film_of_water_is_a_wet_sensor() {
    let mut aloft = Aloft::new();
    // In a bank a film overhead that is not whole yet may be a wall as well, and nothing is given: it is seen in level flight.
    let now = || clock::now().as_secs_f64();
    wait_for("the right moment", || (attitude(now() + FILM_SEEN_S).0.abs() < 5.0).then_some(()));
    aloft.wrong(Wrong::Wet(UP, now()));
    aloft.told("wet-sensor:up", " %, limit ", &[], true, 1);
    aloft.wrong(Wrong::Nothing);
    aloft.well(1);
}

/// Six times the same word.
#[test]
fn six_equal_words_are_low_contrast() {
    let mut aloft = Aloft::new();
    aloft.wrong(Wrong::Fog);
    aloft.told("low-contrast", " K, limit ", &[], false, 1);
    aloft.wrong(Wrong::Nothing);
    aloft.well(1);
}

/// As a USB adapter is pulled out and plugged in again.
#[test]
fn a_bus_that_goes_is_down() {
    let mut aloft = Aloft::new();
    let (path, number) = (aloft.bus.path.clone(), aloft.bus.number);
    // Whoever holds the node keeps the module.
    aloft.flight = None;
    let mut pulled = Command::new("rmmod").arg("i2c-fault").spawn().unwrap();
    aloft.told(&format!("bus-down:{path}"), "bus gone", &["stale"], false, 1);
    assert!(wait_for("rmmod ends", || pulled.try_wait().unwrap()).success());
    let list: Vec<String> = ADDRESSES.iter().map(|a| format!("{a:#04x}")).collect();
    let parameters = [format!("chip_addr={}", list.join(",")), format!("nr={number}")];
    assert!(Command::new("modprobe").arg("i2c-fault").args(parameters).status().unwrap().success());
    wait_for("the node", || Path::new(&path).exists().then_some(()));
    aloft.flight = Some(Turning::start(&aloft.bus));
    aloft.well(2);
}
