//! Which readings are heard: new ones, of sensors that nothing speaks against.

use super::correct::Misfit;
use super::moved::Moved;
use super::predict::{Pace, scene};
use super::state::MAX_SENSORS;
use super::stuck::Stuck;
use super::witness::Known;
use super::{FieldEstimator, GAP_S};
use crate::estimator::{Hearing, Standing};
use crate::frame::Frame;
use crate::time::Time;

/// Sensors whose readings are no farther apart make one frame, s.
const TURNS_S: f64 = 0.05;
/// So long a sensor is taken to be the cause of what does not fit, s.
const UNDECIDED_S: f64 = 5.0;
/// For so long after there was no contrast the sky is still changing, and no sensor is found to be at fault for it, s.
const CHANGING_S: f64 = 10.0;

impl FieldEstimator {
    /// The readings of `frame` that are newer than the last of their sensor, and the newest stamp.
    pub(super) fn readings(&mut self, frame: &Frame) -> ([Option<f64>; MAX_SENSORS], Option<Time>) {
        if let (Some((last, _)), Some(now)) = (self.last, frame.sample_time()) {
            if now.since(last) < -GAP_S {
                // A clock that has been set back begins anew.
                (self.last, self.stamps) = (None, [None; MAX_SENSORS]);
            } else if now < last {
                // What comes late says nothing of now.
                return ([None; MAX_SENSORS], None);
            }
        }
        let mut newest = None;
        let mut readings: [Option<f64>; MAX_SENSORS] = std::array::from_fn(|i| {
            let (value, time) = self.model.reading(i, frame)?;
            if self.stamps[i].is_some_and(|stamp| time <= stamp) {
                return None;
            }
            self.stamps[i] = Some(time);
            self.ambient_c[i] = frame.readings[i].ok().and_then(|s| s.value.ambient_c());
            newest = newest.max(Some(time));
            self.stuck[i].update(value, self.state.plain[i], time);
            Some(value)
        });
        self.is_stuck = Stuck::among(&self.stuck);
        let suspects = Stuck::suspects(&self.stuck);
        for (i, reading) in readings.iter_mut().enumerate() {
            let new = reading.is_some();
            *reading = reading.filter(|_| !self.is_stuck[i] && !suspects[i]);
            if new {
                self.latest[i] = *reading;
            }
        }
        (readings, newest)
    }

    /// The readings of this frame, and the last ones of sensors that take turns with these, but of none that is left out.
    pub(super) fn lately(&self, readings: &[Option<f64>; MAX_SENSORS], now: Time) -> [Option<f64>; MAX_SENSORS] {
        std::array::from_fn(|i| {
            let lately = self.stamps[i].is_some_and(|at| (0.0..TURNS_S).contains(&now.since(at)));
            readings[i].or(self.latest[i].filter(|_| lately)).filter(|_| self.is_believed(i))
        })
    }

    /// Whether sensor `i` is not left out.
    fn is_believed(&self, i: usize) -> bool {
        self.witnesses.standing(i) != Standing::LeftOut
    }

    /// Whether the witnesses are about to decide on a sensor; they are given a while.
    pub(super) fn undecided(&mut self, now: Time) -> bool {
        if self.witnesses.undecided() {
            now.since(*self.undecided_since.get_or_insert(now)) < UNDECIDED_S
        } else {
            self.undecided_since = None;
            false
        }
    }

    /// Leaves out what the witnesses do not believe, and begins anew where they have changed their mind.
    pub(super) fn consult(&mut self, readings: &mut [Option<f64>; MAX_SENSORS], pace: &Pace, (now, dt_s): (Time, f64)) {
        let s = &self.state;
        let known = Known {
            axes: s.axes,
            sky: scene(s),
            pace,
            gyro: self.turning(),
            proven: self.turns.proven(),
            usual_k: self.scene.usual_k(),
            even: self.scene.is_even(),
            noise_k: self.noise.variance().sqrt(),
            ambient_c: self.ambient_c,
            lag_s: s.lag_s(self.tuning.lag_s),
        };
        let changing = self.back_at.is_some_and(|at| (0.0..CHANGING_S).contains(&now.since(at)));
        if self.blind || changing {
            self.witnesses.restart();
        } else if self.model.is_absolute() {
            let before: [Standing; MAX_SENSORS] = std::array::from_fn(|i| self.witnesses.standing(i));
            self.witnesses.update(&self.model, &self.tuning, &known, readings, dt_s);
            let newly = |i: &usize| before[*i] != Standing::LeftOut && !self.is_believed(*i);
            if let Some(i) = (0..self.model.sensors()).find(newly) {
                // What it has said against the attitude is void.
                (self.misfit, self.lost_s) = (Misfit::default(), 0.0);
                if self.witnesses.blames_only(i) {
                    self.scene.blame(i);
                    self.moved = Moved::default();
                }
            }
        }
        for (i, reading) in readings.iter_mut().enumerate() {
            *reading = reading.filter(|_| self.witnesses.standing(i) == Standing::Heard);
        }
        if let Some(start) = self.witnesses.revised() {
            self.begin_with(&start, readings, now);
        }
    }

    pub(super) fn hearing(&self, i: usize) -> Hearing {
        let (expected_k, apart_k) = self.witnesses.of(i);
        let standing = if self.is_stuck[i] { Standing::Stuck } else { self.witnesses.standing(i) };
        let residual_k = if standing == Standing::Heard { self.residual_k(i) } else { apart_k };
        Hearing { standing, expected_k, residual_k, lost: self.witnesses.lost(i) }
    }
}
