//! systemd's watchdog, fed by finished scans and by nothing else: a daemon whose sampling stands
//! still is restarted, however well its other threads are.

use crate::attitude::Estimate;
use crate::frame::{Frame, Missing};
use crate::time::Time;
use sd_notify::NotifyState;
use std::ffi::OsStr;
use std::io;
use std::os::linux::net::SocketAddrExt;
use std::os::unix::ffi::OsStrExt;
use std::os::unix::net::{SocketAddr, UnixDatagram};
use std::time::Duration;

/// Meals in the time that systemd waits for one.
const MEALS: u32 = 4;

/// The way to systemd's watchdog. It has its own socket, which is opened once and never waits:
/// neither an allocation nor a systemd that hangs delays the sampling loop.
#[derive(Debug)]
pub struct Watchdog {
    socket: UnixDatagram,
    word: String,
    every: Duration,
    fed: Option<Time>,
}

impl Watchdog {
    /// systemd's, where it keeps one on this process (`WatchdogSec=`).
    pub fn from_environment() -> Option<Self> {
        let limit = sd_notify::watchdog_enabled()?;
        let place = std::env::var_os("NOTIFY_SOCKET")?;
        match connect(&place).and_then(|socket| Self::new(socket, limit)) {
            Ok(watchdog) => Some(watchdog),
            Err(e) => {
                log::error!(
                    "the watchdog's socket {} cannot be reached: {e}; systemd will restart irhorizond, unless its unit \
                     has WatchdogSec=0",
                    place.display()
                );
                None
            }
        }
    }

    /// One that listens at the other end of `socket` and bites after `limit` without a meal.
    pub fn new(socket: UnixDatagram, limit: Duration) -> io::Result<Self> {
        socket.set_nonblocking(true)?;
        Ok(Self { socket, word: NotifyState::Watchdog.to_string(), every: limit / MEALS, fed: None })
    }

    /// A scan has ended in `frame`, and `estimate` was made of it: a meal, if both say something and
    /// the last meal was long enough ago. A meal that systemd does not take now is offered again
    /// at the next scan.
    pub fn scanned(&mut self, frame: &Frame, estimate: &Estimate) {
        let hungry = self.fed.is_none_or(|fed| frame.time.since(fed) >= self.every.as_secs_f64());
        if hungry && says_something(frame, estimate) && self.socket.send(self.word.as_bytes()).is_ok() {
            self.fed = Some(frame.time);
        }
    }
}

/// Whether a scan did its work: it measured, or it or a fault says why it could not. The fault may be allowed to take as
/// long as the watchdog.
fn says_something(frame: &Frame, estimate: &Estimate) -> bool {
    frame.readings.iter().any(|r| *r != Err(Missing::NotYet)) || !estimate.faults.is_empty()
}

/// A path, or a name in the abstract namespace, which begins with `@`.
fn connect(place: &OsStr) -> io::Result<UnixDatagram> {
    let socket = UnixDatagram::unbound()?;
    match place.as_bytes().strip_prefix(b"@") {
        Some(name) => socket.connect_addr(&SocketAddr::from_abstract_name(name)?)?,
        None => socket.connect(place)?,
    }
    Ok(socket)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fault::{ActiveFault, Evidence, FaultKind};
    use crate::frame::{Sample, Value};

    fn pair(limit_s: f64) -> (Watchdog, UnixDatagram) {
        let (ours, theirs) = UnixDatagram::pair().unwrap();
        theirs.set_nonblocking(true).unwrap();
        (Watchdog::new(ours, Duration::from_secs_f64(limit_s)).unwrap(), theirs)
    }

    fn meals(systemd: &UnixDatagram) -> usize {
        let mut buffer = [0; 64];
        std::iter::from_fn(|| systemd.recv(&mut buffer).ok().map(|n| assert_eq!(&buffer[..n], b"WATCHDOG=1"))).count()
    }

    fn frame(time_s: f64, missing: Option<Missing>) -> Frame {
        let time = Time::from_secs_f64(time_s);
        let reading = missing.map_or(Ok(Sample { value: Value::Volts(1.0), time }), Err);
        Frame { time, readings: vec![reading], ..Frame::default() }
    }

    #[test]
    fn a_few_meals_in_its_time_and_no_more() {
        let (mut watchdog, systemd) = pair(4.0);
        for i in 0..500 {
            watchdog.scanned(&frame(100.0 + f64::from(i) * 0.02, None), &Estimate::default());
        }
        let meals = meals(&systemd);
        assert!((9..=11).contains(&meals), "{meals} in 10 s");
    }

    #[test]
    fn scans_that_say_nothing_feed_it_not_and_a_fault_does() {
        let (mut watchdog, systemd) = pair(4.0);
        let mut estimate = Estimate::default();
        for i in 0..500 {
            watchdog.scanned(&frame(f64::from(i) * 0.02, Some(Missing::NotYet)), &estimate);
        }
        assert_eq!(meals(&systemd), 0);
        let evidence = Evidence::Missing { reason: Missing::NoAnswer, failures: 500 };
        estimate.faults.push(ActiveFault { kind: FaultKind::Stale, since: Time::default(), evidence });
        watchdog.scanned(&frame(10.0, Some(Missing::NotYet)), &estimate);
        assert_eq!(meals(&systemd), 1);
    }

    #[test]
    fn scans_that_say_why_they_measured_nothing_feed_it() {
        for missing in [Missing::BusGone, Missing::NoAnswer, Missing::PoweredOff] {
            let (mut watchdog, systemd) = pair(4.0);
            watchdog.scanned(&frame(10.0, Some(missing)), &Estimate::default());
            assert_eq!(meals(&systemd), 1, "{missing}");
        }
    }

    #[test]
    fn a_systemd_that_takes_nothing_delays_nothing() {
        let (mut watchdog, systemd) = pair(0.0);
        for i in 0..10_000 {
            watchdog.scanned(&frame(f64::from(i), None), &Estimate::default());
        }
        let taken = meals(&systemd);
        assert!((1..10_000).contains(&taken), "{taken}");
        watchdog.scanned(&frame(1e5, None), &Estimate::default());
        assert_eq!(meals(&systemd), 1, "and it is fed again");
    }
}
