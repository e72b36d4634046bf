//! Between the thread and the rest of the daemon: what it is told, what it tells.

use super::endpoint::stats::EndpointStats;
use super::service::Change;
use crate::aiding::Inbox;
use crate::config::Settings;
use crate::ctl::view;
use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The changes of settings that were asked for.
#[derive(Default)]
struct Changes {
    /// Not taken yet.
    waiting: Vec<Change>,
    /// How many were taken since start.
    taken: usize,
    /// How many of them were judged since start: they hold now, or never will.
    settled: usize,
    /// What is wrong with the last of these.
    trouble: Option<&'static str>,
}

/// What the thread is told, and what it tells.
pub struct Switchboard {
    settings: Mutex<Arc<Settings>>,
    endpoints: Mutex<Vec<Arc<EndpointStats>>>,
    inbox: Arc<Inbox>,
    changes: Mutex<Changes>,
    wake: Box<dyn Fn() + Send + Sync>,
}

impl fmt::Debug for Switchboard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Switchboard").field("settings", &self.settings).finish_non_exhaustive()
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Switchboard {
    /// The first configuration. What is heard of the autopilot goes to `inbox`; `wake` is called when there are
    /// [changes](Self::take_changes).
    pub fn new(settings: Settings, inbox: Arc<Inbox>, wake: impl Fn() + Send + Sync + 'static) -> Self {
        Self {
            settings: Mutex::new(Arc::new(settings)),
            endpoints: Mutex::default(),
            inbox,
            changes: Mutex::default(),
            wake: Box::new(wake),
        }
    }

    /// For whoever only sends.
    pub fn sending(settings: Settings) -> Self {
        Self::new(settings, Arc::default(), || {})
    }

    /// A new configuration. It is taken up when [`Snapshot::generation`](crate::state::Snapshot) changes: change that
    /// afterwards. Endpoints whose address stays keep their socket, peers, sequence numbers and statistics.
    pub fn configure(&self, settings: Settings) {
        *lock(&self.settings) = Arc::new(settings);
    }

    /// The endpoints as `status` shows them, in the configuration's order; none before the thread has begun.
    pub fn endpoints(&self) -> Vec<view::Endpoint> {
        lock(&self.endpoints).iter().map(|e| e.view()).collect()
    }

    /// The changes of settings that were asked for, in their order, to be kept and taken up.
    pub fn take_changes(&self) -> Vec<Change> {
        let mut changes = lock(&self.changes);
        let taken = std::mem::take(&mut changes.waiting);
        changes.taken += taken.len();
        taken
    }

    /// The changes taken until here are in force by [`configure`](Self::configure), or refused: call this between that and
    /// the change of the generation. Whoever listens is told `trouble`.
    pub fn settle(&self, trouble: Option<&'static str>) {
        let mut changes = lock(&self.changes);
        changes.settled = changes.taken;
        changes.trouble = trouble.or(changes.trouble);
    }

    /// How many were settled since start, and the trouble that is not told yet.
    pub(super) fn settled(&self) -> (usize, Option<&'static str>) {
        let mut changes = lock(&self.changes);
        (changes.settled, changes.trouble.take())
    }

    pub(super) fn settings(&self) -> Arc<Settings> {
        Arc::clone(&lock(&self.settings))
    }

    pub(super) fn inbox(&self) -> &Arc<Inbox> {
        &self.inbox
    }

    pub(super) fn tell(&self, endpoints: Vec<Arc<EndpointStats>>) {
        *lock(&self.endpoints) = endpoints;
    }

    pub(super) fn change(&self, changes: &mut Vec<Change>) {
        if !changes.is_empty() {
            lock(&self.changes).waiting.append(changes);
            (self.wake)();
        }
    }
}
