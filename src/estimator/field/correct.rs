//! What the readings say, and how well they fit.

use super::FieldEstimator;
use super::directions::{Directions, Pattern, dot};
use super::form::SHAPES;
use super::predict::scene;
use super::state::{CONTRAST, DEPTH, LAG, LAGGED, MAX_SENSORS, RADIANCE, SEEN, VIEW};
use crate::sky::family::{FORMS, LN_DEPTH};

/// A reading farther from its prediction than this many standard deviations weighs less.
const GATE: f64 = 6.0;
/// One reading, and no more, this far from its prediction is left out, for so long, s: what lasts is no glitch.
const OUTLIER: f64 = 20.0;
const GLITCH_S: f64 = 0.3;
/// The spread of the field of view may be so much: it stands for a sky of another shape, too, but not for a wall.
const WIDEST: f64 = 2.0;
/// And so much of another form.
const FORMED: (f64, f64) = (-1.2, 1.3);
/// Nothing is averaged in radiance, or everything.
const AVERAGED: (f64, f64) = (0.0, 1.0);
/// Over this time the misfit is averaged, s.
const MISFIT_S: f64 = 0.5;
/// So many times the expected misfit and the filter is lost; with a gyro, that is what is wrong.
const LOST: f64 = 400.0;
const GYRO_WRONG: f64 = 3.3;
/// One reading's misfit counts no more than so much against it.
const WILDEST: f64 = 50.0;
/// Over this time the attitude is compared with what the thermopiles alone say, s.
const APART_S: f64 = 0.7;
/// An attitude farther from them is wrong: rad (8°), or K where the contrast is low.
const APART: (f64, f64) = (0.14, 4.0);
/// Sensors that show less of a turn, as a share of the contrast for each rad, do not tell it: one that looks level shows
/// half of it, and what looks up or down next to nothing while level.
const TELLING: f64 = 0.3;
/// So many times as far where leans are left out: as much as they may hide.
const WARM: f64 = 1.5;

/// How well the readings fit.
#[derive(Clone, Copy, Debug)]
pub struct Misfit {
    /// The innovations' squares over their variances, averaged: 1 where all is as it should be.
    squared: f64,
    /// The same without the worst of each frame: what one sensor does says nothing against the gyro.
    others: f64,
    /// The same of what looks like a turn and like no other contrast or ground: weather says nothing against it either.
    turning: f64,
    /// How far the thermopiles alone put the attitude from the filter's, averaged, rad.
    apart: [f64; 2],
    /// The same of a sky that is alike all around.
    apart_from_even: [f64; 2],
}

impl Default for Misfit {
    fn default() -> Self {
        Self { squared: 1.0, others: 1.0, turning: 1.0, apart: [0.0; 2], apart_from_even: [0.0; 2] }
    }
}

impl Misfit {
    /// What the standard deviations are to be multiplied with: 1 unless the readings fit badly.
    pub fn excess(self) -> f64 {
        (self.squared / 2.0).max(1.0).sqrt()
    }

    /// Whether to begin anew, at this contrast: no scene can be so far off, nor a horizon that is known to lean by `leans`, rad,
    /// from an even one. With a gyro, which is in doubt then, what scenes may hide, rad, is none of its.
    pub fn is_lost(self, contrast_k: f64, leans: f64, hidden: Option<f64>) -> bool {
        let limit = APART.0.max(APART.1 / contrast_k.abs().max(1.0)) + hidden.unwrap_or(0.0);
        let (misfit, most) = hidden.map_or((self.others, LOST), |_| (self.others.min(self.turning), GYRO_WRONG));
        misfit > most
            || self.apart[0].hypot(self.apart[1]) > limit
            || self.apart_from_even[0].hypot(self.apart_from_even[1]) > WARM * limit + leans
    }
}

impl FieldEstimator {
    /// Leaves out the one reading that cannot be, if the others can.
    pub(super) fn leave_out(&mut self, readings: &mut [Option<f64>; MAX_SENSORS], dt_s: f64) {
        let far = |i: usize, reading: f64| {
            let expected = self.state.p[SEEN + i][SEEN + i] + self.tuning.noise_k * self.tuning.noise_k;
            (reading - self.state.x[SEEN + i]).powi(2) > OUTLIER * OUTLIER * expected
        };
        let mut outliers = (0..self.model.sensors()).filter(|i| readings[*i].is_some_and(|r| far(*i, r)));
        if let (Some(one), None) = (outliers.next(), outliers.next()) {
            self.glitch_s += dt_s;
            if self.glitch_s < GLITCH_S {
                readings[one] = None;
            }
        } else {
            self.glitch_s = 0.0;
        }
    }

    /// Takes in the readings, one after the other.
    pub(super) fn correct(&mut self, readings: &[Option<f64>; MAX_SENSORS], dt_s: f64) {
        let noise = self.noise.variance();
        let (mut misfit, mut others, mut worst, mut count) = (0.0, 0.0, 0.0_f64, 0.0);
        let wildest = if self.gyro.in_use() { WILDEST } else { f64::INFINITY };
        for (i, reading) in readings.iter().enumerate().take(self.model.sensors()) {
            let Some(reading) = reading else { continue };
            let innovation = reading - self.state.x[SEEN + i];
            let predicted = self.state.p[SEEN + i][SEEN + i];
            let squared = innovation * innovation;
            let relative = squared / (predicted + noise);
            misfit += relative;
            // What a few wild readings in one frame say against the gyro.
            let relative = relative.min(wildest);
            others += relative;
            worst = worst.max(relative);
            count += 1.0;
            let variance = noise.max(squared / (GATE * GATE) - predicted);
            self.state.read(SEEN + i, innovation, variance);
        }
        self.state.bound(DEPTH, LN_DEPTH);
        self.state.bound(LAG, LAGGED);
        self.state.bound(RADIANCE, AVERAGED);
        self.state.bound(VIEW, (-WIDEST, WIDEST));
        (VIEW + 1..VIEW + 1 + FORMS).for_each(|i| self.state.bound(i, FORMED));
        self.state.settle();
        if count > 1.0 {
            let share = -(-dt_s / MISFIT_S).exp_m1();
            self.misfit.squared += share * (misfit / count - self.misfit.squared);
            self.misfit.others += share * ((others - worst) / (count - 1.0) - self.misfit.others);
        }
    }

    /// Learns from the innovations before they are taken in: what looks like a turn apart from what
    /// looks like another contrast, and that apart from the rest.
    pub(super) fn learn(&mut self, readings: &[Option<f64>; MAX_SENSORS], dt_s: f64) {
        let sky = scene(&self.state);
        let mut innovations = Pattern::default();
        let mut scenes = Pattern::default();
        let mut seen = [None; MAX_SENSORS];
        for (i, reading) in readings.iter().enumerate().take(self.model.sensors()) {
            let Some(reading) = reading else { continue };
            let s = self.model.seen(i, &self.state.axes, &sky);
            innovations[i] = reading - self.state.x[SEEN + i];
            scenes[i] = s.scene * self.state.x[self.state.scene(i)];
            seen[i] = Some(s);
        }
        let shape = SHAPES.map(|i| SHAPES.map(|j| self.state.p[i][j]));
        let directions = Directions::new(&seen, shape);
        let alone = readings.iter().zip(&self.state.plain).map(|(r, p)| r.map_or(0.0, |r| r - p));
        let mut pattern = Pattern::default();
        pattern.iter_mut().zip(alone).for_each(|(p, a)| *p = a);
        if self.gyro.in_use() {
            self.form.update(&pattern, &directions, &self.state, dt_s);
        }
        // A lean that is believed in must not hide an attitude that is off.
        let mut even = pattern;
        for (even, seen) in even.iter_mut().zip(&seen) {
            *even += seen.as_ref().map_or(0.0, |s| s.by_lean.iter().zip(sky.lean).map(|(b, l)| b * l).sum::<f64>());
        }
        let share = -(-dt_s / APART_S).exp_m1();
        let least = (TELLING * self.state.x[CONTRAST].abs()).max(1.0);
        let misfit = &mut self.misfit;
        for (apart, pattern) in [(&mut misfit.apart, &pattern), (&mut misfit.apart_from_even, &even)] {
            for (apart, now) in apart.iter_mut().zip(directions.turned(pattern, least)) {
                *apart += share * (now - *apart);
            }
        }
        if !self.gyro.in_use() {
            self.expect_manoeuvre(&innovations, &directions, dt_s);
        }
        let turning = if self.gyro.in_use() { &mut self.gyro_errors } else { &mut self.rates };
        for (turning, direction) in turning.iter_mut().zip(&directions.turn) {
            turning.update(dot(&innovations, direction), dt_s);
        }
        self.contrast.update(directions.weathered(&innovations), dt_s);
        let state = &self.state;
        let turning = directions.weatherless(&innovations, |p| {
            let shown: [(usize, f64); MAX_SENSORS] = std::array::from_fn(|i| (SEEN + i, p[i]));
            state.variance_of(&shown) + self.noise.variance()
        });
        self.misfit.turning -= (-dt_s / MISFIT_S).exp_m1() * (turning - self.misfit.turning);
        let variance_of = |p: &Pattern| {
            let scenes =
                || seen.iter().enumerate().filter_map(|(i, s)| Some((state.scene(i), s.as_ref()?.scene * p[i])));
            scenes().map(|(i, a)| a * scenes().map(|(j, b)| b * state.p[i][j]).sum::<f64>()).sum()
        };
        self.noise.update(self.telling(readings, &innovations, &directions), directions.count(), dt_s);
        self.change.update(&innovations, &directions, (self.noise.variance(), dt_s));
        let told = (self.noise.variance(), dt_s, self.around.turn());
        self.scene.update((&innovations, &scenes), &directions, variance_of, told);
        self.find_beneath(&seen, dt_s);
    }

    /// What of the innovations tells of noise, K; in how many dimensions; and how much of its square the filter expects by
    /// itself, K².
    fn telling(
        &self,
        readings: &[Option<f64>; MAX_SENSORS],
        innovations: &Pattern,
        directions: &Directions,
    ) -> Option<(Pattern, usize, f64)> {
        let (rest, dimensions) = directions.unexplained(innovations);
        if dimensions > 0 {
            return Some((rest, dimensions, 0.0));
        }
        // With sensors too few for that, all that they show: how they turn is told by a gyro, or by nothing.
        let heard = (0..self.model.sensors()).filter(|i| readings[*i].is_some());
        let expected = heard.map(|i| self.state.p[SEEN + i][SEEN + i]).sum();
        self.gyro.in_use().then_some((*innovations, directions.count(), expected))
    }

    /// What sensor `i` shows beyond what the sky and the attitude explain, K.
    pub fn residual_k(&self, i: usize) -> Option<f64> {
        (i < self.model.sensors()).then(|| self.state.x[self.state.scene(i)] + self.state.off[i] + self.scene.left_k(i))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_even_sky_s_attitude_is_no_loss_beside_a_lean_that_is_known() {
        let apart = |apart_from_even: f64| Misfit { apart_from_even: [apart_from_even, 0.0], ..Misfit::default() };
        let far = WARM * APART.0 + 0.1;
        assert!(apart(far).is_lost(100.0, 0.0, Some(0.0)));
        assert!(!apart(far).is_lost(100.0, 0.2, Some(0.0)));
        assert!(apart(far + 0.2).is_lost(100.0, 0.2, Some(0.0)));
    }
}
