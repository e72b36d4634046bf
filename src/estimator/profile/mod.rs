//! Three pairs or more, inverted through the sky's shape: full attitude, inverted flight included.
//!
//! - [`inverse`]: from a pair's share of the contrast to the sine of its elevation;
//! - [`root`]: one bracketed scalar solve;
//! - [`solve`]: contrast and vertical of one set of signals;
//! - [`range`]: the adaptive range, a filter on that contrast;
//! - [`shape`]: the sky's shape, learnt from how that contrast goes with the bank;
//! - `means`: where opposed sensors show that one is off;
//! - [`motion`]: how the vertical moves, and the sensors' lag made up for;
//! - `output`: angles and standard deviations.
//!
//! See [`ProfileEstimator`].

pub mod inverse;
mod means;
pub mod motion;
mod output;
pub mod range;
pub mod root;
pub mod shape;
pub mod solve;

use super::contrast_vector::contrast_vector;
use super::noise::PAIR_NOISE_K;
use super::sides::Sides;
use super::{Estimator, PAIR_SLOPE, Solution, unseen_lean};
use crate::direction::Direction;
use crate::frame::Frame;
use crate::head::Head;
use crate::sky::{Averaging, FieldOfView, PairCurve, Response, Shape, Sky};
use crate::time::Time;
use means::Means;
use motion::Motion;
use output::{Seen, attitude};
use range::AdaptiveRange;
use shape::ShapeLearner;
use solve::{Solved, Solver};

/// A contrast up to so many times the range is believed; above it the range, so widened, scales the angles.
const BELIEVED: f64 = 1.1;

/// The sky toward which the shape is learnt: that of humid air.
const HUMID: Shape = Shape::Grey { depth: 1.5 };

/// Attitude from the inverted profile.
///
/// Each frame is solved for contrast and vertical. The contrast goes through the adaptive range, which
/// falls fast and rises slowly. A contrast well above the range is doubted: the angles' numerators are
/// then taken on the range, so that a contrast overrated in this frame makes no angle too small.
///
/// In [flight](Self::in_flight) the sky's shape is learnt, and how the attitude moves; what neither tells, and what three
/// pairs cannot see, is in the standard deviations.
#[derive(Clone, Debug)]
pub struct ProfileEstimator {
    head: Head,
    flight: Option<InFlight>,
    solver: Option<Solver>,
    signals: Vec<Option<f64>>,
    range: AdaptiveRange,
    sides: Sides,
    /// Ground and sky looked exchanged in the last frame.
    exchanged: bool,
    residual: Option<f64>,
}

/// What is learnt in flight.
#[derive(Clone, Debug)]
struct InFlight {
    shape: ShapeLearner,
    means: Means,
    motion: Motion,
}

impl ProfileEstimator {
    /// For `head` under a sky in which its pairs are known to have the shape of `curve`, each frame by itself, with a
    /// range that rises with a time constant of `range_time_constant_s` > 0, in seconds. A head whose
    /// pairs do not span space gives no attitude.
    pub fn new(head: Head, curve: PairCurve, range_time_constant_s: f64) -> Self {
        Self::with_curves(head, [curve.clone(), curve], range_time_constant_s)
    }

    /// For `head` under any sky, its sensors with this field of view and a first-order time constant of `lag_s` ≥ 0, in
    /// seconds: as [`new`](Self::new) with the shape of the report's Namibia sky to begin from.
    pub fn in_flight(head: Head, field: FieldOfView, lag_s: f64, range_time_constant_s: f64) -> Self {
        let Sky { shape, ground_c, sky_max_k } = Sky::NAMIBIA;
        let curves =
            [shape, HUMID].map(|s| Response::new(s, field, Averaging::Temperature).pair_curve(ground_c, sky_max_k));
        let means = Means::new(head.pairs.len(), &curves);
        let mut method = Self::with_curves(head, curves, range_time_constant_s);
        let shares = method.solver.as_ref().map_or(shape::POSSIBLE, Solver::shares);
        let shape = ShapeLearner::new(shares);
        method.solver.iter_mut().for_each(|s| s.set_share(shape.share()));
        method.flight = Some(InFlight { shape, means, motion: Motion::new(lag_s) });
        method
    }

    fn with_curves(head: Head, curves: [PairCurve; 2], range_s: f64) -> Self {
        let directions: Vec<Direction> = head.pairs.iter().map(|p| p.direction).collect();
        Self {
            solver: Solver::between(&directions, curves),
            signals: vec![None; directions.len()],
            head,
            flight: None,
            range: AdaptiveRange::new(range_s),
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
}

impl InFlight {
    /// The vertical at `time` and its doubts: of what `solved` says of `signals` with ground and sky as `sign` tells, and of
    /// what was seen before; one sensor may be off by `off_k`, K. The solver is told the shape that is learnt.
    fn learn(
        &mut self,
        solver: &mut Solver,
        signals: &[Option<f64>],
        (solved, sign): (&Solved, f64),
        off_k: f64,
        time: Time,
    ) -> Seen {
        let up = solved.vertical.map(|c| sign * c);
        let mut by_shape = [0.0; 3];
        if let Some((by_share, contrast)) = solver.by_share(signals, solved) {
            if sign > 0.0 {
                self.shape.update(solved.contrast_k, contrast, time);
                solver.set_share(self.shape.share());
            }
            by_shape = by_share.map(|c| sign * self.shape.sigma() * c);
        }
        let noise = PAIR_NOISE_K.hypot(solved.residual_k) / (PAIR_SLOPE * solved.contrast_k);
        let moved = self.motion.update(up, noise, time);
        Seen { moved, by_shape, unseen: unseen_lean(moved.up), off_k }
    }
}

impl Estimator for ProfileEstimator {
    fn set_lag_s(&mut self, lag_s: f64) {
        if let (Some(flight), 0.0..=5.0) = (&mut self.flight, lag_s) {
            flight.motion.set_lag_s(lag_s);
        }
    }

    fn update(&mut self, frame: &Frame) -> Solution {
        for (i, signal) in self.signals.iter_mut().enumerate() {
            *signal = self.head.signal_k(i, frame).ok();
        }
        let solved = self.solver.as_mut().and_then(|s| s.solve(&self.signals).map(|solved| (s, solved)));
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
        self.residual = ranged.map(|r| r.length - 1.0);
        self.exchanged = sign < 0.0;
        let seen = match &mut self.flight {
            Some(flight) => {
                let off_k = flight.means.off_k(&self.head, frame, (&solved, sign), &flight.shape);
                flight.learn(solver, &self.signals, (&solved, sign), off_k, time)
            }
            None => Seen::alone(solved.vertical.map(|c| sign * c)),
        };
        let (attitude, sigma) = attitude(solver, &self.signals, &solved, &seen, scaled.as_ref());
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
