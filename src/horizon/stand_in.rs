//! What is shown in place of an attitude that cannot be trusted.

use super::continuity::{angle, between, widened};
use crate::attitude::Attitude;
use crate::time::Time;
use std::f64::consts::FRAC_PI_2;

/// How fast the attitude of an aircraft that nobody watches departs from what it was, rad/s: 6 °/s. In the
/// simulated flights its vertical is a root mean square of 6 to 7° away after a second, 13 to 17° after three, 26 to
/// 37° after ten.
const DRIFT: f64 = 6.0 / 180.0 * std::f64::consts::PI;

/// The time constant with which what is shown eases to level, s.
const EASES_S: f64 = 2.0;

/// The standard deviation at which nothing is known, rad.
const UNKNOWN: f64 = FRAC_PI_2;

/// An attitude as it was published.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shown {
    /// Roll and pitch, rad.
    pub attitude: Attitude,
    /// Their standard deviations, rad.
    pub sigma: Attitude,
    /// The frame's time.
    pub at: Time,
}

impl Shown {
    /// This attitude at a later time, less sure the longer ago it was.
    pub fn held(&self, now: Time) -> Shown {
        self.moved(self.attitude, now)
    }

    /// This attitude at a later time, eased towards level from a time on. How far that is from what was last known counts as
    /// error.
    pub fn levelled(&self, now: Time, since: Time) -> Shown {
        let share = 1.0 - (-now.since(since).max(0.0) / EASES_S).exp();
        self.moved(Attitude::from_vertical(between(self.attitude.vertical(), [0.0, 0.0, 1.0], share)), now)
    }

    fn moved(&self, attitude: Attitude, now: Time) -> Shown {
        let drift = DRIFT * now.since(self.at).max(0.0);
        let by = drift.hypot(angle(self.attitude.vertical(), attitude.vertical()));
        Shown { attitude, sigma: widened(self.sigma, attitude.pitch, by, UNKNOWN, f64::hypot), at: now }
    }
}
