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
        let text = address.to_string();
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
                _ => false,
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
            EndpointAddress::TcpOut(_) | EndpointAddress::TcpIn(_) | EndpointAddress::Serial { .. } => {}
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
        _ => return Err(Trouble::Other(0)),
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

#[cfg(test)]
mod tests {
    use super::*;

    const NOBODY: fn(&[u8]) = |_| {};

    fn at(secs: f64) -> Time {
        Time::from_secs_f64(1000.0 + secs)
    }

    fn receiver(address: &str) -> UdpSocket {
        let socket = UdpSocket::bind(address).unwrap();
        socket.set_read_timeout(Some(Duration::from_secs(5))).unwrap();
        socket
    }

    fn received(socket: &UdpSocket) -> Vec<u8> {
        let mut buffer = [0; 64];
        let length = socket.recv(&mut buffer).unwrap();
        buffer[..length].to_vec()
    }

    fn nothing(socket: &UdpSocket) -> bool {
        socket.set_nonblocking(true).unwrap();
        let error = socket.recv(&mut [0; 64]).unwrap_err();
        socket.set_nonblocking(false).unwrap();
        error.kind() == ErrorKind::WouldBlock
    }

    #[test]
    fn udpout_reaches_both_internets() {
        for address in ["127.0.0.1:0", "[::1]:0"] {
            let socket = receiver(address);
            let to = socket.local_addr().unwrap();
            let mut endpoint = Endpoint::new(EndpointAddress::UdpOut(to));
            assert!(!endpoint.listening());
            endpoint.send(at(0.0), b"too early");
            endpoint.tend(at(0.0), NOBODY);
            assert!(endpoint.listening());
            endpoint.send(at(0.0), b"fd");
            assert_eq!(received(&socket), b"fd");
            let view = endpoint.stats().view();
            assert_eq!((view.address, view.sent, view.failed), (format!("udpout:{to}"), 1, 1));
        }
    }

    #[test]
    fn nobody_listening_is_noticed_and_does_not_last() {
        let socket = receiver("127.0.0.1:0");
        let to = socket.local_addr().unwrap();
        drop(socket);
        let mut endpoint = Endpoint::new(EndpointAddress::UdpOut(to));
        endpoint.tend(at(0.0), NOBODY);
        for _ in 0..10 {
            endpoint.send(at(0.0), b"lost");
        }
        let view = endpoint.stats().view();
        assert!(view.failed >= 9 && view.sent == 10, "{view:?}");
        assert_eq!(
            view.last_error,
            format!("udpout:{to}: nobody listens there; start the receiver or correct the address")
        );
        assert!(!endpoint.listening());
        endpoint.tend(at(0.1), NOBODY);
        let socket = receiver(&to.to_string());
        endpoint.send(at(0.2), b"here");
        assert_eq!(received(&socket), b"here", "not the first one after the refusals");
        endpoint.tend(at(3.05), NOBODY);
        assert!(!endpoint.listening());
        endpoint.tend(at(3.2), NOBODY);
        assert!(endpoint.listening());
        assert_eq!(endpoint.stats().view().last_error, "");
    }

    #[test]
    fn a_port_in_use_is_named_and_tried_again() {
        let other = receiver("127.0.0.1:0");
        let address = other.local_addr().unwrap();
        let mut endpoint = Endpoint::new(EndpointAddress::UdpIn(address));
        endpoint.tend(at(0.0), NOBODY);
        let port = address.port();
        assert_eq!(
            endpoint.stats().view().last_error,
            format!(
                "udpin:127.0.0.1:{port}: the port is in use by another program; choose another port or stop it \
                 (ss -lunp 'sport = :{port}')"
            )
        );
        drop(other);
        endpoint.tend(at(0.9), NOBODY);
        assert!(endpoint.socket.is_none(), "tried again before its time");
        endpoint.tend(at(1.0), NOBODY);
        assert!(endpoint.socket.is_some());
    }

    #[test]
    fn an_address_that_is_not_here_is_waited_for() {
        // TEST-NET-1 is nobody's.
        let mut endpoint = Endpoint::new(EndpointAddress::UdpIn("192.0.2.1:14550".parse().unwrap()));
        for i in 0..5 {
            endpoint.tend(at(f64::from(i)), NOBODY);
            endpoint.send(at(f64::from(i)), b"fd");
        }
        let view = endpoint.stats().view();
        assert!(view.last_error.contains("does not have that address"), "{view:?}");
        assert_eq!(view.failed, 5);
    }

    fn udpin() -> (Endpoint, SocketAddr) {
        let mut endpoint = Endpoint::new(EndpointAddress::UdpIn("127.0.0.1:0".parse().unwrap()));
        endpoint.tend(at(0.0), NOBODY);
        let address = endpoint.socket.as_ref().unwrap().local_addr().unwrap();
        (endpoint, address)
    }

    #[test]
    fn udpin_sends_to_whom_it_heard_and_forgets_who_is_silent() {
        let (mut endpoint, address) = udpin();
        endpoint.send(at(0.0), b"to nobody");
        let peers: Vec<UdpSocket> = (0..5).map(|_| receiver("127.0.0.1:0")).collect();
        for (i, peer) in peers.iter().take(4).enumerate() {
            peer.send_to(b"hello", address).unwrap();
            endpoint.tend(at(i as f64), NOBODY);
        }
        endpoint.send(at(4.0), b"1");
        for peer in peers.iter().take(4) {
            assert_eq!(received(peer), b"1");
        }
        // The first is heard again, so that the second is silent for longest when a fifth comes.
        peers[0].send_to(b"hello", address).unwrap();
        endpoint.tend(at(5.0), NOBODY);
        peers[4].send_to(b"hello", address).unwrap();
        endpoint.tend(at(6.0), NOBODY);
        endpoint.send(at(7.0), b"2");
        assert!(nothing(&peers[1]));
        for i in [0, 2, 3, 4] {
            assert_eq!(received(&peers[i]), b"2");
        }
        endpoint.tend(at(65.5), NOBODY);
        endpoint.send(at(65.5), b"3");
        assert_eq!(received(&peers[4]), b"3");
        assert!([0, 2, 3].iter().all(|i| nothing(&peers[*i])), "sent to the silent");
        endpoint.tend(at(70.0), NOBODY);
        assert!(!endpoint.listening());
        let view = endpoint.stats().view();
        assert_eq!((view.sent, view.failed, view.last_error.as_str()), (9, 0, ""));
    }

    #[test]
    fn an_empty_datagram_is_not_the_end_and_a_flood_not_for_ever() {
        let (mut endpoint, address) = udpin();
        let peer = receiver("127.0.0.1:0");
        peer.send_to(b"", address).unwrap();
        peer.send_to(b"after", address).unwrap();
        let mut heard = Vec::new();
        endpoint.tend(at(0.0), |d| heard.push(d.to_vec()));
        assert_eq!(heard, [b"".to_vec(), b"after".to_vec()]);
        for _ in 0..100 {
            peer.send_to(b"x", address).unwrap();
        }
        let mut count = 0;
        endpoint.tend(at(0.0), |_| count += 1);
        assert_eq!(count, MAX_DRAINED);
    }

    #[test]
    fn a_peer_that_went_away_harms_nobody() {
        let (mut endpoint, address) = udpin();
        let (gone, stays) = (receiver("127.0.0.1:0"), receiver("127.0.0.1:0"));
        gone.send_to(b"hello", address).unwrap();
        stays.send_to(b"hello", address).unwrap();
        endpoint.tend(at(0.0), NOBODY);
        drop(gone);
        for i in 0..20_u8 {
            endpoint.send(at(0.0), &[i]);
            endpoint.tend(at(0.0), NOBODY);
            assert_eq!(received(&stays), [i]);
        }
    }
}
