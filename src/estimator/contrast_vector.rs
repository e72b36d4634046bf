//! From the signals of pairs in any direction to one vector on the aircraft's axes.

use super::normal::Normal;
use super::vector::{Vector, add_scaled, product};
use crate::frame::Frame;
use crate::head::Head;

/// Signals that are linear in the vertical, `mᵢ = bᵢ·s` with `s = D·u`, solved for `s` by least
/// squares over the pairs that have a signal in `frame`: the components on (nose, left, up), K.
///
/// For three pairs along the axes this is the signals themselves; a head turned 45° on the airframe
/// is only another set of directions. `None` while the pairs with a signal do not span space.
pub fn contrast_vector(head: &Head, frame: &Frame) -> Option<Vector> {
    ContrastSolver::default().solve(head, frame)
}

/// The same, for one head again and again.
#[derive(Clone, Debug, Default)]
pub struct ContrastSolver {
    /// The inverse of the normal equations of all pairs.
    whole: Option<[Vector; 3]>,
}

impl ContrastSolver {
    /// For frames of `head`.
    pub fn new(head: &Head) -> Self {
        Self { whole: whole(head).inverse() }
    }

    /// The contrast vector of `frame`, K; see [`contrast_vector`].
    pub fn solve(&self, head: &Head, frame: &Frame) -> Option<Vector> {
        let mut right = [0.0; 3];
        let mut missing = false;
        for (i, pair) in head.pairs.iter().enumerate() {
            match head.signal_k(i, frame) {
                Ok(signal) => right = add_scaled(right, signal, pair.direction.components()),
                Err(_) => missing = true,
            }
        }
        let inverse = match self.whole {
            Some(whole) if !missing => whole,
            _ => {
                let mut normal = Normal::default();
                let there = |i: &usize| head.signal_k(*i, frame).is_ok();
                (0..head.pairs.len()).filter(there).for_each(|i| normal.add(head.pairs[i].direction));
                normal.inverse()?
            }
        };
        let solution = product(&inverse, right);
        solution.iter().all(|s| s.is_finite()).then_some(solution)
    }
}

/// The normal equations of all pairs.
fn whole(head: &Head) -> Normal {
    let mut normal = Normal::default();
    head.pairs.iter().for_each(|pair| normal.add(pair.direction));
    normal
}

/// Whether pairs in these directions span space well enough to be solved.
pub fn spans_space(head: &Head) -> bool {
    whole(head).inverse().is_some()
}
