//! Linear equations, and the update of a Kalman filter.

/// A pivot below this is none.
const SMALLEST: f64 = 1e-12;

/// The `x` with `matrix · x = right`, by Gaussian elimination with pivots; `None` where the matrix is singular.
pub fn solve<const N: usize>(mut matrix: [[f64; N]; N], mut right: [f64; N]) -> Option<[f64; N]> {
    for k in 0..N {
        let pivot = (k..N).max_by(|a, b| matrix[*a][k].abs().total_cmp(&matrix[*b][k].abs()))?;
        matrix.swap(k, pivot);
        right.swap(k, pivot);
        if matrix[k][k].abs() < SMALLEST || !matrix[k][k].is_finite() {
            return None;
        }
        for r in k + 1..N {
            let share = matrix[r][k] / matrix[k][k];
            let row = matrix[k];
            matrix[r].iter_mut().zip(row).skip(k).for_each(|(entry, p)| *entry -= share * p);
            right[r] -= share * right[k];
        }
    }
    for k in (0..N).rev() {
        let rest: f64 = (k + 1..N).map(|c| matrix[k][c] * right[c]).sum();
        right[k] = (right[k] - rest) / matrix[k][k];
    }
    Some(right)
}

/// Takes an innovation of variance `s` into the first `n` states; `ph` is their covariance with it.
pub fn gain<const M: usize>(x: &mut [f64; M], p: &mut [[f64; M]; M], n: usize, ph: &[f64; M], s: f64, innovation: f64) {
    consider(x, p, n, (ph, ph), s, innovation);
}

/// The same by a Schmidt–Kalman filter: some states are considered, but nothing, or not all, is learnt of them. `ph` comes as
/// it is, and as far as it is learnt.
pub fn consider<const M: usize>(
    x: &mut [f64; M],
    p: &mut [[f64; M]; M],
    n: usize,
    (ph, learnt): (&[f64; M], &[f64; M]),
    s: f64,
    innovation: f64,
) {
    let inverse = 1.0 / s;
    for i in 0..n {
        let k = learnt[i] * inverse;
        x[i] += k * innovation;
        p[i][..n].iter_mut().zip(&ph[..n]).for_each(|(p, h)| *p -= k * h);
        // What is not learnt goes with what is, and among itself as before.
        let only_considered = ph[i] * inverse - k;
        if only_considered != 0.0 {
            p[i][..n].iter_mut().zip(&learnt[..n]).for_each(|(p, l)| *p -= only_considered * l);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn what_is_solved_fits(matrix in proptest::array::uniform4([-9.0_f64..9.0, -9.0..9.0, -9.0..9.0, -9.0..9.0]),
                               right in [-9.0_f64..9.0, -9.0..9.0, -9.0..9.0, -9.0..9.0]) {
            let Some(x) = solve(matrix, right) else { return Ok(()) };
            let largest = x.iter().fold(1.0_f64, |m, v| m.max(v.abs()));
            for (row, r) in matrix.iter().zip(right) {
                let made: f64 = row.iter().zip(x).map(|(m, x)| m * x).sum();
                prop_assert!((made - r).abs() < 1e-9 * largest);
            }
        }
    }

    /// Of two states that go together one is learnt, and one considered: its variance stays, and what the first is known by is
    /// what a gain of nothing for the second leaves, by Joseph's formula.
    #[test]
    fn nothing_is_learnt_of_what_is_considered() {
        let (mut x, mut p) = ([1.0, 2.0], [[4.0, 1.0], [1.0, 2.0]]);
        // A reading of their sum, with a variance of 1.
        consider(&mut x, &mut p, 2, (&[5.0, 3.0], &[5.0, 0.0]), 9.0, 1.8);
        let k = 5.0 / 9.0;
        let first = (1.0 - k) * (1.0 - k) * 4.0 - 2.0 * k * (1.0 - k) * 1.0 + k * k * (2.0 + 1.0);
        let both = (1.0 - k) * 1.0 - k * 2.0;
        assert_eq!(x, [2.0, 2.0]);
        let expected = [[first, both], [both, 2.0]];
        assert!(p.iter().flatten().zip(expected.iter().flatten()).all(|(p, e)| (p - e).abs() < 1e-12), "{p:?}");
    }

    /// Of a state that is learnt by half its gain, likewise.
    #[test]
    fn half_of_it_may_be_learnt() {
        let (mut x, mut p) = ([1.0, 2.0], [[4.0, 1.0], [1.0, 2.0]]);
        consider(&mut x, &mut p, 2, (&[5.0, 3.0], &[5.0, 1.5]), 9.0, 1.8);
        assert_eq!(x, [2.0, 2.3]);
        let (a, b) = (5.0 / 9.0, 1.5 / 9.0);
        // Joseph's formula: (1 - KH) P (1 - KH)' + K R K'.
        let left = [[1.0 - a, -a], [-b, 1.0 - b]];
        let before = [[4.0, 1.0], [1.0, 2.0]];
        let k = [a, b];
        for i in 0..2 {
            for j in 0..2 {
                let kept: f64 = (0..4).map(|m| left[i][m / 2] * before[m / 2][m % 2] * left[j][m % 2]).sum();
                assert!((p[i][j] - (kept + k[i] * k[j])).abs() < 1e-12, "{p:?}");
            }
        }
    }

    #[test]
    fn what_has_no_solution_has_none() {
        assert_eq!(solve([[1.0, 2.0], [2.0, 4.0]], [1.0, 0.0]), None);
        assert_eq!(solve([[f64::NAN, 0.0], [0.0, 1.0]], [1.0, 1.0]), None);
        // The first pivot is zero.
        assert_eq!(solve([[0.0, 2.0], [1.0, 0.0]], [4.0, 3.0]), Some([3.0, 2.0]));
    }
}
