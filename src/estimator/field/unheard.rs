//! What a sensor that is not heard might have been right about.
//!
//! A wall beside, a bank of cloud: to five sensors a sixth that sees it looks like a bad one, and leaving it out makes
//! the attitude worse. Only when what it should show has changed is it known whether it follows (it sees something) or
//! not (a film). Until then its residual is in doubt as a tilt.

use super::FieldEstimator;
use super::state::CONTRAST;
use crate::attitude::Attitude;
use crate::estimator::{PAIR_SLOPE, Standing};

/// A sensor that loses so much of what it should show may see something beside it; one that loses so much does not.
const SEES: (f64, f64) = (0.5, 0.85);

impl FieldEstimator {
    /// The standard deviations of roll and pitch, rad, by what the sensors left out show.
    pub(super) fn unheard(&self, attitude: Attitude) -> Attitude {
        let contrast_k = self.state.x[CONTRAST].abs().max(1.0);
        let mut squared = Attitude::default();
        for i in 0..self.model.sensors() {
            let (standing, residual_k) = (self.witnesses.standing(i), self.witnesses.of(i).1);
            let (Standing::LeftOut | Standing::Doubted, Some(residual_k)) = (standing, residual_k) else { continue };
            let lost = self.witnesses.lost(i).unwrap_or(0.0);
            let doubt = ((SEES.1 - lost) / (SEES.1 - SEES.0)).clamp(0.0, 1.0) * residual_k / contrast_k;
            let [nose, left, up] = self.model.direction(i).map(|c| c * doubt);
            // A level sensor tilts; an upright one scales what the others show.
            squared.roll += (left / PAIR_SLOPE).powi(2) + (up * attitude.roll.sin()).powi(2);
            squared.pitch += (nose / PAIR_SLOPE).powi(2) + (up * attitude.pitch.sin()).powi(2);
        }
        Attitude { roll: squared.roll.sqrt(), pitch: squared.pitch.sqrt() }
    }
}
