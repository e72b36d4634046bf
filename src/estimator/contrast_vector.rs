//! From the signals of pairs in any direction to one vector on the aircraft's axes.

use super::normal::Normal;
use super::vector::product;
use crate::frame::Frame;
use crate::head::Head;

/// Signals that are linear in the vertical, `mᵢ = bᵢ·s` with `s = D·u`, solved for `s` by least
/// squares over the pairs that have a signal in `frame`: the components on (nose, left, up), K.
///
/// For three pairs along the axes this is the signals themselves; a head turned 45° on the airframe
/// is only another set of directions. `None` while the pairs with a signal do not span space.
pub fn contrast_vector(head: &Head, frame: &Frame) -> Option<[f64; 3]> {
    let mut normal = Normal::default();
    let mut right = [0.0; 3];
    for (i, pair) in head.pairs.iter().enumerate() {
        let Ok(signal) = head.signal_k(i, frame) else { continue };
        normal.add(pair.direction);
        for (sum, b) in right.iter_mut().zip(pair.direction.components()) {
            *sum += b * signal;
        }
    }
    let solution = product(&normal.inverse()?, right);
    solution.iter().all(|s| s.is_finite()).then_some(solution)
}

/// Whether pairs in these directions span space well enough to be solved.
pub fn spans_space(head: &Head) -> bool {
    let mut normal = Normal::default();
    head.pairs.iter().for_each(|pair| normal.add(pair.direction));
    normal.inverse().is_some()
}
