//! Three pairs or more, inverted through the sky's shape: full attitude, inverted flight included.
//!
//! - [`inverse`]: from a pair's share of the contrast to the sine of its elevation;
//! - [`root`]: one bracketed scalar solve;
//! - [`solve`]: contrast and vertical of one set of signals;
//! - [`range`]: the adaptive range, a filter on that contrast.
//!
//! The method is static: a frame's attitude comes from the frame's signals, the range and the side
//! up that was last seen. See [`ProfileEstimator`].

pub mod inverse;
pub mod range;
pub mod root;
pub mod solve;

use super::contrast_vector::contrast_vector;
use super::noise::PAIR_NOISE_K;
use super::sides::Sides;
use super::vector::Vector;
use super::{Estimator, Solution};
use crate::attitude::Attitude;
use crate::direction::Direction;
use crate::frame::Frame;
use crate::head::Head;
use crate::sky::PairCurve;
use range::AdaptiveRange;
use solve::{Scaled, Solved, Solver};

/// A contrast up to so many times the range is believed; above it the range, so widened, scales the angles.
const BELIEVED: f64 = 1.1;

/// The cosine of pitch below which the standard deviation of roll grows no more.
const LEAST_ACROSS: f64 = 0.05;

/// Attitude from the inverted profile.
///
/// Each frame is solved for contrast and vertical. The contrast goes through the adaptive range, which
/// falls fast and rises slowly. A contrast well above the range is doubted: the angles' numerators are
/// then taken on the range, so that a contrast overrated in this frame makes no angle too small.
#[derive(Clone, Debug)]
pub struct ProfileEstimator {
    head: Head,
    solver: Option<Solver>,
    signals: Vec<Option<f64>>,
    range: AdaptiveRange,
    sides: Sides,
    /// Ground and sky looked exchanged in the last frame.
    exchanged: bool,
    residual: Option<f64>,
}

impl ProfileEstimator {
    /// For `head` under a sky in which its pairs have the shape of `curve`, with a range that rises
    /// with a time constant of `range_time_constant_s` > 0, in seconds. A head whose pairs do not
    /// span space gives no attitude.
    pub fn new(head: Head, curve: PairCurve, range_time_constant_s: f64) -> Self {
        let directions: Vec<Direction> = head.pairs.iter().map(|p| p.direction).collect();
        Self {
            solver: Solver::new(&directions, curve),
            signals: vec![None; directions.len()],
            head,
            range: AdaptiveRange::new(range_time_constant_s),
            sides: Sides::default(),
            exchanged: false,
            residual: None,
        }
    }

    /// The length of the vertical on the range, less 1, in the last frame that had one: above 0
    /// while the contrast is larger than the range, below 0 where a pair shows less than it should
    /// (obstruction, a cloud's edge, a wet pair).
    pub fn residual(&self) -> Option<f64> {
        self.residual
    }

    /// The range, below 0 while ground and sky look exchanged, K.
    fn contrast_k(&self) -> Option<f64> {
        self.range.value().map(|range| if self.exchanged { -range } else { range })
    }

    /// The attitude, and its standard deviation, of what `solved` says with ground and sky as `sign`
    /// tells.
    fn attitude(&self, solver: &Solver, solved: &Solved, ranged: Option<&Scaled>, sign: f64) -> (Attitude, Attitude) {
        let exact = solved.vertical.map(|c| sign * c);
        let mut larger = exact;
        if let Some(ranged) = ranged {
            for (component, r) in larger.iter_mut().zip(ranged.vertical) {
                *component = component.abs().max((r * ranged.length).abs()).copysign(*component);
            }
        }
        let across = exact[1].hypot(exact[2]);
        let angles = |u: Vector| Attitude { roll: u[1].atan2(exact[2]), pitch: u[0].atan2(across) };
        let (given, plain) = (angles(larger), angles(exact));

        // The ways that the vertical goes when roll or pitch grows, over how far it goes.
        let (sin_roll, cos_roll) = plain.roll.sin_cos();
        let roll = [0.0, cos_roll, -sin_roll].map(|c| c / across.max(LEAST_ACROSS));
        let pitch = [across, -exact[0] * sin_roll, -exact[0] * cos_roll];
        let noise = solver.spread(&self.signals, solved, [roll, pitch], PAIR_NOISE_K.hypot(solved.residual_k));
        let [roll_noise, pitch_noise] = noise.unwrap_or([std::f64::consts::PI; 2]);
        // What cannot be explained at all, and what the range has added.
        let unexplained = (1.0 - solved.length).max(0.0);
        let sigma = |noise: f64, given: f64, plain: f64| noise.hypot(unexplained).hypot(given - plain);
        let sigma = Attitude {
            roll: sigma(roll_noise, given.roll, plain.roll),
            pitch: sigma(pitch_noise, given.pitch, plain.pitch),
        };
        (given, sigma)
    }
}

impl Estimator for ProfileEstimator {
    fn update(&mut self, frame: &Frame) -> Solution {
        for (i, signal) in self.signals.iter_mut().enumerate() {
            *signal = self.head.signal_k(i, frame).ok();
        }
        let solved = self.solver.as_ref().and_then(|s| Some((s, s.solve(&self.signals)?)));
        let (Some((solver, solved)), Some(time)) = (solved, frame.sample_time()) else {
            // A head that sees no contrast at all sees that.
            let seen_k = contrast_vector(&self.head, frame);
            return Solution { contrast_k: self.contrast_k(), seen_k, ..Solution::default() };
        };
        let sign = self.sides.sign(solved.vertical.map(|c| solved.contrast_k * c), time);
        let range = self.range.update(solved.contrast_k, time).map(|r| BELIEVED * r);
        let doubted = range.filter(|r| solved.contrast_k > *r);
        let scaled = doubted.and_then(|r| solver.with_contrast(&self.signals, r));
        let ranged = self.range.value().and_then(|r| solver.with_contrast(&self.signals, r));
        let (attitude, sigma) = self.attitude(solver, &solved, scaled.as_ref(), sign);
        self.residual = ranged.map(|r| r.length - 1.0);
        self.exchanged = sign < 0.0;
        Solution {
            attitude: Some(attitude),
            sigma,
            contrast_k: self.contrast_k(),
            seen_k: Some([0.0, 0.0, sign * solved.contrast_k]),
            ..Solution::default()
        }
    }
}

#[cfg(test)]
mod tests;
