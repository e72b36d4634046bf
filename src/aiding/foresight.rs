//! How far an aircraft turns beyond what its newest rates alone would make it, learnt from how it did. Pure.
//!
//! What has begun goes on for a moment: a gust, a roll into a turn. How much of it, and for how long, is the
//! aircraft's and the air's. So the least-squares weights of the last slopes of a rate, and of the rate itself, are
//! learnt for each axis and some times ahead, from what came to be; and how far the guesses were off.

use super::rates::Rate;
use crate::estimator::linear;

/// The times ahead, s.
pub const AHEAD_S: [f64; 5] = [0.04, 0.08, 0.12, 0.16, 0.2];
const COUNT: usize = AHEAD_S.len();
/// The newest slope of a rate, °/s², the one before, and the rate, °/s.
const TERMS: usize = 3;

/// Over how long the weights are learnt, and over how long how far they are off, s.
const WEIGHTS_S: f64 = 20.0;
const ERRORS_S: f64 = 4.0;
/// Before all learning: the newest slope goes on with this time constant, s, and by this much, °/s², it is wrong.
const GOES_ON_S: f64 = 0.07;
const WRONG_DEG_S2: f64 = 100.0;
/// That counts for as many rates.
const PRIOR: f64 = 50.0;

/// Nothing is learnt from what is larger than this, whatever its unit: no aircraft does it.
const LARGEST: f64 = 1e7;

type Weights = [f64; TERMS];

/// What is told apart of each axis.
pub type Terms = [Weights; 3];

/// What is known of one axis.
#[derive(Clone, Copy, Debug)]
struct Axis {
    /// The weighted means of the products of the terms, and of each with what came to be.
    products: [Weights; TERMS],
    outcomes: [Weights; COUNT],
    weights: [Weights; COUNT],
    /// Squares of what the guesses were off by, °².
    errors: [f64; COUNT],
}

/// What is known of all three.
#[derive(Clone, Debug)]
pub struct Foresight {
    axes: [Axis; 3],
    learnt: f64,
}

/// The weights before all learning.
fn prior() -> [Weights; COUNT] {
    AHEAD_S.map(|ahead_s| {
        let gone_s = GOES_ON_S * (1.0 - (-ahead_s / GOES_ON_S).exp());
        [GOES_ON_S * (ahead_s - gone_s), 0.0, 0.0]
    })
}

impl Default for Foresight {
    fn default() -> Self {
        let axis = Axis {
            products: [[0.0; TERMS]; TERMS],
            outcomes: [[0.0; TERMS]; COUNT],
            weights: prior(),
            errors: AHEAD_S.map(|ahead_s| (0.5 * WRONG_DEG_S2 * ahead_s * ahead_s).powi(2)),
        };
        Self { axes: [axis; 3], learnt: 0.0 }
    }
}

fn dot(a: &Weights, b: &Weights) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The mean `old` moved toward `new`.
fn blend(old: &mut f64, new: f64, share: f64) {
    *old += share * (new - *old);
}

impl Axis {
    /// `terms` were followed by `outcomes`, °.
    fn learn(&mut self, terms: &Weights, outcomes: [f64; COUNT], [weights, errors]: [f64; 2], learnt: f64) {
        for (k, outcome) in outcomes.into_iter().enumerate() {
            blend(&mut self.errors[k], (outcome - dot(&self.weights[k], terms)).powi(2), errors);
            for (sum, term) in self.outcomes[k].iter_mut().zip(terms) {
                blend(sum, term * outcome, weights);
            }
        }
        for (row, a) in self.products.iter_mut().zip(terms) {
            row.iter_mut().zip(terms).for_each(|(entry, b)| blend(entry, a * b, weights));
        }
        if let Some(solved) = self.solve(PRIOR / learnt) {
            self.weights = solved;
        }
    }

    /// The weights of least squares, drawn to those of before all learning as by a share `pull` of the terms.
    fn solve(&self, pull: f64) -> Option<[Weights; COUNT]> {
        let (mut matrix, mut solved) = (self.products, prior());
        for (i, row) in matrix.iter_mut().enumerate() {
            row[i] *= 1.0 + pull;
        }
        for (weights, outcomes) in solved.iter_mut().zip(&self.outcomes) {
            let right = std::array::from_fn(|i| outcomes[i] + pull * self.products[i][i] * weights[i]);
            *weights = linear::solve(matrix, right)?;
        }
        solved.iter().flatten().all(|w| w.is_finite()).then_some(solved)
    }
}

impl Foresight {
    /// `terms` were followed after each of [`AHEAD_S`] by `outcomes`, °, beyond what the rate alone makes; `dt_s` after
    /// those that were learnt last.
    pub fn learn(&mut self, terms: &Terms, outcomes: &[Rate; COUNT], dt_s: f64) {
        let mut values = terms.iter().chain(outcomes).flatten();
        if !values.all(|v| v.abs() < LARGEST) {
            return;
        }
        self.learnt += 1.0;
        let shares = [WEIGHTS_S, ERRORS_S].map(|over_s| (1.0 - (-dt_s / over_s).exp()).max(1.0 / (self.learnt + 1.0)));
        let count = self.learnt.min(1.0 / shares[0]);
        for (i, axis) in self.axes.iter_mut().enumerate() {
            axis.learn(&terms[i], outcomes.map(|o| o[i]), shares, count);
        }
    }

    /// How far it will have turned `ahead_s` after `terms` beyond what the rate alone makes, °, and the variance of that,
    /// °².
    pub fn guess(&self, terms: &Terms, ahead_s: f64) -> [Rate; 2] {
        let next = AHEAD_S.partition_point(|at| *at < ahead_s).clamp(1, COUNT - 1);
        let (a, b) = (next - 1, next);
        let x = ((ahead_s - AHEAD_S[a]) / (AHEAD_S[b] - AHEAD_S[a])).max(0.0);
        // It begins with the square of the time.
        let between = |at: &dyn Fn(usize) -> f64, power: i32| {
            let [first, second] = [a, b].map(|k| at(k) / AHEAD_S[k].powi(power));
            (first + x * (second - first)) * ahead_s.powi(power)
        };
        let axis = |i: usize| (&self.axes[i], &terms[i]);
        [
            std::array::from_fn(|i| between(&|k| dot(&axis(i).0.weights[k], axis(i).1), 2)),
            std::array::from_fn(|i| between(&|k| axis(i).0.errors[k], 4).max(0.0)),
        ]
    }
}

#[cfg(test)]
mod tests {
    use crate::aiding::rates::Rates;
    use crate::time::Time;

    /// What the guesses 60 ms ahead of a rate at 50 Hz are off by, rms, and by how much they are said to be, after a
    /// minute of learning; and what holding the rate is off by.
    fn off(rate: impl Fn(f64) -> f64) -> [f64; 3] {
        let at = |s: f64| Time::from_secs_f64(100.0 + s);
        let (mut rates, mut sums, mut count) = (Rates::default(), [0.0; 3], 0.0);
        for i in 0..6000 {
            let (s, ahead_s) = (f64::from(i) * 0.02, 0.06);
            assert!(rates.insert(at(s), [0.0, rate(s), 0.0]));
            if s > 60.0 {
                let mut guess = 0.0;
                rates.through(at(s), at(s + ahead_s), |mean, dt_s| guess += mean[1] * dt_s).unwrap();
                let truth: f64 = (0..600).map(|j| rate(s + (f64::from(j) + 0.5) * 1e-4) * 1e-4).sum();
                let off = [guess - truth, rates.unknown(at(s + ahead_s))[1].sqrt(), rate(s) * ahead_s - truth];
                sums.iter_mut().zip(off).for_each(|(sum, off)| *sum += off * off);
                count += 1.0;
            }
        }
        sums.map(|sum| (sum / count).sqrt())
    }

    #[test]
    fn what_swings_evenly_is_foreseen() {
        let [guess, said, held] = off(|s| 20.0 * (4.0 * s).sin());
        assert!(guess < 0.1 * held && (0.5..2.0).contains(&(said / guess)), "{guess} {said} {held}");
    }

    #[test]
    fn what_has_no_trend_is_not_believed_to_have_one() {
        // A new rate every 20 ms, whatever it was before.
        let rate = |s: f64| {
            let i = (s / 0.02 + 1e-6).floor() as u64;
            (i.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40) as f64 / f64::from(1 << 24) - 0.5
        };
        let [guess, said, held] = off(rate);
        assert!(guess < 0.9 * held && (0.8..1.25).contains(&(said / guess)), "{guess} {said} {held}");
    }

    #[test]
    fn no_rate_is_too_large() {
        let mut rates = Rates::default();
        let at = |i: u32| Time::from_secs_f64(5.0 + f64::from(i) * 0.02);
        for i in 0..200 {
            rates.insert(at(i), [if i == 50 { 1e200 } else { 1.0 }; 3]);
            let later = at(i) + std::time::Duration::from_millis(100);
            let guessed = rates.at(later).unwrap();
            assert!(i < 70 || guessed.iter().all(|v| v.is_finite()), "{i}: {guessed:?}");
        }
    }
}
