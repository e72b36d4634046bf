//! How the facts are come by. No bus is touched while a daemon runs.

use super::facts::{Facts, Lateness, Line, Seen, Silence};
use super::system;
use crate::bus::BusError;
use crate::bus::explain;
use crate::bus::linux::LinuxBus;
use crate::clock;
use crate::config::settings::{BusAddress, DeviceSettings, LineSettings, Settings};
use crate::ctl::error::chain;
use crate::ctl::kit::{DaemonError, Kit};
use crate::ctl::view::Sensor;
use crate::frame::{Missing, Value};
use crate::gpio::lines;
use crate::sensor::Chip;
use crate::sensor::ads1115::registers;
use crate::sensor::mlx90614::Mlx90614Chip;
use crate::sensor::schedule;
use crate::source::Integrity;
use std::collections::BTreeSet;
use std::path::Path;
use std::time::Duration;

/// As often is a sensor read.
const READS: usize = 10;
/// As often is a tick waited for, at most, and for how long all of them together.
const WAITS: u32 = 50;
const WAIT_FOR: Duration = Duration::from_millis(800);

/// Looks at everything.
pub fn gather(file: &Path, asked: &BusAddress, kit: &Kit) -> Facts {
    let root = Path::new("/");
    let configuration = (kit.load)(file).map_err(|e| e.to_string());
    let daemon = (kit.connect)(asked).and_then(|mut daemon| daemon.status()).map_err(|e| match e {
        DaemonError::Absent(why) => Silence::Absent(chain(why.as_ref())),
        DaemonError::Silent(why) | DaemonError::Refused(why) => Silence::Refused(chain(why.as_ref())),
    });
    let mut facts = Facts {
        file: file.to_owned(),
        configuration,
        asked: asked.clone(),
        daemon,
        process: (kit.daemon_process)(),
        policy: system::policy(root),
        service: system::service(root),
        nodes: Vec::new(),
        adapters: Vec::new(),
        sensors: Vec::new(),
        lines: Vec::new(),
        lateness: None,
    };
    let settings = facts.configuration.as_ref().ok().map(|l| l.settings.clone());
    if facts.daemon.is_err() {
        facts.lateness = settings.as_ref().map(|s| lateness(s.rate_hz));
    }
    if facts.hands_off().is_none() {
        look_at_hardware(&mut facts, settings.as_ref());
    }
    facts
}

fn look_at_hardware(facts: &mut Facts, settings: Option<&Settings>) {
    let root = Path::new("/");
    let sensors: Vec<Sensor> = match (&facts.daemon, settings) {
        (Ok(status), _) => status.sensors.clone(),
        (Err(_), Some(settings)) => read(settings),
        (Err(_), None) => Vec::new(),
    };
    let buses: BTreeSet<String> = sensors.iter().map(|s| s.bus.clone()).filter(|b| !b.is_empty()).collect();
    let serial = facts.configuration.as_ref().map(|l| system::serial_ports(&l.text)).unwrap_or_default();
    facts.nodes = buses.iter().chain(&serial).map(|path| system::node(root, path)).collect();
    // Asks the adapter, not what is on it.
    facts.adapters = buses.iter().map(|bus| (bus.clone(), LinuxBus::functions_of(Path::new(bus)))).collect();
    let seen =
        |sensor: Sensor| Seen { system: explain::Facts::gather(root, Path::new(&sensor.bus), sensor.address), sensor };
    facts.sensors = sensors.into_iter().map(seen).collect();
    facts.lines = settings.map(used_lines).unwrap_or_default().into_iter().map(look_at_line).collect();
}

/// The configured sensors, read directly: nothing is written to any of them.
fn read(settings: &Settings) -> Vec<Sensor> {
    let head = settings.head();
    let mut sensors: Vec<Sensor> = settings
        .sensors
        .iter()
        .map(|s| Sensor {
            name: s.name.clone(),
            kind: if matches!(s.device, DeviceSettings::Ads1115(_)) { "ads1115" } else { "mlx90614" }.to_owned(),
            bus: s.device.bus().to_string_lossy().into_owned(),
            address: s.device.address(),
            direction: s.direction.to_string(),
            state: Missing::NotYet.to_string(),
            ..Sensor::default()
        })
        .collect();
    for plan in schedule::chips(&settings.sensors, &head) {
        let devices: Vec<&DeviceSettings> = plan.sensors.iter().map(|s| &settings.sensors[*s].device).collect();
        let mlx: Vec<_> =
            devices.iter().filter_map(|d| if let DeviceSettings::Mlx90614(m) = d { Some(m) } else { None }).collect();
        let Some(first) = plan.sensors.first() else { continue };
        if let Some(mut chip) =
            Mlx90614Chip::from_settings(&sensors[*first].name.clone(), &mlx).filter(|_| !mlx.is_empty())
        {
            read_mlx(&mut chip, &plan.sensors, settings.quiet, &mut sensors);
        } else {
            let state = read_ads(&sensors[*first]).err().map_or("ok".to_owned(), |e| e.missing().to_string());
            for index in &plan.sensors {
                sensors[*index].state.clone_from(&state);
                sensors[*index].integrity = Integrity::SensorWithout.as_str().to_owned();
            }
        }
    }
    sensors
}

/// Reads a chip some times; `slots` are its sensors' places in `sensors`.
fn read_mlx(chip: &mut dyn Chip, slots: &[usize], quiet: Duration, sensors: &mut [Sensor]) {
    let opened = chip.open();
    for (slot, index) in slots.iter().enumerate() {
        let sensor = &mut sensors[*index];
        let mut reading = opened.map_err(BusError::missing).and_then(|()| chip.read(slot));
        for _ in 1..if opened.is_ok() { READS } else { 1 } {
            std::thread::sleep(quiet);
            reading = chip.read(slot);
        }
        match reading.map(|sample| sample.value) {
            Ok(Value::Absolute { object_c, ambient_c }) => {
                (sensor.object_c, sensor.ambient_c) = (Some(object_c), ambient_c);
                sensor.state = "ok".to_owned();
            }
            Ok(Value::Volts(volts)) => sensor.volts = Some(volts),
            Err(why) => sensor.state = why.to_string(),
        }
        let health = chip.health(slot);
        sensor.integrity = health.integrity.as_str().to_owned();
        sensor.settling_s = health.settling_s;
        sensor.emissivity = health.emissivity;
        sensor.identity = health.identity.map_or(String::new(), |id| format!("{id:016x}"));
        sensor.counters = health.counters.named().map(|(name, count)| (name.to_owned(), count)).into();
    }
}

/// Whether an ADS1115 answers: its config register is read, and no conversion begun.
fn read_ads(sensor: &Sensor) -> Result<(), BusError> {
    use crate::bus::WordBus;
    LinuxBus::open(Path::new(&sensor.bus), sensor.address)?.read_word(registers::CONFIG).map(drop)
}

/// Every GPIO line that the configuration names, with what it is for.
fn used_lines(settings: &Settings) -> Vec<(String, LineSettings)> {
    let mut used: Vec<(String, LineSettings)> = Vec::new();
    let mut add = |purpose: String, line: Option<&LineSettings>| {
        if let Some(line) = line.filter(|l| !used.iter().any(|(_, known)| known == *l)) {
            used.push((purpose, line.clone()));
        }
    };
    for s in &settings.sensors {
        add(format!("power of {}", s.name), s.power.as_ref());
        if let DeviceSettings::Ads1115(ads) = &s.device {
            add(format!("data-ready of {}", s.name), ads.data_ready.as_ref());
        }
    }
    add("lamp".to_owned(), settings.faults.lamp.as_ref());
    used
}

fn look_at_line((purpose, settings): (String, LineSettings)) -> Line {
    let used_by = lines::find(&settings).map_err(|e| e.to_string()).and_then(|line| {
        let info = line.info().map_err(|e| format!("it cannot be looked at: {e}"))?;
        Ok(info.is_kernel().then(|| info.consumer().unwrap_or("the kernel").to_owned()))
    });
    Line { purpose, settings, used_by }
}

/// Waits as the sampling loop does, and reads nothing.
fn lateness(rate_hz: f64) -> Lateness {
    let period = Duration::from_secs_f64(1.0 / rate_hz);
    let waits = ((WAIT_FOR.as_secs_f64() * rate_hz) as u32).clamp(1, WAITS);
    let mut due = clock::now();
    let mut late = Lateness { waits, ..Lateness::default() };
    for _ in 0..waits {
        due = due + period;
        clock::sleep_until(due);
        let now = clock::now();
        let ms = now.since(due) * 1e3;
        late.mean_ms += ms / f64::from(waits);
        late.most_ms = late.most_ms.max(ms);
        due = due.max(now);
    }
    late
}
