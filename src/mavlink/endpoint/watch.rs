//! Waiting for several file descriptors at once, each of them some endpoint's.

use crate::clock;
use crate::time::Time;
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use std::os::fd::BorrowedFd;
use std::time::Duration;

/// As many as are watched: the bell, and of 16 endpoints a listener with four clients each.
const MOST: usize = 1 + 16 * 5;

/// How long to wait when the system will not: far less than anything is due.
const UNWATCHED: Duration = Duration::from_millis(10);

/// What is watched, and whose it is.
pub struct Watch<'a> {
    fds: [PollFd<'a>; MOST],
    owners: [u8; MOST],
    used: usize,
    owner: u8,
}

impl<'a> Watch<'a> {
    /// Watches `bell`, which is nobody's.
    pub fn new(bell: BorrowedFd<'a>) -> Self {
        let fds = std::array::from_fn(|_| PollFd::from_borrowed_fd(bell, PollFlags::IN));
        Self { fds, owners: [0; MOST], used: 1, owner: 0 }
    }

    /// What is added from now on is of the endpoint with this index.
    pub fn of(&mut self, owner: usize) {
        self.owner = u8::try_from(owner).unwrap_or(u8::MAX);
    }

    /// Watches `fd` for what comes in, and for room for what goes out if `write`.
    pub fn add(&mut self, fd: BorrowedFd<'a>, write: bool) {
        if let (Some(slot), Some(owner)) = (self.fds.get_mut(self.used), self.owners.get_mut(self.used)) {
            let flags = if write { PollFlags::IN | PollFlags::OUT } else { PollFlags::IN };
            *slot = PollFd::from_borrowed_fd(fd, flags);
            *owner = self.owner;
            self.used += 1;
        }
    }

    /// Waits until something has happened or `until` has come.
    pub fn wait(mut self, until: Time) -> Ready {
        let left_ns = until.as_nanos().saturating_sub(clock::now().as_nanos());
        let timeout = Timespec {
            tv_sec: i64::try_from(left_ns / 1_000_000_000).unwrap_or(i64::MAX),
            tv_nsec: (left_ns % 1_000_000_000) as i64,
        };
        match poll(&mut self.fds[..self.used], Some(&timeout)) {
            Ok(_) => {}
            Err(rustix::io::Errno::INTR) => return Ready::default(),
            Err(_) => {
                std::thread::sleep(UNWATCHED);
                return Ready { bell: true, owners: u32::MAX };
            }
        }
        let happened = |fd: &PollFd<'_>| !fd.revents().is_empty();
        let mut ready = Ready { bell: happened(&self.fds[0]), owners: 0 };
        for (fd, owner) in self.fds[1..self.used].iter().zip(&self.owners[1..]) {
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
