//! All that findings are made of, as plain data.

use crate::bus::{BusError, Functions, explain};
use crate::config::Loaded;
use crate::config::settings::{BusAddress, LineSettings};
use crate::ctl::view::{Sensor, Status};
use std::path::PathBuf;

/// What was found out.
#[derive(Clone, Debug)]
pub struct Facts {
    /// The configuration file.
    pub file: PathBuf,
    /// What it says, or what is wrong with it.
    pub configuration: Result<Loaded, String>,
    /// The D-Bus bus that was asked.
    pub asked: BusAddress,
    /// What the daemon says.
    pub daemon: Result<Status, Silence>,
    /// The process of a daemon that runs, whether it answers or not.
    pub process: Option<u32>,
    /// Where the policy of the system bus for the daemon's name is installed.
    pub policy: Option<PathBuf>,
    /// The unit, where systemd is.
    pub service: Option<Service>,
    /// The device files that the configuration names.
    pub nodes: Vec<Node>,
    /// What the adapters can do, by their device file.
    pub adapters: Vec<(String, Result<Functions, BusError>)>,
    /// The sensors, by the daemon or read directly; empty when nobody could tell.
    pub sensors: Vec<Seen>,
    /// The GPIO lines that the configuration names.
    pub lines: Vec<Line>,
    /// How late this process was woken, where no daemon tells its rate.
    pub lateness: Option<Lateness>,
}

impl Facts {
    /// Whether the sensors are the daemon's: it runs and answers.
    pub fn by_daemon(&self) -> bool {
        self.daemon.is_ok()
    }

    /// Why the hardware was left alone, when it was.
    pub fn hands_off(&self) -> Option<String> {
        match (&self.daemon, self.process) {
            (Err(_), Some(pid)) => Some(format!("left alone: an irhorizond (pid {pid}) is using it")),
            _ if self.simulated() => Some("the flight is simulated".to_owned()),
            (Err(_), None) if self.configuration.is_err() => {
                Some("without a configuration nothing is known".to_owned())
            }
            _ => None,
        }
    }

    /// Whether there is no hardware at all.
    pub fn simulated(&self) -> bool {
        match &self.daemon {
            Ok(status) => status.sensors.iter().any(|s| s.kind == "simulated"),
            Err(_) => self.configuration.as_ref().is_ok_and(|l| l.settings.simulation.is_some()),
        }
    }
}

/// Why the daemon says nothing, and what to do about it, as the error tells it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Silence {
    /// Nobody owns its name, or there is no bus.
    Absent(String),
    /// It refuses, or answers nonsense.
    Refused(String),
}

/// A systemd unit.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Service {
    /// `loaded`, `not-found`, …
    pub load: String,
    /// `active`, `inactive`, `failed`, …
    pub active: String,
    /// Why it ended, `success` or not.
    pub result: String,
    /// How often systemd has started it again.
    pub restarts: u32,
}

/// A device file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Node {
    /// `/dev/i2c-1`.
    pub path: String,
    /// Whether it is there.
    pub present: bool,
    /// Whether this user may read and write it.
    pub allowed: bool,
    /// Its group, and its mode.
    pub group: Option<(String, u32)>,
    /// Who asks.
    pub user: String,
    /// Whether the user is in that group by /etc/group, whatever this session was begun with.
    pub member: bool,
}

/// A sensor with what the system knows of its address.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Seen {
    /// The sensor.
    pub sensor: Sensor,
    /// The system.
    pub system: explain::Facts,
}

/// A GPIO line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Line {
    /// What it is for: `data-ready of long`.
    pub purpose: String,
    /// Which.
    pub settings: LineSettings,
    /// Who uses it, if anybody does; or why it cannot be had.
    pub used_by: Result<Option<String>, String>,
}

/// How late a process was woken at the configured rate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lateness {
    /// How often it waited.
    pub waits: u32,
    /// On the mean, ms.
    pub mean_ms: f64,
    /// At most, ms.
    pub most_ms: f64,
}
