//! The sampling loop by itself: what records the frames of a head that no daemon reads.

use super::running::{StartError, header, spawn};
use super::sampling::Sampling;
use super::source;
use crate::config::Loaded;
use crate::horizon::Horizon;
use crate::recording::Taps;
use crate::state::Shared;
use std::os::fd::OwnedFd;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A sampling loop that publishes nothing; it ends when this is dropped, and is not waited for: it may hang on a bus
/// that is held.
#[derive(Debug)]
pub struct Alone(Arc<AtomicBool>);

impl Alone {
    /// Samples as the daemon would with `loaded`, but without an autopilot, a lamp or a publisher. Gives the loop, and
    /// what the daemon's `Frames` gives: the header of a recording, then a row for each frame.
    pub fn start(loaded: &Loaded) -> Result<(Self, OwnedFd), StartError> {
        let (settings, head) = (&loaded.settings, loaded.settings.head());
        let source = source::open(settings, &head).map_err(StartError::Configuration)?;
        let taps = Arc::new(Taps::new(&header(loaded)));
        let frames = taps.subscribe().map_err(StartError::Frames)?;
        let horizon = Horizon::new(settings, head.clone());
        let sampling = Sampling::new(head, source, horizon, Arc::new(Shared::default()), taps, None);
        let (rate_hz, stop) = (settings.rate_hz, Arc::new(AtomicBool::new(false)));
        let alone = Self(Arc::clone(&stop));
        spawn("sampling", move || sampling.run(rate_hz, &stop))?;
        Ok((alone, frames))
    }
}

impl Drop for Alone {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}
