//! When the scene is found not to be alike all around.

use super::state::{CONTRAST, DEPTH, LEAN, OFFSET, RATE, TURN, VIEW};
use super::{FieldEstimator, lean};
use crate::attitude::Attitude;
use crate::estimator::{PAIR_SLOPE, unseen_lean};
use crate::time::Time;

/// What no sky alike all around explains, from nothing to certain: below the first there is none (again),
/// beyond the second there is.
const UNLIKE: (f64, f64) = (0.1, 0.5);
/// A horizon found to lean so many times farther than was expected was expected wrongly.
const UNEXPECTED: f64 = 3.0;
/// Turns by so much, rad, show all sides.
const LOOKED_AROUND: f64 = 3.5;
/// Banks whose sines are so far apart (15°) show sensors that are off.
const BANKED: f64 = 0.26;
/// Straight on, so many times the lean of a horizon that leans is expected: twice that holds nineteen flights in twenty where
/// one in five has one (of 0.2, a quarter is beyond 1.15).
const HELD: f64 = 1.15 / 2.0;
/// What turns and climb say more than the thermopiles is no more than this, rad; more, on a straight course, may as well be a
/// horizon that leans.
const USUAL_OFFSET: f64 = 3_f64.to_radians();
/// What is found after these must last so long, s: it is new, and may be what one sensor does, or a wall, until the
/// witnesses know. What is found before was there.
const LASTS_S: f64 = 3.0;
/// Of a scene that has been unlike for long, so much is remembered, s.
const LONG_S: f64 = 30.0;
/// What has been told of the lean holds while it is known so well, rad (2.2°: less than what is not told of at all).
const KNOWN: f64 = 0.038;
/// How long it is remembered afterwards, s.
const REMEMBERED_S: f64 = 300.0;

impl FieldEstimator {
    /// What was learnt while the scene was thought to be alike all around is in doubt once it is not: the sky's shape at
    /// once, the attitude and how the horizon leans when that has lasted.
    pub(super) fn doubt(&mut self, now: Time, dt_s: f64) {
        let known = self.state.p[LEAN][LEAN].max(self.state.p[LEAN + 1][LEAN + 1]) < KNOWN * KNOWN;
        self.told = self.gyro.in_use() && (self.aid.tells(now) || self.told && known);
        if !self.told {
            self.forget_lean(dt_s);
        }
        // What one sensor does is no scene.
        if self.witnesses.undecided() {
            self.found_s = 0.0;
            return;
        }
        let unlike = self.scene.unlike();
        let more_s = if unlike > UNLIKE.0 { dt_s } else { -dt_s };
        self.unlike_s = (self.unlike_s + more_s).clamp(0.0, LONG_S);
        if unlike < UNLIKE.0 {
            (self.unlike, self.tilted) = (false, false);
        }
        if unlike > UNLIKE.1 && !self.unlike {
            self.unlike = true;
            self.doubt_sky();
        }
        let even = self.told && !self.leant;
        // Where much depends on it the sky's shape is found first: a lean that is expected in vain is there for minutes.
        let sure = if self.gyro.in_use() { self.scene.surely_unlike() } else { unlike } > UNLIKE.1;
        let found = sure && (even || !self.tilted) || even && self.leans();
        self.found_s = if found { self.found_s + dt_s } else { 0.0 };
        if self.found_s > LASTS_S * (self.turned / LOOKED_AROUND).min(1.0) {
            self.found_s = 0.0;
            self.tilted |= sure;
            self.doubt_attitude(even);
        }
    }

    /// The tilt that scenes of so many K may hide, rad.
    pub(super) fn hidden(&self, scene_k: f64) -> f64 {
        2.0 * self.tuning.hidden.0 * scene_k / (PAIR_SLOPE * self.state.x[CONTRAST].abs().max(1.0))
    }

    /// The tilt that the scene may hide, rad: what is new may be a wall; of what has been there all along slow references
    /// may have told, and no more of it is hidden than the attitude may be `off` by, rad. What one sensor does is no
    /// scene; with a gyro that is soon known, and that it may be a film below or above at once.
    pub(super) fn may_hide(&self, off: f64) -> f64 {
        if self.scene.long_unlike() < UNLIKE.1 && self.witnesses.may_see_film(&self.model) {
            return 0.0;
        }
        let seen = self.hidden(self.scene.seen_k());
        if self.gyro.in_use() && self.witnesses.undecided() {
            return seen;
        }
        seen.min(off).max(self.hidden(self.scene.new_hides_k())).max(self.moved.hides())
    }

    /// The walk of how the horizon leans while the scene is seen to be unlike, as far as slow references tell of it, rad for
    /// a second: a scene that has become stronger makes it lean by as much as it may hide.
    pub(super) fn lean_walk(&self) -> f64 {
        if !self.told {
            return 0.0;
        }
        let t = &self.tuning;
        let new = (self.hidden(self.scene.new_k()) - t.new_lean.0).max(0.0);
        self.scene.surely_unlike() * t.unlike_lean_walk + t.new_lean.1 * new
    }

    /// The walk of the logarithm of the sky's depth, for a second, while what is seen has become unlike the sky that was known,
    /// but may be another one alike all around: it is changing.
    pub(super) fn depth_walk(&self) -> f64 {
        // What one sensor does is no sky.
        if self.witnesses.undecided() || self.unlike_s < LASTS_S {
            return 0.0;
        }
        let new = self.scene.new_k() / self.scene.seen_k().max(f64::MIN_POSITIVE);
        new * self.scene.unlike() * (1.0 - self.scene.surely_unlike()) * self.tuning.unlike_depth_walk
    }

    /// Where nothing tells of the attitude but the thermopiles it is they that are to be believed: a horizon that might
    /// lean anyhow would leave it to the gyro alone, which drifts.
    fn forget_lean(&mut self, dt_s: f64) {
        if self.leant {
            self.leant = false;
            lean::settle(&mut self.state, self.tuning.lean.0);
        }
        let keep = (-dt_s / REMEMBERED_S).exp();
        let s = &mut self.state;
        s.x[LEAN..LEAN + 2].iter_mut().chain(&mut s.lean_mean).for_each(|lean| *lean *= keep);
    }

    /// How far the attitude may be off by a lean that is not expected, and that what tells of it has not ruled out yet; by
    /// any where nothing tells and nothing would show it; rad.
    pub(super) fn unexpected_lean(&self) -> Attitude {
        let up = self.state.vertical();
        if !self.told && !self.model.shows_scenes() {
            return unseen_lean(up);
        }
        let t = &self.tuning;
        let straight = 1.0 - (self.around.ever() / LOOKED_AROUND).min(self.around.banks() / BANKED).min(1.0);
        // Straight on, turns and climb tell of a lean no more than readings do; nor, with one bank, of sensors that are off.
        let unseen = straight * t.unlike_lean * if self.leant { 1.0 } else { HELD };
        let [roll, pitch] = [0, 1].map(|i| {
            let offset = if self.told { (self.state.x[OFFSET + i].abs() - USUAL_OFFSET).max(0.0) } else { 0.0 };
            unseen.hypot(straight * offset)
        });
        let least = Attitude { roll: roll / up[1].hypot(up[2]).max(0.2), pitch };
        if !self.told || self.leant {
            return least;
        }
        let [roll, pitch] = lean::unexpected(&self.state, t.unlike_lean).map(f64::sqrt);
        Attitude { roll: roll.max(least.roll), pitch: pitch.max(least.pitch) }
    }

    /// Whether the horizon leans farther than expected.
    fn leans(&self) -> bool {
        let (s, t) = (&self.state, &self.tuning);
        s.x[LEAN].hypot(s.x[LEAN + 1]) > UNEXPECTED * t.lean.0 || lean::shows(s, t.unlike_lean)
    }

    /// The sky's shape, and what each sensor sees of a scene of its own.
    fn doubt_sky(&mut self) {
        let scene_k2 = self.scene.variance();
        self.state.add_variance(DEPTH, 0.1);
        self.state.add_variance(VIEW, 0.1);
        for i in 0..self.model.sensors() {
            self.state.add_variance(self.state.scene(i), scene_k2);
        }
    }

    /// The attitude, for which a warm side may have been taken; where the horizon was taken for `even` so far, how it
    /// leans too.
    fn doubt_attitude(&mut self, even: bool) {
        let (s, t) = (&mut self.state, &self.tuning);
        for i in 0..3 {
            s.add_variance(TURN + i, t.unlike_turn.powi(2));
            s.add_variance(RATE + i, if self.gyro.in_use() { 0.1_f64.to_radians().powi(2) } else { 0.0 });
        }
        if even {
            self.leant = true;
            // An aircraft that has looked all around has seen what side was warmer: what is found then is new, and
            // was never taken for an attitude.
            if self.turned < LOOKED_AROUND {
                lean::hide(s, t.unlike_lean)
            } else {
                lean::expect(s, t.unlike_lean)
            }
            self.doubt_sky();
        }
    }
}
