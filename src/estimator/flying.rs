//! What every reader of slow references shares: what flies, what was heard lately, angles the short way round.

use crate::time::Time;
use std::f64::consts::{PI, TAU};

/// Standard gravity, m/s².
pub const G_M_S2: f64 = 9.806_65;
/// What flies is faster than this, and nothing is faster than that, m/s.
pub const FLYING_M_S: std::ops::Range<f64> = 6.0..200.0;
/// A speed or course older than this is none, s.
const FRESH_S: f64 = 3.0;

/// The last value that was heard, and when.
pub type Held = Option<(f64, Time)>;

/// Takes in what is new, if anything is.
pub fn keep(held: &mut Held, new: Option<f64>, now: Time) {
    if let Some(v) = new {
        *held = Some((v, now));
    }
}

/// What was heard lately.
pub fn fresh(held: Held, now: Time) -> Option<f64> {
    held.filter(|(_, at)| (0.0..FRESH_S).contains(&now.since(*at))).map(|(v, _)| v)
}

/// The speed of something that flies, m/s, if it was heard lately.
pub fn flying(held: Held, now: Time) -> Option<f64> {
    fresh(held, now).filter(|v| FLYING_M_S.contains(v))
}

/// A speed that can be, m/s.
pub fn speed(new: Option<f64>) -> Option<f64> {
    new.filter(|v| (0.0..FLYING_M_S.end).contains(v))
}

/// An angle, rad, into (−π, π].
pub fn wrapped(angle: f64) -> f64 {
    PI - (PI - angle).rem_euclid(TAU)
}
