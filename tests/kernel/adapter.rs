//! Kernel modules, and the buses and lines that they make.

use crate::rig::{require_kernel, wait_for};
use i2cdev::core::I2CDevice;
use i2cdev::linux::{LinuxI2CDevice, LinuxI2CError};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A module, removed at the end of the test.
pub struct Module {
    name: &'static str,
}

impl Module {
    /// Loads `name` (as modprobe spells it) with `parameters`: `["chip_addr=0x5a,0x5b"]`.
    pub fn load(name: &'static str, parameters: &[&str]) -> Self {
        require_kernel();
        assert!(!Path::new("/sys/module").join(name.replace('-', "_")).exists(), "{name} is loaded already");
        let output = Command::new("modprobe").arg(name).args(parameters).output().unwrap();
        assert!(output.status.success(), "modprobe {name}: {}", String::from_utf8_lossy(&output.stderr));
        Self { name }
    }

    /// Writes a parameter at run time.
    pub fn set(&self, parameter: &str, value: &str) {
        let path = Path::new("/sys/module").join(self.name.replace('-', "_")).join("parameters").join(parameter);
        fs::write(&path, value).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    }
}

impl Drop for Module {
    fn drop(&mut self) {
        // Whoever is still about to close a device is waited for.
        let removed = || Command::new("rmmod").arg(self.name).status().is_ok_and(|s| s.success());
        if std::thread::panicking() {
            let _ = removed();
        } else {
            wait_for(&format!("rmmod {}", self.name), || removed().then_some(()));
        }
    }
}

/// A bus made by a module.
pub struct Adapter {
    /// `/dev/i2c-N`.
    pub path: String,
    pub number: u32,
    /// Last, so that what hangs on the bus is gone before it.
    pub module: Module,
}

impl Adapter {
    /// `i2c-stub`: plain memory at `addresses`, no PEC.
    pub fn stub(addresses: &[u16]) -> Self {
        Self::make("i2c-stub", addresses, "SMBus stub driver")
    }

    /// `i2c-fault`: real PEC, and faults by `module.set`.
    pub fn fault(addresses: &[u16]) -> Self {
        Self::make("i2c-fault", addresses, "i2c-fault")
    }

    fn make(module: &'static str, addresses: &[u16], name: &str) -> Self {
        let list: Vec<String> = addresses.iter().map(|a| format!("{a:#04x}")).collect();
        require_kernel();
        assert!(Command::new("modprobe").arg("i2c-dev").status().unwrap().success(), "modprobe i2c-dev");
        let module = Module::load(module, &[&format!("chip_addr={}", list.join(","))]);
        let number = wait_for(&format!("an adapter called {name}"), || {
            let nodes = fs::read_dir("/sys/class/i2c-dev").ok()?.flatten();
            let mut named = nodes.filter(|n| fs::read_to_string(n.path().join("name")).is_ok_and(|t| t.trim() == name));
            named.next()?.file_name().to_str()?.strip_prefix("i2c-")?.parse().ok()
        });
        let path = format!("/dev/i2c-{number}");
        wait_for(&path, || Path::new(&path).exists().then_some(()));
        Self { path, number, module }
    }

    /// A descriptor of the test's own for the chip at `address`.
    pub fn chip(&self, address: u16) -> Chip {
        Chip(LinuxI2CDevice::new(&self.path, address).unwrap())
    }
}

/// A chip as the test moves it.
pub struct Chip(LinuxI2CDevice);

impl Chip {
    /// Writes SMBus words, low byte first.
    pub fn write(&mut self, register: u8, word: u16) {
        self.try_write(register, word).unwrap();
    }

    /// The same where the chip may not answer.
    pub fn try_write(&mut self, register: u8, word: u16) -> Result<(), LinuxI2CError> {
        self.0.smbus_write_word_data(register, word)
    }

    pub fn read(&mut self, register: u8) -> u16 {
        self.0.smbus_read_word_data(register).unwrap()
    }
}

/// A GPIO chip of eight lines.
pub struct GpioSim {
    /// `gpiochipN`: what configuration may call it.
    pub chip: String,
    folder: PathBuf,
    lines: PathBuf,
    _module: Module,
}

impl GpioSim {
    pub fn new() -> Self {
        let module = Module::load("gpio-sim", &[]);
        let folder = PathBuf::from("/sys/kernel/config/gpio-sim/irhorizon");
        let bank = folder.join("bank0");
        fs::create_dir_all(&bank).unwrap();
        fs::write(bank.join("num_lines"), "8").unwrap();
        fs::write(folder.join("live"), "1").unwrap();
        let read = |path: PathBuf| fs::read_to_string(path).unwrap().trim().to_owned();
        let chip = read(bank.join("chip_name"));
        let lines = Path::new("/sys/devices/platform").join(read(folder.join("dev_name"))).join(&chip);
        let node = Path::new("/dev").join(&chip);
        wait_for("the GPIO chip's node", || node.exists().then_some(()));
        Self { chip, folder, lines, _module: module }
    }

    /// Pulls input `line` up or down: an edge, where it lay the other way.
    pub fn pull(&self, line: u32, up: bool) {
        let pull = if up { "pull-up" } else { "pull-down" };
        fs::write(self.lines.join(format!("sim_gpio{line}/pull")), pull).unwrap();
    }

    /// What a program drives output `line` to.
    pub fn value(&self, line: u32) -> bool {
        fs::read_to_string(self.lines.join(format!("sim_gpio{line}/value"))).unwrap().trim() == "1"
    }
}

impl Drop for GpioSim {
    fn drop(&mut self) {
        let _ = fs::write(self.folder.join("live"), "0");
        let _ = fs::remove_dir(self.folder.join("bank0"));
        let _ = fs::remove_dir(&self.folder);
    }
}
