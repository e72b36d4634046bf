//! GPIO lines against the kernel's simulated chip, `gpio-sim`.

use crate::rig::require_kernel;
use irhorizon::config::settings::LineSettings;
use irhorizon::gpio::edge::EdgeInput;
use irhorizon::gpio::output::{OutputLine, PlugInLine};
use irhorizon::gpio::pin::{PinReady, PinSwitch};
use irhorizon::gpio::{DataReady, GpioError, Switch, lines};
use linux_embedded_hal::CdevPin;
use std::fs;
use std::path::PathBuf;
use std::process::Command;
use std::thread;
use std::time::{Duration, Instant};

const LABEL: &str = "irhorizon-lines";
const LINES: u32 = 8;
const WHILE: Duration = Duration::from_secs(5);

/// A simulated chip, gone when dropped.
struct Sim {
    config: PathBuf,
    lines: PathBuf,
    name: String,
}

impl Sim {
    fn new() -> Self {
        assert!(Command::new("modprobe").arg("gpio-sim").status().unwrap().success());
        let config = PathBuf::from("/sys/kernel/config/gpio-sim").join(LABEL);
        let bank = config.join("bank0");
        fs::create_dir_all(&bank).unwrap();
        fs::write(bank.join("num_lines"), LINES.to_string()).unwrap();
        fs::write(bank.join("label"), LABEL).unwrap();
        fs::write(config.join("live"), "1").unwrap();
        let read = |path: PathBuf| fs::read_to_string(path).unwrap().trim().to_owned();
        let name = read(bank.join("chip_name"));
        let lines = PathBuf::from("/sys/devices/platform").join(read(config.join("dev_name"))).join(&name);
        Self { config, lines, name }
    }

    fn pull(&self, line: u32, up: bool) {
        let pull = if up { "pull-up" } else { "pull-down" };
        fs::write(self.lines.join(format!("sim_gpio{line}/pull")), pull).unwrap();
    }

    fn pulse(&self, line: u32) {
        self.pull(line, false);
        self.pull(line, true);
    }

    fn level(&self, line: u32) -> bool {
        fs::read_to_string(self.lines.join(format!("sim_gpio{line}/value"))).unwrap().trim() == "1"
    }
}

impl Drop for Sim {
    fn drop(&mut self) {
        let _ = fs::write(self.config.join("live"), "0");
        let _ = fs::remove_dir(self.config.join("bank0"));
        let _ = fs::remove_dir(&self.config);
    }
}

fn line(line: u32, active_low: bool) -> LineSettings {
    LineSettings { chip: LABEL.into(), line, active_low }
}

#[test]
fn lines_of_a_kernels_chip() {
    require_kernel();
    let sim = Sim::new();
    chips(&sim);
    edges(&sim);
    outputs(&sim);
    comes_later(&sim);
    pins(&sim);
}

/// By label, name and path; who holds a line; what is not there.
fn chips(sim: &Sim) {
    for chip in [LABEL, &sim.name, &format!("/dev/{}", sim.name)] {
        let settings = LineSettings { chip: chip.into(), line: 7, active_low: false };
        assert_eq!(lines::find(&settings).unwrap().chip().label(), LABEL);
    }
    let missing = EdgeInput::open(&LineSettings { chip: "pinctrl-none".into(), ..line(0, false) }).unwrap_err();
    assert!(missing.to_string().contains(&format!("{LABEL:?} ({})", sim.name)), "{missing}");
    let beyond = EdgeInput::open(&line(LINES, false)).unwrap_err();
    assert_eq!(beyond, GpioError::NoLine { chip: LABEL.into(), line: LINES, lines: LINES });
    let _held = OutputLine::open(&line(1, false), false).unwrap();
    let busy = EdgeInput::open(&line(1, false)).unwrap_err();
    assert_eq!(busy, GpioError::Busy { chip: LABEL.into(), line: 1, consumer: "irhorizon".into() });
    assert!(matches!(OutputLine::open(&line(1, false), true), Err(GpioError::Busy { .. })));
}

/// A pulse is not missed, however short; old ones are forgotten; a wait ends.
fn edges(sim: &Sim) {
    sim.pull(4, true);
    let mut ready = EdgeInput::open(&line(4, false)).unwrap();
    let begun = Instant::now();
    assert_eq!(ready.wait(Duration::from_millis(30)), Ok(false));
    assert!(begun.elapsed() >= Duration::from_millis(30));
    sim.pulse(4);
    assert_eq!(ready.wait(WHILE), Ok(true), "a pulse from before the wait");
    assert_eq!(ready.wait(Duration::ZERO), Ok(false), "one pulse, one edge");
    for _ in 0..40 {
        sim.pulse(4);
    }
    ready.clear();
    assert_eq!(ready.wait(Duration::ZERO), Ok(false), "more pulses than the queue holds, all forgotten");
    thread::scope(|scope| {
        scope.spawn(|| {
            thread::sleep(Duration::from_millis(50));
            sim.pulse(4);
        });
        assert_eq!(ready.wait(WHILE), Ok(true), "a pulse during the wait");
    });
    drop(ready);

    let mut inverted = EdgeInput::open(&line(4, true)).unwrap();
    sim.pull(4, false);
    assert_eq!(inverted.wait(Duration::from_millis(20)), Ok(false), "falling, through an inverter");
    sim.pull(4, true);
    assert_eq!(inverted.wait(WHILE), Ok(true), "rising, through an inverter");
}

/// On from the first moment; active-low turns the level, not the meaning.
fn outputs(sim: &Sim) {
    for active_low in [false, true] {
        let mut switch = OutputLine::open(&line(5, active_low), true).unwrap();
        assert_eq!(sim.level(5), !active_low);
        for on in [false, true, true, false] {
            switch.set(on).unwrap();
            assert_eq!(sim.level(5), on != active_low, "active low {active_low}, on {on}");
        }
    }
}

/// A supply's line that cannot be had at first is taken when it can.
fn comes_later(sim: &Sim) {
    let mut supply = PlugInLine::new(&line(3, false));
    let held = OutputLine::open(&line(3, false), false).unwrap();
    assert!(matches!(supply.set(true), Err(GpioError::Busy { .. })));
    drop(held);
    for on in [true, false, true] {
        supply.set(on).unwrap();
        assert_eq!(sim.level(3), on);
    }
}

/// linux-embedded-hal's pins do the same.
fn pins(sim: &Sim) {
    use gpio_cdev::LineRequestFlags as Flags;
    let pin = |settings: &LineSettings, flags| {
        CdevPin::new(lines::find(settings).unwrap().request(flags, 0, "irhorizon-test").unwrap()).unwrap()
    };
    for active_low in [false, true] {
        let mut flags = Flags::OUTPUT;
        flags.set(Flags::ACTIVE_LOW, active_low);
        let mut switch = PinSwitch::new(pin(&line(6, active_low), flags), active_low);
        for on in [true, false] {
            switch.set(on).unwrap();
            assert_eq!(sim.level(6), on != active_low, "active low {active_low}, on {on}");
        }
    }
    sim.pull(7, true);
    let mut ready = PinReady::new(pin(&line(7, false), Flags::INPUT));
    assert_eq!(ready.wait(Duration::from_millis(2)), Ok(false));
    sim.pull(7, false);
    assert_eq!(ready.wait(WHILE), Ok(true));
}
