//! How much the sensors average in radiance, and whether that can be told.

use super::FieldEstimator;
use super::state::RADIANCE;
use crate::estimator::Standing;
use crate::time::Time;

/// A sensor looks up whose axis' sine above the wings' plane is larger.
const UP: f64 = 0.5;
/// One that was not heard for longer is missing, s.
const MISSING_S: f64 = 1.0;
/// Nothing is averaged in radiance, or everything.
const BOUNDS: (f64, f64) = (0.0, 1.0);

impl FieldEstimator {
    /// Takes it for certain while it cannot be told. Without a gyro, and without a sensor that looks up, it is learnt from what
    /// the model leaves, goes to its bounds, and takes the sky's depth and the field of view with it.
    pub(super) fn consider_averaging(&mut self, now: Time) {
        let looks_up = |i: usize| {
            self.model.direction(i)[2] > UP
                && self.hearing(i).standing == Standing::Heard
                && self.stamps[i].is_some_and(|at| now.since(at) < MISSING_S)
        };
        let told = self.gyro.in_use() || (0..self.model.sensors()).any(looks_up);
        if !told && self.averaging.is_none() {
            self.averaging = Some(self.state.p[RADIANCE][RADIANCE]);
            self.state.set_variance(RADIANCE, 0.0);
        } else if let (true, Some(variance)) = (told, self.averaging) {
            self.averaging = None;
            self.state.set_variance(RADIANCE, variance);
        }
    }

    /// Keeps it to what can be.
    pub(super) fn bound_averaging(&mut self) {
        self.state.bound(RADIANCE, BOUNDS);
    }
}
