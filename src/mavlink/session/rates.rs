//! How often each message goes out: as configured, until somebody asks for another interval.

use super::Seen;
use crate::config::settings::Streams;
use crate::mavlink::decimator::Decimator;
use crate::time::Time;
use ::mavlink::MessageData;
use ::mavlink::dialects::common::{
    ATTITUDE_DATA, ATTITUDE_QUATERNION_COV_DATA, ATTITUDE_QUATERNION_DATA, HEARTBEAT_DATA, NAMED_VALUE_FLOAT_DATA,
    SYS_STATUS_DATA,
};
use std::time::Duration;
use thiserror::Error;

/// The period of HEARTBEAT, and of SYS_STATUS where that is sent.
pub const SECOND: Duration = Duration::from_secs(1);

/// How often a message goes out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rate {
    /// Not at all.
    Never,
    /// Once for each frame.
    EachFrame,
    /// Once in this time, and not more often than there are frames.
    Every(Duration),
}

impl Rate {
    /// So many times a second; 0, and what is no rate, is never.
    fn hz(hz: f64) -> Self {
        Duration::try_from_secs_f64(1.0 / hz).ok().filter(|p| !p.is_zero()).map_or(Self::Never, Self::Every)
    }
}

/// Why an interval is not set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum IntervalError {
    /// The message has no interval to set.
    #[error("message {0} is not sent at intervals; SYS_STATUS, ATTITUDE, ATTITUDE_QUATERNION and its covariance are")]
    NoStream(u32),
    /// Whoever listens relies on the heartbeat.
    #[error("HEARTBEAT goes out once a second, whatever is asked for")]
    Heartbeat,
    /// Not an interval.
    #[error("an interval is in microseconds, -1 for none or 0 for the usual one")]
    NoInterval,
}

/// One message's pace.
#[derive(Clone, Debug)]
pub struct Pace {
    usual: Rate,
    asked: Option<Rate>,
    decimator: Option<Decimator>,
    next: Time,
}

impl Pace {
    fn new(usual: Rate, now: Time) -> Self {
        let mut pace = Self { usual, asked: None, decimator: None, next: now };
        pace.settle();
        pace
    }

    /// The rate in force.
    pub fn rate(&self) -> Rate {
        self.asked.unwrap_or(self.usual)
    }

    fn settle(&mut self) {
        self.decimator = match self.rate() {
            Rate::Every(period) => Decimator::new(1.0 / period.as_secs_f64()),
            Rate::Never | Rate::EachFrame => None,
        };
    }

    /// Whether the frame of `time` is one to send.
    pub fn passes(&mut self, time: Time) -> bool {
        self.rate() != Rate::Never && self.decimator.as_mut().is_none_or(|d| d.passes(time))
    }

    /// Whether one is due at `now`, with a `fresh` frame or without, where frames come every `frame`.
    pub fn due(&mut self, now: Time, fresh: bool, frame: Duration) -> bool {
        let (fresh, period) = match self.rate() {
            Rate::Never => return false,
            Rate::Every(period) if period >= frame => (false, period),
            // When frames no longer come it goes on, slowly: that is to be told as well.
            Rate::EachFrame | Rate::Every(_) => (fresh, SECOND.max(2 * frame)),
        };
        // Further away than a period: it was longer before, or the clock was set back.
        let astray = self.next.since(now) > period.as_secs_f64();
        if now < self.next && !astray && !fresh {
            return false;
        }
        self.next = if astray || fresh { now + period } else { after(self.next, period, now) };
        true
    }
}

/// The next due time on a schedule of `period` that is not left for a late step, only for one that
/// is late by more than a period.
pub fn after(due: Time, period: Duration, now: Time) -> Time {
    if due + period > now { due + period } else { now + period }
}

/// The paces of all messages that have one.
#[derive(Clone, Debug)]
pub struct Rates {
    /// ATTITUDE.
    pub attitude: Pace,
    /// ATTITUDE_QUATERNION.
    pub quaternion: Pace,
    /// ATTITUDE_QUATERNION_COV.
    pub covariance: Pace,
    /// SYS_STATUS.
    pub sys_status: Pace,
    /// NAMED_VALUE_FLOAT, all of them.
    pub values: Pace,
    frame: Duration,
}

impl Rates {
    /// As `streams` says, from `now` on.
    pub fn new(streams: &Streams, now: Time) -> Self {
        let pace = |rate| Pace::new(rate, now);
        Self {
            attitude: pace(streams.attitude_hz.map_or(Rate::EachFrame, Rate::hz)),
            quaternion: pace(Rate::hz(streams.quaternion_hz)),
            covariance: pace(Rate::hz(streams.covariance_hz)),
            sys_status: pace(Rate::Never),
            values: pace(Rate::hz(streams.values_hz)),
            frame: Duration::from_millis(20),
        }
    }

    /// Whether SYS_STATUS goes out once a second unasked.
    pub fn set_sys_status(&mut self, wanted: bool) {
        self.sys_status.usual = if wanted { Rate::Every(SECOND) } else { Rate::Never };
        self.sys_status.settle();
    }

    /// The daemon's own rate: nothing goes out more often.
    pub fn set_frame_rate(&mut self, hz: f64) {
        self.frame = Duration::try_from_secs_f64(1.0 / hz).unwrap_or(self.frame);
    }

    /// The time between two frames.
    pub fn frame(&self) -> Duration {
        self.frame
    }

    /// Other settings: what was asked for stays.
    pub fn configure(&mut self, streams: &Streams, now: Time) {
        let new = Self::new(streams, now);
        for (old, new) in [
            (&mut self.attitude, new.attitude),
            (&mut self.quaternion, new.quaternion),
            (&mut self.covariance, new.covariance),
            (&mut self.values, new.values),
        ] {
            *old = Pace { asked: old.asked, ..new };
            old.settle();
        }
    }

    fn pace(&mut self, id: u32) -> Option<&mut Pace> {
        Some(match id {
            SYS_STATUS_DATA::ID => &mut self.sys_status,
            ATTITUDE_DATA::ID => &mut self.attitude,
            ATTITUDE_QUATERNION_DATA::ID => &mut self.quaternion,
            ATTITUDE_QUATERNION_COV_DATA::ID => &mut self.covariance,
            NAMED_VALUE_FLOAT_DATA::ID => &mut self.values,
            _ => return None,
        })
    }

    /// SET_MESSAGE_INTERVAL of message `id`: µs, -1 for none, 0 for the configured one. Nothing goes out more often
    /// than there are frames.
    pub fn set(&mut self, id: u32, interval_us: f32) -> Result<(), IntervalError> {
        let frame = self.frame;
        let asked = match interval_us {
            -1.0 => Some(Rate::Never),
            0.0 => None,
            us if us > 0.0 && us.is_finite() => {
                let period = Duration::from_micros(us as u64).min(Duration::from_micros(u64::from(i32::MAX as u32)));
                Some(if period <= frame { Rate::EachFrame } else { Rate::Every(period) })
            }
            _ => return Err(IntervalError::NoInterval),
        };
        if id == HEARTBEAT_DATA::ID {
            let same = matches!(asked, None | Some(Rate::Every(SECOND)));
            return if same { Ok(()) } else { Err(IntervalError::Heartbeat) };
        }
        let pace = self.pace(id).ok_or(IntervalError::NoStream(id))?;
        pace.asked = asked;
        pace.settle();
        Ok(())
    }

    /// The interval of message `id` as MESSAGE_INTERVAL has it: µs, -1 for one that is not sent, 0 for one that has no
    /// interval.
    pub fn interval_us(&mut self, id: u32) -> i32 {
        let micros = |d: Duration| i32::try_from(d.as_micros()).unwrap_or(i32::MAX);
        if id == HEARTBEAT_DATA::ID {
            return micros(SECOND);
        }
        let frame = self.frame;
        self.pace(id).map_or(0, |pace| match pace.rate() {
            Rate::Never => -1,
            Rate::EachFrame => micros(frame),
            Rate::Every(period) => micros(period.max(frame)),
        })
    }
}

/// Whether the attitude in `seen` is of a moment other than `last`.
pub fn is_new(seen: &Seen, last: Option<Time>) -> bool {
    seen.moment.attitude.is_some() && last != Some(seen.moment.valid_at)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rates(streams: &Streams) -> Rates {
        let mut rates = Rates::new(streams, Time::default());
        rates.set_frame_rate(50.0);
        rates
    }

    #[test]
    fn intervals_are_set_bounded_and_given_back() {
        let mut r = rates(&Streams { values_hz: 2.0, ..Streams::default() });
        assert_eq!(
            [0, 1, 30, 31, 251, 253, 33].map(|id| r.interval_us(id)),
            [1_000_000, -1, 20_000, -1, 500_000, 0, 0]
        );
        for (asked, got) in [(100_000.0, 100_000), (5_000.0, 20_000), (-1.0, -1), (1e30, i32::MAX), (0.0, 20_000)] {
            assert_eq!(r.set(30, asked), Ok(()));
            assert_eq!(r.interval_us(30), got, "{asked} µs");
        }
        for bad in [f32::NAN, f32::INFINITY, -2.0, -0.5] {
            assert_eq!(r.set(30, bad), Err(IntervalError::NoInterval));
        }
        assert_eq!(r.set(33, 1e5), Err(IntervalError::NoStream(33)));
        assert_eq!(r.interval_us(30), 20_000);
    }

    #[test]
    fn the_heartbeat_stays_as_it_is() {
        let mut r = rates(&Streams::default());
        assert_eq!([-1.0, 2e6, 1e5].map(|us| r.set(0, us)), [Err(IntervalError::Heartbeat); 3]);
        assert_eq!([0.0, 1e6].map(|us| r.set(0, us)), [Ok(()); 2]);
        assert_eq!(r.interval_us(0), 1_000_000);
    }

    #[test]
    fn a_shorter_interval_holds_at_once() {
        let mut r = rates(&Streams::default());
        let due = |r: &mut Rates, secs| r.values.due(Time::from_secs_f64(secs), true, r.frame);
        r.set(251, 1e9).unwrap();
        assert!(due(&mut r, 1.0) && !due(&mut r, 2.0));
        r.set(251, 1e5).unwrap();
        assert!(due(&mut r, 2.1) && !due(&mut r, 2.15) && due(&mut r, 2.2));
    }

    #[test]
    fn what_was_asked_for_outlives_other_settings() {
        let mut r = rates(&Streams::default());
        r.set(31, 50_000.0).unwrap();
        r.configure(&Streams { quaternion_hz: 1.0, values_hz: 5.0, ..Streams::default() }, Time::default());
        assert_eq!((r.interval_us(31), r.interval_us(251)), (50_000, 200_000));
        r.set(31, 0.0).unwrap();
        assert_eq!(r.interval_us(31), 1_000_000);
    }
}
