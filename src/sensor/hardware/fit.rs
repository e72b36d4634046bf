//! The source from the configuration.

use super::{Fitted, HardwareSource, System};
use crate::bus::WordBus;
use crate::bus::explain::Place;
use crate::bus::linux::LinuxBus;
use crate::config::settings::{Ads1115Settings, DeviceSettings, LineSettings, Mlx90614Settings, Settings};
use crate::gpio::Switch;
use crate::gpio::output::PlugInLine;
use crate::head::Head;
use crate::sensor::Chip;
use crate::sensor::ads1115::Ads1115Chip;
use crate::sensor::mlx90614::Mlx90614Chip;
use crate::sensor::schedule::{ChipPlan, DoesNotFit, Schedule};
use std::fmt;
use std::path::Path;

/// Why the configured hardware cannot be read as configured.
#[derive(Debug)]
pub enum OpenError {
    /// The sensors do not fit into a period.
    Schedule(DoesNotFit),
    /// Sensors that share an address cannot.
    Chip {
        /// Their names.
        names: String,
        /// Why.
        why: String,
    },
}

impl fmt::Display for OpenError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Schedule(e) => e.fmt(f),
            Self::Chip { names, why } => write!(f, "{names}: {why}"),
        }
    }
}

impl std::error::Error for OpenError {}

impl HardwareSource {
    /// What [`open`](Self::open) would answer; nothing is read, switched or taken.
    pub fn check(settings: &Settings, head: &Head) -> Result<(), OpenError> {
        fit(settings, head).map(drop)
    }

    /// The source of the configured sensors. Nothing need be plugged in: what is absent is missing
    /// from the frames until it is there.
    pub fn open(settings: &Settings, head: &Head) -> Result<Self, OpenError> {
        let (schedule, fitted) = fit(settings, head)?;
        log::info!("{schedule}");
        let mut known_lines: Vec<&LineSettings> = Vec::new();
        let mut lines: Vec<Box<dyn Switch>> = Vec::new();
        let mut chips = Vec::new();
        for (index, (plan, chip)) in schedule.chips.iter().zip(fitted).enumerate() {
            let name = schedule.chip_name(index);
            let sensors: Vec<_> = plan.sensors.iter().map(|s| &settings.sensors[*s]).collect();
            let power = sensors.iter().find_map(|s| s.power.as_ref()).map(|line| {
                if let Some(index) = known_lines.iter().position(|known| *known == line) {
                    return index;
                }
                let mut switch = PlugInLine::new(line);
                if let Err(e) = switch.set(true) {
                    log::error!("switching the supply of {name} on: {e}; tried again while the sensors are silent");
                }
                lines.push(Box::new(switch));
                known_lines.push(line);
                known_lines.len() - 1
            });
            let kind = match sensors.first().map(|s| &s.device) {
                Some(DeviceSettings::Ads1115(_)) => "ADS1115",
                _ => "MLX90614",
            };
            let bus = head.buses.get(plan.bus).map(Into::into).unwrap_or_default();
            chips.push(Fitted { chip, place: Place { name, chip: kind, bus, address: plan.address }, power });
        }
        Ok(Self::on(System { announce, ..System::real() }, schedule, chips, lines))
    }
}

/// One line in the log for a bus that is there.
fn announce(bus: &str) {
    // What keeps it from being opened is said when its chips are.
    if let Ok(functions) = LinuxBus::functions_of(Path::new(bus)) {
        log::info!("{bus}: {functions}");
    }
}

/// When the sensors are read, and the chip of each plan in it.
fn fit(settings: &Settings, head: &Head) -> Result<(Schedule, Vec<Box<dyn Chip>>), OpenError> {
    let schedule =
        Schedule::plan(&settings.sensors, head, settings.rate_hz, settings.quiet).map_err(OpenError::Schedule)?;
    let chip = |(index, plan): (usize, &ChipPlan)| {
        let devices: Vec<&DeviceSettings> = plan.sensors.iter().map(|s| &settings.sensors[*s].device).collect();
        let names = schedule.chip_name(index);
        chip(&names, &devices).map_err(|why| OpenError::Chip { names, why })
    };
    let chips = schedule.chips.iter().enumerate().map(chip).collect::<Result<_, _>>()?;
    Ok((schedule, chips))
}

/// The chip that `devices` share.
fn chip(name: &str, devices: &[&DeviceSettings]) -> Result<Box<dyn Chip>, String> {
    let mlx: Vec<&Mlx90614Settings> =
        devices.iter().filter_map(|d| if let DeviceSettings::Mlx90614(m) = d { Some(m) } else { None }).collect();
    let ads: Vec<&Ads1115Settings> =
        devices.iter().filter_map(|d| if let DeviceSettings::Ads1115(a) = d { Some(a) } else { None }).collect();
    match (mlx.as_slice(), ads.as_slice()) {
        (mlx, []) => Mlx90614Chip::from_settings(name, mlx)
            .map(|c| Box::new(c) as Box<dyn Chip>)
            .ok_or_else(|| "an MLX90614 has an object 1 and an object 2; set object to one of them".to_owned()),
        ([], ads) => {
            let (bus, address) = (devices[0].bus().clone(), devices[0].address());
            let open_bus = Box::new(move || Ok(Box::new(LinuxBus::open(&bus, address)?) as Box<dyn WordBus>));
            let chip = Ads1115Chip::from_settings(ads, open_bus).map_err(|e| e.to_string())?;
            Ok(Box::new(chip))
        }
        _ => Err("an MLX90614 and an ADS1115 cannot share an address on one bus; change one of them".to_owned()),
    }
}
