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
    let inverse = 1.0 / s;
    for i in 0..n {
        let k = ph[i] * inverse;
        x[i] += k * innovation;
        if k != 0.0 {
            for (p, h) in p[i][..n].iter_mut().zip(&ph[..n]) {
                *p -= k * h;
            }
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

    #[test]
    fn what_has_no_solution_has_none() {
        assert_eq!(solve([[1.0, 2.0], [2.0, 4.0]], [1.0, 0.0]), None);
        assert_eq!(solve([[f64::NAN, 0.0], [0.0, 1.0]], [1.0, 1.0]), None);
        // The first pivot is zero.
        assert_eq!(solve([[0.0, 2.0], [1.0, 0.0]], [4.0, 3.0]), Some([3.0, 2.0]));
    }
}
