//! Faults of real transfers: how soon each is told, what is said of it, how soon it is over.
//!
//! Times are taken from the daemon's log, whose lines come with the frame that they are about; a
//! client's question costs a tenth of a second in an emulated machine.

use crate::adapter::{Adapter, GpioSim, Module};
use crate::rig::*;
use crate::stalls::{Span, Watch};
use irhorizon::bus::generic::GenericBus;
use irhorizon::bus::linux::LinuxBus;
use irhorizon::bus::{BusError, PecBus, WordBus};
use irhorizon::ctl::client::Client;
use irhorizon::ctl::view::{Sensor, Status};
use irhorizon::sensor::mlx90614::driver::Mlx90614;
use irhorizon::sensor::mlx90614::eeprom::{Change, EepromError};
use irhorizon::sensor::mlx90614::registers::Configuration;
use irhorizon::source::Integrity;
use linux_embedded_hal::I2cdev;
use rustix::process::Signal;
use std::fs;
use std::os::unix::fs::{PermissionsExt, chown};
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

const NAMES: [&str; 6] = ["nose", "tail", "left", "right", "up", "down"];
const ADDRESSES: [u16; 6] = [0x5b, 0x5c, 0x5d, 0x5e, 0x5f, 0x60];
/// Level under a cold sky, °C.
const OBJECT_C: [f64; 6] = [3.0, 3.0, 3.0, 3.0, -20.0, 20.0];

/// 0.02 K per bit.
fn word(c: f64) -> u16 {
    ((c + 273.15) * 50.0).round() as u16
}

/// Gives the six sensors what they measure and their factory's settings.
fn fill(bus: &Adapter) {
    for (address, object_c) in ADDRESSES.into_iter().zip(OBJECT_C) {
        let mut chip = bus.chip(address);
        for (register, value) in [(0x06, word(25.0)), (0x07, word(object_c)), (0x24, 0xffff), (0x25, 0x9fb4)] {
            chip.write(register, value);
        }
    }
}

fn adapter() -> Adapter {
    let bus = Adapter::fault(&ADDRESSES);
    fill(&bus);
    bus
}

/// The six of them, by a method that needs every pair.
fn config(bus: &str) -> String {
    let sensor = |(name, address): (&&str, u16)| {
        format!("[[sensor]]\nname = \"{name}\"\nkind = \"mlx90614\"\nbus = \"{bus}\"\naddress = {address:#04x}\n")
    };
    let sensors: String = NAMES.iter().zip(ADDRESSES).map(sensor).collect();
    format!("{sensors}[estimator]\nmethod = \"inverse-sine\"\n")
}

/// What a client on D-Bus sees, asked again and again.
struct Eye(Client);

impl Eye {
    fn on(daemon: &Daemon) -> Self {
        let mut eye = Self(daemon.bus.client());
        eye.until("all is well", well);
        eye
    }

    /// The first status that is as it should be.
    fn until(&mut self, what: &str, done: impl Fn(&Status) -> bool) -> Status {
        wait_for(what, || self.0.status().ok().filter(&done))
    }
}

/// Waits until the daemon has logged `text` so many `times`; gives how long after `cause` that was.
fn logged(daemon: &Daemon, cause: Watch, text: &str, times: usize) -> Span {
    wait_for(&format!("{text:?} logged {times} times"), || {
        (daemon.said().matches(text).count() >= times).then(|| cause.stop())
    })
}

fn seconds(s: f64) -> Duration {
    Duration::from_secs_f64(s)
}

fn well(s: &Status) -> bool {
    s.mode == "nominal" && s.faults.is_empty()
}

fn has(s: &Status, fault: &str, why: &str) -> bool {
    s.faults.iter().any(|f| f.name == fault && f.evidence.contains(why))
}

fn counter(s: &Sensor, name: &str) -> u64 {
    s.counters.iter().find(|(n, _)| n == name).map_or_else(|| panic!("{name} in {:?}", s.counters), |(_, n)| *n)
}

/// One sensor fails by `parameter` and comes back.
fn one_fails(parameter: &str, sensor: usize, why: &str, count: &str) {
    let bus = adapter();
    let mut daemon = Daemon::start(&config(&bus.path));
    let mut eye = Eye::on(&daemon);
    let fault = format!("sensor-lost:{}", NAMES[sensor]);
    // Short, and long enough for the chip to be opened anew.
    for (round, lasts) in [(1, Duration::from_millis(50)), (2, Duration::from_secs(2))] {
        let before = counter(&eye.0.status().unwrap().sensors[sensor], count);
        let cause = Watch::start();
        bus.module.set(parameter, &format!("{:#04x}", ADDRESSES[sensor]));
        let seen = logged(&daemon, cause, &format!("{fault}: {why}, "), round);
        let status = eye.until(&fault, |s| has(s, &fault, why));
        assert_eq!((status.mode.as_str(), status.pitch_deg), ("faulted", None), "no pair along, no attitude");
        assert_eq!(status.sensors[sensor].state, why);
        std::thread::sleep(lasts);
        let end = Watch::start();
        bus.module.set(parameter, "0");
        let over = logged(&daemon, end, &format!("{fault} is over"), round);
        let status = eye.until("all is well again", well);
        println!("{fault} ({why}, {lasts:?}): told after {seen}, over {over} after its cause");
        assert!(seen.within(seconds(0.2)) && over.within(seconds(0.5)), "{seen}, {over}");
        assert!(counter(&status.sensors[sensor], count) >= before + 5);
        for other in (0..6).filter(|i| *i != sensor) {
            assert_eq!(counter(&status.sensors[other], count), 0, "{} is not to blame", NAMES[other]);
        }
    }
    assert!(daemon.is_running());
}

#[test]
fn a_wrong_pec_is_told_and_passes() {
    one_fails("bad_pec", 0, "PEC mismatch", "bad-pec");
}

#[test]
fn a_sensor_that_does_not_answer_is_told_and_passes() {
    one_fails("nak", 1, "no answer", "no-answer");
}

#[test]
fn a_held_bus_is_told_and_passes() {
    let bus = adapter();
    let daemon = Daemon::start(&config(&bus.path));
    let mut eye = Eye::on(&daemon);
    let down = format!("bus-down:{}", bus.path);
    let cause = Watch::start();
    bus.module.set("held", "1");
    let seen = logged(&daemon, cause, &format!("{down}: bus held"), 1);
    let status = eye.until("withheld", |s| has(s, &down, "bus held") && s.mode == "faulted");
    assert_eq!((status.roll_deg, status.pitch_deg), (None, None));
    std::thread::sleep(Duration::from_secs(1));
    let end = Watch::start();
    bus.module.set("held", "0");
    let over = logged(&daemon, end, &format!("{down} is over"), 1);
    eye.until("all is well again", well);
    println!("{down} (held): told after {seen}, over {over} after its cause");
    assert!(seen.within(seconds(0.5)) && over.within(seconds(0.5)), "{seen}, {over}");
    assert!(daemon.said().contains("the bus is held; a chip keeps its clock or data line low"), "{}", daemon.said());
}

/// As a USB adapter is pulled out and plugged in again.
#[test]
fn an_adapter_that_goes_and_comes_back() {
    let bus = adapter();
    let mut daemon = Daemon::start(&config(&bus.path));
    let mut eye = Eye::on(&daemon);
    let down = format!("bus-down:{}", bus.path);
    for round in 1..=2 {
        // It waits until the daemon has let go.
        let mut pulled = Command::new("rmmod").arg("i2c-fault").spawn().unwrap();
        wait_for("the node goes", || (!Path::new(&bus.path).exists()).then_some(()));
        let cause = Watch::start();
        let seen = logged(&daemon, cause, &format!("{down}: bus gone"), round);
        assert!(wait_for("rmmod ends", || pulled.try_wait().unwrap()).success());
        let status = eye.until("withheld", |s| s.mode == "faulted" && has(s, &down, "bus gone"));
        assert_eq!(status.roll_deg, None);
        assert!(!Path::new(&bus.path).exists() && daemon.is_running());
        std::thread::sleep(Duration::from_millis(500));
        let list: Vec<String> = ADDRESSES.iter().map(|a| format!("{a:#04x}")).collect();
        let parameters = [format!("chip_addr={}", list.join(",")), format!("nr={}", bus.number)];
        let status = Command::new("modprobe").arg("i2c-fault").args(parameters).status().unwrap();
        assert!(status.success());
        wait_for("the node", || Path::new(&bus.path).exists().then_some(()));
        let end = Watch::start();
        fill(&bus);
        let over = logged(&daemon, end, &format!("{down} is over"), round);
        eye.until("all is well again", well);
        println!("{down} (gone, round {round}): told after {seen}, over {over} after the node was back");
        assert!(seen.within(seconds(0.3)) && over.within(seconds(1.0)), "{seen}, {over}");
    }
    let said = daemon.said();
    assert!(said.contains(&format!("{} is back", bus.path)), "{said}");
    daemon.signal(Signal::TERM);
    assert!(daemon.ended().success());
}

/// The kernel's own driver has taken the nose.
#[test]
fn a_claimed_address_is_explained_and_the_advice_works() {
    let bus = adapter();
    let mlx90614 = Module::load("mlx90614", &[]);
    let devices = format!("/sys/bus/i2c/devices/i2c-{}", bus.number);
    fs::write(format!("{devices}/new_device"), "mlx90614 0x5b").unwrap();
    let daemon = Daemon::start(&config(&bus.path));
    let mut eye = Eye(daemon.bus.client());
    eye.until("sensor-lost:nose", |s| has(s, "sensor-lost:nose", "claimed by a kernel driver"));
    let advice = format!("echo {}-005b | sudo tee /sys/bus/i2c/drivers/mlx90614/unbind", bus.number);
    assert!(daemon.said().contains(&advice), "{}", daemon.said());
    let sensors = String::from_utf8(daemon.ctl(&["sensors"]).stdout).unwrap();
    println!("{sensors}");
    assert!(sensors.contains("claimed by a kernel driver") && sensors.contains(&advice), "{sensors}");
    let end = Watch::start();
    let done = Command::new("sh").args(["-c", &advice.replace("sudo ", "")]).stdout(Stdio::null()).status().unwrap();
    assert!(done.success());
    let over = logged(&daemon, end, "sensor-lost:nose is over", 1);
    eye.until("all is well", well);
    println!("claimed: over {over} after its cause");
    assert!(over.within(seconds(1.0)), "{over}");
    drop(daemon);
    fs::write(format!("{devices}/delete_device"), "0x5b").unwrap();
    drop(mlx90614);
}

/// A daemon that is nobody, and a node for root alone, then for a group, then for all.
#[test]
fn a_node_that_may_not_be_opened_is_explained() {
    let bus = adapter();
    let mode = |mode| fs::set_permissions(&bus.path, fs::Permissions::from_mode(mode)).unwrap();
    mode(0o600);
    let folder = Folder::new();
    let binary = folder.path("irhorizond");
    fs::copy(DAEMON, &binary).unwrap();
    let start = |log: &str| {
        let file = folder.path("irhorizon.toml");
        fs::write(&file, format!("{}[dbus]\nbus = \"none\"\n", config(&bus.path))).unwrap();
        let log = fs::File::create(folder.path(log)).unwrap();
        Command::new(&binary).arg("--config").arg(&file).uid(65534).gid(65534).stderr(log).spawn().unwrap()
    };
    let says = |log: &str, text: &str| {
        wait_for(&format!("{log} says {text:?}"), || {
            fs::read_to_string(folder.path(log)).unwrap().contains(text).then_some(())
        });
    };
    let mut daemon = start("root");
    says("root", &format!("{} may not be opened by nobody, and no group may", bus.path));
    says("root", &format!("bus-down:{}: permission denied", bus.path));
    mode(0o666);
    let end = Watch::start();
    says("root", &format!("{} works again", bus.path));
    says("root", "is over");
    println!("denied: over {} after its cause", end.stop());
    let (_, _) = (daemon.kill(), daemon.wait());
    // A group of its own, as i2c-tools makes it.
    mode(0o660);
    chown(&bus.path, Some(0), Some(4)).unwrap();
    let mut daemon = start("group");
    says("group", "it is for group adm (mode 0660); join it with: sudo usermod -aG adm nobody");
    let (_, _) = (daemon.kill(), daemon.wait());
    println!("{}", fs::read_to_string(folder.path("group")).unwrap());
}

/// The nose hangs; its line is switched off and on, which wakes it; the lamp says how things are.
#[test]
fn a_hung_sensor_is_power_cycled_and_the_lamp_follows() {
    const POWER: u32 = 2;
    const LAMP: u32 = 5;
    let gpio = GpioSim::new();
    let bus = adapter();
    let power = format!("power = {{ chip = \"{}\", line = {POWER} }}\n", gpio.chip);
    let lamp = format!("[faults]\nlamp = {{ chip = \"{}\", line = {LAMP} }}\n", gpio.chip);
    let text = lamp + &config(&bus.path).replacen("0x5b\n", &format!("0x5b\n{power}"), 1);
    bus.module.set("nak", "0x5b,0x5c,0x5d,0x5e,0x5f,0x60");
    let daemon = Daemon::start(&text);
    wait_for("the lamp is lit while there is no attitude", || gpio.value(LAMP).then_some(()));
    assert!(gpio.value(POWER), "the sensors have their supply from the start");
    bus.module.set("nak", "0");
    let mut eye = Eye::on(&daemon);
    wait_for("the lamp is dark", || (!gpio.value(LAMP)).then_some(()));

    let cause = Watch::start();
    bus.module.set("nak", "0x5b");
    wait_for("the lamp is lit", || gpio.value(LAMP).then_some(()));
    let lit = cause.stop();
    wait_for("the supply is off", || (!gpio.value(POWER)).then_some(()));
    let (off, went) = (cause.stop(), Watch::start());
    wait_for("the supply is on", || gpio.value(POWER).then_some(()));
    let end = Watch::start();
    let dark = went.stop();
    bus.module.set("nak", "0");
    let over = logged(&daemon, end, "sensor-lost:nose is over", 1);
    assert!(daemon.said().contains("sensor-lost:nose: no answer, "), "{}", daemon.said());
    let status = eye.until("all is well", well);
    println!("hung: lamp after {lit}, off after {off} for {dark}, well {over} after it was on");
    assert!(
        lit.within(seconds(0.3)) && off.within(seconds(2.5)) && dark.within(seconds(0.5)) && over.within(seconds(1.0))
    );
    assert!(off.took >= seconds(1.9) && dark.took >= seconds(0.25));
    assert_eq!(counter(&status.sensors[0], "power-cycles"), 1);
    assert_eq!(counter(&status.sensors[1], "power-cycles"), 0);
    wait_for("the lamp is dark", || (!gpio.value(LAMP)).then_some(()));
}

fn sensor(bus: &Adapter, address: u8) -> Mlx90614<LinuxBus> {
    let mut bus = LinuxBus::open(Path::new(&bus.path), address).unwrap();
    assert_eq!(bus.pec(), Some(Integrity::Pec));
    bus.set_pec(true).unwrap();
    Mlx90614::new(bus)
}

#[test]
fn eeprom_cells_are_erased_written_and_verified() {
    let bus = Adapter::fault(&[0x5a, 0x5c]);
    bus.chip(0x5a).write(0x25, 0x9fb4);
    bus.module.set("eeprom", "1");
    let wait = &mut |d| std::thread::sleep(d);
    let mut chip = sensor(&bus, 0x5a);

    assert_eq!(chip.set_address(0x5b, wait), Ok(Change { from: 0xbe5a, to: 0xbe5b }), "the high byte stays");
    assert_eq!(chip.bus().read_word(0x2e), Ok(0xbe5b));
    assert_eq!(chip.set_address(0x5b, wait), Err(EepromError::Unchanged(0xbe5b)));
    for bad in [0x00, 0x02, 0x78, 0xff] {
        assert_eq!(chip.set_address(bad, wait), Err(EepromError::BadAddress(bad)));
    }
    bus.module.set("power_cycle", "1");
    assert_eq!(chip.bus().read_word(0x2e), Err(BusError::NoAnswer), "it has moved");
    let mut chip = sensor(&bus, 0x5b);
    assert_eq!(chip.bus().read_word(0x2e), Ok(0xbe5b));

    // IIR 100 % (4), FIR 128 (4): 0x9fb4 with bits 10 to 8 = 100.
    assert_eq!(chip.set_configuration(Configuration(0x9cb4), wait), Ok(Change { from: 0x9fb4, to: 0x9cb4 }));
    assert_eq!(chip.bus().read_word(0x25), Ok(0x9cb4));
    for bit in [14, 13, 12, 11, 7, 3] {
        let asked = 0x9cb4 ^ 1 << bit;
        let refused = Err(EepromError::FactoryBits { holds: 0x9cb4, asked });
        assert_eq!(chip.set_configuration(Configuration(asked), wait), refused);
    }

    // Without PEC the sensor takes nothing.
    chip.bus().set_pec(false).unwrap();
    let refused = EepromError::Refused { cell: 0x2e, holds: 0xbe5b, error: Some(BusError::NoAnswer) };
    assert_eq!(chip.set_address(0x5d, wait), Err(refused));
    chip.bus().set_pec(true).unwrap();
    assert_eq!(chip.bus().read_word(0x2e), Ok(0xbe5b));

    // Without the pauses the cell stays erased; the next attempt with them mends it.
    let hasty = chip.set_address(0x5d, &mut |_| {});
    assert!(matches!(hasty, Err(EepromError::Damaged { cell: 0x2e, held: 0xbe5b, holds: Some(0), .. })), "{hasty:?}");
    std::thread::sleep(Duration::from_millis(20));
    assert!(chip.set_address(0x5d, wait).is_ok());
    assert_eq!(chip.bus().read_word(0x2e).map(|w| w & 0xff), Ok(0x5d));

    // Nobody there.
    bus.module.set("nak", "0x5b");
    let unread = chip.set_address(0x5e, wait);
    assert_eq!(unread, Err(EepromError::Unread { cell: 0x2e, error: Some(BusError::NoAnswer) }));
}

/// Any embedded-hal I²C will do: here linux-embedded-hal's, with PEC in this process.
#[test]
fn pec_in_software_over_embedded_hal() {
    let bus = Adapter::fault(&[0x5a]);
    bus.chip(0x5a).write(0x07, word(21.5));
    let mut chip = GenericBus::new(I2cdev::new(&bus.path).unwrap(), 0x5a);
    assert_eq!(chip.pec(), Some(Integrity::SoftwarePec));
    for checked in [false, true] {
        chip.set_pec(checked).unwrap();
        assert_eq!(chip.read_word(0x07), Ok(word(21.5)));
        chip.write_word(0x10, 0xa55a ^ u16::from(checked)).unwrap();
        assert_eq!(bus.chip(0x5a).read(0x10), 0xa55a ^ u16::from(checked));
    }
    bus.module.set("bad_pec", "0x5a");
    assert_eq!(chip.read_word(0x07), Err(BusError::Pec));
    bus.module.set("bad_pec", "0");
    assert_eq!(chip.read_word(0x07), Ok(word(21.5)));
    bus.module.set("nak", "0x5a");
    assert_eq!(chip.read_word(0x07), Err(BusError::NoAnswer));
    assert_eq!(chip.write_word(0x07, 0), Err(BusError::NoAnswer));
    bus.module.set("nak", "0");
    // Cells that are EEPROM take no write without its PEC.
    bus.module.set("eeprom", "1");
    chip.write_word(0x2e, 0).unwrap();
    chip.set_pec(false).unwrap();
    assert_eq!(chip.write_word(0x2e, 0xbe5b), Err(BusError::NoAnswer));
}
