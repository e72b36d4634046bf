//! A film on one sensor, by what the others say that it should show.

use crate::estimator::{Hearing, Standing};
use crate::fault::debounce::Debounce;
use crate::fault::{ActiveFault, Evidence, FaultKind};
use crate::time::Time;

/// Shares are averaged over this time, s.
const SHARE_S: f64 = 0.5;
/// What it should show must differ from its own temperature by so much for a share to be seen, K; for any film
/// where the scene is found to be obstructed, which leaves in doubt what it should show, by more.
const APART_K: (f64, f64) = (1.5, 3.0);
/// Seconds for which it must be seen, and must be gone; for one that the others contradict without any film seen.
const LASTS_S: (f64, f64) = (0.1, 1.0);
const CONTRADICTED_S: f64 = 8.0;
/// So far from what the others say it is contradicted, K.
const CONTRADICTED_K: f64 = 1.0;
/// It is gone below this share of the limit.
const HYSTERESIS: f64 = 0.6;

/// What is known of one sensor.
#[derive(Clone, Copy, Debug)]
pub struct Film {
    /// The share of its own temperature in what it shows.
    share: Option<f64>,
    /// How much it does not follow of what it should show.
    lost: Option<f64>,
    /// How long it has been left out, s.
    out_s: f64,
    residual_k: f64,
    wet: Debounce,
}

impl Default for Film {
    fn default() -> Self {
        Self { share: None, lost: None, out_s: 0.0, residual_k: 0.0, wet: Debounce::new(LASTS_S.0, LASTS_S.1) }
    }
}

impl Film {
    /// Takes in what it shows, its own temperature, what the method makes of it, and whether the scene is found to be
    /// `obstructed`.
    pub fn see(&mut self, (shown_c, own_c): (f64, Option<f64>), hearing: &Hearing, obstructed: bool, dt_s: f64) {
        let doubted = matches!(hearing.standing, Standing::LeftOut | Standing::Doubted);
        let Some(expected) = hearing.expected_k.filter(|e| doubted && e.is_finite()) else {
            (self.share, self.lost, self.out_s) = (None, None, 0.0);
            return;
        };
        self.residual_k = shown_c - expected;
        if self.residual_k.abs() < CONTRADICTED_K {
            self.out_s = (self.out_s - dt_s).max(0.0);
        } else if hearing.standing == Standing::LeftOut {
            self.out_s += dt_s;
        }
        let apart_k = own_c.map(|own| (own - expected).abs());
        if obstructed && apart_k.is_some_and(|k| k < APART_K.1) {
            (self.share, self.lost) = (None, None);
            return;
        }
        if let Some(own) = own_c.filter(|_| apart_k.is_some_and(|k| k > APART_K.0)) {
            let share = ((shown_c - expected) / (own - expected)).clamp(-1.0, 2.0);
            let before = self.share.unwrap_or(share);
            self.share = Some(before - (-dt_s / SHARE_S).exp_m1() * (share - before));
        }
        self.lost = hearing.lost;
    }

    /// How much of a film there is by what is known: its own temperature, else what it does not follow.
    fn film(&self) -> Option<f64> {
        self.share.or(self.lost)
    }

    /// Decides, with the share of a film from which it is wet, 0..1. What the others say counts for nothing where the
    /// scene is found to be `obstructed`: it may see a wall.
    pub fn judge(&mut self, limit: f64, obstructed: bool, now: Time) {
        let limit = if self.wet.is_active() { HYSTERESIS * limit } else { limit };
        let contradicted = self.out_s > CONTRADICTED_S && !obstructed;
        let wet = self.out_s > 0.0 && (self.film().is_some_and(|f| f > limit) || contradicted);
        self.wet.update(wet, now);
    }

    fn evidence(&self, limit: f64) -> Evidence {
        match self.film() {
            Some(film) if film > HYSTERESIS * limit => {
                Evidence::Limit { value: 100.0 * film.clamp(0.0, 1.0), limit: 100.0 * limit, unit: "%" }
            }
            _ => Evidence::Limit { value: self.residual_k, limit: 0.0, unit: "K" },
        }
    }

    /// Adds it to `faults` if it is wet.
    pub fn report(&self, kind: FaultKind, limit: f64, faults: &mut Vec<ActiveFault>) {
        self.wet.report(kind, self.evidence(limit), faults);
    }
}
