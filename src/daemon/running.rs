//! The parts at work, and how a new configuration gets into them.

use super::control::{self, Desk};
use super::kept::Kept;
use super::sampling::{Retune, Sampling};
use super::source;
use crate::aiding::Inbox;
use crate::config::changes;
use crate::config::{Loaded, Settings};
use crate::dbus::{self, DbusError, Service};
use crate::gpio::lamp::Lamp;
use crate::gpio::output::PlugInLine;
use crate::horizon::Horizon;
use crate::mavlink::publisher::Publisher;
use crate::mavlink::switchboard::Switchboard;
use crate::recording::{Taps, Writer};
use crate::state::Shared;
use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::sync_channel;
use std::sync::{Arc, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// How long the parts have to end in good order; what hangs on a held bus is left behind.
const END_WITHIN: Duration = Duration::from_millis(400);

/// How long the first frame may take before the daemon is called ready without it.
const FIRST_FRAME: Duration = Duration::from_secs(5);

/// How long the first connection to D-Bus may take before it goes on in the background.
const FIRST_CONNECTION: Duration = Duration::from_secs(2);

/// Why the daemon did not start, or a new configuration was not taken up.
#[derive(Debug)]
pub enum StartError {
    /// The configuration is sound but cannot be done.
    Configuration(String),
    /// The D-Bus name cannot be had.
    Dbus(DbusError),
    /// The system gave no thread.
    Thread(std::io::Error),
    /// The system gave no socket.
    Frames(std::io::Error),
}

impl StartError {
    /// Whether the configuration must be changed.
    pub const fn is_configuration(&self) -> bool {
        matches!(self, Self::Configuration(_))
    }
}

impl fmt::Display for StartError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Configuration(text) => f.write_str(text),
            Self::Dbus(e) => e.fmt(f),
            Self::Thread(e) => write!(f, "cannot start a thread: {e}"),
            Self::Frames(e) => write!(f, "cannot make a socket for frames: {e}"),
        }
    }
}

impl std::error::Error for StartError {}

/// A sampling loop at work.
struct Loop {
    stop: Arc<AtomicBool>,
    retune: Retune,
    thread: JoinHandle<()>,
}

/// The daemon at work.
pub struct Running {
    settings: Settings,
    kept: Kept,
    shared: Arc<Shared>,
    taps: Arc<Taps>,
    /// What the autopilot says, on its way to the sampling loop.
    inbox: Arc<Inbox>,
    mavlink: Arc<Switchboard>,
    publisher: Arc<Publisher>,
    desk: Arc<Desk>,
    sampling: Option<Loop>,
    publishers: Vec<JoinHandle<()>>,
}

impl Running {
    /// Starts everything.
    pub fn start(loaded: Loaded, kept: Kept) -> Result<Self, StartError> {
        let settings = &loaded.settings;
        let shared = Arc::new(Shared::default());
        let taps = Arc::new(Taps::new(&header(&loaded)));
        let inbox = Arc::new(Inbox::default());
        let mavlink = Arc::new(Switchboard::new(settings.clone(), Arc::clone(&inbox), control::hang_up));
        let desk = Arc::new(Desk::new(&loaded, Arc::clone(&mavlink)));
        let mut publishers = Vec::new();
        if let Some(bus) = settings.dbus.bus.clone() {
            let (first, outcome) = sync_channel(1);
            let control = Arc::clone(&desk) as Arc<dyn dbus::Control>;
            let service = Service { bus, shared: Arc::clone(&shared), taps: Arc::clone(&taps), control };
            publishers.push(spawn("dbus", move || dbus::run(&service, first))?);
            match outcome.recv_timeout(FIRST_CONNECTION) {
                Ok(Err(e)) if e.fatal() => return Err(StartError::Dbus(e)),
                _ => {}
            }
        }
        log::info!(
            "irhorizond {}: {} sensors at {} Hz, method {}",
            env!("CARGO_PKG_VERSION"),
            settings.head().sensors.len(),
            settings.rate_hz,
            settings.method().as_str()
        );
        // Not before it is known that no other daemon is there, whose signing time it would move on.
        let publisher = Arc::new(Publisher::new(&mavlink));
        let sampling = Some(sample(settings, None, &shared, &taps, &inbox, &publisher)?);
        {
            let (publisher, shared, mavlink) = (Arc::clone(&publisher), Arc::clone(&shared), Arc::clone(&mavlink));
            publishers.push(spawn("mavlink", move || publisher.run(&shared, &mavlink))?);
        }
        let settings = loaded.settings;
        Ok(Self { settings, kept, shared, taps, inbox, mavlink, publisher, desk, sampling, publishers })
    }

    /// Does `ready` with the first frame, or after a while without one.
    pub fn when_ready(&self, ready: impl FnOnce() + Send + 'static) -> Result<(), StartError> {
        let shared = Arc::clone(&self.shared);
        let wait = move || {
            drop(shared.wait_beyond(0, FIRST_FRAME));
            ready();
        };
        spawn("ready", wait).map(drop)
    }

    /// Takes up the configuration as it is written now, with what was changed by MAVLink; one that is not good changes
    /// nothing.
    pub fn reload(&mut self) {
        Arc::clone(&self.desk).answer(|| self.read_anew());
    }

    fn read_anew(&mut self) -> Result<(), String> {
        let changes = self.mavlink.take_changes();
        changes.iter().for_each(|c| log::info!("set by MAVLink: {c}"));
        let before = (!changes.is_empty()).then(|| self.kept.keep(&changes));
        let outcome = match self.kept.load() {
            Ok(loaded) => self.take_up(loaded).map_err(|e| e.to_string()),
            Err(errors) => Err(errors.to_string()),
        };
        // What is refused must not come into force at some later start.
        let trouble = match before {
            Some(before) if outcome.is_err() => {
                self.kept.put(before);
                Some("settings refused: see the log")
            }
            Some(_) if !self.kept.is_written() => Some("set until restart: cannot be saved"),
            _ => None,
        };
        self.mavlink.settle(trouble);
        self.shared.update(|s| s.generation += 1);
        match &outcome {
            Ok(()) => log::info!("configuration reloaded"),
            Err(e) => log::error!("the new configuration is refused, the old one stays in force:\n{e}"),
        }
        outcome
    }

    fn take_up(&mut self, loaded: Loaded) -> Result<(), StartError> {
        let changed = changes(&self.settings, &loaded.settings);
        let new = &loaded.settings;
        for change in changed.iter().filter(|c| c.needs_restart()) {
            log::warn!("{} has changed: that takes effect when irhorizond is restarted", change.as_str());
        }
        if changed.iter().any(|c| c.begins_anew()) {
            // While the old loop still goes on.
            source::check(new, &new.head()).map_err(StartError::Configuration)?;
            // The old loop must let go of buses and lines before the new one can have them.
            self.end_sampling();
            match self.sample(new, Some(&header(&loaded))) {
                Ok(sampling) => self.sampling = Some(sampling),
                Err(e) => {
                    self.sampling = Some(self.sample(&self.settings, None)?);
                    return Err(e);
                }
            }
        } else if let Some(Loop { retune, .. }) = &self.sampling {
            self.taps.describe(&header(&loaded));
            *retune.lock().unwrap_or_else(PoisonError::into_inner) = Some(Box::new(new.clone()));
        }
        self.mavlink.configure(new.clone());
        self.desk.configure(&loaded);
        // The bus in use stays the one that another is compared with.
        let bus = self.settings.dbus.bus.take();
        self.settings = loaded.settings;
        self.settings.dbus.bus = bus;
        Ok(())
    }

    fn sample(&self, settings: &Settings, header: Option<&str>) -> Result<Loop, StartError> {
        sample(settings, header, &self.shared, &self.taps, &self.inbox, &self.publisher)
    }

    fn end_sampling(&mut self) {
        if let Some(Loop { stop, thread, .. }) = self.sampling.take() {
            stop.store(true, Ordering::Relaxed);
            let _ = thread.join();
        }
    }

    /// Ends everything in good order, or leaves behind what hangs.
    pub fn stop(mut self) {
        let deadline = Instant::now() + END_WITHIN;
        self.shared.update(|s| s.stopping = true);
        if let Some(Loop { stop, thread, .. }) = self.sampling.take() {
            stop.store(true, Ordering::Relaxed);
            self.publishers.push(thread);
        }
        for thread in self.publishers {
            while !thread.is_finished() && Instant::now() < deadline {
                thread::sleep(Duration::from_millis(5));
            }
            if !thread.is_finished() {
                log::warn!("{} hangs and is left behind", thread.thread().name().unwrap_or("a thread"));
            }
        }
        log::info!("stopped");
    }
}

pub(super) fn spawn(name: &str, body: impl FnOnce() + Send + 'static) -> Result<JoinHandle<()>, StartError> {
    // Small stacks: none of the loops is deep.
    thread::Builder::new().name(name.to_owned()).stack_size(512 * 1024).spawn(body).map_err(StartError::Thread)
}

/// What a recording of frames begins with.
pub(super) fn header(loaded: &Loaded) -> String {
    Writer::new(&loaded.settings.head(), &loaded.text).header().to_owned()
}

/// Starts a sampling loop; its frames begin with `header`, or with the one that the taps have.
fn sample(
    settings: &Settings,
    header: Option<&str>,
    shared: &Arc<Shared>,
    taps: &Arc<Taps>,
    inbox: &Arc<Inbox>,
    publisher: &Arc<Publisher>,
) -> Result<Loop, StartError> {
    let head = settings.head();
    let source = source::open(settings, &head).map_err(StartError::Configuration)?;
    let horizon = Horizon::new(settings, head.clone());
    let lamp = settings.faults.lamp.as_ref().map(|line| Lamp::new(PlugInLine::new(line)));
    let stop = Arc::new(AtomicBool::new(false));
    let retune = Retune::default();
    let sampling = Sampling::new(head, source, horizon, Arc::clone(shared), Arc::clone(taps), lamp)
        .with_inbox(Arc::clone(inbox))
        .with_publisher(Arc::clone(publisher))
        .with_retune(Arc::clone(&retune));
    let (rate_hz, flag) = (settings.rate_hz, Arc::clone(&stop));
    header.into_iter().for_each(|header| taps.begin(header));
    let thread = spawn("sampling", move || sampling.run(rate_hz, &flag))?;
    Ok(Loop { stop, retune, thread })
}
