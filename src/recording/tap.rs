//! Live frames for other processes: each subscriber holds one end of a packet socket and gets a
//! line for each frame. A subscriber that does not read loses lines; the sampling loop never waits.

use rustix::io::Errno;
use rustix::net::{AddressFamily, SendFlags, SocketFlags, SocketType, send, socketpair};
use std::os::fd::OwnedFd;
use std::sync::{Mutex, MutexGuard, PoisonError, TryLockError};

/// As many subscribers as are served at once.
const MAX_SUBSCRIBERS: usize = 8;

/// Everyone who listens to frames, and what the frames begin with.
#[derive(Debug, Default)]
pub struct Taps(Mutex<Told>);

#[derive(Debug, Default)]
struct Told {
    header: String,
    subscribers: Vec<OwnedFd>,
}

impl Taps {
    /// Frames that begin with `header`.
    pub fn new(header: &str) -> Self {
        Self(Mutex::new(Told { header: header.to_owned(), subscribers: Vec::new() }))
    }

    /// Whoever comes from now on gets `header`: the columns are the same.
    pub fn describe(&self, header: &str) {
        self.told().header = header.to_owned();
    }

    /// Frames of other sensors follow, that begin with `header`: ends the stream of everyone who had another.
    pub fn begin(&self, header: &str) {
        *self.told() = Told { header: header.to_owned(), subscribers: Vec::new() };
    }

    /// A new subscriber's end, on which the header has been sent already; then a line a frame, one
    /// packet each. Errors when there are too many subscribers or the system has no descriptor left.
    pub fn subscribe(&self) -> std::io::Result<OwnedFd> {
        let mut told = self.told();
        if told.subscribers.len() >= MAX_SUBSCRIBERS {
            return Err(std::io::Error::other(format!("{MAX_SUBSCRIBERS} recordings are running already")));
        }
        let (ours, theirs) = socketpair(AddressFamily::UNIX, SocketType::SEQPACKET, SocketFlags::CLOEXEC, None)?;
        send(&ours, told.header.as_bytes(), SendFlags::DONTWAIT | SendFlags::NOSIGNAL)?;
        told.subscribers.push(ours);
        Ok(theirs)
    }

    fn told(&self) -> MutexGuard<'_, Told> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Sends the line that `make` writes to every subscriber that has room for it; does not call
    /// `make` when there is none.
    pub fn offer(&self, line: &mut String, make: impl FnOnce(&mut String)) {
        let mut told = match self.0.try_lock() {
            Ok(guard) => guard,
            Err(TryLockError::Poisoned(p)) => p.into_inner(),
            Err(TryLockError::WouldBlock) => return,
        };
        if told.subscribers.is_empty() {
            return;
        }
        line.clear();
        make(line);
        told.subscribers.retain(|fd| {
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
        let taps = Taps::new("time_s\n");
        let mut line = String::new();
        taps.offer(&mut line, |_| panic!("nobody listens"));
        let fd = taps.subscribe().unwrap();
        taps.offer(&mut line, |l| l.push_str("0.02\n"));
        assert_eq!(read(&fd), "time_s\n");
        assert_eq!(read(&fd), "0.02\n");
        drop(fd);
        taps.offer(&mut line, |l| l.push_str("0.04\n"));
        taps.offer(&mut line, |_| panic!("the subscriber is gone"));
    }

    #[test]
    fn who_was_told_of_other_columns_gets_nothing_more() {
        let taps = Taps::new("time_s,nose_obj_c\n");
        let before = taps.subscribe().unwrap();
        taps.describe("# a trim\ntime_s,nose_obj_c\n");
        let between = taps.subscribe().unwrap();
        taps.offer(&mut String::new(), |l| l.push_str("0.02,1\n"));
        taps.begin("time_s,tail_obj_c\n");
        let after = taps.subscribe().unwrap();
        taps.offer(&mut String::new(), |l| l.push_str("0.04,2\n"));
        let all = |fd| [read(fd), read(fd), read(fd)];
        assert_eq!(all(&before), ["time_s,nose_obj_c\n", "0.02,1\n", ""], "ended");
        assert_eq!(all(&between), ["# a trim\ntime_s,nose_obj_c\n", "0.02,1\n", ""]);
        assert_eq!([read(&after), read(&after)], ["time_s,tail_obj_c\n", "0.04,2\n"]);
    }

    #[test]
    fn a_subscriber_that_does_not_read_holds_up_nobody() {
        let taps = Taps::new("time_s\n");
        let _fd = taps.subscribe().unwrap();
        let mut line = String::new();
        for _ in 0..100_000 {
            taps.offer(&mut line, |l| l.push_str("0.02,1,2,3,4,5,6\n"));
        }
    }
}
