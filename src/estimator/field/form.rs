//! Sensors that see in another form than they are said to: alike all over a cone, or with long tails.
//!
//! A datasheet tells how wide a field of view is; its form depends on lens, window and hood. What it does to a reading goes
//! with the elevation alone, whatever the sensor: half a kelvin where the contrast is 40 K, and more than any scene. But a
//! filter that expects it finds a warm side later, and most heads are much as they are said to be. So nothing is expected,
//! until it explains what is seen all the way round and no sky does: then the filter begins anew.

use super::directions::{Directions, Pattern, SHAPE, dot};
use super::model::Scene;
use super::predict::scene;
use super::start::Start;
use super::state::{DEPTH, LAG, MAX_SENSORS, RADIANCE, RATE, State, TURN, VIEW};
use super::tuning::Tuning;
use super::{FieldEstimator, askew};
use crate::estimator::linear::solve;
use crate::sky::family::{FORMS, View};
use crate::time::Time;
use std::f64::consts::TAU;
use std::ops::Range;

/// The states.
const STATES: Range<usize> = VIEW + 1..VIEW + 1 + FORMS;
/// How much of these is expected before any is found: none.
const NONE: f64 = 1e-4;
/// What the sky's shape is told by, in the order of [`Directions::shape`].
pub const SHAPES: [usize; SHAPE] = [DEPTH, RADIANCE, VIEW, VIEW + 1, VIEW + 2];

/// What was seen is forgotten over this time, s; so often it is asked what it tells.
const WINDOW_S: f64 = 40.0;
const STEP_S: f64 = 0.5;
/// As much must be explained that was not, K rms, beyond so many times the square of one frame's noise, which chance may
/// explain; and no more be left than such a share of it.
const EXPLAINED_K: f64 = 0.01;
const CHANCE: f64 = 20.0;
const LEFT: f64 = 0.5;
/// After as much of a turn a warm side has been on all sides, and on some of them twice, rad.
const ROUND: f64 = 1.5 * TAU;
/// How well a second tells of the shape, K²/s.
const TOLD_K2_S: f64 = 4e-4;

/// What no attitude, ground or contrast explains, against what the sky's shape and the field of view would.
#[derive(Clone, Copy, Debug, Default)]
pub struct Form {
    /// It has been found to be another.
    found: bool,
    /// Least squares: what each of [`SHAPES`] would show with each other, with what is seen, and that with itself, K²·s.
    products: [[f64; SHAPE]; SHAPE],
    along: [f64; SHAPE],
    square: f64,
    /// Half of the squares of what jumps from frame to frame: noise is left whatever the shape.
    noise: f64,
    /// For how long, by dimensions, s.
    seen_s: f64,
    last: Option<Pattern>,
    turned: f64,
    since_s: f64,
}

impl Form {
    /// Takes in a pattern that the shape of `state` leaves, K, which lasts `dt_s`.
    pub fn update(&mut self, pattern: &Pattern, directions: &Directions, state: &State, dt_s: f64) {
        let (rest, dimensions) = directions.unexplained(pattern);
        if self.found || dimensions < 2 {
            self.last = None;
            return;
        }
        let shape = directions.shape();
        let mut seen = rest;
        for (pattern, i) in shape.iter().zip(SHAPES) {
            seen.iter_mut().zip(pattern).for_each(|(s, p)| *s += state.x[i] * p);
        }
        let jump: Pattern = self.last.map_or_else(Pattern::default, |last| std::array::from_fn(|i| rest[i] - last[i]));
        self.last = Some(rest);
        let keep = (-dt_s / WINDOW_S).exp();
        let add = |sum: &mut f64, square: f64| *sum = keep * *sum + dt_s * square;
        for (i, pattern) in shape.iter().enumerate() {
            for (product, other) in self.products[i].iter_mut().zip(shape) {
                add(product, dot(pattern, other));
            }
            add(&mut self.along[i], dot(pattern, &seen));
        }
        add(&mut self.square, dot(&seen, &seen));
        add(&mut self.noise, dot(&jump, &jump) / 2.0);
        add(&mut self.seen_s, dimensions as f64);
        self.since_s += dt_s;
    }

    /// What the likeliest shape leaves, K²·s, where `form` (one standard deviation) is expected.
    fn left(&self, t: &Tuning, form: f64) -> Option<f64> {
        let expected = [(t.depth.0, t.depth.1), t.radiance, (0.0, t.spread), (0.0, form), (0.0, form)];
        let (mut matrix, mut right) = (self.products, self.along);
        for (k, (mean, sigma)) in expected.into_iter().enumerate() {
            let weight = TOLD_K2_S / (sigma * sigma);
            matrix[k][k] += weight;
            right[k] += weight * mean;
        }
        let x = solve(matrix, right)?;
        let shown: f64 = x.iter().zip(&self.products).map(|(x_i, row)| x_i * dot(row, &x)).sum();
        Some(self.square - 2.0 * dot(&x, &self.along) + shown)
    }

    /// Whether another form explains it.
    fn shows(&self, t: &Tuning, dt_s: f64) -> bool {
        let (Some(without), Some(with)) = (self.left(t, NONE), self.left(t, t.form)) else { return false };
        let (explained, left) = (without - with, with - self.noise);
        let enough = EXPLAINED_K * EXPLAINED_K * self.seen_s + CHANCE * self.noise / self.seen_s * dt_s;
        self.turned > ROUND && explained > enough && left < LEFT * explained
    }

    /// Whether that is so for the first time, now that it has turned about the vertical at `rate`, rad/s, for `dt_s`.
    fn is_found(&mut self, t: &Tuning, rate: f64, dt_s: f64) -> bool {
        self.turned += dt_s * rate.abs();
        if self.found || self.since_s < STEP_S {
            return false;
        }
        self.since_s = 0.0;
        self.found = self.shows(t, dt_s);
        self.found
    }
}

impl FieldEstimator {
    /// Begins anew, with sensors of any form, once it shows that theirs is another. The attitude stays, and what is known of
    /// it and of the gyro; without one nothing tells a form from an attitude.
    pub(super) fn doubt_form(&mut self, readings: &[Option<f64>; MAX_SENSORS], now: Time, dt_s: f64) {
        let Some(rates) = self.turning() else { return };
        if !self.form.is_found(&self.tuning, dot(&rates, &self.state.vertical()), dt_s) {
            return;
        }
        let ((ln_depth, ..), (radiance, _)) = (self.tuning.depth, self.tuning.radiance);
        let scene = Scene { ln_depth, radiance, view: View::default(), ..scene(&self.state) };
        let start = Start { axes: self.state.axes, scene, misfit_k2: 0.0 };
        let (before, turned, around) = (self.state.clone(), self.turned, self.around);
        self.scene.forget();
        self.begin_with(&start, &self.lately(readings, now), now);
        for i in (TURN..TURN + 3).chain(RATE..RATE + 3).chain([LAG]).chain(askew::STATES) {
            self.state.x[i] = before.x[i];
            self.state.set_variance(i, before.p[i][i]);
        }
        (self.state.askew2, self.turned, self.around) = (before.askew2, turned, around);
    }

    /// How much of another form is expected from a beginning on; what was seen before it tells no more.
    pub(super) fn set_form(&mut self) {
        let expected = if self.form.found { self.tuning.form } else { NONE };
        self.form = Form { found: self.form.found, ..Form::default() };
        STATES.for_each(|i| self.state.set_variance(i, expected * expected));
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::after;
    use super::*;
    use crate::frame::Aiding;
    use crate::simulation::Scenario;
    use crate::sky::FieldOfView;

    /// After two minutes and a half with sensors that see so; whether an autopilot is heard.
    fn flown(name: &str, seeing: FieldOfView, aided: bool) -> FieldEstimator {
        after(&Scenario::named(name).unwrap().seeing(seeing), 15, 7500, |frame| {
            if !aided {
                frame.aiding = Aiding::default();
            }
        })
    }

    const SAID: FieldOfView = FieldOfView::Gaussian { fwhm_deg: 90.0 };

    #[test]
    fn another_form_is_found_and_learnt() {
        for (seeing, form) in
            [(FieldOfView::Even { half_deg: 50.0 }, [1.0, 0.0]), (FieldOfView::Tailed { fwhm_deg: 90.0 }, [0.0, 1.0])]
        {
            let e = flown("clear-dry", seeing, true);
            assert!(e.form.found);
            for (i, truth) in STATES.zip(form) {
                assert!((e.state.x[i] - truth).abs() < 0.2, "{seeing:?}: {:?}", &e.state.x[STATES]);
            }
        }
    }

    #[test]
    fn neither_a_scene_nor_a_warm_side_is_one() {
        for name in ["clear-dry", "clear-humid", "overcast", "scattered", "warm-sky", "warm-slope", "into-cloud"] {
            let e = flown(name, SAID, true);
            assert!(!e.form.found && e.state.x[STATES].iter().all(|x| x.abs() < 1e-3), "{name}");
        }
    }

    #[test]
    fn without_a_gyro_none_is_looked_for() {
        assert!(!flown("clear-dry", FieldOfView::Even { half_deg: 50.0 }, false).form.found);
    }
}
