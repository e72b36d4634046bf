//! A film of water or dirt dominates what a sensor sees (report section V.3).

use super::debounce::Debounce;
use super::{ActiveFault, Evidence, FaultKind};
use crate::estimator::{Hearing, Solution, Standing};
use crate::frame::{Frame, Value};
use crate::head::Head;

/// Shares are averaged over this time, s; what a sensor follows of what it should show, over that one.
const SHARE_S: f64 = 0.5;
const FOLLOWS_S: f64 = 4.0;
/// What it should show must differ from its own temperature by so much for a share to be seen, K.
const APART_K: f64 = 3.0;
/// What it should show must change by so much, K rms, to see what it follows.
const CHANGES_K: f64 = 0.7;
/// Seconds for which it must be seen, and must be gone; for one that the others contradict without any film seen.
const LASTS_S: (f64, f64) = (0.5, 1.0);
const CONTRADICTED_S: f64 = 8.0;
/// So far from what the others say it is contradicted, K.
const CONTRADICTED_K: f64 = 1.0;
/// It is gone below this share of the limit.
const HYSTERESIS: f64 = 0.6;

/// All of them: how long what was before is remembered, s, how fast what is now is seen, and for how long it must
/// last.
const BEFORE_S: f64 = 20.0;
const NOW_S: f64 = 0.3;
const ALL_S: (f64, f64) = (1.0, 1.0);
/// What may be left of what they differ by and of the distance from their own temperatures; what must have been there, K.
const LEFT: f64 = 0.2;
const THERE_K: f64 = 5.0;
/// Below this share of a low contrast it is fog.
const FOG: f64 = 0.5;

/// One sensor.
#[derive(Clone, Copy, Debug)]
struct Film {
    /// The share of its own temperature in what it shows.
    share: Option<f64>,
    /// Weights, means, and the second moments of what it should show and shows.
    sums: [f64; 5],
    /// How long it has been left out, s.
    out_s: f64,
    residual_k: f64,
    wet: Debounce,
}

/// Sees `wet-sensor`. For one sensor the method must know what it should show by the others; for all of them, their
/// own temperatures must be read.
#[derive(Clone, Debug)]
pub struct WetSensors {
    limit: f64,
    films: Vec<Film>,
    absolute: bool,
    last_s: Option<f64>,
    /// From the coldest to the warmest of them, and the sum of the distances from their own temperatures: before, now. K.
    before: Option<[f64; 2]>,
    now: [f64; 2],
    all: Debounce,
}

impl WetSensors {
    /// With the share of a film from which a sensor is wet, 0..1.
    pub fn new(head: &Head, limit: f64) -> Self {
        let none =
            Film { share: None, sums: [0.0; 5], out_s: 0.0, residual_k: 0.0, wet: Debounce::new(LASTS_S.0, LASTS_S.1) };
        Self {
            limit,
            films: vec![none; head.sensors.len()],
            absolute: head.sensors.iter().all(crate::head::Sensor::is_absolute),
            last_s: None,
            before: None,
            now: [0.0; 2],
            all: Debounce::new(ALL_S.0, ALL_S.1),
        }
    }

    /// Takes in a frame and what the method makes of it; `low_k` is the contrast below which it is low.
    pub fn update(&mut self, frame: &Frame, solution: &Solution, low_k: f64) {
        let now_s = frame.time.as_secs_f64();
        let dt_s = self.last_s.replace(now_s).map_or(0.0, |last| (now_s - last).clamp(0.0, 1.0));
        let mut apart_k = Some(0.0);
        let mut range_c = (f64::INFINITY, f64::NEG_INFINITY);
        for (i, film) in self.films.iter_mut().enumerate() {
            let value = frame.readings.get(i).and_then(|r| r.ok()).map(|s| s.value);
            let Some(Value::Absolute { object_c, ambient_c }) = value else {
                apart_k = None;
                continue;
            };
            apart_k = apart_k.zip(ambient_c).map(|(sum, own)| sum + (object_c - own).abs());
            range_c = (range_c.0.min(object_c), range_c.1.max(object_c));
            let hearing = solution.sensors.get(i).copied().unwrap_or_default();
            film.see(object_c, ambient_c, &hearing, dt_s);
            film.judge(self.limit, frame);
        }
        if self.absolute {
            let seen_k = apart_k.map(|apart_k| [range_c.1 - range_c.0, apart_k]);
            self.see_all(seen_k.filter(|s| s.iter().all(|k| k.is_finite())), low_k, dt_s, frame);
        }
    }

    fn see_all(&mut self, seen: Option<[f64; 2]>, low_k: f64, dt_s: f64, frame: &Frame) {
        let Some(seen) = seen else {
            self.all.update(false, frame.time);
            return;
        };
        let Some(before) = &mut self.before else {
            (self.before, self.now) = (Some(seen), seen);
            return;
        };
        let collapsed = self.now[0] < 0.5 * before[0] && self.now[1] < 0.5 * before[1];
        let share = -(-dt_s / NOW_S).exp_m1();
        let slow = if collapsed { 0.0 } else { -(-dt_s / BEFORE_S).exp_m1() };
        for ((before, now), seen) in before.iter_mut().zip(&mut self.now).zip(seen) {
            *now += share * (seen - *now);
            *before += slow * (*now - *before);
        }
        let left = if self.all.is_active() { 2.0 * LEFT } else { LEFT };
        let gone = |i: usize| self.now[i] < left * before[i];
        // Where next to nothing is left it may as well be fog.
        let film = self.now[0] > FOG * low_k && before[0] > THERE_K;
        self.all.update(film && gone(0) && gone(1), frame.time);
    }

    /// Whether all of them are: nothing can be said any more.
    pub fn all(&self) -> bool {
        self.all.is_active()
    }

    /// Adds what is there to `faults`.
    pub fn report(&self, faults: &mut Vec<ActiveFault>) {
        for (i, film) in self.films.iter().enumerate() {
            if self.all() {
                let before = self.before.map_or(1.0, |b| b[1]);
                let value = 100.0 * (1.0 - self.now[1] / before.max(1e-3)).clamp(0.0, 1.0);
                let evidence = Evidence::Limit { value, limit: 100.0 * (1.0 - LEFT), unit: "%" };
                self.all.report(FaultKind::WetSensor(i), evidence, faults);
            } else {
                film.wet.report(FaultKind::WetSensor(i), film.evidence(self.limit), faults);
            }
        }
    }
}

impl Film {
    fn see(&mut self, shown_c: f64, own_c: Option<f64>, hearing: &Hearing, dt_s: f64) {
        let doubted = matches!(hearing.standing, Standing::LeftOut | Standing::Doubted);
        let Some(expected) = hearing.expected_k.filter(|e| doubted && e.is_finite()) else {
            (self.share, self.sums, self.out_s) = (None, [0.0; 5], 0.0);
            return;
        };
        self.residual_k = shown_c - expected;
        if self.residual_k.abs() < CONTRADICTED_K {
            self.out_s = (self.out_s - dt_s).max(0.0);
        } else if hearing.standing == Standing::LeftOut {
            self.out_s += dt_s;
        }
        if let Some(own) = own_c.filter(|own| (own - expected).abs() > APART_K) {
            let share = ((shown_c - expected) / (own - expected)).clamp(-1.0, 2.0);
            let before = self.share.unwrap_or(share);
            self.share = Some(before - (-dt_s / SHARE_S).exp_m1() * (share - before));
        }
        let keep = (-dt_s / FOLLOWS_S).exp();
        let sample = [1.0, expected, shown_c, expected * expected, expected * shown_c];
        self.sums.iter_mut().zip(sample).for_each(|(s, x)| *s = keep * *s + (1.0 - keep) * x);
    }

    /// How much it does not follow of what it should show, where that has changed.
    fn lost(&self) -> Option<f64> {
        let [w, e, z, ee, ez] = self.sums;
        if w < 0.2 {
            return None;
        }
        let [e, z, ee, ez] = [e / w, z / w, ee / w, ez / w];
        let changes = ee - e * e;
        (changes > CHANGES_K * CHANGES_K).then(|| 1.0 - (ez - e * z) / changes)
    }

    /// How much of a film there is by what is known: its own temperature, else what it does not follow.
    fn film(&self) -> Option<f64> {
        self.share.or(self.lost())
    }

    fn judge(&mut self, limit: f64, frame: &Frame) {
        let limit = if self.wet.is_active() { HYSTERESIS * limit } else { limit };
        let contradicted = self.out_s > CONTRADICTED_S;
        let wet = self.out_s > 0.0 && (self.film().is_some_and(|f| f > limit) || contradicted);
        self.wet.update(wet, frame.time);
    }

    fn evidence(&self, limit: f64) -> Evidence {
        match self.film() {
            Some(film) if film > HYSTERESIS * limit => {
                Evidence::Limit { value: 100.0 * film.clamp(0.0, 1.0), limit: 100.0 * limit, unit: "%" }
            }
            _ => Evidence::Limit { value: self.residual_k, limit: 0.0, unit: "K" },
        }
    }
}

#[cfg(test)]
mod tests;
