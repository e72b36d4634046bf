//! Data-ready as edges that the kernel queues, so that a short pulse is not missed.
//!
//! Kernel interface v1 knows no pull-up request: ALERT/RDY is an open drain and needs a resistor.
//! The queue holds 16 events; an older one that stays unread costs newer ones, never the fact that
//! there was one.

use super::lines::{CONSUMER, Shown, find, refused};
use super::{DataReady, GpioError};
use crate::config::settings::LineSettings;
use gpio_cdev::{EventRequestFlags, LineEventHandle, LineRequestFlags};
use rustix::event::{PollFd, PollFlags, poll};
use rustix::time::Timespec;
use std::time::{Duration, Instant};

/// As many events are forgotten at once; more than the kernel's queue holds.
const DRAIN: usize = 64;

/// A line that falls when a conversion has ended; with `active-low`, one that an inverter makes
/// rise.
#[derive(Debug)]
pub struct EdgeInput {
    events: LineEventHandle,
}

impl EdgeInput {
    /// Requests the line. Fails when it is not there, is in use, or cannot tell edges.
    pub fn open(settings: &LineSettings) -> Result<Self, GpioError> {
        let line = find(settings)?;
        let mut flags = LineRequestFlags::INPUT;
        flags.set(LineRequestFlags::ACTIVE_LOW, settings.active_low);
        let events = line
            .events(flags, EventRequestFlags::FALLING_EDGE, CONSUMER)
            .map_err(|e| refused(&line, "asking for the edges of", &e))?;
        Ok(Self { events })
    }

    /// Takes the oldest event off the queue; `None` when there is none within `timeout`.
    fn take(&mut self, timeout: Duration) -> Result<Option<()>, GpioError> {
        let begun = Instant::now();
        loop {
            let left = timeout.saturating_sub(begun.elapsed());
            let limit = Timespec {
                tv_sec: i64::try_from(left.as_secs()).unwrap_or(i64::MAX),
                tv_nsec: left.subsec_nanos().into(),
            };
            let mut fds = [PollFd::new(&self.events, PollFlags::IN | PollFlags::PRI)];
            match poll(&mut fds, Some(&limit)) {
                Ok(0) => return Ok(None),
                Ok(_) if fds[0].revents().intersects(PollFlags::ERR | PollFlags::HUP | PollFlags::NVAL) => {
                    return Err(self.failed("the chip went away"));
                }
                Ok(_) => break,
                Err(rustix::io::Errno::INTR) => {}
                Err(e) => return Err(self.failed(e)),
            }
        }
        self.events.get_event().map(|_| Some(())).map_err(|e| self.failed(e))
    }

    fn failed(&self, cause: impl std::fmt::Display) -> GpioError {
        GpioError::failed("waiting for an edge of", Shown(self.events.line()), cause)
    }
}

impl DataReady for EdgeInput {
    fn wait(&mut self, timeout: Duration) -> Result<bool, GpioError> {
        Ok(self.take(timeout)?.is_some())
    }

    fn clear(&mut self) {
        for _ in 0..DRAIN {
            if !matches!(self.take(Duration::ZERO), Ok(Some(()))) {
                break;
            }
        }
    }
}
