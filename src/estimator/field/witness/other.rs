//! What there is to blame beside a sensor.

use super::filter::{Step, UNHEARD, Witness};
use super::{BOUNDS, MAX_SENSORS, Model, Tuning};
use crate::estimator::vector::dot;

/// Walks of ground and contrast, as a share of the contrast, of a sky and a ground that change quickly.
const QUICK: f64 = 0.7;
/// Body rates of aerobatics, rad/s rms.
const AEROBATIC: f64 = 1.5;
/// Not to hear a gyro costs as much as not to hear so many sensors; and one that has been seen to turn rightly.
const GYRO_UNHEARD: (f64, f64) = (0.5, 2.0);
/// The cosine between two sensors that look apart.
const OPPOSED: f64 = -0.95;

/// What is to blame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Blames {
    /// The gyro: it is not heard.
    Gyro,
    /// A sky and a ground that change quickly: fog, a cloud, hail.
    Weather,
    /// The pilot, where there is no gyro: the body turns as it has not turned before.
    Pilot,
    /// Two sides at once: a valley. Two opposed sensors are not heard.
    Scene(usize, usize),
}

/// A witness by whom no sensor is to blame, and how much less that surprises.
#[derive(Clone, Debug)]
pub struct Other {
    blames: Blames,
    witness: Witness,
    /// The sum of its surprises less those of the witness that hears all.
    pub surprise: f64,
}

impl Other {
    /// All that there are, beginning with what `witness` knows.
    pub fn all(model: &Model, witness: &Witness, gyro: bool) -> impl Iterator<Item = Self> {
        let turning = if gyro { Blames::Gyro } else { Blames::Pilot };
        let plain = [turning, Blames::Weather].map(|blames| (blames, witness.clone()));
        let scenes = opposed(model).map(|(i, j)| (Blames::Scene(i, j), witness.deaf_to(i).deaf_to(j)));
        plain.into_iter().chain(scenes).map(|(blames, witness)| Self { blames, witness, surprise: BOUNDS.0 })
    }

    /// Takes in a step, of which the witness that hears all makes `likelihood`.
    pub fn hear(
        &mut self,
        model: &Model,
        step: &Step,
        readings: &[Option<f64>; MAX_SENSORS],
        t: &Tuning,
        likelihood: f64,
    ) {
        let contrast = step.sky.contrast_k.abs().max(1.0);
        let step = match self.blames {
            Blames::Gyro => Step { gyro: None, rate: (t.rate_sigma, t.rate_time_s), ..*step },
            Blames::Weather => Step { walk_k: [QUICK * contrast; 2], ..*step },
            Blames::Pilot => Step { rate: ([AEROBATIC; 3], t.rate_time_s), ..*step },
            Blames::Scene(..) => *step,
        };
        let said = self.witness.hear(model, &step, readings).likelihood - likelihood;
        self.surprise += match self.blames {
            Blames::Gyro if step.proven => said - GYRO_UNHEARD.1 * UNHEARD,
            Blames::Gyro => said - GYRO_UNHEARD.0 * UNHEARD,
            // Where one of two sides is not seen it is the other that is to blame, by itself.
            Blames::Scene(i, j) if readings[i].is_none() || readings[j].is_none() => 0.0,
            _ => said,
        };
    }
}

/// The pairs of sensors that look apart.
pub fn opposed(model: &Model) -> impl Iterator<Item = (usize, usize)> {
    let n = model.sensors();
    let all = (0..n).flat_map(move |i| (i + 1..n).map(move |j| (i, j)));
    all.filter(|(i, j)| dot(model.direction(*i), model.direction(*j)) < OPPOSED)
}
