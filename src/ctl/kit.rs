//! What the commands are given: the daemon, the configuration, the pipeline. Tests give their own.

use super::view::Status;
use crate::attitude::Estimate;
use crate::config::Settings;
use crate::config::settings::BusAddress;
use crate::frame::Frame;
use crate::head::Head;
use std::error::Error;
use std::os::fd::OwnedFd;
use std::path::{Path, PathBuf};

/// Why a part could not do what it was asked; its chain of sources is shown to the user.
pub type Cause = Box<dyn Error + Send + Sync>;

/// Why the daemon gave no answer; the cause says what the user can do.
#[derive(Debug)]
pub enum DaemonError {
    /// There is none on the bus, or no bus.
    Absent(Cause),
    /// It is there and refuses, or answers nonsense.
    Refused(Cause),
}

/// The daemon as a client sees it. Calls are bounded in time.
pub trait Daemon {
    /// Its state now.
    fn status(&mut self) -> Result<Status, DaemonError>;

    /// A packet socket on which it sends a recording's header and then a row for each frame.
    fn frames(&mut self) -> Result<OwnedFd, DaemonError>;

    /// Makes it read its configuration again.
    fn reload(&mut self) -> Result<(), DaemonError>;
}

/// A configuration that has been read and found good.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// What it says.
    pub settings: Settings,
    /// The files it was read from, in order.
    pub files: Vec<PathBuf>,
    /// What is allowed and yet unlikely to be meant.
    pub warnings: Vec<String>,
    /// All of it as one TOML text.
    pub text: String,
}

/// The daemon's own way from a frame to an estimate.
pub type Pipeline = Box<dyn FnMut(&Frame, &mut Estimate)>;

/// The parts.
#[derive(Clone, Copy, Debug)]
pub struct Kit {
    /// Speaks to the daemon on a bus.
    pub connect: fn(&BusAddress) -> Result<Box<dyn Daemon>, DaemonError>,
    /// Reads a configuration file with its drop-ins, strictly.
    pub load: fn(&Path) -> Result<Loaded, Cause>,
    /// Reads a configuration for a replay: it may have no sensors.
    pub load_for_replay: fn(&Path) -> Result<Settings, Cause>,
    /// Reads the configuration that a recording carries.
    pub parse: fn(&str) -> Result<Settings, Cause>,
    /// The settings of an empty configuration.
    pub defaults: fn() -> Result<Settings, Cause>,
    /// Builds the pipeline.
    pub pipeline: fn(&Settings, &Head) -> Pipeline,
}

impl Kit {
    /// The real parts. SEAM: each of these is fitted to its room when that room is there.
    pub const REAL: Self = Self {
        connect: |_| Err(DaemonError::Absent("this build has no D-Bus client".into())),
        load: |_| Err("this build reads no configuration".into()),
        load_for_replay: |_| Err("this build reads no configuration".into()),
        parse: |_| Err("this build reads no configuration".into()),
        defaults: || Err("this build has no default configuration".into()),
        pipeline: |_, _| Box::new(|_, _| {}),
    };
}
