//! The other verdict: a film on either of two sensors that look apart makes both look too warm, and while it grows the
//! wrong one may be left out. What follows tells: what is under a film goes on showing the same.

use super::filter::{Step, Witness};
use super::follow::Follow;
use super::{MAX_SENSORS, Model};
use crate::attitude::Attitude;
use crate::estimator::vector::Vector;

/// The logarithm of the odds over how much less a verdict surprises: readings are not independent.
const ODDS: f64 = 0.25;
/// By so long after one is left out a film has grown, s.
const GROWN_S: f64 = 2.5;
/// One that loses so little of what it should show is under no film; one that loses so much is,
const FOLLOWS: f64 = 0.5;
const FILM: f64 = 0.85;
/// where the other moves by so much, K rms, and so many times as much.
const MOVES: (f64, f64) = (1.0, 3.0);
/// So much is enough to end the doubt where the one left out is still, and to be in doubt where the other is.
const STILL: (f64, f64) = (0.2, 2.5);

/// The verdict on the sensor that looks away from the one left out.
#[derive(Clone, Debug)]
pub struct Rival {
    /// The sensor that is to blame by it.
    pub culprit: usize,
    /// The one that is left out.
    pub left_out: usize,
    /// One that hears that, and not the culprit.
    pub witness: Witness,
    /// By how much the sums of surprises differed when it was not believed.
    behind: f64,
    age_s: f64,
    /// What either should show by the verdict on it, and shows.
    follow: [Follow; 2],
}

impl Rival {
    /// The verdict on `culprit`, for which `witness` stands, and whose sum is `behind` that on `left_out`.
    pub fn new((culprit, left_out): (usize, usize), witness: Witness, behind: f64) -> Self {
        Self { culprit, left_out, witness, behind, age_s: 0.0, follow: [Follow::default(); 2] }
    }

    /// Takes in a step, in which the one left out should show `expected`.
    pub fn hear(&mut self, model: &Model, step: &Step, readings: &[Option<f64>; MAX_SENSORS], expected: f64) {
        let testimony = self.witness.hear(model, step, readings);
        self.age_s += step.dt_s;
        if self.age_s < GROWN_S {
            return;
        }
        let two = [(self.culprit, testimony.expected[self.culprit]), (self.left_out, expected)];
        for (follow, (i, expected)) in self.follow.iter_mut().zip(two) {
            readings[i].into_iter().for_each(|shown| follow.update(expected, shown, step.dt_s));
        }
    }

    /// Whether it is right: what it blames shows the same all the time, and the one left out does not.
    pub fn is_right(&self) -> bool {
        let [culprit, left_out] = &self.follow;
        culprit.lost().is_some_and(|lost| lost > FILM) && is_still(culprit, left_out, MOVES)
    }

    /// Whether it is wrong: the other way round, or what it blames follows what it should show.
    pub fn is_wrong(&self) -> bool {
        let [culprit, left_out] = &self.follow;
        is_still(left_out, culprit, STILL) || culprit.lost().is_some_and(|lost| lost < FOLLOWS)
    }

    /// How far roll and pitch may be off by it, rad, where `up` is taken to be up.
    pub fn spread(&self, up: Vector) -> Attitude {
        let [culprit, left_out] = &self.follow;
        let odds = if is_still(culprit, left_out, STILL) { 1.0 } else { (-ODDS * self.behind).exp() };
        let share = odds / (1.0 + odds);
        let (own, other) = (Attitude::from_vertical(self.witness.up()), Attitude::from_vertical(up));
        let wrap = |a: f64| a.sin().atan2(a.cos());
        let part = |a: f64| share.sqrt() * wrap(a).abs();
        Attitude { roll: part(own.roll - other.roll), pitch: part(own.pitch - other.pitch) }
    }
}

/// Whether one shows the same all the time, and the other moves by so much, K, and so many times as much.
fn is_still(one: &Follow, other: &Follow, (least_k, times): (f64, f64)) -> bool {
    let [Some(still_k), Some(moves_k)] = [one, other].map(Follow::moves_k) else { return false };
    moves_k > least_k.max(times * still_k)
}
