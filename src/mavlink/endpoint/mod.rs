//! Endpoints. None of this ever blocks, and no failure is the end: what cannot be had or is of no use any more is
//! tried again.
//!
//! - [`udp`]: datagrams to one host, or to whoever is heard.
//! - [`tcp_client`], [`tcp_server`]: connections made, and taken.
//! - [`serial`]: a tty.
//! - [`stream`]: what the last three have in common; [`queue`]: what waits for them.
//! - [`watch`]: waiting for all of them at once; [`budget`]: how much one of them is given at a time.
//! - [`stats`]: what they have done, and how they are.

pub mod budget;
pub mod queue;
pub mod serial;
pub mod stats;
pub mod stream;
pub mod tcp_client;
pub mod tcp_server;
pub mod udp;
pub mod watch;

use super::deframe::Packet;
use super::tlog::Tlog;
use super::trouble::Trouble;
use crate::config::settings::EndpointAddress;
use crate::time::Time;
use stats::{About, EndpointStats, Health};
use std::fmt::Debug;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;
use watch::Watch;

/// The time between two attempts.
const RETRY: Duration = Duration::from_secs(1);

/// The time before the first attempt to have a serial port again, which doubles with each.
const SERIAL_RETRY: Duration = Duration::from_millis(200);

/// The longest time between two of them: with the time between two looks at it still within a second.
const SERIAL_RETRY_LONGEST: Duration = Duration::from_millis(800);

/// Without a failure for so long, s, an endpoint counts as well again. Longer than the second that
/// hosts leave between two "nobody listens".
const WELL_AFTER_S: f64 = 3.0;

/// What every kind of endpoint does while it is open. An error is its end: it is opened anew.
trait Transport: Debug + Send {
    /// How many may be there to listen.
    fn peers(&self) -> usize;

    /// Its file descriptors.
    fn watch(&self, watch: &mut Watch);

    /// Sends a message, or lets it wait; whether it is for anybody. What failed is counted.
    fn send(&mut self, now: Time, message: &[u8], health: &mut Health) -> Result<bool, Trouble>;

    /// Sends what waits and takes in what has come, within bounds.
    fn receive(&mut self, now: Time, heed: &mut dyn FnMut(&Packet<'_>), health: &mut Health) -> Result<(), Trouble>;

    /// What is to be done now and then; whether messages can be sent, if anybody is there.
    fn tend(&mut self, now: Time, health: &mut Health) -> Result<bool, Trouble>;
}

/// One place that messages go to and come from.
#[derive(Debug)]
pub struct Endpoint {
    address: EndpointAddress,
    transport: Option<Box<dyn Transport>>,
    retry: Time,
    retry_after: Duration,
    health: Health,
    tlog: Option<Tlog>,
}

impl Endpoint {
    /// An endpoint that is opened by the first [`tend`](Self::tend).
    pub fn new(address: EndpointAddress) -> Self {
        let stats = Arc::new(EndpointStats::new(address.to_string()));
        let retry_after = first_retry(&address);
        let health = Health::new(stats);
        Self { address, transport: None, retry: Time::default(), retry_after, health, tlog: None }
    }

    /// Writes all that goes out and comes in to the tlog at `path`, or to none.
    pub fn log_to(&mut self, path: Option<&Path>) {
        if self.tlog.as_ref().map(Tlog::path) != path {
            // The old one is closed first.
            self.tlog = None;
            self.health.stats.set_error(About::Tlog, String::new());
            self.tlog = path.and_then(|path| Tlog::new(path, Arc::clone(&self.health.stats)));
        }
    }

    /// Where it goes.
    pub fn address(&self) -> &EndpointAddress {
        &self.address
    }

    /// What it has done.
    pub fn stats(&self) -> &Arc<EndpointStats> {
        &self.health.stats
    }

    /// Whether somebody may be there to listen: someone was heard or is connected, or nothing speaks against it.
    pub fn listening(&self) -> bool {
        self.peers() > 0
    }

    fn peers(&self) -> usize {
        match &self.transport {
            Some(transport) if self.health.trouble() != Some(Trouble::Refused) => transport.peers(),
            _ => 0,
        }
    }

    /// Whether it is open: messages can be sent, if anybody is there.
    pub fn is_open(&self) -> bool {
        self.transport.is_some()
    }

    /// Whether what must be [watched](Self::watch) has changed since then.
    pub fn watch_anew(&self) -> bool {
        self.health.watch_anew.get()
    }

    /// Its file descriptors.
    pub fn watch(&self, watch: &mut Watch) {
        self.health.watch_anew.set(false);
        if let Some(transport) = &self.transport {
            transport.watch(watch);
        }
    }

    /// Sends a message to everybody there, or lets it wait for those who take it slowly. Counts one for each of them;
    /// where nobody can be there it counts as failed, where nobody is there not at all. An empty one is none: what could
    /// not be signed.
    pub fn send(&mut self, now: Time, message: &[u8]) {
        if message.is_empty() {
            return;
        }
        let Some(transport) = &mut self.transport else {
            self.health.stats.failed();
            return;
        };
        match transport.send(now, message, &mut self.health) {
            Ok(false) => {}
            Ok(true) => {
                if let Some(tlog) = &self.tlog {
                    tlog.write(message);
                }
            }
            Err(trouble) => self.close(now, trouble),
        }
    }

    /// Sends what waits, takes in what has come and gives it to `heed`. For when [`watch`](Self::watch) has told that
    /// there is something.
    pub fn receive(&mut self, now: Time, mut heed: impl FnMut(&Packet<'_>)) {
        let Self { transport: Some(transport), health, tlog, .. } = self else { return };
        let stats = Arc::clone(&health.stats);
        let mut heed = |packet: &Packet<'_>| {
            stats.received();
            if let Some(tlog) = tlog {
                tlog.write(packet.bytes);
            }
            heed(packet);
        };
        if let Err(trouble) = transport.receive(now, &mut heed, health) {
            self.close(now, trouble);
        }
    }

    /// What is to be done now and then, ten times a second: opens it, forgets who is gone, notices that all is well
    /// again.
    pub fn tend(&mut self, now: Time) {
        if self.transport.is_none() && now >= self.retry {
            match open(now, &self.address) {
                Ok(transport) => self.transport = Some(transport),
                Err(trouble) => self.close(now, trouble),
            }
        }
        if let Some(transport) = &mut self.transport {
            match transport.tend(now, &mut self.health) {
                Ok(true) if self.health.well_for_s(now) >= WELL_AFTER_S => {
                    self.retry_after = first_retry(&self.address);
                    self.health.recovered(now);
                }
                Ok(_) => {}
                Err(trouble) => self.close(now, trouble),
            }
        }
        self.health.stats.set_peers(self.peers());
    }

    /// Waits until the tlog is written, until `end` at most.
    pub fn finish(&mut self, end: Time) {
        if let Some(tlog) = self.tlog.take() {
            tlog.finish(end);
        }
    }

    fn close(&mut self, now: Time, trouble: Trouble) {
        self.health.note(now, trouble);
        self.health.watch_anew.set(true);
        self.transport = None;
        self.retry = now + self.retry_after;
        if matches!(self.address, EndpointAddress::Serial { .. }) {
            self.retry_after = SERIAL_RETRY_LONGEST.min(self.retry_after * 2);
        }
    }
}

fn first_retry(address: &EndpointAddress) -> Duration {
    if matches!(address, EndpointAddress::Serial { .. }) { SERIAL_RETRY } else { RETRY }
}

fn open(now: Time, address: &EndpointAddress) -> Result<Box<dyn Transport>, Trouble> {
    Ok(match address {
        EndpointAddress::UdpOut(to) => Box::new(udp::Out::open(*to)?),
        EndpointAddress::UdpIn(at) => Box::new(udp::In::open(*at)?),
        EndpointAddress::TcpOut(to) => Box::new(tcp_client::TcpClient::open(now, *to)?),
        EndpointAddress::TcpIn(at) => Box::new(tcp_server::TcpServer::open(*at)?),
        EndpointAddress::Serial { path, baud } => Box::new(serial::Serial::open(path, *baud)?),
    })
}

#[cfg(test)]
mod kit;
