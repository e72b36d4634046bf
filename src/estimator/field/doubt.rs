//! When the scene is found not to be alike all around.

use super::state::{DEPTH, RADIANCE, RATE, SIDE, TURN};
use super::{FieldEstimator, side};

/// What no sky alike all around explains, from nothing to certain: below the first there is none (again),
/// beyond the second there is.
const UNLIKE: (f64, f64) = (0.1, 0.5);
/// A warm side found so many times larger than it was expected was expected wrongly.
const UNEXPECTED: f64 = 3.0;
/// Turns by so much in all, rad, show all sides.
const LOOKED_AROUND: f64 = 3.5;

impl FieldEstimator {
    /// What was learnt while the scene was thought to be alike all around is in doubt once it is not.
    pub(super) fn doubt(&mut self) {
        // What one sensor does is no scene.
        if self.witnesses.undecided() {
            return;
        }
        let (unlike, t, gyro) = (self.scene.unlike(), &self.tuning, self.gyro.in_use());
        let side_k2: f64 = self.state.x[SIDE..SIDE + 4].iter().map(|k| k * k).sum();
        let newly = gyro && !self.sided;
        let found = newly && (side_k2 > (UNEXPECTED * t.side.0).powi(2) || side::shows(&self.state, t.unlike_side));
        if unlike < UNLIKE.0 {
            self.unlike = false;
        }
        if found || unlike > UNLIKE.1 && !self.unlike {
            self.unlike |= unlike > UNLIKE.1;
            // An aircraft that has looked all around has seen what side was warmer: what is found then is new, and
            // was never taken for an attitude.
            let first = gyro && !self.sided && self.turned < LOOKED_AROUND;
            self.sided |= gyro;
            let s = &mut self.state;
            let share = if gyro { 1.0 } else { 0.0 };
            for i in 0..3 {
                s.add_variance(TURN + i, t.unlike_turn.powi(2));
                s.add_variance(RATE + i, share * 0.1_f64.to_radians().powi(2));
            }
            s.add_variance(DEPTH, 0.1);
            s.add_variance(RADIANCE, 0.1);
            if first {
                side::hide(s, t.unlike_side);
            } else if newly {
                side::expect(s, t.unlike_side);
            }
            for i in 0..self.model.sensors() {
                s.add_variance(s.scene(i), self.scene.variance());
            }
        }
    }
}
