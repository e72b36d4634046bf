//! A side of the sky, or of the ground, that is warmer: how far the horizon is expected to lean.
//!
//! Where it is warmer the horizon looks higher, and a whole horizon that leans looks like an attitude: only what tells of
//! the attitude otherwise, turns and climb, tells how it leans. Most skies are much alike all around, and a filter that
//! expects any lean at all would wait for these. So little is expected, until what has been said is far more likely where
//! there is much.

use super::expected::{self, IfExpected};
use super::state::{LEAN, MAX, OFFSET, State, TURN};
use crate::estimator::linear::gain;
use crate::estimator::vector::cross;

/// How many times more likely, as a logarithm, a large lean must be.
const SURE: f64 = 7.0;
/// The share of flights in which the horizon leans.
const LEANING: f64 = 0.2;

/// What the leans would be, beside what was known of them, had a standard deviation of `large` (rad) been expected of
/// them; none where more was.
fn if_expected(state: &State, large: f64) -> Option<IfExpected> {
    IfExpected::of(state, LEAN..LEAN + 2, &state.lean_mean, (state.lean2, large * large))
}

/// Whether leans of standard deviation `large` (rad) explain what was said so far better than the ones that were expected.
pub fn shows(state: &State, large: f64) -> bool {
    if_expected(state, large).is_some_and(|then| then.likelier > SURE)
}

/// The variance of roll and of pitch, rad², by leans of standard deviation `large` (rad) that are not expected and may be
/// there for all that was said so far.
pub fn unexpected(state: &State, large: f64) -> [f64; 2] {
    let Some(IfExpected { x, p, likelier, .. }) = if_expected(state, large) else { return [0.0; 2] };
    let there = 1.0 / (1.0 + (1.0 - LEANING) / LEANING * (-likelier).exp());
    let up = state.vertical();
    let upright = up[2].abs().max(0.3);
    [(1, upright), (0, 1.0)].map(|(axis, share)| {
        let by = [0, 1].map(|i| state.axes[i][axis] / share);
        let square = |i: usize, j: usize| by[i] * by[j] * (x[i] * x[j] + p[i][j]);
        there * (square(0, 0) + 2.0 * square(0, 1) + square(1, 1)).max(0.0)
    })
}

/// Expects leans of standard deviation `large` (rad) from now on, and of what was said so far too.
pub fn expect(state: &mut State, large: f64) {
    let mean = state.lean_mean;
    expected::expect(state, LEAN..LEAN + 2, &mean, (state.lean2, large * large));
    state.lean2 = large * large;
}

/// Takes the leans for known to a standard deviation of `small` (rad), as they are.
pub fn settle(state: &mut State, small: f64) {
    let n = state.size();
    for i in LEAN..LEAN + 2 {
        let ph: [f64; MAX] = state.p[i];
        gain(&mut state.x, &mut state.p, n, &ph, ph[i] + small * small, 0.0);
    }
    (state.lean2, state.lean_mean) = (small * small, [state.x[LEAN], state.x[LEAN + 1]]);
}

/// A horizon that leans by `lean` (rad) may have been taken for an attitude, and that for an offset of the slow
/// references: doubt along the line on which nothing shows.
pub fn hide(s: &mut State, lean: f64) {
    let up = s.vertical();
    for i in 0..2 {
        let level = s.axes[i];
        let turn = cross(level, up).map(|c| lean * c);
        let upright = if up[2].abs() < 0.3 { 0.3_f64.copysign(up[2]) } else { up[2] };
        s.widen(&[
            (LEAN + i, lean),
            (TURN, turn[0]),
            (TURN + 1, turn[1]),
            (TURN + 2, turn[2]),
            (OFFSET, -lean * level[1] / upright),
            (OFFSET + 1, -lean * level[0]),
        ]);
    }
}

#[cfg(test)]
mod tests {
    use super::super::state::SEEN;
    use super::*;

    /// A few readings of leans and of a turn together, none of which says all; `lean` was expected before.
    fn told(lean: f64, readings: &[f64]) -> State {
        let mut state = State::new(6);
        state.lean2 = lean * lean;
        for i in LEAN..LEAN + 2 {
            state.set_variance(i, state.lean2);
        }
        (TURN..TURN + 2).for_each(|i| state.set_variance(i, 0.01));
        for (k, reading) in readings.iter().enumerate() {
            let turned = k as f64;
            let h = [(LEAN, turned.cos()), (LEAN + 1, turned.sin()), (TURN, 10.0)];
            let innovation = reading - h.iter().map(|(i, c)| c * state.x[*i]).sum::<f64>();
            state.correct(&h, innovation, 0.01);
        }
        state
    }

    /// What a lean of `lean` to the north shows, seen all around.
    fn around(lean: f64) -> Vec<f64> {
        (0..12).map(|i| lean * f64::from(i).cos()).collect()
    }

    #[test]
    fn what_is_expected_later_is_as_if_it_had_been_from_the_beginning() {
        for north in [0.0, 0.3, 2.0] {
            let (mut late, early) = (told(0.05, &around(north)), told(1.2, &around(north)));
            assert!((late.x[LEAN] - early.x[LEAN]).abs() >= 0.01 * north);
            expect(&mut late, 1.2);
            for i in 0..late.size() {
                assert!((late.x[i] - early.x[i]).abs() < 1e-6, "{north}, state {i}");
                for j in 0..late.size() {
                    assert!((late.p[i][j] - early.p[i][j]).abs() < 1e-6, "{north}, {i} and {j}");
                }
            }
            assert_eq!(late.lean2, 1.2 * 1.2);
        }
    }

    #[test]
    fn a_lean_shows_and_an_even_sky_does_not() {
        for (north, there) in [(0.0, false), (0.1, false), (1.0, true), (-3.0, true)] {
            assert_eq!(shows(&told(0.05, &around(north)), 1.2), there, "{north}");
        }
        assert!(!shows(&told(0.05, &[]), 1.2), "nothing was read");
        assert!(!shows(&told(2.0, &around(3.0)), 1.2), "more was expected");
    }

    /// Before anything is said the share of flights that have one counts; what is said all around settles it.
    #[test]
    fn what_nobody_has_ruled_out_may_be_there() {
        let large = 1.2;
        let sigma = |state: &State| unexpected(state, large).map(f64::sqrt);
        let at_first = sigma(&told(0.05, &[]));
        assert!(at_first.iter().all(|s| (s / (LEANING.sqrt() * large) - 1.0).abs() < 0.01), "{at_first:?}");
        let even = sigma(&told(0.05, &around(0.0)));
        assert!(even.iter().all(|s| *s < 0.2 * at_first[0]), "{even:?}");
        // What speaks for one counts.
        let leaning = sigma(&told(0.05, &around(1.0)));
        assert!((0.7..1.3).contains(&leaning[1]), "{leaning:?}");
        let mut far = told(0.05, &around(0.0));
        far.x[LEAN] = 1e3;
        assert!(unexpected(&far, large).iter().all(|s| s.is_finite()), "beyond all likelihood");
        assert_eq!(unexpected(&told(2.0, &around(3.0)), large), [0.0; 2], "more was expected");
    }

    /// Readings tell of the attitude, but never better than the lean is known; a reference tells of both.
    #[test]
    fn readings_tell_nothing_of_it_and_references_do() {
        let mut state = State::new(6);
        state.set_variance(LEAN, 0.04_f64.powi(2));
        state.set_variance(TURN + 1, 0.1_f64.powi(2));
        // A sensor that shows 20 K for a radian of either.
        let shows = SEEN;
        let by = 20.0;
        let (lean, turn) = (state.p[LEAN][LEAN], state.p[TURN + 1][TURN + 1]);
        for (i, covariance) in [(LEAN, by * lean), (TURN + 1, by * turn), (shows, by * by * (lean + turn) + 0.01)] {
            (state.p[shows][i], state.p[i][shows]) = (covariance, covariance);
        }
        for _ in 0..1000 {
            state.read(shows, 1.0, 0.01);
        }
        assert_eq!((state.x[LEAN], state.p[LEAN][LEAN]), (0.0, lean));
        let sigma = state.p[TURN + 1][TURN + 1].sqrt();
        assert!(state.x[TURN + 1] > 0.01 && (0.037..0.041).contains(&sigma), "{sigma}");
        assert!((0..state.size()).all(|i| (0..i).all(|j| (state.p[i][j] - state.p[j][i]).abs() < 1e-12)));
        // The attitude by something else.
        state.correct(&[(TURN + 1, 1.0)], 0.0 - state.x[TURN + 1], 1e-6);
        let left = state.p[LEAN][LEAN] / lean;
        assert!(state.x[LEAN] > 0.01 && left < 0.2 && state.is_sound(), "{left}");
    }

    /// What has been told of a lean speaks for no other one once it is taken for known.
    #[test]
    fn a_lean_that_is_known_is_no_wonder() {
        let mut state = told(1.2, &around(1.0));
        let lean = state.x[LEAN];
        settle(&mut state, 0.05);
        assert!(lean > 0.5 && (state.x[LEAN] - lean).abs() < 1e-9 && !shows(&state, 1.2));
        let sigma = unexpected(&state, 1.2).map(f64::sqrt);
        assert!(sigma.iter().all(|s| *s < 1.2), "{sigma:?}");
        // Nor does it once it has been seen to be there as before; had it gone, that would show.
        for (north, gone) in [(lean, false), (lean - 1.0, true)] {
            let mut later = state.clone();
            for i in 0..12 {
                let h = [(LEAN, f64::from(i).cos()), (LEAN + 1, f64::from(i).sin())];
                let innovation = north * h[0].1 - h.iter().map(|(i, c)| c * later.x[*i]).sum::<f64>();
                later.correct(&h, innovation, 0.01);
            }
            assert_eq!(shows(&later, 1.2), gone, "{north}");
        }
    }

    /// As without a gyro.
    #[test]
    fn where_none_is_expected_at_all_there_is_none() {
        let mut state = told(0.05, &[]);
        (LEAN..LEAN + 2).for_each(|i| state.set_variance(i, 0.0));
        assert!(!shows(&state, 1.2));
        assert_eq!(unexpected(&state, 1.2), [0.0; 2]);
        expect(&mut state, 1.2);
        assert_eq!((state.x[LEAN], state.p[LEAN][LEAN]), (0.0, 0.0));
    }

    #[test]
    fn no_more_is_taken_out_than_there_is() {
        let mut state = told(0.05, &around(1.0));
        // A walk that nobody told of.
        (LEAN..LEAN + 2).for_each(|i| state.add_variance(i, 1.0));
        let before = state.clone();
        assert!(!shows(&state, 1.2));
        expect(&mut state, 1.2);
        assert_eq!(state.x, before.x);
        assert!(state.is_sound());
    }
}
