//! Least squares over directions: the 3×3 matrix that they all share.

use super::vector::Vector;
use crate::direction::Direction;

/// The smallest determinant that can be solved. The entries are sums of products of unit vectors,
/// so its natural scale is 1.
const SMALLEST_DETERMINANT: f64 = 0.01;

/// The sum of `b·bᵀ` over directions `b`: the normal equations of everything linear in `b·u`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Normal([Vector; 3]);

impl Normal {
    /// Takes in one direction.
    pub fn add(&mut self, direction: Direction) {
        self.add_vector(direction.components());
    }

    /// Takes in a vector of any length.
    pub fn add_vector(&mut self, b: Vector) {
        for (row, r) in self.0.iter_mut().zip(b) {
            for (entry, c) in row.iter_mut().zip(b) {
                *entry += r * c;
            }
        }
    }

    /// The inverse; `None` while the directions do not span space, or hardly.
    pub fn inverse(&self) -> Option<[Vector; 3]> {
        let m = &self.0;
        let cofactor = |r: usize, c: usize| {
            let [(a, b), (d, e)] = [r, c].map(|i| ((i + 1) % 3, (i + 2) % 3));
            m[a][d] * m[b][e] - m[a][e] * m[b][d]
        };
        let determinant: f64 = (0..3).map(|c| m[0][c] * cofactor(0, c)).sum();
        // The matrix is symmetric, and so is its inverse: no transposition.
        (determinant >= SMALLEST_DETERMINANT)
            .then(|| std::array::from_fn(|r| std::array::from_fn(|c| cofactor(r, c) / determinant)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimator::vector::product;

    #[test]
    fn the_inverse_undoes_the_matrix() {
        let mut n = Normal::default();
        for (azimuth, elevation) in [(10.0, 5.0), (80.0, -20.0), (200.0, 60.0), (300.0, 33.0)] {
            n.add(Direction::from_angles(azimuth, elevation).unwrap());
        }
        let inverse = n.inverse().unwrap();
        for v in [[1.0, 0.0, 0.0], [0.3, -2.0, 0.7]] {
            let back = product(&inverse, product(&n.0, v));
            assert!(back.iter().zip(v).all(|(a, b)| (a - b).abs() < 1e-12), "{v:?} {back:?}");
        }
    }

    #[test]
    fn directions_in_one_plane_do_not_span_space() {
        let mut n = Normal::default();
        assert_eq!(n.inverse(), None);
        n.add(Direction::NOSE);
        n.add(Direction::LEFT);
        n.add(Direction::from_angles(45.0, 0.0).unwrap());
        assert_eq!(n.inverse(), None);
        n.add(Direction::UP);
        assert!(n.inverse().is_some());
    }
}
