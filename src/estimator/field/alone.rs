//! What one sensor tells alone, without a gyro, where the one on the other side is not heard.
//!
//! A film on it, or what it does by itself, looks to all others like another bank beneath another contrast, as what looks up and
//! down sees what it saw before. Whether the contrast has changed or the bank is what it was nobody tells: how far that is apart
//! is in doubt.

use super::FieldEstimator;
use super::state::{CONTRAST, MAX_SENSORS};
use super::witness::level_pairs;
use crate::attitude::Attitude;
use crate::time::Time;

/// The contrast is remembered over this time, s,
const OVER_S: f64 = 5.0;
/// while all are heard, or the body is as level as that: then it is what looks up and down that tells of it. A cosine (15°).
const LEVEL: f64 = 0.966;
/// From one of these changes of the contrast to the other, logarithms, the one that tells alone is suspect: it may as well be a
/// bank to the other side.
const CHANGED: (f64, f64) = (0.05, 0.15);
/// If it would have to lean farther than this for the contrast to be what it was, it is the contrast that has changed: in a cloud.
/// A cosine (60°).
const CLOUD: f64 = 0.5;

/// What is known of sensors that tell alone.
#[derive(Clone, Copy, Debug, Default)]
pub struct Alone {
    /// The contrast while it could be told from a bank, K.
    before_k: Option<f64>,
    /// Who is heard while who looks the other way is not.
    sensors: [bool; MAX_SENSORS],
}

impl FieldEstimator {
    /// Finds who tells alone among what has been heard of late, at `now`, `dt_s` after the last frame.
    pub(super) fn find_alone(&mut self, readings: &[Option<f64>; MAX_SENSORS], now: Time, dt_s: f64) {
        let heard = self.lately(readings, now).map(|reading| reading.is_some());
        let mut sensors = [false; MAX_SENSORS];
        for (i, j) in level_pairs(&self.model) {
            (sensors[i], sensors[j]) = (heard[i] && !heard[j], heard[j] && !heard[i]);
        }
        let all = heard[..self.model.sensors()].iter().all(|h| *h);
        let (cos, contrast_k) = (self.state.vertical()[2].abs(), self.state.x[CONTRAST].abs());
        let before_k = self.alone.before_k.get_or_insert(contrast_k);
        if cos * contrast_k < CLOUD * *before_k {
            *before_k = contrast_k;
        } else if all || cos > LEVEL {
            *before_k += -(-dt_s / OVER_S).exp_m1() * (contrast_k - *before_k);
        }
        self.alone.sensors = sensors;
    }

    /// How far roll and pitch may be off by who tells alone, rad: as far as it is to where the body would lean if the contrast had
    /// not changed.
    pub(super) fn by_one_alone(&self) -> Attitude {
        let Alone { before_k: Some(before_k), sensors } = self.alone else { return Attitude::default() };
        if self.gyro.in_use() {
            return Attitude::default();
        }
        let cos = self.state.vertical()[2].abs().min(1.0);
        let changed = self.state.x[CONTRAST].abs() / before_k.max(1.0);
        let (lean, other) = (cos.acos(), (cos * changed).min(1.0).acos());
        let suspect = ((changed.ln().abs() - CHANGED.0) / (CHANGED.1 - CHANGED.0)).clamp(0.0, 1.0);
        let doubt = (lean - other).abs().max(suspect * (lean + other));
        let along = |axis: usize| {
            let shares = (0..self.model.sensors()).filter(|i| sensors[*i]).map(|i| self.model.direction(i)[axis].abs());
            doubt * shares.fold(0.0, f64::max)
        };
        Attitude { roll: along(1), pitch: along(0) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimator::Estimator;
    use crate::estimator::field::Tuning;
    use crate::frame::{Aiding, Frame, Missing, Sample, Value};
    use crate::simulation::scenario::Scenario;
    use crate::source::FrameSource;

    /// Flies for 40 s without instruments, after 10 s without sensor `lost`, from 14 s on with a film growing on `wet` for 3 s. How
    /// many frames are more than 10° and three standard deviations off, and how many beyond 20° of standard deviation.
    fn flown(name: &str, seed: u64, lost: usize, wet: Option<usize>) -> (u32, u32) {
        let scenario = Scenario::named(name).unwrap().lasting(40.0);
        let (mut source, head) = (scenario.source(seed), scenario.head());
        let mut e = FieldEstimator::new(&head, scenario.field(), Tuning::default());
        let mut frame = Frame::new(head.sensors.len());
        let (mut wrong, mut unsure) = (0, 0);
        for i in 0..2000 {
            let s = f64::from(i) * 0.02;
            let now = Time::from_secs_f64(100.0 + s);
            source.scan(now, &mut frame);
            frame.aiding = Aiding::default();
            let share = 0.92 * ((s - 14.0) / 3.0).clamp(0.0, 1.0);
            if let Some(Ok(Sample { value: Value::Absolute { object_c, ambient_c }, .. })) =
                wet.map(|wet| &mut frame.readings[wet])
            {
                *object_c += share * (ambient_c.unwrap() - *object_c);
            }
            if s > 10.0 {
                frame.readings[lost] = Err(Missing::NoAnswer);
            }
            let solution = e.update(&frame);
            let Some(a) = solution.attitude else { continue };
            let truth = source.truth_at(now);
            let far = |a: f64, b: f64, sigma: f64| (a - b).abs() > 10_f64.to_radians().max(3.0 * sigma);
            let sigma = solution.sigma;
            wrong += u32::from(far(a.roll, truth.roll, sigma.roll) || far(a.pitch, truth.pitch, sigma.pitch));
            unsure += u32::from(sigma.roll.max(sigma.pitch) > 20_f64.to_radians());
        }
        (wrong, unsure)
    }

    #[test]
    fn a_film_on_who_is_left_of_a_pair_is_in_the_standard_deviation() {
        for name in ["clear-dry", "clear-humid", "overcast"] {
            for (lost, wet) in [(0, 1), (2, 3), (3, 2)] {
                let (wrong, unsure) = flown(name, 1, lost, Some(wet));
                assert!(wrong < 75 && unsure > 600, "{name}, {wet} alone: {wrong} wrong, {unsure} unsure");
                assert_eq!(flown(name, 1, lost, None), (0, 0), "{name}, {lost} lost");
            }
        }
    }
}
