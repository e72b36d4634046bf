//! Roll and pitch against the turn and the climb that are flown, and whether the head is wired as it is configured.

mod scale;
mod side;

use super::debounce::Debounce;
use super::wired::Wired;
use super::{ActiveFault, Evidence, FaultKind};
use crate::attitude::Attitude;
use crate::estimator::Solution;
use crate::estimator::references::{Angle, CORRELATION_S, References, STEEPEST};
use crate::frame::Aiding;
use crate::time::Time;
use scale::Scale;
use side::Side;
use std::f64::consts::FRAC_PI_2;

/// Over this time differences are averaged, s.
const WINDOW_S: f64 = 5.0;
/// What has been found fades by such a share of what is new to the average.
const FADES: f64 = 0.5;
/// So many standard deviations of both together a difference must be.
const SIGMAS: f64 = 2.5;
/// Seconds for which it must be there, and must be gone.
const LASTS_S: (f64, f64) = (2.0, 3.0);
/// It is gone below this share of the limit.
const HYSTERESIS: f64 = 0.6;
/// Beyond so much of roll and pitch it is aerobatics, in which nothing tells of the bank by the turn, rad.
const FLYING: Attitude = Attitude { roll: FRAC_PI_2, pitch: STEEPEST };
/// So old, s, a difference is none.
const STALE_S: f64 = 4.0;

/// One angle less its reference, averaged.
#[derive(Clone, Copy, Debug)]
struct Difference {
    mean: f64,
    /// The largest that it has been of late: a mean that changes its sign is small for a moment, and what disagrees is not.
    found: f64,
    variance: f64,
    /// That of what stays, rad².
    stays: f64,
    /// The time that it stands for, s, up to [`WINDOW_S`].
    weight_s: f64,
    heard: Option<Time>,
    disagrees: Debounce,
}

/// Sees `roll-disagrees` and `pitch-disagrees`. Without GPS or a gyro it says nothing.
#[derive(Clone, Debug)]
pub struct Disagree {
    limit: f64,
    wired: Wired,
    scale: Scale,
    side: Side,
    references: References,
    roll: Difference,
    pitch: Difference,
    /// The mean of pitch since the last climb.
    pitched: (f64, f64),
}

impl Disagree {
    /// With the difference from references from which they disagree, rad.
    pub fn new(limit: f64) -> Self {
        let none = Difference {
            mean: 0.0,
            found: 0.0,
            variance: 0.0,
            stays: 0.0,
            weight_s: 0.0,
            heard: None,
            disagrees: Debounce::new(LASTS_S.0, LASTS_S.1),
        };
        let references = References::default();
        Self {
            limit,
            wired: Wired::default(),
            scale: Scale::default(),
            side: Side::default(),
            references,
            roll: none,
            pitch: none,
            pitched: (0.0, 0.0),
        }
    }

    /// Another difference from which they disagree, rad.
    pub fn retune(&mut self, limit: f64) {
        self.limit = limit;
    }

    /// Takes in what a method makes of a frame: whether a gyro turns otherwise.
    pub fn hear(&mut self, solution: &Solution, now: Time) {
        self.wired.update(solution, now);
    }

    /// Takes in an attitude with its standard deviation, and what other instruments said. Without an attitude
    /// nothing is compared, and what was compared ends.
    pub fn update(&mut self, attitude: Option<(Attitude, Attitude)>, aiding: &Aiding, now: Time) {
        let Some((attitude, sigma)) = attitude else {
            let (wired, scale) = (std::mem::take(&mut self.wired), std::mem::take(&mut self.scale));
            let side = std::mem::take(&mut self.side);
            *self = Self { wired, scale, side, ..Self::new(self.limit) };
            return;
        };
        let heard = self.references.hear(aiding, attitude.roll, now);
        self.pitched = (self.pitched.0 + attitude.pitch, self.pitched.1 + 1.0);
        let flying = attitude.roll.abs() < FLYING.roll && attitude.pitch.abs() < FLYING.pitch;
        let references = [heard.bank.map(|(bank, _)| bank), heard.climb];
        self.wired.compare(attitude, references.map(|r| r.filter(|_| flying)), now);
        if let Some((bank, roll)) = heard.bank {
            if roll.abs() < FLYING.roll && attitude.pitch.abs() < FLYING.pitch {
                self.scale.compare(roll, bank, now);
                // How steep a steep one is nobody knows: one of the two that is disagrees by so much at least.
                let [roll, angle] = [roll, bank.angle].map(|a| a.clamp(-STEEPEST, STEEPEST));
                if let Some(course) = heard.course {
                    self.side.roll(roll - angle, bank, course, now);
                }
                self.roll.compare(roll, Angle { angle, ..bank }, now);
            } else {
                self.roll.forget();
            }
        }
        if let Some(climb) = heard.climb {
            let pitch = self.pitched.0 / self.pitched.1;
            self.pitched = (0.0, 0.0);
            if let Some(course) = heard.course.filter(|_| flying) {
                self.side.pitch(pitch - climb.angle, climb, course, now);
            }
            self.pitch.compare(pitch, climb, now);
        }
        self.scale.judge(attitude, now);
        self.side.judge(now);
        self.roll.judge(self.limit, sigma.roll, now);
        self.pitch.judge(self.limit, sigma.pitch, now);
    }

    /// What to add to the standard deviations of roll and pitch: one of the two is wrong, and nobody knows which. Where
    /// a sensor is `left_out` it may be the wrong one, and the attitude is likely to be what is wrong.
    pub fn doubt(&self, left_out: bool) -> Attitude {
        let share = if left_out { 1.0 } else { 0.5 };
        let of = |d: &Difference| if d.disagrees.is_active() { share * d.found } else { 0.0 };
        let own = Attitude { roll: of(&self.roll), pitch: of(&self.pitch) };
        let larger = |a: Attitude, b: Attitude| Attitude { roll: a.roll.max(b.roll), pitch: a.pitch.max(b.pitch) };
        larger(own, larger(self.side.doubt(), larger(self.wired.doubt(), self.scale.doubt())))
    }

    /// Adds what is there to `faults`.
    pub fn report(&self, faults: &mut Vec<ActiveFault>) {
        let kinds = [FaultKind::RollDisagrees, FaultKind::PitchDisagrees];
        for (angle, (kind, d)) in kinds.into_iter().zip([&self.roll, &self.pitch]).enumerate() {
            let [value, limit] = [d.mean, self.limit].map(f64::to_degrees);
            if d.disagrees.is_active() {
                d.disagrees.report(kind, Evidence::Limit { value, limit, unit: "°" }, faults);
            } else if self.wired.tells(angle) {
                self.wired.report(angle, kind, faults);
            } else if kind == FaultKind::RollDisagrees {
                self.scale.report(faults);
            }
        }
    }
}

impl Difference {
    fn compare(&mut self, angle: f64, reference: Angle, now: Time) {
        let share = (reference.span_s / WINDOW_S).min(1.0).max(reference.span_s / (self.weight_s + reference.span_s));
        self.weight_s = (self.weight_s + reference.span_s).min(WINDOW_S);
        self.mean += share * (angle - reference.angle - self.mean);
        self.found = self.mean.abs().max(self.found * (1.0 - FADES * share));
        self.variance += share * (reference.sigma * reference.sigma - self.variance);
        self.stays += share * (reference.stays * reference.stays - self.stays);
        self.heard = Some(now);
    }

    fn forget(&mut self) {
        (self.mean, self.weight_s) = (0.0, 0.0);
    }

    fn judge(&mut self, limit: f64, sigma: f64, now: Time) {
        if self.heard.is_none_or(|at| !(0.0..STALE_S).contains(&now.since(at))) {
            self.forget();
        }
        let alone = (self.weight_s / CORRELATION_S).max(1.0);
        let expected = (self.variance / alone + self.stays + sigma * sigma).sqrt();
        let limit = limit.max(SIGMAS * expected) * if self.disagrees.is_active() { HYSTERESIS } else { 1.0 };
        let there = self.weight_s >= CORRELATION_S && self.mean.abs() > limit;
        self.disagrees.update(there, now);
    }
}

#[cfg(test)]
mod tests;
