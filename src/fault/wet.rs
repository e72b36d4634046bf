//! A film of water or dirt dominates what a sensor sees (report section V.3).
//!
//! - `film`: on one sensor; `everywhere`: on all of them.

mod everywhere;
mod film;

use super::{ActiveFault, FaultKind};
use crate::estimator::Solution;
use crate::frame::{Frame, Value};
use crate::head::{Head, SensorKind};
use everywhere::Everywhere;
use film::Film;

/// Sees `wet-sensor`. For one sensor the method must know what it should show by the others; for all of them, their
/// own temperatures must be read.
#[derive(Clone, Debug)]
pub struct WetSensors {
    limit: f64,
    films: Vec<(SensorKind, Film)>,
    absolute: bool,
    last_s: Option<f64>,
    everywhere: Everywhere,
}

impl WetSensors {
    /// With the share of a film from which a sensor is wet, 0..1.
    pub fn new(head: &Head, limit: f64) -> Self {
        Self {
            limit,
            films: head.sensors.iter().map(|s| (s.kind, Film::default())).collect(),
            absolute: head.sensors.iter().all(crate::head::Sensor::is_absolute),
            last_s: None,
            everywhere: Everywhere::new(head.sensors.len()),
        }
    }

    /// Another share of a film, 0..1.
    pub fn retune(&mut self, limit: f64) {
        self.limit = limit;
    }

    /// Takes in a frame and what the method makes of it; `low_k` is the contrast below which it is low; whether the
    /// scene has been found to be `obstructed`.
    pub fn update(&mut self, frame: &Frame, solution: &Solution, low_k: f64, obstructed: bool) {
        let now_s = frame.time.as_secs_f64();
        let dt_s = self.last_s.replace(now_s).map_or(0.0, |last| (now_s - last).clamp(0.0, 1.0));
        let mut range_c = (f64::INFINITY, f64::NEG_INFINITY);
        for (i, (kind, film)) in self.films.iter_mut().enumerate() {
            let value = frame.readings.get(i).and_then(|r| r.ok()).map(|s| s.value);
            let shown = value.and_then(|value| match value {
                Value::Absolute { ambient_c, .. } => Some((kind.kelvin(value)?, ambient_c)),
                Value::Volts(_) => None,
            });
            self.everywhere.see(i, shown.and_then(|(object_c, own_c)| Some((object_c - own_c?).abs())), dt_s);
            let Some((object_c, ambient_c)) = shown else { continue };
            range_c = (range_c.0.min(object_c), range_c.1.max(object_c));
            let hearing = solution.sensors.get(i).copied().unwrap_or_default();
            film.see((object_c, ambient_c), &hearing, obstructed, dt_s);
            film.judge(self.limit, obstructed, frame.time);
        }
        if self.absolute && range_c.1 >= range_c.0 {
            self.everywhere.judge(range_c.1 - range_c.0, low_k, dt_s, frame.time);
        }
    }

    /// Whether all of them are: nothing can be said any more.
    pub fn all(&self) -> bool {
        self.everywhere.is_active()
    }

    /// Adds what is there to `faults`.
    pub fn report(&self, faults: &mut Vec<ActiveFault>) {
        for (i, (_, film)) in self.films.iter().enumerate() {
            let kind = FaultKind::WetSensor(i);
            if self.all() {
                self.everywhere.report(kind, faults);
            } else {
                film.report(kind, self.limit, faults);
            }
        }
    }
}

#[cfg(test)]
mod tests;
