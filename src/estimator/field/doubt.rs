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
/// What is found after these must last so long, s: it is new, and may be what one sensor does, or a wall, until the
/// witnesses know. What is found before was there.
const LASTS_S: f64 = 3.0;

impl FieldEstimator {
    /// What was learnt while the scene was thought to be alike all around is in doubt once it is not: the sky's shape at
    /// once, the attitude and the sides when that has lasted.
    pub(super) fn doubt(&mut self, dt_s: f64) {
        // What one sensor does is no scene.
        if self.witnesses.undecided() {
            self.found_s = 0.0;
            return;
        }
        let unlike = self.scene.unlike();
        if unlike < UNLIKE.0 {
            (self.unlike, self.tilted) = (false, false);
        }
        if unlike > UNLIKE.1 && !self.unlike {
            self.unlike = true;
            self.doubt_sky();
        }
        let even = self.gyro.in_use() && !self.sided;
        let found = unlike > UNLIKE.1 && !self.tilted || even && self.has_warm_side();
        self.found_s = if found { self.found_s + dt_s } else { 0.0 };
        if self.found_s > LASTS_S * (self.turned / LOOKED_AROUND).min(1.0) {
            self.found_s = 0.0;
            self.tilted |= unlike > UNLIKE.1;
            self.doubt_attitude(even);
        }
    }

    /// Whether a side of sky or ground is warmer than expected.
    fn has_warm_side(&self) -> bool {
        let (s, t) = (&self.state, &self.tuning);
        let side_k2: f64 = s.x[SIDE..SIDE + 4].iter().map(|k| k * k).sum();
        side_k2 > (UNEXPECTED * t.side.0).powi(2) || side::shows(s, t.unlike_side)
    }

    /// The sky's shape, and what each sensor sees of a scene of its own.
    fn doubt_sky(&mut self) {
        let scene_k2 = self.scene.variance();
        self.state.add_variance(DEPTH, 0.1);
        self.state.add_variance(RADIANCE, 0.1);
        for i in 0..self.model.sensors() {
            self.state.add_variance(self.state.scene(i), scene_k2);
        }
    }

    /// What a warm side may have been taken for; where the sides were taken for `even` so far, these too.
    fn doubt_attitude(&mut self, even: bool) {
        let (s, t) = (&mut self.state, &self.tuning);
        for i in 0..3 {
            s.add_variance(TURN + i, t.unlike_turn.powi(2));
            s.add_variance(RATE + i, if self.gyro.in_use() { 0.1_f64.to_radians().powi(2) } else { 0.0 });
        }
        if even {
            self.sided = true;
            // An aircraft that has looked all around has seen what side was warmer: what is found then is new, and
            // was never taken for an attitude.
            if self.turned < LOOKED_AROUND {
                side::hide(s, t.unlike_side)
            } else {
                side::expect(s, t.unlike_side)
            }
            self.doubt_sky();
        }
    }
}
