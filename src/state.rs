//! The one shared state: written by the sampling loop, read by every publisher.
//!
//! Whoever waits for every frame has a [`Bell`] among its file descriptors; whoever looks now and then waits for the
//! [`Alarm`] meanwhile.

mod alarm;

pub use alarm::Alarm;

use crate::aiding::Autopilot;
use crate::attitude::{Attitude, Estimate, Mode};
use crate::frame::Frame;
use crate::head::Head;
use crate::source::SensorHealth;
use crate::time::Time;
use rustix::event::{EventfdFlags, eventfd};
use std::io;
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::thread;
use std::time::{Duration, Instant};

/// As many frames before the newest are remembered: a publisher that is late by fewer leaves none out.
pub const BEFORE: usize = 4;

/// Between two looks of [`Shared::wait_beyond`].
const LOOK: Duration = Duration::from_millis(5);

/// The attitude of one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moment {
    /// Counts frames; 0 before the first.
    pub sequence: u64,
    /// When it was written.
    pub written: Time,
    /// The newest conversion in it.
    pub time: Time,
    /// The moment that the attitude speaks of.
    pub valid_at: Time,
    /// Roll and pitch, or nothing while they are withheld.
    pub attitude: Option<Attitude>,
    /// Whether that was measured, and does not stand in for one that is withheld.
    pub measured: bool,
    /// Their standard deviations, rad.
    pub sigma: Attitude,
    /// Body rates about x (nose), y (right), z (down), rad/s, where they are known.
    pub rates: Option<[f64; 3]>,
    /// How far to trust it.
    pub mode: Mode,
}

/// What the sampling loop says after each frame.
#[derive(Clone, Debug, Default)]
pub struct Snapshot {
    /// Counts frames; 0 before the first.
    pub sequence: u64,
    /// When this was written, on the same clock as every stamp.
    pub written: Time,
    /// The sensors that it speaks of; another head after a reload, from its first frame on.
    pub head: Arc<Head>,
    /// The estimate.
    pub estimate: Estimate,
    /// The frame it came from.
    pub frame: Frame,
    /// What is known of each sensor, in the head's order.
    pub health: Vec<SensorHealth>,
    /// Frames a second, measured over the last few seconds.
    pub rate_hz: f64,
    /// The autopilot that is listened to.
    pub autopilot: Autopilot,
    /// How many times each configuration-relevant change has happened: a publisher that sees it
    /// change reads its settings again.
    pub generation: u64,
    /// The daemon is going down.
    pub stopping: bool,
    /// The frames before this one, the newest first: [`Shared::update`] sees to it.
    pub before: [Moment; BEFORE],
}

impl Snapshot {
    /// The newest frame.
    pub fn moment(&self) -> Moment {
        let (sequence, written) = (self.sequence, self.written);
        let Estimate { time, valid_at, attitude, measured, sigma, rates, mode, .. } = self.estimate;
        Moment { sequence, written, time, valid_at, attitude, measured, sigma, rates, mode }
    }
}

/// The state with a bell that rings at every change.
#[derive(Debug, Default)]
pub struct Shared {
    snapshot: Mutex<Snapshot>,
    /// Rings at what must not wait.
    pub alarm: Alarm,
    bells: Mutex<Vec<Weak<OwnedFd>>>,
}

/// Rings at every change of the state: its file descriptor can be read from then.
#[derive(Debug)]
pub struct Bell(Arc<OwnedFd>);

impl Bell {
    /// Is silent until the next change.
    pub fn hush(&self) {
        let _ = rustix::io::read(&self.0, &mut [0_u8; 8]);
    }
}

impl AsFd for Bell {
    fn as_fd(&self) -> BorrowedFd<'_> {
        self.0.as_fd()
    }
}

impl Shared {
    /// The state, for a short look or a short write.
    pub fn lock(&self) -> MutexGuard<'_, Snapshot> {
        self.snapshot.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Changes the state and wakes the publishers.
    pub fn update(&self, change: impl FnOnce(&mut Snapshot)) {
        self.put(change);
        self.ring();
    }

    /// Changes the state. Whoever has a bell is not woken: [`ring`](Self::ring) does that.
    pub fn put(&self, change: impl FnOnce(&mut Snapshot)) {
        let mut snapshot = self.lock();
        let last = snapshot.moment();
        change(&mut snapshot);
        if snapshot.sequence != last.sequence {
            snapshot.before.rotate_right(1);
            snapshot.before[0] = last;
        }
        self.alarm.hear(&snapshot);
    }

    /// Rings all bells.
    pub fn ring(&self) {
        self.bells.lock().unwrap_or_else(PoisonError::into_inner).retain(|bell| {
            let bell = bell.upgrade();
            if let Some(bell) = &bell {
                // One that cannot be rung has rung already.
                let _ = rustix::io::write(bell, &1_u64.to_ne_bytes());
            }
            bell.is_some()
        });
    }

    /// A bell for every change from now on, until it is dropped.
    pub fn bell(&self) -> io::Result<Bell> {
        let bell = Arc::new(eventfd(0, EventfdFlags::CLOEXEC | EventfdFlags::NONBLOCK)?);
        self.bells.lock().unwrap_or_else(PoisonError::into_inner).push(Arc::downgrade(&bell));
        Ok(Bell(bell))
    }

    /// Waits until a frame later than `seen` is there, the daemon stops, or `timeout` is over; gives the state then.
    /// For now and then: nobody rings here, it looks again and again.
    pub fn wait_beyond(&self, seen: u64, timeout: Duration) -> MutexGuard<'_, Snapshot> {
        let end = Instant::now() + timeout;
        loop {
            let snapshot = self.lock();
            if snapshot.sequence > seen || snapshot.stopping || Instant::now() >= end {
                return snapshot;
            }
            drop(snapshot);
            thread::sleep(LOOK);
        }
    }
}
