//! States of which little is expected until what has been said is far more likely with more.
//!
//! What was said until then is not lost: of normal distributions one expectation can be taken out and another put in, as by
//! a measurement whose variance is negative.

use super::state::{MAX, MAX_SENSORS, State};
use crate::estimator::linear::gain;
use std::ops::Range;

/// The most states that can be asked about.
const MOST: usize = 2 * MAX_SENSORS;

/// What some states would be, less what they are expected about, had more been expected of them, by what was said so far.
#[derive(Clone, Copy, Debug)]
pub struct IfExpected {
    /// Their values: as many as there are such states.
    pub x: [f64; MOST],
    /// Their covariance.
    pub p: [[f64; MOST]; MOST],
    /// How many times likelier, as a logarithm, what was said so far is then.
    pub likelier: f64,
    /// How unlikely such values are even then, as a logarithm.
    pub unlikely: f64,
}

impl IfExpected {
    /// Had a variance of `large` about `means` (0 where there is none) been expected of each of `states` (no more than two for
    /// each of [`MAX_SENSORS`]) where it was `was`; none where more was expected, or nothing at all is.
    pub fn of(state: &State, states: Range<usize>, means: &[f64], (was, large): (f64, f64)) -> Option<Self> {
        let n = states.len();
        let mut made = Self { x: [0.0; MOST], p: [[0.0; MOST]; MOST], likelier: 0.0, unlikely: 0.0 };
        let Self { x, p, likelier, unlikely } = &mut made;
        x[..n].copy_from_slice(&state.x[states.clone()]);
        x.iter_mut().zip(means).for_each(|(x, mean)| *x -= mean);
        p.iter_mut().zip(&state.p[states.clone()]).for_each(|(p, row)| p[..n].copy_from_slice(&row[states.clone()]));
        for i in 0..n {
            let (mean, variance) = (x[i], p[i][i]);
            let taken = negative(variance, was, large)?;
            let ph = p[i];
            gain(x, p, n, &ph, variance + taken, -mean);
            let shown = x[i] * x[i] / p[i][i] - mean * mean / variance;
            *likelier += 0.5 * (shown + (p[i][i] / variance * was / large).ln());
        }
        *unlikely = x.iter().map(|x| 0.5 * x * x / large).sum();
        Some(made)
    }
}

/// Expects a variance of `large` about `means` of each of `states` from now on where it was `was`, and of what was said so far
/// too.
pub fn expect(state: &mut State, states: Range<usize>, means: &[f64], (was, large): (f64, f64)) {
    let n = state.size();
    for (k, i) in states.enumerate() {
        if let Some(taken) = negative(state.p[i][i], was, large) {
            let ph: [f64; MAX] = state.p[i];
            let mean = state.x[i] - means.get(k).unwrap_or(&0.0);
            gain(&mut state.x, &mut state.p, n, &ph, ph[i] + taken, -mean);
        }
    }
}

/// The variance of the measurement that takes out an expectation of variance `was` and puts in `large`; none where
/// that was no smaller, or the readings have told less than nothing, or the state is none of this filter's.
fn negative(variance: f64, was: f64, large: f64) -> Option<f64> {
    let taken = 1.0 / (1.0 / large - 1.0 / was);
    (was < large && variance > 0.0 && variance < (1.0 + 1e-9) * was).then_some(taken)
}
