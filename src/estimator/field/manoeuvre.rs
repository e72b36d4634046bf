//! A manoeuvre that begins quicker than rates were thought to change, without a gyro. After minutes of calm they are thought to
//! change little, and what the sensors show of the first bank would be taken for noise, for a second and more.

use super::FieldEstimator;
use super::directions::{Directions, Pattern, dot};
use super::state::{MAX_SENSORS, RATE, SEEN, TURN};

/// Over this time innovations are averaged, s.
const SMOOTH_S: f64 = 0.1;
/// Farther than this many standard deviations is no noise.
const STARTLING: f64 = 5.0;
/// The sensors' patterns of a turn are shorter than this in a contrast of 4 K, K/rad: then it is weather that changes.
const TELLING_K: f64 = 3.0;
/// What shows is behind, by the sensors' lag and by the time over which it is averaged: it has turned so many times as far,
const AHEAD: f64 = 2.0;
/// and began so long ago, s.
const BEGAN_S: f64 = 0.06;
/// How much the rates are thought to change from then on, of what the tuning says.
const LIVELY: f64 = 2.0;

/// Innovations, averaged until a manoeuvre shows.
#[derive(Clone, Copy, Debug, Default)]
pub struct Manoeuvre {
    innovations: Pattern,
}

impl FieldEstimator {
    /// Where what is seen can be no noise and is a turn, doubts at once that there was none: by as much as is shown, what the
    /// sensors show of it included. These readings then say how much of it there was.
    pub(super) fn expect_manoeuvre(&mut self, innovations: &Pattern, directions: &Directions, dt_s: f64) {
        let keep = (-dt_s / SMOOTH_S).exp();
        let averaged = &mut self.manoeuvre.innovations;
        averaged.iter_mut().zip(innovations).for_each(|(a, now)| *a = keep * *a + (1.0 - keep) * now);
        let (averaged, sensors) = (*averaged, self.model.sensors());
        for (axis, pattern) in directions.turn.iter().enumerate() {
            let (shown_k, slope_k) = (dot(&averaged, pattern), directions.slope(axis));
            let shows: [(usize, f64); MAX_SENSORS] = std::array::from_fn(|i| (SEEN + i, pattern[i]));
            let variance = self.state.variance_of(&shows[..sensors]) + self.noise.variance();
            // An average of what is white has this share of its variance.
            let expected = variance * (1.0 - keep) / (1.0 + keep);
            if slope_k > TELLING_K && shown_k * shown_k > STARTLING * STARTLING * expected {
                let angle = shown_k / slope_k;
                let mut along = [(TURN + axis, AHEAD * angle); MAX_SENSORS + 2];
                along[1] = (RATE + axis, angle / BEGAN_S);
                along[2..].iter_mut().zip(shows).for_each(|(a, (i, share))| *a = (i, share * shown_k));
                self.state.widen(&along[..sensors + 2]);
                self.rates[axis].expect(LIVELY);
                self.manoeuvre = Manoeuvre::default();
            }
        }
    }
}
