//! `serial`: a tty in raw mode. One that is pulled out is taken up again as soon as it is back.

use super::Transport;
use super::stats::Health;
use super::stream::Stream;
use super::watch::Watch;
use crate::mavlink::deframe::Packet;
use crate::mavlink::trouble::Trouble;
use crate::time::Time;
use rustix::fs::{Mode, OFlags};
use rustix::termios::{
    ControlModes, OptionalActions, QueueSelector, Termios, ioctl_tiocexcl, tcflush, tcgetattr, tcsetattr,
};
use std::path::Path;

/// A tty.
#[derive(Debug)]
pub struct Serial(Stream);

impl Serial {
    /// Opens it for this program alone: raw, without flow control, 8 bits without parity.
    pub fn open(path: &Path, baud: u32) -> Result<Self, Trouble> {
        // Without NONBLOCK it would wait for a carrier, without NOCTTY it could become this process's own terminal.
        let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::NONBLOCK | OFlags::CLOEXEC;
        let fd = rustix::fs::open(path, flags, Mode::empty()).map_err(Trouble::device)?;
        let mut tty = tcgetattr(&fd).map_err(Trouble::device)?;
        ioctl_tiocexcl(&fd).map_err(Trouble::device)?;
        raw(&mut tty);
        tty.set_speed(baud).map_err(|_| Trouble::Baud(baud))?;
        tcsetattr(&fd, OptionalActions::Now, &tty).map_err(|_| Trouble::Baud(baud))?;
        // What came in at another speed is nothing.
        tcflush(&fd, QueueSelector::IFlush).map_err(Trouble::device)?;
        Ok(Self(Stream::new(fd)))
    }
}

impl Drop for Serial {
    fn drop(&mut self) {
        // Closing would wait for what the other side does not take.
        let _ = tcflush(self.0.fd(), QueueSelector::OFlush);
    }
}

fn raw(tty: &mut Termios) {
    tty.make_raw();
    tty.control_modes.remove(ControlModes::CRTSCTS | ControlModes::CSTOPB | ControlModes::PARENB);
    tty.control_modes.insert(ControlModes::CLOCAL | ControlModes::CREAD | ControlModes::CS8);
}

impl Transport for Serial {
    fn peers(&self) -> usize {
        1
    }

    fn watch(&self, watch: &mut Watch) {
        self.0.watch(watch);
    }

    fn send(&mut self, now: Time, message: &[u8], health: &mut Health) -> Result<bool, Trouble> {
        self.0.send(now, message, health).map(|()| true).map_err(|e| {
            health.stats.failed();
            Trouble::device(e)
        })
    }

    fn receive(&mut self, now: Time, heed: &mut dyn FnMut(&Packet<'_>), health: &mut Health) -> Result<(), Trouble> {
        match self.0.flush(now, health).and_then(|()| self.0.receive(heed, health)) {
            Ok(true) => Ok(()),
            Ok(false) => Err(Trouble::Unplugged),
            Err(e) => Err(Trouble::device(e)),
        }
    }

    fn tend(&mut self, _: Time, _: &mut Health) -> Result<bool, Trouble> {
        Ok(true)
    }
}

#[cfg(test)]
mod tests;
