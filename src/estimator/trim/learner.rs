//! The learner: differences from the references, averaged over minutes, and the trim that follows.

use super::prior::Prior;
use crate::attitude::Attitude;
use crate::estimator::references::{Angle, References};
use crate::frame::Aiding;
use crate::time::Time;

/// The time over which differences are averaged, s: long, since a mounting does not change in flight, and
/// every gust that fades out of the mean would move the trim.
const WINDOW_S: f64 = 600.0;
/// The time after which a reference's error is another one, s.
const CORRELATION_S: f64 = 3.0;
/// The fastest change of the trim, rad/s.
const FASTEST_RAD_S: f64 = 0.05_f64.to_radians();
/// A larger difference is an error of something, rad.
const LARGEST: f64 = 30_f64.to_radians();
/// The estimated angles beyond which nothing is compared, rad.
const STEEPEST_ROLL: f64 = 45_f64.to_radians();
const STEEPEST_PITCH: f64 = 30_f64.to_radians();
/// A side of the sky or ground warmer than the other tilts the horizon by about so much (1σ), rad. It
/// turns with the heading: flown round, it is nothing in the mean.
const WARM_SIDE: f64 = 2.5_f64.to_radians();
/// What the angle of attack grows by at twice the weight, about, rad.
const ATTACK_PER_G: f64 = 5_f64.to_radians();
/// The share of a lasting climb that may be the air's own rising.
const AIR_SHARE: f64 = 0.5;

/// What is compared, beside the difference itself.
#[derive(Clone, Copy, Debug)]
struct Circumstances {
    course: f64,
    climb: f64,
}

/// What is learnt of one angle.
#[derive(Clone, Copy, Debug)]
struct Axis {
    prior: Prior,
    /// The largest trim, rad.
    limit: f64,
    /// The weights in the mean: each is 1 over the variance of what it weighs, and fades with its age.
    /// Their sum, and the sum of their squares by that variance, rad⁻².
    weight: f64,
    square: f64,
    /// Means over the window: the difference, its squared departures in their own σ², the course as a
    /// unit vector, the angle of climb.
    means: [f64; 5],
    trim: f64,
    sigma: f64,
}

impl Axis {
    fn new(prior: Prior, limit_deg: f64) -> Self {
        Self { prior, limit: limit_deg.to_radians(), weight: 0.0, square: 0.0, means: [0.0; 5], trim: 0.0, sigma: 0.0 }
    }

    /// Takes in that the estimate is `difference` (rad) above the reference.
    fn learn(&mut self, difference: f64, reference: Angle, seen: Circumstances) {
        let Angle { sigma, span_s, .. } = reference;
        if difference.abs() > LARGEST {
            return;
        }
        let departure = if self.weight > 0.0 { (difference - self.means[0]) / sigma } else { 1.0 };
        let new = span_s / (CORRELATION_S * sigma.powi(2));
        let fading = (-span_s / WINDOW_S).exp();
        self.weight = self.weight * fading + new;
        self.square = self.square * fading.powi(2) + new;
        let (sin, cos) = seen.course.sin_cos();
        for (mean, value) in self.means.iter_mut().zip([difference, departure.powi(2), cos, sin, seen.climb]) {
            *mean += new / self.weight * (value - *mean);
        }
        let [mean, scatter, north, east, climb] = self.means;
        let error = (scatter.max(1.0) * self.square).sqrt() / self.weight;
        let error = error.hypot(WARM_SIDE * north.hypot(east)).hypot(AIR_SHARE * climb);
        let belief = self.prior.believe(mean, error);
        let step = FASTEST_RAD_S * span_s;
        self.trim += (belief.trim.clamp(-self.limit, self.limit) - self.trim).clamp(-step, step);
        self.sigma = belief.sigma.hypot(belief.trim - self.trim);
    }
}

/// The trim of a head, learnt in flight.
///
/// It changes by 0.05 °/s at the most, stays within ±10° of roll and ±15° of pitch, and stands still
/// while there is nothing to learn from.
#[derive(Clone, Debug)]
pub struct Learner {
    references: References,
    roll: Axis,
    pitch: Axis,
}

impl Default for Learner {
    fn default() -> Self {
        Self {
            references: References::default(),
            roll: Axis::new(Prior::ROLL, 10.0),
            pitch: Axis::new(Prior::PITCH, 15.0),
        }
    }
}

impl Learner {
    /// Takes in `attitude`, as estimated at `now` with no trim but the configured, and what came beside
    /// its frame.
    pub fn update(&mut self, attitude: Attitude, aiding: &Aiding, now: Time) {
        let Attitude { roll, pitch } = attitude;
        if !(roll.is_finite() && pitch.is_finite()) {
            return;
        }
        let heard = self.references.hear(aiding, roll, now);
        // Without a course nothing is known to have been flown round.
        let course = heard.course.unwrap_or(0.0);
        if let Some((bank, roll)) = heard.bank {
            self.roll.learn(roll - bank.angle, bank, Circumstances { course, climb: 0.0 });
        }
        if let Some(climb) = heard.climb
            && roll.abs() < STEEPEST_ROLL
            && pitch.abs() < STEEPEST_PITCH
        {
            // In a bank only this share of a turn about the wing is a change of pitch, and the wing
            // carries more than the weight.
            let share = roll.cos();
            let sigma = (climb.sigma / share).hypot(ATTACK_PER_G * (1.0 / share - 1.0));
            let of_head = Angle { sigma, ..climb };
            self.pitch.learn((pitch - climb.angle) / share, of_head, Circumstances { course, climb: climb.angle });
        }
    }

    /// What the head shows in level flight beyond the configured trim, rad.
    pub fn trim(&self) -> Attitude {
        Attitude { roll: self.roll.trim, pitch: self.pitch.trim }
    }

    /// The part of the trim's standard deviation that it brings to the attitude, and how far it has yet
    /// to go, rad; 0 before anything was learnt.
    pub fn sigma(&self) -> Attitude {
        Attitude { roll: self.roll.sigma, pitch: self.pitch.sigma }
    }
}
