//! Live frames for other processes: each subscriber holds one end of a packet socket and gets a
//! line for each frame. A subscriber that does not read loses lines; the sampling loop never waits.

use rustix::io::Errno;
use rustix::net::{AddressFamily, SendFlags, SocketFlags, SocketType, send, socketpair};
use std::os::fd::OwnedFd;
use std::sync::{Mutex, PoisonError, TryLockError};

/// As many subscribers as are served at once.
const MAX_SUBSCRIBERS: usize = 8;

/// Everyone who listens to frames.
#[derive(Debug, Default)]
pub struct Taps {
    subscribers: Mutex<Vec<OwnedFd>>,
}

impl Taps {
    /// A new subscriber's end, on which `header` has been sent already; then a line a frame, one
    /// packet each. Errors when there are too many subscribers or the system has no descriptor left.
    pub fn subscribe(&self, header: &str) -> std::io::Result<OwnedFd> {
        let mut subscribers = self.subscribers.lock().unwrap_or_else(PoisonError::into_inner);
        if subscribers.len() >= MAX_SUBSCRIBERS {
            return Err(std::io::Error::other(format!("{MAX_SUBSCRIBERS} recordings are running already")));
        }
        let (ours, theirs) = socketpair(AddressFamily::UNIX, SocketType::SEQPACKET, SocketFlags::CLOEXEC, None)?;
        send(&ours, header.as_bytes(), SendFlags::DONTWAIT | SendFlags::NOSIGNAL)?;
        subscribers.push(ours);
        Ok(theirs)
    }

    /// Sends the line that `make` writes to every subscriber that has room for it; does not call
    /// `make` when there is none.
    pub fn offer(&self, line: &mut String, make: impl FnOnce(&mut String)) {
        let mut subscribers = match self.subscribers.try_lock() {
            Ok(guard) => guard,
            Err(TryLockError::Poisoned(p)) => p.into_inner(),
            Err(TryLockError::WouldBlock) => return,
        };
        if subscribers.is_empty() {
            return;
        }
        line.clear();
        make(line);
        subscribers.retain(|fd| {
            match send(fd, line.as_bytes(), SendFlags::DONTWAIT | SendFlags::NOSIGNAL) {
                // A full socket loses this line; the recording's time column shows the gap.
                Ok(_) | Err(Errno::AGAIN | Errno::NOBUFS | Errno::INTR) => true,
                Err(_) => false,
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rustix::net::{RecvFlags, recv};

    fn read(fd: &OwnedFd) -> String {
        let mut buffer = [0_u8; 256];
        let (n, _) = recv(fd, &mut buffer[..], RecvFlags::DONTWAIT).unwrap();
        String::from_utf8_lossy(&buffer[..n]).into_owned()
    }

    #[test]
    fn a_subscriber_gets_the_header_and_then_every_line() {
        let taps = Taps::default();
        let mut line = String::new();
        taps.offer(&mut line, |_| panic!("nobody listens"));
        let fd = taps.subscribe("time_s\n").unwrap();
        taps.offer(&mut line, |l| l.push_str("0.02\n"));
        assert_eq!(read(&fd), "time_s\n");
        assert_eq!(read(&fd), "0.02\n");
        drop(fd);
        taps.offer(&mut line, |l| l.push_str("0.04\n"));
        taps.offer(&mut line, |_| panic!("the subscriber is gone"));
    }

    #[test]
    fn a_subscriber_that_does_not_read_holds_up_nobody() {
        let taps = Taps::default();
        let _fd = taps.subscribe("time_s\n").unwrap();
        let mut line = String::new();
        for _ in 0..100_000 {
            taps.offer(&mut line, |l| l.push_str("0.02,1,2,3,4,5,6\n"));
        }
    }
}
