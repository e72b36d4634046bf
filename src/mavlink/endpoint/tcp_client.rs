//! `tcpout`: a connection to a server, made anew whenever it ends.

use super::Transport;
use super::stats::Health;
use super::stream::Stream;
use super::watch::Watch;
use crate::mavlink::deframe::Packet;
use crate::mavlink::trouble::Trouble;
use crate::time::Time;
use rustix::io::Errno;
use rustix::net::{AddressFamily, SocketFlags, SocketType, connect, getpeername, getsockname, socket_with, sockopt};
use std::net::SocketAddr;
use std::os::fd::OwnedFd;

/// How long a server may take to answer, s.
const PATIENCE_S: f64 = 5.0;

/// The system's buffer for what goes out, bytes: what waits there grows old.
const SEND_BUFFER: usize = 16 * 1024;

/// After so long without an answer to what was sent a connection is given up, ms.
const USER_TIMEOUT_MS: u32 = 30_000;

/// Makes a connection's socket fit for frames: sent at once, or not kept for long.
pub fn prepare(socket: &OwnedFd) -> Result<(), Errno> {
    sockopt::set_tcp_nodelay(socket, true)?;
    sockopt::set_socket_send_buffer_size(socket, SEND_BUFFER)?;
    sockopt::set_tcp_user_timeout(socket, USER_TIMEOUT_MS)
}

/// A connection to a server.
#[derive(Debug)]
pub struct TcpClient {
    stream: Stream,
    begun: Time,
    connected: bool,
}

impl TcpClient {
    /// Begins to connect.
    pub fn open(now: Time, to: SocketAddr) -> Result<Self, Trouble> {
        let family = if to.is_ipv4() { AddressFamily::INET } else { AddressFamily::INET6 };
        let open = || {
            let flags = SocketFlags::NONBLOCK | SocketFlags::CLOEXEC;
            let socket = socket_with(family, SocketType::STREAM, flags, None)?;
            prepare(&socket)?;
            match connect(&socket, &to) {
                Ok(()) | Err(Errno::INPROGRESS) => Ok(socket),
                Err(e) => Err(e),
            }
        };
        let socket = open().map_err(|e: Errno| Trouble::new(&e.into(), 0))?;
        Ok(Self { stream: Stream::new(socket), begun: now, connected: false })
    }

    /// Whether it is connected by now.
    fn connected(&mut self, now: Time, health: &mut Health) -> Result<bool, Trouble> {
        if !self.connected {
            let fd = self.stream.fd();
            match sockopt::socket_error(fd) {
                Ok(Ok(())) => {}
                Ok(Err(e)) | Err(e) => return Err(Trouble::new(&e.into(), 0)),
            }
            match (getpeername(fd), getsockname(fd)) {
                (Err(Errno::NOTCONN), _) => return Ok(false),
                (Err(e), _) | (_, Err(e)) => return Err(Trouble::new(&e.into(), 0)),
                // A port of this machine that nobody listens at may be given to this very socket, which then talks
                // to itself.
                (Ok(there), Ok(here)) if there == Some(here.clone()) => return Err(Trouble::Refused),
                _ => {}
            }
            self.connected = true;
            health.say(now, format_args!("connected"));
            health.recovered(now);
        }
        Ok(true)
    }
}

impl Transport for TcpClient {
    fn peers(&self) -> usize {
        usize::from(self.connected)
    }

    fn watch(&self, watch: &mut Watch) {
        if self.connected {
            self.stream.watch(watch);
        } else {
            watch.add(self.stream.fd().clone(), true);
        }
    }

    fn send(&mut self, now: Time, message: &[u8], health: &mut Health) -> Result<bool, Trouble> {
        if !self.connected {
            health.stats.failed();
            return Ok(false);
        }
        self.stream.send(now, message, health).map(|()| true).map_err(|e| {
            health.stats.failed();
            Trouble::new(&e.into(), 0)
        })
    }

    fn receive(&mut self, now: Time, heed: &mut dyn FnMut(&Packet<'_>), health: &mut Health) -> Result<(), Trouble> {
        if !self.connected(now, health)? {
            return Ok(());
        }
        let turn = self.stream.flush(now, health).and_then(|()| self.stream.receive(heed, health));
        match turn {
            Ok(true) => Ok(()),
            Ok(false) => Err(Trouble::Closed),
            Err(e) => Err(Trouble::new(&e.into(), 0)),
        }
    }

    fn tend(&mut self, now: Time, health: &mut Health) -> Result<bool, Trouble> {
        let connected = self.connected(now, health)?;
        if !connected && now.since(self.begun) >= PATIENCE_S {
            return Err(Trouble::NoAnswer);
        }
        Ok(connected)
    }
}

#[cfg(test)]
mod tests;
