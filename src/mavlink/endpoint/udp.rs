//! Datagrams, each of them one message going out, and any number of whole ones coming in.

use super::Transport;
use super::budget::Budget;
use super::stats::Health;
use super::watch::Watch;
use crate::mavlink::deframe::{self, Packet};
use crate::mavlink::trouble::Trouble;
use crate::time::Time;
use std::io::{Error, ErrorKind};
use std::net::{Ipv4Addr, Ipv6Addr, SocketAddr, UdpSocket};
use std::sync::Arc;

/// As many peers as a `udpin` endpoint serves.
const MAX_PEERS: usize = 4;

/// The silence after which a peer of a `udpin` endpoint is forgotten, s.
const PEER_SILENCE_S: f64 = 60.0;

/// The silence after which it makes room for another, s: whoever goes on talking stays, however many strangers come.
const PEER_QUIET_S: f64 = 3.0;

/// Datagrams taken in at a time.
const MAX_DRAINED: u32 = 256;

/// `udpout`. Connected: the system then tells when nobody listens, and nobody else is heard.
#[derive(Debug)]
pub struct Out(Arc<UdpSocket>);

impl Out {
    /// A socket to send there.
    pub fn open(to: SocketAddr) -> Result<Self, Trouble> {
        let any = if to.is_ipv4() { Ipv4Addr::UNSPECIFIED.into() } else { Ipv6Addr::UNSPECIFIED.into() };
        let open = || {
            let socket = bind(SocketAddr::new(any, 0))?;
            // Without it a subnet's broadcast address is refused; others do not mind.
            socket.set_broadcast(to.is_ipv4())?;
            socket.connect(to)?;
            Ok(Self(Arc::new(socket)))
        };
        open().map_err(|e: Error| Trouble::new(&e, 0))
    }
}

impl Transport for Out {
    fn peers(&self) -> usize {
        1
    }

    fn watch(&self, watch: &mut Watch) {
        watch.add(self.0.clone(), false);
    }

    /// A datagram that the other host refuses counts as sent, and as failed when that is known.
    fn send(&mut self, now: Time, message: &[u8], health: &mut Health) -> Result<bool, Trouble> {
        let mut result = self.0.send(message);
        if result.as_ref().is_err_and(|e| e.kind() == ErrorKind::ConnectionRefused) {
            // That was the answer to an earlier datagram; this one was not tried yet.
            result = self.0.send(message);
            health.failed(now, Trouble::Refused);
        }
        match count(now, result, health) {
            Err(trouble) if trouble.wants_new_socket() => Err(trouble),
            outcome => Ok(outcome.is_ok()),
        }
    }

    fn receive(&mut self, now: Time, heed: &mut dyn FnMut(&Packet<'_>), health: &mut Health) -> Result<(), Trouble> {
        drain(&self.0, now, |_, _, _| {}, heed, health);
        Ok(())
    }

    fn tend(&mut self, _: Time, _: &mut Health) -> Result<bool, Trouble> {
        Ok(true)
    }
}

/// Someone who was heard on a `udpin` endpoint.
#[derive(Clone, Copy, Debug)]
struct Peer {
    address: SocketAddr,
    heard: Time,
}

/// `udpin`.
#[derive(Debug)]
pub struct In {
    socket: Arc<UdpSocket>,
    peers: Vec<Peer>,
}

impl In {
    /// A socket to listen at.
    pub fn open(at: SocketAddr) -> Result<Self, Trouble> {
        let socket = bind(at).map_err(|e| Trouble::new(&e, at.port()))?;
        Ok(Self { socket: Arc::new(socket), peers: Vec::with_capacity(MAX_PEERS) })
    }
}

impl Transport for In {
    fn peers(&self) -> usize {
        self.peers.len()
    }

    fn watch(&self, watch: &mut Watch) {
        watch.add(self.socket.clone(), false);
    }

    fn send(&mut self, now: Time, message: &[u8], health: &mut Health) -> Result<bool, Trouble> {
        let mut any = false;
        for peer in &self.peers {
            any |= count(now, self.socket.send_to(message, peer.address), health).is_ok();
        }
        Ok(any)
    }

    fn receive(&mut self, now: Time, heed: &mut dyn FnMut(&Packet<'_>), health: &mut Health) -> Result<(), Trouble> {
        drain(&self.socket, now, |from, now, health| heard(&mut self.peers, from, now, health), heed, health);
        Ok(())
    }

    fn tend(&mut self, now: Time, _: &mut Health) -> Result<bool, Trouble> {
        self.peers.retain(|p| now.since(p.heard) < PEER_SILENCE_S);
        Ok(true)
    }
}

/// Remembers a peer; the one silent for longest makes room for a fifth.
fn heard(peers: &mut Vec<Peer>, address: SocketAddr, now: Time, health: &mut Health) {
    if let Some(peer) = peers.iter_mut().find(|p| p.address == address) {
        peer.heard = now;
        return;
    }
    if peers.len() >= MAX_PEERS {
        let oldest = (0..peers.len()).min_by_key(|i| peers[*i].heard);
        match oldest.filter(|i| now.since(peers[*i].heard) >= PEER_QUIET_S) {
            Some(oldest) => drop(peers.swap_remove(oldest)),
            None => return,
        }
    }
    health.say(now, format_args!("sending to {address}"));
    peers.push(Peer { address, heard: now });
}

/// A socket that does not block.
fn bind(at: SocketAddr) -> Result<UdpSocket, Error> {
    let socket = UdpSocket::bind(at)?;
    socket.set_nonblocking(true)?;
    Ok(socket)
}

fn count(now: Time, result: Result<usize, Error>, health: &mut Health) -> Result<(), Trouble> {
    match result {
        Ok(_) => {
            health.stats.sent();
            Ok(())
        }
        Err(e) => {
            let trouble = Trouble::new(&e, 0);
            health.failed(now, trouble);
            Err(trouble)
        }
    }
}

/// Takes in what has come, within bounds: each datagram's sender is given to `from`, its messages to `heed`.
fn drain(
    socket: &UdpSocket,
    now: Time,
    mut from: impl FnMut(SocketAddr, Time, &mut Health),
    heed: &mut dyn FnMut(&Packet<'_>),
    health: &mut Health,
) {
    let mut buffer = [0_u8; 2048];
    let mut budget = Budget::new(MAX_DRAINED);
    while budget.more() {
        match socket.recv_from(&mut buffer) {
            Ok((length, sender)) => {
                from(sender, now, health);
                health.stats.skipped(deframe::datagram(&buffer[..length], |packet| heed(&packet)));
            }
            // The answer to an earlier datagram comes out of whichever call is made next.
            Err(e) if e.kind() == ErrorKind::ConnectionRefused => health.failed(now, Trouble::Refused),
            Err(e) if e.kind() == ErrorKind::Interrupted => {}
            Err(_) => return,
        }
    }
}

#[cfg(test)]
mod tests;
