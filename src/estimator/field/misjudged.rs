//! Whether the wrong sensor was left out: the sky that the others tell of is none then.
//!
//! Five sensors of which one is wrong are explained by an attitude and a sky that go ever farther with what that one shows.
//! What they must be taken to see by shows it first: it is known well before, and a sky of any shape asks for little of it.

use super::FieldEstimator;
use super::state::{DEPTH, VIEW};
use crate::attitude::Attitude;
use crate::estimator::Standing;

/// So many standard deviations from what they are said to see by is no sky's.
const FAR: f64 = 3.0;
/// For so long, s: what is found at a wall, or in a turn, comes and goes.
const FAR_S: f64 = 2.0;
/// So many are usual of that, and of how thick the sky is; for each that it is more the attitude is off by so much, rad (20°).
const USUAL: f64 = 2.0;
const DOUBT: f64 = 0.35;

impl FieldEstimator {
    /// Whether, `dt_s` after the last frame, what was said against sensors is to be taken back: one is left out, and those that
    /// are heard have told of no sky for long enough. Beside a gyro that would show in the turns.
    pub(super) fn misjudged(&mut self, dt_s: f64) -> bool {
        let far = self.state.x[VIEW].abs() > FAR * self.tuning.spread;
        let astray = far && self.by_fewer();
        self.astray_s = if astray { self.astray_s + dt_s.clamp(0.0, 1.0) } else { 0.0 };
        self.astray_s > FAR_S
    }

    /// How far roll and pitch may be off for it meanwhile, rad.
    pub(super) fn astray(&self) -> Attitude {
        if !self.by_fewer() {
            return Attitude::default();
        }
        let ((depth, sigma, _), x) = (self.tuning.depth, &self.state.x);
        let off = (x[VIEW] / self.tuning.spread).abs().max((depth - x[DEPTH]) / sigma);
        let doubt = DOUBT * (off - USUAL).max(0.0);
        Attitude { roll: doubt, pitch: doubt }
    }

    /// Whether a sensor is left out where nothing but the others tells that, and not its die.
    fn by_fewer(&self) -> bool {
        let mut left_out =
            (0..self.model.sensors()).filter(|i| self.witnesses.standing(*i) == Standing::LeftOut).peekable();
        left_out.peek().is_some() && !left_out.any(|i| self.witnesses.sees_film(i)) && !self.gyro.in_use()
    }
}
