//! Contrast and vertical of one set of signals: `mᵢ = D·g(bᵢ·u)`, `|u| = 1`.

use super::inverse::Inverse;
use super::root::{Point, root};
use crate::direction::Direction;
use crate::estimator::normal::Normal;
use crate::estimator::vector::{Vector, add_scaled, dot, product};
use crate::sky::PairCurve;

/// How far |u| may be from 1 at the contrast that is found: far below a hundredth of a degree.
const TOLERANCE: f64 = 1e-7;

/// A signal beyond this, K, comes from no pair and counts as missing.
const LARGEST_SIGNAL_K: f64 = 1e4;

/// Signals that are all below this, K, have no direction.
const SMALLEST_SIGNAL_K: f64 = 1e-6;

/// Places at which a bracket is looked for where the end of the search gives none.
const PLACES: u32 = 32;

/// Pairs in any directions under a sky of known shape: that of one curve, or between two.
#[derive(Clone, Debug)]
pub struct Solver {
    directions: Vec<Direction>,
    curves: [PairCurve; 2],
    inverse: Inverse,
    /// The inverse of the normal equations of all directions.
    all: [Vector; 3],
}

/// A vertical and the contrast at which the signals agree with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solved {
    /// The upward vertical on (nose, left, up), of length 1, for a ground warmer than the sky.
    pub vertical: Vector,
    /// The contrast `D` > 0, K: what a pair along the vertical gives.
    pub contrast_k: f64,
    /// Its length before it was made 1: below 1 where no contrast can explain the signals.
    pub length: f64,
    /// Root mean square of what the pairs gave beyond that, K; 0 for three pairs, which always agree.
    pub residual_k: f64,
}

/// A vertical made with a contrast from elsewhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scaled {
    /// The direction found, of length 1.
    pub vertical: Vector,
    /// Its length before it was made 1: above 1 where the contrast was too small for the signals,
    /// below 1 where it was too large.
    pub length: f64,
    /// A pair gave more than the contrast allows and was taken as vertical.
    pub saturated: bool,
}

/// Which pairs there are this time.
struct Present<'a> {
    solver: &'a Solver,
    signals: &'a [Option<f64>],
    normal: [Vector; 3],
    largest_k: f64,
    count: usize,
}

impl Solver {
    /// For pairs whose positive directions are `directions`, all with the shape of `curve`.
    /// `None` when they do not span space.
    pub fn new(directions: &[Direction], curve: PairCurve) -> Option<Self> {
        Self::between(directions, [curve.clone(), curve])
    }

    /// The same for a shape between those of two curves: the first, until a share of the second is set.
    pub fn between(directions: &[Direction], curves: [PairCurve; 2]) -> Option<Self> {
        let mut normal = Normal::default();
        directions.iter().for_each(|d| normal.add(*d));
        let inverse = Inverse::between(&curves[0], &curves[1]);
        Some(Self { directions: directions.to_vec(), curves, inverse, all: normal.inverse()? })
    }

    /// The shares of the second curve that can be, least and most, as [`Inverse::rising`] has it.
    pub fn shares(&self) -> (f64, f64) {
        self.inverse.rising()
    }

    /// The share of the second curve from now on.
    pub fn set_share(&mut self, share: f64) {
        self.inverse.set_share(share);
    }

    /// The vertical and the contrast behind `signals`, K, in the order of the directions; `None`
    /// while those that are there do not span space, or say nothing.
    ///
    /// The length of u falls with the contrast that is assumed, from that of the largest signal on,
    /// so the contrast is where it passes 1. Signals that no contrast explains (noise, an obstructed
    /// sensor) get the smallest one possible. Three pairs at right angles have one solution. Very skew
    /// pairs under a curve far from the sine (in-plane and flat conical fields) can have two, and one
    /// is given: of three pairs at random, the other in 3 attitudes of 1000.
    pub fn solve(&self, signals: &[Option<f64>]) -> Option<Solved> {
        let present = self.present(signals)?;
        if present.largest_k < SMALLEST_SIGNAL_K {
            return None;
        }
        // The unknown is 1/D in units of the largest signal: at 0 there is nothing, at 1 the largest
        // signal's pair is vertical, and between them |u| is close to a straight line.
        let excess = |x: f64| present.excess(x);
        let top = excess(1.0);
        // Only skew pairs come out too short there and long enough elsewhere.
        let x = if top.value >= -TOLERANCE {
            root(excess, 0.0, top, TOLERANCE)
        } else {
            let mut places = (1..PLACES).rev().map(|i| excess(f64::from(i) / f64::from(PLACES)));
            let inside = places.find(|p| p.value >= 0.0);
            inside.map_or(1.0, |inside| root(excess, 0.0, inside, TOLERANCE))
        };
        let contrast_k = present.largest_k / x;
        let (vertical, length) = unit(present.vertical(1.0 / contrast_k))?;
        let residual_k = if present.count > 3 { present.misfit_k(vertical, contrast_k) } else { 0.0 };
        Some(Solved { vertical, contrast_k, length, residual_k })
    }

    /// The vertical behind `signals`, K, when the contrast is known to be `contrast_k` > 0.
    pub fn with_contrast(&self, signals: &[Option<f64>], contrast_k: f64) -> Option<Scaled> {
        let present = self.present(signals)?;
        if !(contrast_k.is_finite() && contrast_k > 0.0) {
            return None;
        }
        let (vertical, length) = unit(present.vertical(1.0 / contrast_k))?;
        Some(Scaled { vertical, length, saturated: present.largest_k > contrast_k })
    }

    /// How noise of the signals, `noise_k` rms in each, moves a solution along `ways`: the standard
    /// deviations of `way·u` with the contrast solved for.
    pub fn spread<const N: usize>(
        &self,
        signals: &[Option<f64>],
        solved: &Solved,
        ways: [Vector; N],
        noise_k: f64,
    ) -> Option<[f64; N]> {
        let present = self.present(signals)?;
        let per_k = 1.0 / solved.contrast_k;
        // What u moves by when the contrast does, over what its length does.
        let pull = present.pull(per_k);
        let along = dot(pull, solved.vertical);
        let mut squares = [0.0; N];
        for (direction, m) in present.pairs() {
            let slope = self.inverse.sine_and_slope(m * per_k).1;
            let moved = product(&present.normal, direction.components()).map(|p| p * slope * per_k);
            let kept = if along > 0.0 { dot(moved, solved.vertical) / along } else { 0.0 };
            for (square, way) in squares.iter_mut().zip(ways) {
                *square += (dot(moved, way) - kept * dot(pull, way)).powi(2);
            }
        }
        Some(squares.map(|s: f64| noise_k * s.sqrt()))
    }

    /// How the vertical of a solution goes with the share of the second curve, and the logarithm of its contrast.
    pub fn by_share(&self, signals: &[Option<f64>], solved: &Solved) -> Option<(Vector, f64)> {
        let present = self.present(signals)?;
        let per_k = 1.0 / solved.contrast_k;
        let pull = present.pull(per_k);
        let other = present.sum(|m| self.inverse.by_share(m * per_k));
        // The contrast goes as far as leaves the length 1.
        let along = dot(pull, solved.vertical);
        let contrast = if along > 0.0 { dot(other, solved.vertical) / along } else { 0.0 };
        Some((add_scaled(other, -contrast, pull), contrast))
    }

    fn present<'a>(&'a self, signals: &'a [Option<f64>]) -> Option<Present<'a>> {
        let mut present = Present { solver: self, signals, normal: self.all, largest_k: 0.0, count: 0 };
        let (mut normal, mut largest_k, mut count) = (Normal::default(), 0.0_f64, 0);
        for (direction, m) in present.pairs() {
            normal.add(direction);
            largest_k = largest_k.max(m.abs());
            count += 1;
        }
        if count < self.directions.len() {
            present.normal = normal.inverse()?;
        }
        Some(Present { largest_k, count, ..present })
    }
}

impl Present<'_> {
    /// The pairs that have a signal.
    fn pairs(&self) -> impl Iterator<Item = (Direction, f64)> {
        let usable = |m: &f64| m.abs() <= LARGEST_SIGNAL_K;
        self.solver.directions.iter().zip(self.signals).filter_map(move |(d, m)| Some((*d, m.filter(usable)?)))
    }

    /// The least squares' vector of `component(signal)` along the pairs.
    fn sum(&self, component: impl Fn(f64) -> f64) -> Vector {
        let mut right = [0.0; 3];
        for (direction, m) in self.pairs() {
            let s = component(m);
            for (sum, b) in right.iter_mut().zip(direction.components()) {
                *sum += b * s;
            }
        }
        product(&self.normal, right)
    }

    /// The vector whose components along the pairs are `g⁻¹(m/D)`, for 1/D = `per_k`.
    fn vertical(&self, per_k: f64) -> Vector {
        self.sum(|m| self.solver.inverse.sine(m * per_k))
    }

    /// How it goes with the logarithm of 1/D.
    fn pull(&self, per_k: f64) -> Vector {
        self.sum(|m| self.solver.inverse.sine_and_slope(m * per_k).1 * m * per_k)
    }

    /// By how much its length exceeds 1, for 1/D = `x`/largest signal.
    fn excess(&self, x: f64) -> Point {
        let per_k = x / self.largest_k;
        let (mut right, mut rising) = ([0.0; 3], [0.0; 3]);
        for (direction, m) in self.pairs() {
            let (sine, slope) = self.solver.inverse.sine_and_slope(m * per_k);
            for ((sum, rise), b) in right.iter_mut().zip(&mut rising).zip(direction.components()) {
                *sum += b * sine;
                *rise += b * slope * m / self.largest_k;
            }
        }
        let (u, rising) = (product(&self.normal, right), product(&self.normal, rising));
        let length = dot(u, u).sqrt();
        Point { x, value: length - 1.0, slope: dot(u, rising) / length }
    }

    fn misfit_k(&self, vertical: Vector, contrast_k: f64) -> f64 {
        let ([one, other], share) = (&self.solver.curves, self.solver.inverse.share());
        let g = |sine: f64| (1.0 - share) * one.g(sine) + share * other.g(sine);
        let square = |(d, m): (Direction, f64)| (m - contrast_k * g(d.dot(vertical))).powi(2);
        (self.pairs().map(square).sum::<f64>() / self.count as f64).sqrt()
    }
}

/// A vector made to length 1, and the length it had.
fn unit(vector: Vector) -> Option<(Vector, f64)> {
    let length = dot(vector, vector).sqrt();
    (length > 0.0).then(|| (vector.map(|c| c / length), length))
}
