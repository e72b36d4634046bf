//! Whether there is a contrast to see by, by each frame alone.

use super::FieldEstimator;
use super::state::CONTRAST;
use crate::estimator::Standing;
use crate::estimator::sides::TELLING_K;
use crate::estimator::vector::{dot, length};
use crate::frame::Frame;
use crate::time::Time;

/// After so long without a contrast to see by the filter begins anew when it is back, s.
const BLIND_S: f64 = 0.3;
/// For so long after a frame that showed none one in which not all are heard tells nothing of it.
const NOTHING_S: f64 = 1.0;

impl FieldEstimator {
    /// The contrast that this frame alone shows, K; below 0 where ground and sky look exchanged.
    pub(super) fn look(&mut self, frame: &Frame, now: Time) {
        let all_heard = (0..self.model.sensors()).all(|i| self.hearing(i).standing == Standing::Heard);
        let alone = self.pairs.solve(&self.head, frame).filter(|_| all_heard);
        if let Some(alone) = alone {
            self.nothing_at = (length(alone) < TELLING_K).then_some(now);
        } else if self.nothing_at.is_some_and(|at| now.since(at) < NOTHING_S) {
            // What is still known is what was made of nothing.
            self.seen_k = None;
            return;
        }
        let seen = alone.unwrap_or_else(|| self.state.vertical().map(|c| c * self.state.x[CONTRAST]));
        let sign = self.sides.sign(seen, now);
        self.seen_k = Some(sign * length(seen));
        let upright = sign > 0.0 && length(seen) > TELLING_K;
        // Out of a contrast of nothing ground, sky and attitude may come all upside down.
        let mirrored = alone.is_some() && upright && dot(seen, self.state.vertical()) < 0.0;
        if self.blind && upright && length(seen) > 2.0 * TELLING_K {
            // What was made of nothing is nothing to go on with.
            (self.blind, self.blind_since, self.last) = (false, None, None);
            self.back_at = Some(now);
        } else if upright && !mirrored {
            self.blind_since = None;
        } else if now.since(*self.blind_since.get_or_insert(now)) > BLIND_S {
            self.blind = true;
        }
    }
}
