//! What is said of the attitude, with all that it might be wrong by.

use super::FieldEstimator;
use super::askew::unbelievable;
use super::output::{attitude, moving};
use super::state::CONTRAST;
use crate::attitude::Attitude;
use crate::estimator::guard::guard;
use crate::estimator::vector::{Vector, product, rotation};
use crate::estimator::{Otherwise, PAIR_SLOPE, Solution};

/// The deviation of what is all or nothing, and one as likely as the other, from all of it: as a share.
const EITHER: f64 = std::f64::consts::FRAC_1_SQRT_2;

impl FieldEstimator {
    pub(super) fn solution(&self) -> Solution {
        let (mut attitude, own, at_rest) = attitude(&self.state, self.vertical());
        let contrast_k = self.state.x[CONTRAST];
        // A warm side looks like an attitude where nothing else tells of that; that there is one shows elsewhere.
        let t = &self.tuning;
        let (least_k, most_k) = if self.told {
            let unseen_k = if self.model.shows_scenes() { 0.0 } else { 2.0 * t.unlike_side_k.1 };
            let side_k = self.scene.unlike() * t.unlike_side_k.1;
            (side_k, side_k.max(self.scene.unlike() * t.hidden.1 * self.scene.seen_k()).max(unseen_k))
        } else {
            let lately = self.scene.lately_unlike();
            let side_k = lately * t.unlike_side_k.0;
            (side_k, side_k.max(lately * t.hidden.0 * self.scene.lately_k()))
        };
        let poor = self.misfit.excess();
        let doubted = |own: Attitude, side_k: f64| {
            let doubt = side_k / (PAIR_SLOPE * contrast_k.abs().max(1.0));
            let roll = own.roll.hypot(doubt / attitude.pitch.cos().max(0.2));
            Attitude { roll: poor * roll, pitch: poor * own.pitch.hypot(doubt) }
        };
        let unheard = self.unheard(attitude);
        let late = self.late();
        let leaning = self.unexpected_lean();
        // Angles are shown larger by the least doubt, that of the model: more of it, and what the aircraft does, may as
        // well be on the other side.
        let (guarded, sigma) = (doubted(at_rest, least_k), doubted(own, most_k));
        let (astray, unbelieved) = (self.astray(), unbelievable(&self.state));
        let turning = Attitude { roll: unbelieved * attitude.roll.abs(), pitch: unbelieved * attitude.pitch.abs() };
        let sigma = [unheard, leaning, late, turning, astray, self.walled(attitude), self.by_one_alone()]
            .iter()
            .fold(sigma, |all, one| Attitude { roll: all.roll.hypot(one.roll), pitch: all.pitch.hypot(one.pitch) });
        attitude.roll = guard(attitude.roll, guarded.roll, std::f64::consts::PI);
        attitude.pitch = guard(attitude.pitch, guarded.pitch, std::f64::consts::FRAC_PI_2);
        Solution {
            attitude: Some(attitude),
            sigma,
            contrast_k: Some(contrast_k),
            seen_k: self.seen_k.map(|seen_k| [0.0, 0.0, seen_k]),
            sensors: std::array::from_fn(|i| self.hearing(i)),
            hidden: Some(self.may_hide(2.0 * (sigma.roll * attitude.pitch.cos()).max(sigma.pitch))),
            hint: self.hint(),
            wired: self.gyro.heard().and_then(|_| self.turns.wired()).map(|wired| Otherwise {
                attitude: wired.attitude(attitude),
                angles: wired.angles(),
                left: self.turns.left(),
            }),
        }
    }

    /// The upward vertical on (nose, left, up): a gyro's that is late, turned on by as much as it has yet to say.
    fn vertical(&self) -> Vector {
        let late_s = self.state.late_s();
        let back = self.turning().map_or([0.0; 3], |rates| rates.map(|r| -late_s * r));
        product(&rotation(back), self.state.vertical())
    }

    /// How far the attitude may be off while it moves, rad: with a gyro's, it is that of the gyro's clock. Where that seems to
    /// be late it may as well be that the sensors are sooner than they are said to be, and nothing else is.
    pub(super) fn late(&self) -> Attitude {
        let sooner_s = (self.tuning.lag_s - self.state.lag_s(self.tuning.lag_s)).max(0.0);
        let clock_s = self.tuning.clock_s.hypot(EITHER * (sooner_s + self.state.late_s()));
        let moving = self.turning().map_or_else(Attitude::default, |rates| moving(&self.state, rates));
        Attitude { roll: clock_s * moving.roll, pitch: clock_s * moving.pitch }
    }
}
