//! How the head sits on the airframe, learnt in flight from slow references. Pure: time comes with the frame.
//!
//! - [`prior`]: how much of a difference is the mounting's, and how much no more than the angle of attack;
//! - [`differences`]: what explains the differences of minutes: the mounting, and a horizon that leans;
//! - [`departure`]: whether those of late are still the same;
//! - [`learner`]: the trim that follows, never by a step.
//!
//! The references are slow and coarse: none of them says what the attitude is now, their mean over minutes
//! says how the head is mounted. Without them there is no trim; with them it stays within limits.

pub mod departure;
pub mod differences;
pub mod learner;
pub mod prior;

pub use learner::Learner;

use super::vector::Vector;
use crate::attitude::Attitude;

/// The attitude of the aircraft on which a head shows `seen`, where the head shows `trim` in level
/// flight: the vertical turned back about the nose by the trim's roll, then about the left wing by its
/// pitch. Exact at any attitude, where a difference of angles is not; without a trim, not a bit is changed.
pub fn level(seen: Attitude, trim: Attitude) -> Attitude {
    if trim == Attitude::default() {
        return seen;
    }
    Attitude::from_vertical(turned(seen.vertical(), trim))
}

/// What is `[nose, left, up]` on the head, on the axes of an aircraft on which it sits askew by `trim`.
pub fn turned([nose, left, up]: Vector, trim: Attitude) -> Vector {
    let ((sr, cr), (sp, cp)) = (trim.roll.sin_cos(), trim.pitch.sin_cos());
    let (left, up) = (left * cr - up * sr, left * sr + up * cr);
    [nose * cp - up * sp, left, nose * sp + up * cp]
}

/// What a head that shows `trim` in level flight shows on an aircraft in `attitude`: the inverse of [`level`].
pub fn shown(attitude: Attitude, trim: Attitude) -> Attitude {
    let [x, y, z] = attitude.vertical();
    let ((sr, cr), (sp, cp)) = (trim.roll.sin_cos(), trim.pitch.sin_cos());
    let (nose, up) = (x * cp + z * sp, z * cp - x * sp);
    let (left, up) = (y * cr + up * sr, up * cr - y * sr);
    Attitude::from_vertical([nose, left, up])
}

#[cfg(test)]
mod tests;
