//! Whether a daemon reads an I²C bus: it is left to it.

use super::kit::Kit;
use crate::config::settings::BusAddress;
use std::fs;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why a bus is left alone, with the next step.
#[derive(Debug, Error)]
pub enum InUse {
    /// The daemon reads the bus.
    #[error(
        "irhorizond reads {} on {}: stop it first: sudo systemctl stop irhorizond",
        .sensors.join(", "), .bus.display()
    )]
    Daemon {
        /// The bus.
        bus: PathBuf,
        /// Its sensors there.
        sensors: Vec<String>,
    },
    /// A daemon runs that does not say which bus it reads.
    #[error("an irhorizond (pid {0}) runs and may be reading the bus: stop it first, or say where to ask it: --bus")]
    Process(u32),
}

/// Refuses while a daemon reads the bus.
pub(super) fn nobody_reads(i2c_bus: &Path, dbus: &BusAddress, kit: &Kit) -> Result<(), InUse> {
    let real = |path: &Path| fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    match (kit.connect)(dbus).and_then(|mut daemon| daemon.status()) {
        Ok(status) => {
            let ours = status.sensors.iter().filter(|s| !s.bus.is_empty() && real(Path::new(&s.bus)) == real(i2c_bus));
            let sensors: Vec<String> = ours.map(|s| s.name.clone()).collect();
            let bus = i2c_bus.to_owned();
            if sensors.is_empty() { Ok(()) } else { Err(InUse::Daemon { bus, sensors }) }
        }
        // One that is not on this D-Bus bus may be on this I²C bus.
        Err(_) => (kit.daemon_process)().map_or(Ok(()), |pid| Err(InUse::Process(pid))),
    }
}
