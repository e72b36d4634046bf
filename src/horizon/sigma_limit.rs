//! An attitude that is too uncertain is none: a limit on the standard deviation, with hysteresis.

use crate::attitude::Attitude;
use crate::fault::debounce::{Debounce, State};
use crate::fault::{ActiveFault, Evidence, FaultKind};
use crate::time::Time;

/// For how long the limit must be exceeded, and kept again, s.
const ON_AFTER_S: f64 = 0.2;
const OFF_AFTER_S: f64 = 1.0;

/// The share of the limit below which it is kept again.
const HYSTERESIS: f64 = 0.8;

/// Stands for a standard deviation that is no number, °: nothing is known.
const UNKNOWN_DEG: f64 = 90.0;

/// Watches the standard deviation of the direction of the vertical. That of roll counts by the cosine of pitch:
/// towards ±90° of pitch it grows without the vertical being known any less.
#[derive(Clone, Copy, Debug)]
pub(super) struct SigmaLimit {
    limit_deg: f64,
    worst_deg: f64,
    debounce: Debounce,
}

impl SigmaLimit {
    /// For a limit in degrees.
    pub fn new(limit_deg: f64) -> Self {
        Self { limit_deg, worst_deg: 0.0, debounce: Debounce::new(ON_AFTER_S, OFF_AFTER_S) }
    }

    /// Another limit, °.
    pub fn retune(&mut self, limit_deg: f64) {
        self.limit_deg = limit_deg;
    }

    /// Takes in an attitude with its standard deviations, rad; whether it may be given.
    pub fn update(&mut self, attitude: Attitude, sigma: Attitude, now: Time) -> bool {
        let worst_deg = (sigma.roll * attitude.pitch.cos()).abs().max(sigma.pitch.abs()).to_degrees();
        let known = [attitude.roll, attitude.pitch, sigma.roll, sigma.pitch].into_iter().all(f64::is_finite);
        self.worst_deg = if known { worst_deg } else { UNKNOWN_DEG };
        let limit_deg = if self.debounce.is_active() { HYSTERESIS * self.limit_deg } else { self.limit_deg };
        self.debounce.update(!known || self.worst_deg > limit_deg, now) != State::Active
    }

    /// Adds to `faults` what may not be given, in the vocabulary's order. A wet sensor is reason enough. Whether it may not.
    pub fn report(&self, faults: &mut Vec<ActiveFault>) -> bool {
        let kind = FaultKind::Obstructed;
        let told = |f: &ActiveFault| f.kind == kind || matches!(f.kind, FaultKind::WetSensor(_));
        if self.debounce.is_active() && !faults.iter().any(told) {
            let evidence = Evidence::Limit { value: self.worst_deg, limit: self.limit_deg, unit: "°" };
            let place = faults.iter().position(|f| f.kind > kind).unwrap_or(faults.len());
            faults.insert(place, ActiveFault { kind, since: self.debounce.since(), evidence });
        }
        self.debounce.is_active()
    }
}
