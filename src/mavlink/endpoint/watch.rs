//! Waiting for several file descriptors at once, each of them some endpoint's.

use crate::clock;
use crate::time::Time;
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use std::os::fd::{AsFd, BorrowedFd};
use std::sync::Arc;
use std::time::Duration;

/// As many as are watched: of 16 endpoints a listener with four clients each.
const MOST: usize = 16 * 5;

/// How long to wait when the system will not: far less than anything is due.
const UNWATCHED: Duration = Duration::from_millis(10);

/// What is watched. It stays open as long, whatever another thread does with its endpoint meanwhile.
pub type Watched = Arc<dyn AsFd + Send + Sync>;

/// What is watched, and whose it is.
pub struct Watch {
    watched: Vec<(Watched, PollFlags, u8)>,
    owner: u8,
}

impl Default for Watch {
    fn default() -> Self {
        Self { watched: Vec::with_capacity(MOST), owner: 0 }
    }
}

impl Watch {
    /// What is added from now on is of the endpoint with this index.
    pub fn of(&mut self, owner: usize) {
        self.owner = u8::try_from(owner).unwrap_or(u8::MAX);
    }

    /// Watches `fd` for what comes in, and for room for what goes out if `write`.
    pub fn add(&mut self, fd: Watched, write: bool) {
        if self.watched.len() < MOST {
            let flags = if write { PollFlags::IN | PollFlags::OUT } else { PollFlags::IN };
            self.watched.push((fd, flags, self.owner));
        }
    }

    /// Waits until the bell rings, something has happened, or `until` has come. Nothing is watched any more then.
    pub fn wait(&mut self, bell: BorrowedFd<'_>, until: Time) -> Ready {
        let ready = self.poll(bell, until);
        self.watched.clear();
        ready
    }

    fn poll(&self, bell: BorrowedFd<'_>, until: Time) -> Ready {
        let mut fds: [_; 1 + MOST] = std::array::from_fn(|_| PollFd::from_borrowed_fd(bell, PollFlags::IN));
        for (slot, (fd, flags, _)) in fds[1..].iter_mut().zip(&self.watched) {
            *slot = PollFd::from_borrowed_fd(fd.as_fd(), *flags);
        }
        let fds = &mut fds[..=self.watched.len()];
        let left_ns = until.as_nanos().saturating_sub(clock::now().as_nanos());
        let timeout = Timespec {
            tv_sec: i64::try_from(left_ns / 1_000_000_000).unwrap_or(i64::MAX),
            tv_nsec: (left_ns % 1_000_000_000) as i64,
        };
        match poll(fds, Some(&timeout)) {
            Ok(_) => {}
            Err(rustix::io::Errno::INTR) => return Ready::default(),
            Err(_) => {
                std::thread::sleep(UNWATCHED);
                return Ready { bell: true, owners: u32::MAX };
            }
        }
        let happened = |fd: &PollFd<'_>| !fd.revents().is_empty();
        let mut ready = Ready { bell: happened(&fds[0]), owners: 0 };
        for (fd, (_, _, owner)) in fds[1..].iter().zip(&self.watched) {
            if happened(fd) {
                ready.owners |= 1_u32.checked_shl(u32::from(*owner)).unwrap_or(0);
            }
        }
        ready
    }
}

/// Where something has happened.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Ready {
    /// The bell has rung.
    pub bell: bool,
    owners: u32,
}

impl Ready {
    /// Whether at the endpoint with this index.
    pub fn at(self, owner: usize) -> bool {
        owner < 32 && self.owners & 1 << owner != 0
    }
}
