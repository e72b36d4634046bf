//! What the commands are given: the daemon, the configuration, the pipeline. Tests give their own.

use super::client::{Client, ClientError};
use super::doctor;
use super::view::Status;
use crate::attitude::Estimate;
use crate::bus::linux::LinuxBus;
use crate::bus::{BusError, PecBus};
use crate::config::settings::BusAddress;
use crate::config::{self, Loaded, Settings};
use crate::daemon::alone::Alone;
use crate::daemon::logging;
use crate::daemon::running::StartError;
use crate::frame::Frame;
use crate::head::Head;
use crate::horizon::Horizon;
use std::error::Error;
use std::io::{self, BufRead, Write};
use std::os::fd::{AsFd, OwnedFd};
use std::path::Path;
use std::time::Duration;

/// Why a part could not do what it was asked; its chain of sources is shown to the user.
pub type Cause = Box<dyn Error + Send + Sync>;

/// Why the daemon gave no answer; the cause says what the user can do.
#[derive(Debug)]
pub enum DaemonError {
    /// There is none on the bus, or no bus.
    Absent(Cause),
    /// It is there and does not answer in time.
    Silent(Cause),
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

    /// From now on waits no longer than `limit` for its state, where that is less than it would be.
    fn answer_within(&mut self, _limit: Duration) {}
}

/// The daemon's own way from a frame to an estimate.
pub type Pipeline = Box<dyn FnMut(&Frame, &mut Estimate)>;

/// Opens an address on an I²C bus.
pub type OpenBus = fn(&Path, u8) -> Result<Box<dyn PecBus>, BusError>;

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
    /// Samples without the daemon, as long as the loop is kept; gives its frames as the daemon does.
    pub sample: fn(&Loaded) -> Result<(Alone, OwnedFd), StartError>,
    /// Reaches the chips themselves.
    pub open_bus: OpenBus,
    /// The process of a daemon that runs, whether it answers or not.
    pub daemon_process: fn() -> Option<u32>,
    /// Asks the user, and gives whether the answer was yes.
    pub ask: fn(&str) -> io::Result<bool>,
    /// Waits.
    pub pause: fn(Duration),
}

impl Kit {
    /// The real parts.
    pub const REAL: Self = Self {
        connect: |bus| Ok(Box::new(Client::connect(bus)?)),
        load: |path| config::load(path).map_err(Cause::from),
        load_for_replay: |path| Ok(config::load_for_replay(path)?.settings),
        parse: |text| Ok(config::parse(&[("the recording's configuration".into(), text.to_owned())])?.settings),
        defaults: || Ok(Settings::default()),
        pipeline: |settings, head| {
            let mut horizon = Horizon::new(settings, head.clone());
            Box::new(move |frame, estimate| horizon.update(frame, &[], estimate))
        },
        sample: |loaded| {
            // What is wrong with the sensors, it says in the log.
            logging::start("irhorizonctl", log::LevelFilter::Warn);
            Alone::start(loaded)
        },
        open_bus: |bus, address| Ok(Box::new(LinuxBus::open(bus, address)?)),
        daemon_process: || doctor::daemon_process(Path::new("/")),
        ask,
        pause: std::thread::sleep,
    };
}

/// The end of the input is no.
fn ask(question: &str) -> io::Result<bool> {
    let mut err = io::stderr();
    write!(err, "{question} [y/N] ")?;
    err.flush()?;
    let mut answer = String::new();
    if io::stdin().lock().read_line(&mut answer)? == 0 {
        writeln!(err)?;
    }
    Ok(matches!(answer.trim().to_lowercase().as_str(), "y" | "yes"))
}

impl From<ClientError> for DaemonError {
    fn from(error: ClientError) -> Self {
        match error {
            e if e.no_daemon() => Self::Absent(e.into()),
            e @ ClientError::Silent(..) => Self::Silent(e.into()),
            e => Self::Refused(e.into()),
        }
    }
}

impl Daemon for Client {
    fn status(&mut self) -> Result<Status, DaemonError> {
        Ok(Client::status(self)?)
    }

    fn frames(&mut self) -> Result<OwnedFd, DaemonError> {
        let frames = Client::frames(self)?;
        frames.as_fd().try_clone_to_owned().map_err(|e| DaemonError::Refused(e.into()))
    }

    fn reload(&mut self) -> Result<(), DaemonError> {
        Ok(Client::reload(self)?)
    }

    fn answer_within(&mut self, limit: Duration) {
        Client::answer_within(self, limit);
    }
}
