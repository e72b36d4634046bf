//! UDP endpoints. None of this ever blocks, and no failure is the end: a socket that cannot be had
//! or is of no use any more is tried again every second.

use super::trouble::Trouble;
use crate::config::settings::EndpointAddress;
use crate::ctl::view;
use crate::time::Time;
use std::io::{Error, ErrorKind};
use std::net::{Ipv4Addr, Ipv6Addr, SocketAddr, UdpSocket};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// As many peers as a `udpin` endpoint serves.
const MAX_PEERS: usize = 4;

/// The silence after which a peer of a `udpin` endpoint is forgotten, s.
const PEER_SILENCE_S: f64 = 60.0;

/// The time between two attempts to get a socket.
const RETRY: Duration = Duration::from_secs(1);

/// Without a failure for so long, s, an endpoint counts as well again. Longer than the second that
/// hosts leave between two "nobody listens".
const WELL_AFTER_S: f64 = 3.0;

/// Datagrams taken in at a time, so that a flood does not hold up what goes out.
const MAX_DRAINED: usize = 64;

/// What an endpoint has done, for whoever shows it.
#[derive(Debug)]
pub struct EndpointStats {
    address: String,
    sent: AtomicU64,
    failed: AtomicU64,
    last_error: Mutex<String>,
}

impl EndpointStats {
    /// As `status` shows it.
    pub fn view(&self) -> view::Endpoint {
        view::Endpoint {
            address: self.address.clone(),
            sent: self.sent.load(Ordering::Relaxed),
            failed: self.failed.load(Ordering::Relaxed),
            last_error: self.last_error.lock().unwrap_or_else(PoisonError::into_inner).clone(),
        }
    }

    fn set_last_error(&self, text: String) {
        *self.last_error.lock().unwrap_or_else(PoisonError::into_inner) = text;
    }
}

/// Someone who was heard on a `udpin` endpoint.
#[derive(Clone, Copy, Debug)]
struct Peer {
    address: SocketAddr,
    heard: Time,
}

/// One place that messages go to.
#[derive(Debug)]
pub struct Endpoint {
    address: EndpointAddress,
    socket: Option<UdpSocket>,
    retry: Time,
    peers: Vec<Peer>,
    trouble: Option<Trouble>,
    failed: Time,
    stats: Arc<EndpointStats>,
}

impl Endpoint {
    /// An endpoint whose socket is opened by the first [`tend`](Self::tend).
    pub fn new(address: EndpointAddress) -> Self {
        let text = match &address {
            EndpointAddress::UdpOut(to) => format!("udpout:{to}"),
            EndpointAddress::UdpIn(at) => format!("udpin:{at}"),
        };
        let stats = EndpointStats {
            address: text,
            sent: AtomicU64::new(0),
            failed: AtomicU64::new(0),
            last_error: Mutex::default(),
        };
        Self {
            address,
            socket: None,
            retry: Time::default(),
            peers: Vec::with_capacity(MAX_PEERS),
            trouble: None,
            failed: Time::default(),
            stats: Arc::new(stats),
        }
    }

    /// Where it goes.
    pub fn address(&self) -> &EndpointAddress {
        &self.address
    }

    /// What it has done.
    pub fn stats(&self) -> &Arc<EndpointStats> {
        &self.stats
    }

    /// Whether somebody may be there to listen: for `udpin` someone was heard, for `udpout` nothing
    /// speaks against it.
    pub fn listening(&self) -> bool {
        self.socket.is_some()
            && match self.address {
                EndpointAddress::UdpOut(_) => self.trouble != Some(Trouble::Refused),
                EndpointAddress::UdpIn(_) => !self.peers.is_empty(),
            }
    }

    /// Sends a message, to every peer of a `udpin`. Counts one for each datagram; a `udpin` without
    /// peers counts nothing. A datagram that the other host refuses counts as sent, and as failed
    /// when that is known.
    pub fn send(&mut self, now: Time, message: &[u8]) {
        let Some(socket) = &self.socket else {
            self.stats.failed.fetch_add(1, Ordering::Relaxed);
            return;
        };
        match self.address {
            EndpointAddress::UdpOut(_) => {
                let mut result = socket.send(message);
                if result.as_ref().is_err_and(|e| e.kind() == ErrorKind::ConnectionRefused) {
                    // That was the answer to an earlier datagram; this one was not tried yet.
                    result = socket.send(message);
                    self.count(now, Err(Trouble::Refused));
                }
                let result = result.map_err(|e| Trouble::new(&e, 0));
                self.count(now, result);
                if result.is_err_and(Trouble::wants_new_socket) {
                    self.socket = None;
                    self.retry = now + RETRY;
                }
            }
            EndpointAddress::UdpIn(_) => {
                for i in 0..self.peers.len() {
                    let Some(socket) = &self.socket else { return };
                    let result = socket.send_to(message, self.peers[i].address).map_err(|e| Trouble::new(&e, 0));
                    self.count(now, result);
                }
            }
        }
    }

    /// What is to be done now and then: opens the socket, takes in what has arrived and gives it to
    /// `heed`, learns and forgets peers, notices that all is well again.
    pub fn tend(&mut self, now: Time, mut heed: impl FnMut(&[u8])) {
        if self.socket.is_none() && now >= self.retry {
            self.retry = now + RETRY;
            match open(&self.address) {
                Ok(socket) => self.socket = Some(socket),
                Err(trouble) => self.note(now, trouble),
            }
        }
        self.drain(now, &mut heed);
        self.peers.retain(|p| now.since(p.heard) < PEER_SILENCE_S);
        if self.trouble.is_some() && self.socket.is_some() && now.since(self.failed) >= WELL_AFTER_S {
            self.trouble = None;
            self.stats.set_last_error(String::new());
            log::info!("{}: sending again", self.stats.address);
        }
    }

    fn drain(&mut self, now: Time, heed: &mut impl FnMut(&[u8])) {
        let mut buffer = [0_u8; 2048];
        for _ in 0..MAX_DRAINED {
            let Some(socket) = &self.socket else { return };
            match socket.recv_from(&mut buffer) {
                Ok((length, from)) => {
                    if matches!(self.address, EndpointAddress::UdpIn(_)) {
                        self.heard(now, from);
                    }
                    heed(&buffer[..length]);
                }
                // The answer to an earlier datagram comes out of whichever call is made next.
                Err(e) if e.kind() == ErrorKind::ConnectionRefused => {
                    self.count(now, Err(Trouble::Refused));
                }
                Err(e) if e.kind() == ErrorKind::Interrupted => {}
                Err(_) => return,
            }
        }
    }

    /// Remembers a peer; the one silent for longest makes room for a fifth.
    fn heard(&mut self, now: Time, address: SocketAddr) {
        if let Some(peer) = self.peers.iter_mut().find(|p| p.address == address) {
            peer.heard = now;
            return;
        }
        if self.peers.len() >= MAX_PEERS
            && let Some(oldest) = (0..self.peers.len()).min_by_key(|i| self.peers[*i].heard)
        {
            self.peers.swap_remove(oldest);
        }
        log::info!("{}: sending to {address}", self.stats.address);
        self.peers.push(Peer { address, heard: now });
    }

    fn count(&mut self, now: Time, result: Result<usize, Trouble>) {
        match result {
            Ok(_) => {
                self.stats.sent.fetch_add(1, Ordering::Relaxed);
            }
            Err(trouble) => {
                self.stats.failed.fetch_add(1, Ordering::Relaxed);
                self.note(now, trouble);
            }
        }
    }

    /// Keeps the reason of a failure; it is logged once, not for every message.
    fn note(&mut self, now: Time, trouble: Trouble) {
        self.failed = now;
        if self.trouble != Some(trouble) {
            self.trouble = Some(trouble);
            let text = format!("{}: {trouble}", self.stats.address);
            log::warn!("{text}");
            self.stats.set_last_error(text);
        }
    }
}

/// The socket of an endpoint, non-blocking. A `udpout` is connected: the system then tells when
/// nobody listens, and nobody else is heard.
fn open(address: &EndpointAddress) -> Result<UdpSocket, Trouble> {
    let (bind, port) = match address {
        EndpointAddress::UdpOut(SocketAddr::V4(_)) => (SocketAddr::from((Ipv4Addr::UNSPECIFIED, 0)), 0),
        EndpointAddress::UdpOut(SocketAddr::V6(_)) => (SocketAddr::from((Ipv6Addr::UNSPECIFIED, 0)), 0),
        EndpointAddress::UdpIn(at) => (*at, at.port()),
    };
    let open = || -> Result<UdpSocket, Error> {
        let socket = UdpSocket::bind(bind)?;
        socket.set_nonblocking(true)?;
        if let EndpointAddress::UdpOut(to) = address {
            // Without it a subnet's broadcast address is refused; others do not mind.
            socket.set_broadcast(to.is_ipv4())?;
            socket.connect(to)?;
        }
        Ok(socket)
    };
    open().map_err(|e| Trouble::new(&e, port))
}
