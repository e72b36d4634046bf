//! No step in what is published that the aircraft has not made.
//!
//! Where the estimate lies farther from what was published last than the aircraft can have turned meanwhile and the
//! standard deviation explains, what is too much is kept as an offset, which fades away and counts as error.
//! Everything is reckoned with the vertical: a loop over ±90° of pitch or ±180° of roll is no step.

use super::stand_in::Shown;
use crate::attitude::Attitude;
use crate::estimator::vector::{Vector, cross, dot, length, product, rotation, unit};
use crate::time::Time;
use std::f64::consts::PI;

/// The time constant with which an offset fades, s.
const FADES_S: f64 = 1.0;

/// The fastest that a small aircraft turns, rad/s: 400 °/s.
const FASTEST: f64 = 400.0 / 180.0 * PI;

/// What may always be turned, rad/s (100 °/s), and how much faster than of late the aircraft may turn at once.
const SLOW: f64 = 100.0 / 180.0 * PI;
const QUICKENING: f64 = 2.0;

/// How long "of late" is, s.
const LATELY_S: f64 = 0.5;

/// An offset smaller than this, rad, is none: 0.01°.
const NONE: f64 = 0.01 / 180.0 * PI;

/// The angle between two unit vectors, rad.
pub(crate) fn angle(a: Vector, b: Vector) -> f64 {
    length(cross(a, b)).atan2(dot(a, b))
}

/// The turn of unit vector `from` to `to`, as rotation vector; of two opposite ones about an axis across them.
fn turn(from: Vector, to: Vector) -> Vector {
    let across = || unit(cross(from, [1.0, 0.0, 0.0])).unwrap_or([0.0, 1.0, 0.0]);
    let by = angle(from, to);
    if by == 0.0 {
        return [0.0; 3];
    }
    unit(cross(from, to)).unwrap_or_else(across).map(|c| c * by)
}

/// The unit vector `share` of the way from `from` to `to`.
pub(crate) fn between(from: Vector, to: Vector, share: f64) -> Vector {
    product(&rotation(turn(from, to).map(|c| c * share)), from)
}

/// `sigma` made larger by an error of the vertical's direction of `by`, rad, as `add` puts the two together. Towards
/// ±90° of pitch the same error is a larger one of roll; no more than `most` comes of it.
pub(super) fn widened(sigma: Attitude, pitch: f64, by: f64, most: f64, add: fn(f64, f64) -> f64) -> Attitude {
    let steepest = (by / most).max(1e-9);
    let wide = |sigma: f64, by: f64| add(sigma, by).min(sigma.max(most));
    Attitude { roll: wide(sigma.roll, by / pitch.cos().abs().max(steepest)), pitch: wide(sigma.pitch, by) }
}

/// What is kept from frame to frame.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Continuity {
    /// Turns the estimated vertical to the published one.
    offset: Vector,
    /// The newest estimated vertical.
    last: Option<(Vector, Time)>,
    /// How fast it turned of late, rad/s.
    speed: f64,
}

impl Continuity {
    /// What to publish for `attitude` with `sigma` at `now`, after `shown`, which stood in for a measured one or did
    /// not. Finite angles in, finite angles out; without an offset not a bit is changed.
    pub fn update(
        &mut self,
        attitude: Attitude,
        sigma: Attitude,
        shown: Option<Shown>,
        stood_in: bool,
        now: Time,
    ) -> (Attitude, Attitude) {
        let vertical = attitude.vertical();
        let Some(shown) = shown else {
            *self = Self { last: Some((vertical, now)), speed: FASTEST, ..Self::default() };
            return (attitude, sigma);
        };
        let dt = now.since(shown.at).max(0.0);
        let faded = if stood_in { 0.0 } else { (-dt / FADES_S).exp() };
        self.offset = self.offset.map(|c| c * faded);
        let from = shown.attitude.vertical();
        let mut to = product(&rotation(self.offset), vertical);
        let unsure = (sigma.roll * attitude.pitch.cos()).abs().min(sigma.pitch.abs());
        let fastest = if stood_in { 0.0 } else { FASTEST.min(QUICKENING * self.speed + SLOW) };
        let (step, most) = (angle(from, to), unsure + fastest * dt);
        if step > most {
            to = between(from, to, most / step);
            self.offset = turn(vertical, to);
        }
        self.remember(vertical, fastest, now);
        let left = length(self.offset);
        if left < NONE {
            self.offset = [0.0; 3];
            return (attitude, sigma);
        }
        let published = Attitude::from_vertical(to);
        (published, widened(sigma, published.pitch, left, PI, |sigma, by| sigma + by))
    }

    /// How fast the estimate turns; of a step no more than was allowed.
    fn remember(&mut self, vertical: Vector, fastest: f64, now: Time) {
        if let Some((last, at)) = self.last.replace((vertical, now)) {
            let dt = now.since(at);
            if dt > 0.0 {
                let speed = (angle(last, vertical) / dt).min(fastest);
                self.speed = speed.max(self.speed * (-dt / LATELY_S).exp());
            }
        }
    }
}
