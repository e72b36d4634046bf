//! From the signals of pairs in any direction to one vector on the aircraft's axes.

use crate::frame::Frame;
use crate::head::Head;

/// Signals that are linear in the vertical, `mᵢ = bᵢ·s` with `s = D·u`, solved for `s` by least
/// squares over the pairs that have a signal in `frame`: the components on (nose, left, up), K.
///
/// For three pairs along the axes this is the signals themselves; a head turned 45° on the airframe
/// is only another set of directions. `None` while the pairs with a signal do not span space.
pub fn contrast_vector(head: &Head, frame: &Frame) -> Option<[f64; 3]> {
    let mut normal = [[0.0; 3]; 3];
    let mut right = [0.0; 3];
    for (i, pair) in head.pairs.iter().enumerate() {
        let Ok(signal) = head.signal_k(i, frame) else { continue };
        let b = pair.direction.components();
        for r in 0..3 {
            right[r] += b[r] * signal;
            for c in 0..3 {
                normal[r][c] += b[r] * b[c];
            }
        }
    }
    solve(normal, right)
}

/// Whether pairs in these directions span space well enough to be solved.
pub fn spans_space(head: &Head) -> bool {
    let mut normal = [[0.0; 3]; 3];
    for pair in &head.pairs {
        let b = pair.direction.components();
        for r in 0..3 {
            for c in 0..3 {
                normal[r][c] += b[r] * b[c];
            }
        }
    }
    solve(normal, [0.0; 3]).is_some()
}

/// Solves a symmetric 3×3 system by Cramer's rule; `None` when it is close to singular. The
/// entries are sums of products of unit vectors, so the determinant has a natural scale of 1.
fn solve(m: [[f64; 3]; 3], right: [f64; 3]) -> Option<[f64; 3]> {
    let determinant = |m: &[[f64; 3]; 3]| {
        m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
            + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
    };
    let d = determinant(&m);
    if d < 0.01 {
        return None;
    }
    let mut solution = [0.0; 3];
    for (column, s) in solution.iter_mut().enumerate() {
        let mut replaced = m;
        for r in 0..3 {
            replaced[r][column] = right[r];
        }
        *s = determinant(&replaced) / d;
    }
    solution.iter().all(|s| s.is_finite()).then_some(solution)
}
