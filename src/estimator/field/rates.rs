//! How fast it turns, by a gyro or without one.

use super::state::{RATE, State};
use super::tuning::Tuning;
use super::{FieldEstimator, askew};
use crate::estimator::flying::G_M_S2;
use crate::estimator::vector::{Vector, add_scaled, dot};

/// The steepest bank's tangent from which a turn is reckoned.
const STEEPEST: f64 = 2.0;
/// The least bank by which it turns where no gyro tells, rad.
const LEAST_BANK: f64 = 10_f64.to_radians();

impl FieldEstimator {
    /// A gyro's rates as they are by all that is known of it, rad/s on nose, left, up.
    pub(super) fn turning(&self) -> Option<Vector> {
        self.gyro.rates().map(|gyro| rates(&self.state, &self.tuning, Some(gyro)))
    }

    /// How fast it turns about the vertical, rad/s.
    pub(super) fn heading_rate(&self) -> f64 {
        let up = self.state.vertical();
        // Without a gyro a turn is what a bank makes, and a small bank may be an error.
        let turns = self.gyro.in_use() || up[1].abs() > LEAST_BANK.sin();
        if turns { dot(rates(&self.state, &self.tuning, self.gyro.rates()), up) } else { 0.0 }
    }
}

/// What is added to a gyro's rates, or the rates themselves without one.
pub fn correction(state: &State) -> Vector {
    [state.x[RATE], state.x[RATE + 1], state.x[RATE + 2]]
}

/// How fast the body turns, rad/s on (nose, left, up): by a gyro's rates, or by those that are part of the state.
pub fn rates(state: &State, t: &Tuning, gyro: Option<Vector>) -> Vector {
    match gyro {
        Some(gyro) => {
            let unshown = add_scaled(correction(state), 1.0, askew::unshown(state, gyro));
            add_scaled(unshown, 1.0, gyro)
        }
        // Nothing tells of the heading but the bank.
        None => add_scaled(correction(state), turning(state.vertical(), t.cruise_m_s), state.vertical()),
    }
}

/// The rate about the upward vertical of a coordinated turn, rad/s: clockwise, below 0, with the right
/// wing down.
pub fn turning(up: Vector, speed_m_s: f64) -> f64 {
    -G_M_S2 / speed_m_s * (up[1] / up[2].abs().max(0.3)).clamp(-STEEPEST, STEEPEST)
}
