//! A gyro's bias that has changed.
//!
//! The filter knows a bias well after a minute, and one that moves it explains by scenes: the attitude follows the gyro. How
//! the sky turns otherwise than the gyro says ([turns](super::turns)) depends on no scene, and tells of it within seconds.

use super::FieldEstimator;
use super::rates::correction;
use super::state::{CONTRAST, RATE};
use crate::estimator::vector::{Vector, add_scaled, dot, length};

/// So far apart they may be, rad/s (0.5°/s); the more under a contrast below the second, K.
const APART: (f64, f64) = (0.0087, 14.0);
/// What is seen of it is off by so much, rad/s, for so long, s.
const SEEN: (f64, f64) = (0.0087, 5.0);
/// Less than this a filter that begins anew finds by itself, rad/s (1°/s).
const FOUND: f64 = 0.017;

impl FieldEstimator {
    /// Doubts the bias where the sky is seen to turn otherwise, for `dt_s`, and lets that tell of it.
    pub(super) fn watch_bias(&mut self, dt_s: f64) {
        let Some(bias) = self.turns.bias().filter(|_| self.gyro.in_use() && dt_s > 0.0) else { return };
        let (up, off) = (self.state.vertical(), add_scaled(bias, 1.0, correction(&self.state)));
        // Nothing is seen of how it turns about the vertical.
        let off = add_scaled(off, -dot(off, up), up);
        let contrast_k = self.state.x[CONTRAST].abs().max(1.0);
        let more = length(off) - APART.0 * (APART.1 / contrast_k).max(1.0);
        if more <= 0.0 {
            return;
        }
        let share = more / length(off);
        for (i, off) in off.iter().enumerate() {
            self.state.add_variance(RATE + i, (share * off).powi(2) * dt_s);
        }
        for (i, off) in off.iter().enumerate() {
            self.state.correct(&[(RATE + i, 1.0)], -off, SEEN.0.powi(2) * 2.0 * SEEN.1 / dt_s);
        }
        self.state.settle();
    }

    /// As much of the bias as a filter that begins anew would not find by itself, rad/s.
    pub(super) fn bias_seen(&self) -> Vector {
        let bias = self.turns.bias().unwrap_or_default();
        let share = 1.0 - FOUND / length(bias).max(FOUND);
        bias.map(|b| share * b)
    }
}
