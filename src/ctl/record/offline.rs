//! `record --offline`: the sensors read by this program, where no daemon reads them.

use crate::bus::explain::{Facts, Place, explain};
use crate::config::Settings;
use crate::config::settings::{BusAddress, DeviceSettings};
use crate::ctl::error::CtlError;
use crate::ctl::in_use::nobody_reads;
use crate::ctl::kit::Kit;
use crate::daemon::alone::Alone;
use std::io::Write;
use std::os::fd::OwnedFd;
use std::path::Path;

/// Frames of the head that `config` describes, as long as the loop is kept; notices go to `err`.
pub(super) fn start(
    config: &Path,
    dbus: &BusAddress,
    kit: &Kit,
    err: &mut dyn Write,
) -> Result<(Alone, OwnedFd), CtlError> {
    let loaded = (kit.load)(config).map_err(CtlError::Config)?;
    for warning in &loaded.warnings {
        let _ = writeln!(err, "warning: {warning}");
    }
    let settings = &loaded.settings;
    if settings.simulation.is_some() {
        let _ = writeln!(err, "notice: the configuration says [simulation]: a flight is made up, no sensor is read");
    } else {
        for bus in &settings.head().buses {
            nobody_reads(Path::new(bus), dbus, kit)?;
        }
        reachable(settings, kit)?;
    }
    (kit.sample)(&loaded).map_err(|e| match e.is_configuration() {
        true => CtlError::Config(e.into()),
        false => CtlError::NoFrames(e.into()),
    })
}

/// Whether anything can be read at all. What is missing beside it is missing in the rows, as with the daemon.
fn reachable(settings: &Settings, kit: &Kit) -> Result<(), CtlError> {
    let mut failures: Vec<(&Path, String)> = Vec::new();
    for sensor in &settings.sensors {
        let (bus, address) = (sensor.device.bus().as_path(), sensor.device.address());
        let Err(error) = (kit.open_bus)(bus, address) else { return Ok(()) };
        // Its neighbours on the bus would say the same.
        if failures.iter().all(|(known, _)| *known != bus) {
            let chip = match sensor.device {
                DeviceSettings::Mlx90614(_) => "MLX90614",
                DeviceSettings::Ads1115(_) => "ADS1115",
            };
            let place = Place { name: sensor.name.clone(), chip, bus: bus.to_owned(), address };
            failures.push((bus, explain(&place, error, &Facts::gather(Path::new("/"), bus, address))));
        }
    }
    let failures: Vec<String> = failures.into_iter().map(|(_, why)| why).collect();
    Err(CtlError::Unreachable(failures.join("; ")))
}
