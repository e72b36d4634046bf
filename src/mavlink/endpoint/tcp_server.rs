//! `tcpin`: connections of up to four clients. One that takes nothing costs nobody anything, and makes room.

use super::Transport;
use super::stats::Health;
use super::stream::Stream;
use super::tcp_client::prepare;
use super::watch::Watch;
use crate::mavlink::deframe::Packet;
use crate::mavlink::trouble::Trouble;
use crate::time::Time;
use std::io::ErrorKind;
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::os::fd::OwnedFd;
use std::sync::Arc;
use std::time::Duration;

/// As many clients as are served.
const MAX_CLIENTS: usize = 4;

/// A client that has taken nothing for so long, s, makes room for another.
const STUCK_S: f64 = 3.0;

/// And after so long, s, it is given up.
const GIVEN_UP_S: f64 = 60.0;

/// Connections taken at a time.
const MAX_ACCEPTED: usize = 8;

/// How long no connection is taken after one could not be (no file descriptors).
const REST: Duration = Duration::from_secs(1);

/// A client.
#[derive(Debug)]
struct Client {
    stream: Stream,
    address: SocketAddr,
}

/// A server.
#[derive(Debug)]
pub struct TcpServer {
    listener: Arc<TcpListener>,
    clients: Vec<Client>,
    /// No connection is taken before that.
    rest: Option<Time>,
}

impl TcpServer {
    /// Listens there.
    pub fn open(at: SocketAddr) -> Result<Self, Trouble> {
        let open = || {
            let listener = TcpListener::bind(at)?;
            listener.set_nonblocking(true)?;
            Ok(listener)
        };
        let listener = open().map_err(|e: std::io::Error| Trouble::new(&e, at.port()))?;
        Ok(Self { listener: Arc::new(listener), clients: Vec::with_capacity(MAX_CLIENTS), rest: None })
    }

    fn accept(&mut self, now: Time, health: &mut Health) {
        for _ in 0..MAX_ACCEPTED {
            match self.listener.accept() {
                Ok((stream, address)) => self.take(stream, address, now, health),
                Err(e) if matches!(e.kind(), ErrorKind::Interrupted | ErrorKind::ConnectionAborted) => {}
                Err(e) if e.kind() == ErrorKind::WouldBlock => return,
                Err(e) => {
                    health.note(now, Trouble::new(&e, 0));
                    self.rest = Some(now + REST);
                    return;
                }
            }
        }
    }

    /// Takes a client in, if there is room or one of the others takes nothing.
    fn take(&mut self, stream: TcpStream, address: SocketAddr, now: Time, health: &mut Health) {
        if self.clients.len() >= MAX_CLIENTS {
            let stuck = |i: &usize| self.clients[*i].stream.stuck_s(now);
            let longest = (0..self.clients.len()).max_by(|a, b| stuck(a).total_cmp(&stuck(b)));
            let Some(longest) = longest.filter(|i| stuck(i) >= STUCK_S) else {
                health.say(now, format_args!("turned {address} away: {MAX_CLIENTS} others are connected"));
                return;
            };
            let gone = self.clients.swap_remove(longest);
            health.say(now, format_args!("gave {} up for {address}: it takes nothing", gone.address));
        }
        let fd = OwnedFd::from(stream);
        if rustix::io::ioctl_fionbio(&fd, true).and_then(|()| prepare(&fd)).is_ok() {
            health.say(now, format_args!("sending to {address}"));
            self.clients.push(Client { stream: Stream::new(fd), address });
        }
    }

    /// Does something for each client; it stays while that gives true. Whether any stays.
    fn each(&mut self, now: Time, health: &mut Health, mut act: impl FnMut(&mut Stream, &mut Health) -> bool) -> bool {
        self.clients.retain_mut(|client| {
            let stays = act(&mut client.stream, health);
            if !stays {
                health.say(now, format_args!("{} is gone", client.address));
                health.watch_anew.set(true);
            }
            stays
        });
        !self.clients.is_empty()
    }
}

impl Transport for TcpServer {
    fn peers(&self) -> usize {
        self.clients.len()
    }

    fn watch(&self, watch: &mut Watch) {
        if self.rest.is_none() {
            watch.add(self.listener.clone(), false);
        }
        for client in &self.clients {
            client.stream.watch(watch);
        }
    }

    fn send(&mut self, now: Time, message: &[u8], health: &mut Health) -> Result<bool, Trouble> {
        Ok(self.each(now, health, |stream, health| stream.send(now, message, health).is_ok()))
    }

    fn receive(&mut self, now: Time, heed: &mut dyn FnMut(&Packet<'_>), health: &mut Health) -> Result<(), Trouble> {
        self.each(now, health, |stream, health| {
            stream.flush(now, health).is_ok() && stream.receive(heed, health) == Ok(true)
        });
        if self.rest.is_none() {
            self.accept(now, health);
        }
        Ok(())
    }

    fn tend(&mut self, now: Time, health: &mut Health) -> Result<bool, Trouble> {
        self.rest = self.rest.filter(|until| now < *until);
        self.each(now, health, |stream, _| stream.stuck_s(now) < GIVEN_UP_S);
        Ok(true)
    }
}

#[cfg(test)]
mod tests;
