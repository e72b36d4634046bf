//! A side of the sky, or of the ground, that is warmer: how large it is expected to be.
//!
//! Most skies are much alike all around, and a filter that expects any warm side at all would take every tilt for one.
//! So little is expected, until what the readings show is far more likely where there is much. What they have shown
//! until then is not lost: of normal distributions one expectation can be taken out and another put in, as by a
//! measurement whose variance is negative.

use super::state::{CONTRAST, MAX, OFFSET, SIDE, State, TURN, gain};
use crate::estimator::PAIR_SLOPE;
use crate::estimator::vector::cross;

/// How many times more likely, as a logarithm, a large warm side must be.
const SURE: f64 = 7.0;
/// The sides: north and west of the sky, and of the ground.
const SIDES: usize = 4;

/// Whether a warm side of standard deviation `large_k` explains the readings so far better than the one that was expected.
pub fn shows(state: &State, large_k: f64) -> bool {
    let mut x = [0.0; SIDES];
    x.copy_from_slice(&state.x[SIDE..SIDE + SIDES]);
    let mut p: [[f64; SIDES]; SIDES] = std::array::from_fn(|i| std::array::from_fn(|j| state.p[SIDE + i][SIDE + j]));
    let mut likelier = 0.0;
    for i in 0..SIDES {
        let (mean, variance) = (x[i], p[i][i]);
        let Some(taken) = negative(variance, state.side_k2, large_k * large_k) else { return false };
        let ph = p[i];
        gain(&mut x, &mut p, SIDES, &ph, variance + taken, -mean);
        let shown = x[i] * x[i] / p[i][i] - mean * mean / variance;
        likelier += 0.5 * (shown + (p[i][i] / variance * state.side_k2 / (large_k * large_k)).ln());
    }
    likelier > SURE
}

/// Expects warm sides of standard deviation `large_k` from now on, and of the readings so far too.
pub fn expect(state: &mut State, large_k: f64) {
    let n = state.size();
    for i in SIDE..SIDE + SIDES {
        if let Some(taken) = negative(state.p[i][i], state.side_k2, large_k * large_k) {
            let ph: [f64; MAX] = state.p[i];
            let mean = state.x[i];
            gain(&mut state.x, &mut state.p, n, &ph, ph[i] + taken, -mean);
        }
    }
    state.side_k2 = large_k * large_k;
}

/// Sides that are warmer by `side_k` may have been taken for an attitude, and that for an offset of the slow
/// references: doubt along the line on which nothing shows.
pub fn hide(s: &mut State, side_k: f64) {
    let up = s.vertical();
    let tilt = side_k / (PAIR_SLOPE * s.x[CONTRAST].abs().max(1.0));
    for i in 0..4 {
        let level = s.axes[i % 2];
        let turn = cross(level, up).map(|c| tilt * c);
        let upright = if up[2].abs() < 0.3 { 0.3_f64.copysign(up[2]) } else { up[2] };
        let line = [
            (SIDE + i, side_k),
            (TURN, turn[0]),
            (TURN + 1, turn[1]),
            (TURN + 2, turn[2]),
            (OFFSET, -tilt * level[1] / upright),
            (OFFSET + 1, -tilt * level[0]),
        ];
        for (a, x) in line {
            for (b, y) in line {
                s.p[a][b] += x * y;
            }
        }
    }
}

/// The variance of the measurement that takes out an expectation of variance `was` and puts in `large`; none where
/// that was no smaller, or the readings have told less than nothing.
fn negative(variance: f64, was: f64, large: f64) -> Option<f64> {
    let taken = 1.0 / (1.0 / large - 1.0 / was);
    (was < large && variance < (1.0 + 1e-9) * was).then_some(taken)
}

#[cfg(test)]
mod tests {
    use super::super::state::TURN;
    use super::*;

    /// A few readings of sides and of a turn together, none of which says all; `side_k` was expected before.
    fn told(side_k: f64, readings: &[f64]) -> State {
        let mut state = State::new(6);
        state.side_k2 = side_k * side_k;
        for i in SIDE..SIDE + SIDES {
            state.set_variance(i, state.side_k2);
        }
        (TURN..TURN + 2).for_each(|i| state.set_variance(i, 0.01));
        for (k, reading) in readings.iter().enumerate() {
            let turned = k as f64;
            let h = [(SIDE, turned.cos()), (SIDE + 1, turned.sin()), (TURN, 10.0), (SIDE + 2, 0.4)];
            let innovation = reading - h.iter().map(|(i, c)| c * state.x[*i]).sum::<f64>();
            state.correct(&h, innovation, 0.01);
        }
        state
    }

    /// What a warm north of `k` kelvin shows, seen all around.
    fn around(k: f64) -> Vec<f64> {
        (0..12).map(|i| k * f64::from(i).cos()).collect()
    }

    #[test]
    fn what_is_expected_later_is_as_if_it_had_been_from_the_beginning() {
        for k in [0.0, 0.3, 2.0] {
            let (mut late, early) = (told(0.05, &around(k)), told(1.2, &around(k)));
            assert!((late.x[SIDE] - early.x[SIDE]).abs() >= 0.01 * k);
            expect(&mut late, 1.2);
            for i in 0..late.size() {
                assert!((late.x[i] - early.x[i]).abs() < 1e-6, "{k} K, state {i}");
                for j in 0..late.size() {
                    assert!((late.p[i][j] - early.p[i][j]).abs() < 1e-6, "{k} K, {i} and {j}");
                }
            }
            assert_eq!(late.side_k2, 1.2 * 1.2);
        }
    }

    #[test]
    fn a_warm_side_shows_and_an_even_sky_does_not() {
        for (k, there) in [(0.0, false), (0.1, false), (1.0, true), (-3.0, true)] {
            assert_eq!(shows(&told(0.05, &around(k)), 1.2), there, "{k} K");
        }
        assert!(!shows(&told(0.05, &[]), 1.2), "nothing was read");
        assert!(!shows(&told(2.0, &around(3.0)), 1.2), "more was expected");
    }

    #[test]
    fn no_more_is_taken_out_than_there_is() {
        let mut state = told(0.05, &around(1.0));
        // A walk that nobody told of.
        (SIDE..SIDE + SIDES).for_each(|i| state.add_variance(i, 1.0));
        let before = state.clone();
        assert!(!shows(&state, 1.2));
        expect(&mut state, 1.2);
        assert_eq!(state.x, before.x);
        assert!(state.is_sound());
    }
}
