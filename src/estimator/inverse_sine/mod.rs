//! The report's scheme (section IV.B), kept as published: `roll = asin(y/R)`, `pitch = asin(x/R)`,
//! the inverse sine from a `table`, `R` the vertical pair's output low-passed over a few seconds,
//! roll limited.
//!
//! Its two known faults are kept with it: `R` shrinks with `cos φ cos θ` in a sustained bank, and
//! `asin(y/R)` is not roll while pitch is not zero. The standard deviations own up to both.

mod excess;
mod table;

use super::contrast_vector::ContrastSolver;
use super::noise::PAIR_NOISE_K;
use super::range::LowPass;
use super::{Estimator, Solution};
use crate::attitude::Attitude;
use crate::frame::Frame;
use crate::head::Head;
use excess::Excess;
use table::InverseSine;

/// The smallest range that an angle is divided by, K: far below any usable contrast.
const SMALLEST_RANGE_K: f64 = 1e-3;

/// The share of the range that the vertical pair must see before it is believed which way round it is.
const REVERSAL: f64 = 0.25;

/// The report's estimator.
#[derive(Clone, Debug)]
pub struct InverseSineEstimator {
    solver: ContrastSolver,
    head: Head,
    table: InverseSine,
    excess: Excess,
    /// Low-passed |z|: what scales the angles.
    range: LowPass,
    /// The vertical pair looks reversed: the contrast is shown with a minus sign.
    reversed: bool,
    roll_limit: f64,
}

impl InverseSineEstimator {
    /// For `head` of sensors with `field_of_view_deg` (only their standard deviation depends on it);
    /// `range_time_constant_s` > 0 in seconds, `roll_limit_deg` in degrees, 0 = none
    /// (the report: 45).
    pub fn new(head: Head, field_of_view_deg: f64, range_time_constant_s: f64, roll_limit_deg: f64) -> Self {
        Self {
            solver: ContrastSolver::new(&head),
            head,
            table: InverseSine::new(),
            excess: Excess::new(field_of_view_deg),
            range: LowPass::new(range_time_constant_s),
            reversed: false,
            roll_limit: if roll_limit_deg > 0.0 { roll_limit_deg.to_radians() } else { std::f64::consts::PI },
        }
    }

    /// The angle of `signal` on a range, and its standard deviation: noise, the sine's own excess,
    /// and how far the range seen now would have moved it.
    fn angle(&self, signal_k: f64, range_k: f64, seen_k: f64) -> (f64, f64) {
        let sine = signal_k / range_k;
        let angle = self.table.angle(sine);
        let cosine = (1.0 - sine * sine).max(0.01).sqrt();
        let noise = PAIR_NOISE_K / range_k / cosine;
        let excess = self.excess.at(angle);
        let doubt = angle - self.table.angle(signal_k / seen_k.max(SMALLEST_RANGE_K));
        (angle, (noise * noise + excess * excess + doubt * doubt).sqrt())
    }
}

impl Estimator for InverseSineEstimator {
    fn update(&mut self, frame: &Frame) -> Solution {
        let seen = self.solver.solve(&self.head, frame);
        if let (Some([_, _, z]), Some(time)) = (seen, frame.sample_time()) {
            let range = self.range.update(z.abs(), time).unwrap_or(0.0);
            // A vertical pair near zero (a bank near 90°) has no sign of its own.
            if z.abs() > REVERSAL * range {
                self.reversed = z < 0.0;
            }
        }
        let sign = if self.reversed { -1.0 } else { 1.0 };
        let contrast_k = self.range.value().map(|range| sign * range);
        let mut solution = Solution { contrast_k, seen_k: seen, ..Solution::default() };
        if let (Some([x, y, z]), Some(range)) = (seen, self.range.value()) {
            let range = range.max(SMALLEST_RANGE_K);
            let seen_k = (x * x + y * y + z * z).sqrt();
            let (roll, roll_sigma) = self.angle(y, range, seen_k);
            let (pitch, pitch_sigma) = self.angle(x, range, seen_k);
            solution.attitude = Some(Attitude { roll: roll.clamp(-self.roll_limit, self.roll_limit), pitch });
            solution.sigma = Attitude { roll: roll_sigma, pitch: pitch_sigma };
        }
        solution
    }
}

#[cfg(test)]
mod tests;
