//! What an endpoint has done and how it is, for whoever shows it.

use crate::ctl::view;
use crate::mavlink::deframe::Skipped;
use crate::mavlink::pace::Pace;
use crate::mavlink::trouble::Trouble;
use crate::time::Time;
use std::cell::Cell;
use std::fmt;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// In the long run a line about an endpoint goes to the log so often, however its state flutters.
const LINES: Duration = Duration::from_secs(10);

/// So many lines more at once.
const LINES_AT_ONCE: u32 = 9;

/// What an endpoint has done.
#[derive(Debug, Default)]
pub struct EndpointStats {
    address: String,
    sent: AtomicU64,
    failed: AtomicU64,
    dropped: AtomicU64,
    received: AtomicU64,
    skipped: AtomicU64,
    bad_crc: AtomicU64,
    peers: AtomicU64,
    tlog_lost: AtomicU64,
    errors: Mutex<[String; 3]>,
}

/// What an error is about, the gravest first: that one is shown.
#[derive(Clone, Copy, Debug)]
pub enum About {
    /// There is no key to sign with: nothing is sent.
    Key,
    /// Sending and hearing.
    Link,
    /// The tlog.
    Tlog,
}

impl EndpointStats {
    /// Nothing yet, at `address`.
    pub fn new(address: String) -> Self {
        Self { address, ..Self::default() }
    }

    /// Where it goes, as configured.
    pub fn address(&self) -> &str {
        &self.address
    }

    /// As `status` shows it.
    pub fn view(&self) -> view::Endpoint {
        let read = |n: &AtomicU64| n.load(Ordering::Relaxed);
        view::Endpoint {
            address: self.address.clone(),
            sent: read(&self.sent),
            failed: read(&self.failed),
            dropped: read(&self.dropped),
            received: read(&self.received),
            skipped_bytes: read(&self.skipped),
            bad_crc: read(&self.bad_crc),
            peers: read(&self.peers),
            tlog_lost: read(&self.tlog_lost),
            last_error: self.errors().iter().find(|e| !e.is_empty()).cloned().unwrap_or_default(),
        }
    }

    /// A message went out whole.
    pub fn sent(&self) {
        self.sent.fetch_add(1, Ordering::Relaxed);
    }

    /// A message could not be sent.
    pub fn failed(&self) {
        self.failed.fetch_add(1, Ordering::Relaxed);
    }

    /// Messages were dropped for newer ones.
    pub fn dropped(&self, messages: u64) {
        self.dropped.fetch_add(messages, Ordering::Relaxed);
    }

    /// A good message came in.
    pub fn received(&self) {
        self.received.fetch_add(1, Ordering::Relaxed);
    }

    /// Bytes came in that were no message.
    pub fn skipped(&self, skipped: Skipped) {
        self.skipped.fetch_add(skipped.bytes, Ordering::Relaxed);
        self.bad_crc.fetch_add(skipped.bad_crc, Ordering::Relaxed);
    }

    /// So many listen.
    pub fn set_peers(&self, peers: usize) {
        self.peers.store(peers as u64, Ordering::Relaxed);
    }

    /// Messages did not get into the tlog.
    pub fn tlog_lost(&self, messages: u64) {
        self.tlog_lost.fetch_add(messages, Ordering::Relaxed);
    }

    /// What is wrong; empty: nothing any more.
    pub fn set_error(&self, about: About, text: String) {
        self.errors()[about as usize] = text;
    }

    fn errors(&self) -> MutexGuard<'_, [String; 3]> {
        self.errors.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// How an endpoint is.
#[derive(Debug)]
pub struct Health {
    /// What it has done.
    pub stats: Arc<EndpointStats>,
    trouble: Option<Trouble>,
    failed: Time,
    lines: Pace,
    /// There is another file descriptor to watch, or one less, or one for room as well.
    pub watch_anew: Cell<bool>,
}

impl Health {
    /// All is well.
    pub fn new(stats: Arc<EndpointStats>) -> Self {
        Self {
            stats,
            trouble: None,
            failed: Time::default(),
            lines: Pace::new(LINES, LINES_AT_ONCE),
            watch_anew: Cell::default(),
        }
    }

    /// What is wrong.
    pub fn trouble(&self) -> Option<Trouble> {
        self.trouble
    }

    /// For how long nothing has failed, s.
    pub fn well_for_s(&self, now: Time) -> f64 {
        now.since(self.failed)
    }

    /// A message could not be sent.
    pub fn failed(&mut self, now: Time, trouble: Trouble) {
        self.stats.failed();
        self.note(now, trouble);
    }

    /// Keeps the reason of a failure; it is logged once, not for every message.
    pub fn note(&mut self, now: Time, trouble: Trouble) {
        self.failed = now;
        if self.trouble != Some(trouble) {
            self.trouble = Some(trouble);
            let text = format!("{}: {trouble}", self.stats.address);
            if self.lines.take(now) {
                log::warn!("{text}");
            }
            self.stats.set_error(About::Link, text);
        }
    }

    /// All is well again.
    pub fn recovered(&mut self, now: Time) {
        if self.trouble.take().is_some() {
            self.stats.set_error(About::Link, String::new());
            self.say(now, format_args!("sending again"));
        }
    }

    /// A line in the log, unless there were too many.
    pub fn say(&mut self, now: Time, what: fmt::Arguments<'_>) {
        if self.lines.take(now) {
            log::info!("{}: {what}", self.stats.address);
        }
    }
}
