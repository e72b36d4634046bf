//! A film on all sensors, by their own temperatures: what they differ by collapses, and so does their distance from
//! those.

use crate::fault::debounce::Debounce;
use crate::fault::{ActiveFault, Evidence, FaultKind};
use crate::time::Time;

/// How long what was before is remembered, s, how fast what is now is seen, and for how long it must last.
const BEFORE_S: f64 = 20.0;
const NOW_S: f64 = 0.3;
const LASTS_S: (f64, f64) = (1.0, 1.0);
/// What may be left of what they differ by and of the distance from their own temperatures; what must have been
/// there, K.
const LEFT: f64 = 0.15;
const THERE_K: f64 = 5.0;
/// Below this share of a low contrast it is fog.
const FOG: f64 = 0.5;

/// All of them.
#[derive(Clone, Debug)]
pub struct Everywhere {
    /// From the coldest to the warmest of them, and the sum of the distances from their own temperatures: before, now. K.
    before: Option<[f64; 2]>,
    now: [f64; 2],
    wet: Debounce,
}

impl Default for Everywhere {
    fn default() -> Self {
        Self { before: None, now: [0.0; 2], wet: Debounce::new(LASTS_S.0, LASTS_S.1) }
    }
}

impl Everywhere {
    /// Takes in how far they are apart and from their own temperatures, K; `low_k` is the contrast below which it is low.
    pub fn see(&mut self, seen: Option<[f64; 2]>, low_k: f64, dt_s: f64, time: Time) {
        let Some(seen) = seen else {
            self.wet.update(false, time);
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
        let left = if self.wet.is_active() { 2.0 * LEFT } else { LEFT };
        let gone = |i: usize| self.now[i] < left * before[i];
        // Where next to nothing is left it may as well be fog.
        let film = self.now[0] > FOG * low_k && before[0] > THERE_K;
        self.wet.update(film && gone(0) && gone(1), time);
    }

    /// Whether all of them are wet.
    pub fn is_active(&self) -> bool {
        self.wet.is_active()
    }

    /// Adds it to `faults`, as `kind`.
    pub fn report(&self, kind: FaultKind, faults: &mut Vec<ActiveFault>) {
        let before = self.before.map_or(1.0, |b| b[1]);
        let value = 100.0 * (1.0 - self.now[1] / before.max(1e-3)).clamp(0.0, 1.0);
        self.wet.report(kind, Evidence::Limit { value, limit: 100.0 * (1.0 - LEFT), unit: "%" }, faults);
    }
}
