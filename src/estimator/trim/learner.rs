//! The learner: what the differences from the references over minutes say of the mounting, and the trim that follows.

use super::departure::Departure;
use super::differences::{Differences, Explained, Shares};
use super::prior::Prior;
use crate::attitude::Attitude;
use crate::estimator::references::{AIR_SHARE, Angle, References};
use crate::frame::Aiding;
use crate::time::Time;

/// The fastest change of the trim, rad/s.
const FASTEST_RAD_S: f64 = 0.05_f64.to_radians();
/// A larger difference is an error of something, rad.
const LARGEST: f64 = 30_f64.to_radians();
/// The estimated angles beyond which nothing is compared, rad.
const STEEPEST_ROLL: f64 = 45_f64.to_radians();
const STEEPEST_PITCH: f64 = 30_f64.to_radians();
/// What the angle of attack grows by at twice the weight, about, rad.
const ATTACK_PER_G: f64 = 5_f64.to_radians();
/// The time after which a reference's error is another one, s: a gust, the beginning or end of a turn; air that rises or
/// sinks over a hundred metres.
const LASTS_S: [f64; 2] = [3.0, 7.0];
/// What may be learnt of each angle, and the largest trim, rad.
const LEARNT: [(Prior, f64); 2] = [(Prior::ROLL, 10_f64.to_radians()), (Prior::PITCH, 15_f64.to_radians())];

/// The trim of one angle.
#[derive(Clone, Copy, Debug, Default)]
struct Axis {
    trim: f64,
    sigma: f64,
}

/// The trim of a head, learnt in flight.
///
/// It changes by 0.05 °/s at the most, stays within ±10° of roll and ±15° of pitch, and stands still
/// while there is nothing to learn from.
#[derive(Clone, Debug)]
pub struct Learner {
    references: References,
    /// Of roll and of pitch.
    differences: [Differences; 2],
    explained: Explained,
    departures: [Departure; 2],
    axes: [Axis; 2],
}

impl Default for Learner {
    fn default() -> Self {
        Self {
            references: References::default(),
            differences: LASTS_S.map(Differences::new),
            explained: Explained::default(),
            departures: [Departure::default(); 2],
            axes: [Axis::default(); 2],
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
        let heading = heard.air.map(|air| air.heading).or(heard.course).unwrap_or(0.0);
        let (sin, cos) = heading.sin_cos();
        if let Some((bank, roll)) = heard.gentle_bank() {
            self.learn(0, roll - bank.angle, bank, [1.0, sin, -cos], 0.0);
        }
        if let Some(climb) = heard.climb
            && roll.abs() < STEEPEST_ROLL
            && pitch.abs() < STEEPEST_PITCH
        {
            // In a bank only this share of a turn about the wing is a change of pitch, and the wing
            // carries more than the weight: about so much, and by so much it may be another.
            let share = roll.cos();
            let attack = ATTACK_PER_G * (1.0 - share);
            let sigma = climb.sigma.hypot(attack);
            self.learn(1, pitch - attack - climb.angle, Angle { sigma, ..climb }, [share, cos, sin], climb.angle);
        }
    }

    /// Takes in that `angle` (0 is roll, 1 pitch) is estimated `difference` (rad) above the reference.
    fn learn(&mut self, angle: usize, difference: f64, reference: Angle, shares: Shares, climb: f64) {
        let Angle { sigma, span_s, .. } = reference;
        let (prior, limit) = LEARNT[angle];
        let left = difference - self.explained.of(angle, shares);
        let expected = self.explained.error[angle].hypot(prior.well);
        let scattered = sigma * self.differences[angle].scatter();
        let departure = &mut self.departures[angle];
        departure.hear(left, (scattered, LASTS_S[angle]), span_s, expected);
        if difference.abs() > LARGEST || departure.is_odd() {
            return;
        }
        self.differences[angle].gather((difference, sigma), shares, left, span_s, climb);
        let Some(explained) = Explained::by(&self.differences) else { return };
        self.explained = explained;
        let error = explained.error[angle].hypot(AIR_SHARE * self.differences[angle].climb());
        let belief = prior.believe(explained.mounting[angle], error);
        let step = FASTEST_RAD_S * span_s;
        let axis = &mut self.axes[angle];
        axis.trim += (belief.trim.clamp(-limit, limit) - axis.trim).clamp(-step, step);
        axis.sigma = belief.sigma.hypot(belief.trim - axis.trim);
    }

    /// What the head shows in level flight beyond the configured trim, rad.
    pub fn trim(&self) -> Attitude {
        let [roll, pitch] = self.axes.map(|axis| axis.trim);
        Attitude { roll, pitch }
    }

    /// The part of the trim's standard deviation that it brings to the attitude, and how far it has yet
    /// to go, rad; 0 before anything was learnt.
    pub fn sigma(&self) -> Attitude {
        let [roll, pitch] = self.axes.map(|axis| axis.sigma);
        Attitude { roll, pitch }
    }

    /// How far roll and pitch have departed of late from what was learnt, rad: they are off by that, or a reference is.
    pub fn departed(&self) -> Attitude {
        let [roll, pitch] = self.departures.map(|d| d.angle());
        Attitude { roll, pitch }
    }
}
