//! Frames over a stream of bytes that never blocks: a TCP connection, a tty.

use super::budget::Budget;
use super::queue::Queue;
use super::stats::Health;
use super::watch::Watch;
use crate::mavlink::deframe::{Deframer, Packet};
use crate::time::Time;
use rustix::io::Errno;
use std::os::fd::OwnedFd;
use std::sync::Arc;

/// Reads at a time, of 2 KiB each.
const READS: u32 = 16;

/// A stream both ways. An error is its end.
#[derive(Debug)]
pub struct Stream {
    fd: Arc<OwnedFd>,
    queue: Queue,
    deframer: Deframer,
    stuck: Option<Time>,
}

impl Stream {
    /// Over `fd`, which does not block.
    pub fn new(fd: OwnedFd) -> Self {
        Self { fd: Arc::new(fd), queue: Queue::default(), deframer: Deframer::default(), stuck: None }
    }

    /// What it goes over.
    pub fn fd(&self) -> &Arc<OwnedFd> {
        &self.fd
    }

    /// For how long the other side has taken nothing of what waits, s.
    pub fn stuck_s(&self, now: Time) -> f64 {
        self.stuck.map_or(0.0, |since| now.since(since))
    }

    /// Watches for what comes in, and for room if anything waits.
    pub fn watch(&self, watch: &mut Watch) {
        watch.add(self.fd.clone(), !self.queue.is_empty());
    }

    /// Sends a frame, or lets it wait.
    pub fn send(&mut self, now: Time, frame: &[u8], health: &Health) -> Result<(), Errno> {
        let waited = !self.queue.is_empty();
        health.stats.dropped(self.queue.push(frame));
        self.flush(now, health)?;
        if !waited && !self.queue.is_empty() {
            health.watch_anew.set(true);
        }
        Ok(())
    }

    /// Sends what waits, as far as it is taken.
    pub fn flush(&mut self, now: Time, health: &Health) -> Result<(), Errno> {
        while let Some(front) = self.queue.front() {
            match rustix::io::write(&self.fd, front) {
                Ok(0) | Err(Errno::AGAIN) => {
                    self.stuck.get_or_insert(now);
                    return Ok(());
                }
                Ok(bytes) => {
                    self.stuck = None;
                    if self.queue.gone(bytes) {
                        health.stats.sent();
                    }
                }
                Err(Errno::INTR) => {}
                Err(e) => return Err(e),
            }
        }
        Ok(())
    }

    /// Takes in what has come, within bounds. `Ok(false)`: the other side has closed.
    pub fn receive(&mut self, heed: &mut dyn FnMut(&Packet<'_>), health: &Health) -> Result<bool, Errno> {
        let mut buffer = [0_u8; 2048];
        let mut budget = Budget::new(READS);
        while budget.more() {
            match rustix::io::read(&self.fd, &mut buffer[..]) {
                Ok(0) => return Ok(false),
                Ok(bytes) => {
                    health.stats.skipped(self.deframer.take(&buffer[..bytes], |packet| heed(&packet)));
                    if bytes < buffer.len() {
                        return Ok(true);
                    }
                }
                Err(Errno::AGAIN) => return Ok(true),
                Err(Errno::INTR) => {}
                Err(e) => return Err(e),
            }
        }
        Ok(true)
    }
}
