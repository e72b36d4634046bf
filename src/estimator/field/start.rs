//! Where the filter begins: the attitude and the sky that one frame alone speaks for.

use super::beneath;
use super::model::{Model, Scene};
use super::state::MAX_SENSORS;
use super::tuning::Tuning;
use crate::estimator::linear::solve;
use crate::estimator::vector::{Vector, add_scaled, cross, dot, length, product, rotation, unit};

/// Steps of each descent.
const STEPS: usize = 15;
/// What the model may be wrong by, K.
const DOUBT_K: f64 = 0.3;
/// The unknowns: a turn, ground, contrast, depth.
const N: usize = 6;

/// The fit of one frame.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    /// Level axes on the body.
    pub axes: [Vector; 3],
    /// The sky.
    pub scene: Scene,
    /// Mean square misfit, K².
    pub misfit_k2: f64,
}

/// The best fit to `readings` (missing ones are `None`) from a few first guesses, by damped least
/// squares of bounded length; `None` with fewer than `needed` readings. Where both ways round fit, the one in which up is
/// nearer to `before`.
pub fn start(
    model: &Model,
    readings: &[Option<f64>; MAX_SENSORS],
    needed: usize,
    tuning: &Tuning,
    before: Vector,
) -> Option<Start> {
    let depth = (tuning.depth.0, tuning.depth.1);
    let there = || (0..model.sensors()).filter_map(|i| readings[i].map(|r| (i, r)));
    if there().count() < needed {
        return None;
    }
    let absolute = model.is_absolute();
    let mean = there().map(|(_, r)| r).sum::<f64>() / there().count() as f64;
    // Where it is cold is up: the readings' moment about the axes.
    let mut moment = [0.0; 3];
    for (i, r) in there() {
        let r = if absolute { mean - r } else { r };
        let b = model.direction(i);
        moment = std::array::from_fn(|k| moment[k] + r * b[k]);
    }
    let spread = there()
        .map(|(_, r)| if absolute { r - mean } else { r })
        .fold((0.0_f64, 0.0_f64), |m, r| (m.0.min(r), m.1.max(r)));
    let contrast_k = (spread.1 - spread.0).max(if absolute { 0.0 } else { length(moment) }).max(0.1);
    let cold = unit(moment).unwrap_or([0.0, 0.0, 1.0]);
    // Turned over, or the ground colder than the sky: the first cannot be.
    let tilt = dot(cold, before);
    let (up, sign) = if tilt < 0.0 { (cold.map(|c| -c), -1.0) } else { (cold, 1.0) };
    let ground_c = if absolute { mean + 0.4 * sign * contrast_k } else { 0.0 };
    let scene = Scene {
        ground_c,
        contrast_k: sign * contrast_k,
        ln_depth: depth.0,
        radiance: tuning.radiance.0,
        view: [0.0; 3],
        lean: [0.0; 2],
        beneath: beneath::LEAST,
    };
    let aside: Vector = std::array::from_fn(|i| up[i] - tilt.abs() * before[i]);
    let nearer = unit(add_scaled(before, 0.3, aside)).unwrap_or(up);
    [up, nearer, before]
        .into_iter()
        .map(|up| descend(model, readings, Start { axes: axes(up), scene, misfit_k2: f64::INFINITY }, depth))
        .filter(|s| s.misfit_k2.is_finite())
        .min_by(|a, b| a.misfit_k2.total_cmp(&b.misfit_k2))
}

/// Level axes about an upward vertical, the first as near to the nose as can be.
pub fn axes(up: Vector) -> [Vector; 3] {
    let forward = |d: Vector| unit(std::array::from_fn(|i| d[i] - dot(d, up) * up[i]));
    let north = if up[0].abs() < 0.99 { forward([1.0, 0.0, 0.0]) } else { forward([0.0, 0.0, -up[0].signum()]) };
    let north = north.unwrap_or([1.0, 0.0, 0.0]);
    [north, cross(up, north), up]
}

fn descend(model: &Model, readings: &[Option<f64>; MAX_SENSORS], from: Start, depth: (f64, f64)) -> Start {
    let mut best = from;
    best.misfit_k2 = misfit(model, readings, &best, depth);
    let mut damping = 1e-3;
    for _ in 0..STEPS {
        let mut normal = [[0.0; N]; N];
        let mut right = [0.0; N];
        let mut take = |j: [f64; N], residual: f64, weight: f64| {
            for r in 0..N {
                right[r] += weight * j[r] * residual;
                for c in 0..N {
                    normal[r][c] += weight * j[r] * j[c];
                }
            }
        };
        for (i, reading) in readings.iter().enumerate().take(model.sensors()) {
            let Some(reading) = reading else { continue };
            let s = model.seen(i, &best.axes, &best.scene);
            let [x, y, z] = s.by_turn;
            take([x, y, z, s.by_ground, s.by_contrast, s.by_depth], reading - s.value, DOUBT_K.powi(-2));
        }
        take([0.0, 0.0, 0.0, 0.0, 0.0, 1.0], depth.0 - best.scene.ln_depth, depth.1.powi(-2));
        for (i, row) in normal.iter_mut().enumerate() {
            row[i] += damping * row[i] + 1e-6;
        }
        let Some(step) = solve(normal, right) else { break };
        let mut next = best;
        let turn = rotation([-step[0], -step[1], -step[2]].map(|c| c.clamp(-0.5, 0.5)));
        next.axes = best.axes.map(|a| product(&turn, a));
        next.scene.ground_c += step[3].clamp(-20.0, 20.0);
        next.scene.contrast_k += step[4].clamp(-20.0, 20.0);
        next.scene.ln_depth = (next.scene.ln_depth + step[5].clamp(-0.5, 0.5)).clamp(depth.0 - 2.0, depth.0 + 2.0);
        next.misfit_k2 = misfit(model, readings, &next, depth);
        if next.misfit_k2 < best.misfit_k2 {
            best = next;
            damping *= 0.2;
        } else {
            damping *= 8.0;
        }
    }
    best
}

fn misfit(model: &Model, readings: &[Option<f64>; MAX_SENSORS], at: &Start, depth: (f64, f64)) -> f64 {
    let doubt = ((at.scene.ln_depth - depth.0) / depth.1 * DOUBT_K).powi(2);
    let of = |i: usize| readings[i].map_or(0.0, |r| (r - model.seen(i, &at.axes, &at.scene).value).powi(2));
    (doubt + (0..model.sensors()).map(of).sum::<f64>()) / model.sensors() as f64
}
