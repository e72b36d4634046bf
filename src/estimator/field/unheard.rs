//! What a sensor that is not heard might have been right about.
//!
//! A wall beside, a bank of cloud: to five sensors a sixth that sees it looks like a bad one, and leaving it out makes
//! the attitude worse. Only when what it should show has changed is it known whether it follows (it sees something) or
//! not (a film), unless it is warmer than any ground. Until then its residual is in doubt as a tilt; and so is how far the
//! attitude would be elsewhere if the one on the other side were to blame.

use super::FieldEstimator;
use super::state::{CONTRAST, GROUND};
use crate::attitude::Attitude;
use crate::estimator::{PAIR_SLOPE, Standing};

/// A sensor that loses so much of what it should show may see something beside it; one that loses so much does not.
const SEES: (f64, f64) = (0.5, 0.85);
/// One that shows its die and nothing but, as it never did before, would see a wall that leaves no sky: it is taken to lose
/// so much as long as nothing has changed.
const FILM: f64 = 0.8;
/// Something so much warmer than the ground may be a slope in the sun; what is so much warmer is none, K.
const WARMER_K: (f64, f64) = (3.0, 6.0);
/// Beside a gyro it is off by no more, rad (3°): what comes suddenly is no turn if it says so.
const MOST: f64 = 0.052;

impl FieldEstimator {
    /// The standard deviations of roll and pitch, rad, by what the sensors left out show.
    pub(super) fn unheard(&self, attitude: Attitude) -> Attitude {
        let contrast_k = self.state.x[CONTRAST].abs().max(1.0);
        let mut squared = Attitude::default();
        for i in 0..self.model.sensors() {
            let (standing, residual_k) = (self.witnesses.standing(i), self.witnesses.of(i).1);
            let (Standing::LeftOut | Standing::Doubted, Some(residual_k)) = (standing, residual_k) else { continue };
            let warmer_k = self.witnesses.of(i).0.map_or(0.0, |expected| expected + residual_k - self.state.x[GROUND]);
            let sees = |(from, to): (f64, f64), what: f64| ((to - what) / (to - from)).clamp(0.0, 1.0);
            let lost = self.witnesses.lost(i).unwrap_or(if self.witnesses.sees_film(i) { FILM } else { 0.0 });
            let doubt =
                sees(SEES, lost).max(self.witnesses.strays(i)) * sees(WARMER_K, warmer_k) * residual_k / contrast_k;
            let [nose, left, up] = self.model.direction(i).map(|c| c * doubt);
            // A level sensor tilts; an upright one scales what the others show.
            squared.roll += (left / PAIR_SLOPE).powi(2) + (up * attitude.roll.sin()).powi(2);
            squared.pitch += (nose / PAIR_SLOPE).powi(2) + (up * attitude.pitch.sin()).powi(2);
        }
        let most = if self.gyro.in_use() { MOST } else { f64::INFINITY };
        let rival = self.witnesses.spread();
        Attitude {
            roll: squared.roll.sqrt().max(rival.roll).min(most),
            pitch: squared.pitch.sqrt().max(rival.pitch).min(most),
        }
    }
}
