//! From one frame to the next: how the state moves, and what that leaves in doubt.

use super::askew;
use super::model::{Model, Scene};
use super::rates::{correction, rates, turning};
use super::state::{
    CONTRAST, DEPTH, GROUND, LAG, LATE_S, LEAN, MAX_SENSORS, OFFSET, RADIANCE, RATE, SEEN, SOONEST, SPAN_K, State,
    TURN, VIEW,
};
use super::tuning::Tuning;
use crate::estimator::vector::{Vector, add_scaled, dot, length, product, rotation};

/// How much moves, as learnt from the innovations.
#[derive(Clone, Copy, Debug)]
pub struct Pace {
    /// The body rates without a gyro, of what the tuning says.
    pub rate: [f64; 3],
    /// The errors of a gyro, of what the tuning says.
    pub gyro: [f64; 3],
    /// What a gyro turns more or less than its samples say, at least, rad²/s.
    pub gyro_walk: [f64; 3],
    /// The contrast, of what the tuning says.
    pub contrast: f64,
    /// The variance of the sensors' own scenes, K².
    pub scene_k2: f64,
    /// What that grows by while they change, K²/s.
    pub scene_change_k2_s: f64,
    /// What the horizon's lean walks more than usual, rad for a second.
    pub lean_walk: f64,
    /// What the logarithm of the sky's depth walks more than usual, for a second.
    pub depth_walk: f64,
    /// How surely the scene has not been alike all around for long, 0..1.
    pub long_unlike: f64,
}

#[cfg(test)]
impl Pace {
    /// As the tuning says, under an even sky.
    pub const USUAL: Self = Self {
        rate: [1.0; 3],
        gyro: [1.0; 3],
        gyro_walk: [0.0; 3],
        contrast: 1.0,
        scene_k2: 0.01,
        scene_change_k2_s: 0.0,
        lean_walk: 0.0,
        depth_walk: 0.0,
        long_unlike: 0.0,
    };
}

/// Moves `state` on by `dt_s` > 0 with the body rates of a gyro (rad/s on nose, left, up), or by the
/// rates that are part of the state.
pub fn predict(state: &mut State, model: &Model, t: &Tuning, dt_s: f64, gyro: Option<Vector>, pace: &Pace) {
    let rate = rates(state, t, gyro);
    // Of a heading that is a guess all is counted.
    let motion = if gyro.is_some() {
        length(rate)
    } else {
        length(correction(state)) + turning(state.vertical(), t.cruise_m_s).abs()
    };
    let (new, old) = t.unaided_scene_angle;
    let angle = if gyro.is_some() { t.scene_angle } else { new + pace.long_unlike * (old - new) };
    let scene_keep = (-dt_s * (1.0 / t.scene_time_s + motion / angle)).exp();
    let rate_keep = if gyro.is_some() { 1.0 } else { (-dt_s / t.rate_time_s).exp() };

    let before = state.axes;
    let turn = rate.map(|c| c * dt_s);
    state.rotate(turn);
    let back = rotation(turn.map(|c| -c));
    let sensors = model.sensors();
    move_rows(state, &back, dt_s, rate_keep, scene_keep, sensors);
    if let Some(gyro) = gyro {
        askew::move_rows(state, dt_s, gyro);
        askew::walk(state, t.askew.2, dt_s);
    }
    for i in 0..3 {
        state.x[RATE + i] *= rate_keep;
    }
    for s in &mut state.x[SEEN + sensors..SEEN + 2 * sensors] {
        *s *= scene_keep;
    }
    let lost = (1.0 - rate_keep * rate_keep, 1.0 - scene_keep * scene_keep);
    add_noise(state, sensors, t, dt_s, gyro.map(|_| rate), pace, lost);
    follow(state, model, t, dt_s, rate, &before);
}

/// The core's rows and columns: the turn's error goes round with the body and grows with the rates'.
fn move_rows(state: &mut State, back: &[Vector; 3], dt_s: f64, rate_keep: f64, scene_keep: f64, sensors: usize) {
    let n = state.size();
    let p = &mut state.p;
    let turns = [p[TURN], p[TURN + 1], p[TURN + 2]];
    for (i, from) in back.iter().enumerate() {
        let mut row = p[RATE + i].map(|v| dt_s * v);
        for (share, turn) in from.iter().zip(&turns) {
            row[..n].iter_mut().zip(&turn[..n]).for_each(|(v, t)| *v += share * t);
        }
        p[TURN + i] = row;
        p[RATE + i].iter_mut().for_each(|v| *v *= rate_keep);
    }
    for row in &mut p[SEEN + sensors..SEEN + 2 * sensors] {
        row[..n].iter_mut().for_each(|v| *v *= scene_keep);
    }
    for row in &mut p[..n] {
        let [turn, rate] = [TURN, RATE].map(|at| std::array::from_fn(|i| row[at + i]));
        let new = add_scaled(product(back, turn), dt_s, rate);
        row[TURN..TURN + 3].copy_from_slice(&new);
        row[RATE..RATE + 3].iter_mut().for_each(|v| *v *= rate_keep);
        row[SEEN + sensors..SEEN + 2 * sensors].iter_mut().for_each(|v| *v *= scene_keep);
    }
}

/// The process noise of everything but what the sensors show; `lost` is the share of the variance that
/// rates and scenes have lost in this step; `turns` are the rates by a gyro, rad/s.
fn add_noise(
    state: &mut State,
    sensors: usize,
    t: &Tuning,
    dt_s: f64,
    turns: Option<Vector>,
    pace: &Pace,
    lost: (f64, f64),
) {
    let found = state.x[LEAN].hypot(state.x[LEAN + 1]);
    let errors = state.errors();
    let mut add = |i: usize, variance: f64| state.p[i][i] += variance;
    for i in 0..3 {
        if let Some(rates) = turns {
            // An axis askew shows a share of what goes on about the others.
            let walk = pace.gyro[i] * t.gyro_walk.0.hypot(t.gyro_walk.1 * length(rates));
            add(TURN + i, (walk * walk).max(pace.gyro_walk[i]) * dt_s);
            add(RATE + i, t.bias.1.powi(2) * dt_s);
        } else {
            add(RATE + i, (pace.rate[i] * t.rate_sigma[i]).powi(2) * lost.0);
        }
    }
    add(GROUND, (pace.contrast.max(1.0) * t.ground_walk).powi(2) * dt_s);
    let contrast = pace.contrast * t.contrast.0 * state.x[CONTRAST].abs().max(1.0);
    add(CONTRAST, contrast * contrast * dt_s);
    add(DEPTH, (t.depth.2.powi(2) + pace.depth_walk.powi(2)) * dt_s);
    for i in 0..2 {
        add(OFFSET + i, t.offset.1.powi(2) * dt_s);
    }
    if turns.is_some() {
        let walk = t.lean.1 + pace.lean_walk + t.lean_share * found;
        (LEAN..LEAN + 2).for_each(|i| add(i, walk * walk * dt_s));
        state.lean2 += walk * walk * dt_s;
        let walk = t.error.2;
        errors.for_each(|i| add(i, walk * walk * dt_s));
        state.error2 += walk * walk * dt_s;
    }
    let scene_k2 = pace.scene_k2 * lost.1 + pace.scene_change_k2_s * dt_s;
    (SEEN + sensors..SEEN + 2 * sensors).for_each(|i| add(i, scene_k2));
}

/// What the sensors show follows what they see, behind by their lag.
fn follow(state: &mut State, model: &Model, t: &Tuning, dt_s: f64, rate: Vector, before: &[Vector; 3]) {
    let (n, sensors) = (state.size(), model.sensors());
    let lag_s = state.lag_s(t.lag_s);
    let keep = if lag_s > 1e-4 { (-dt_s / lag_s).exp() } else { 0.0 };
    let gain = 1.0 - keep;
    // How old, on the average over this step, what they follow is: exact for what goes in a straight line.
    let age_s = if gain > 0.0 { (lag_s - dt_s * keep / gain).clamp(0.0, dt_s) } else { dt_s };
    // Of a gyro that is late they see what it has yet to say.
    let age_s = age_s - state.late_s();
    let axes = if age_s >= dt_s {
        *before
    } else {
        let back = rotation(rate.map(|r| age_s * r));
        state.axes.map(|a| product(&back, a))
    };
    let scene = scene(state);
    let mut slopes = [[(0_usize, 0.0_f64); 19]; MAX_SENSORS];
    for (i, slope) in slopes[..sensors].iter_mut().enumerate() {
        let s = model.seen(i, &axes, &scene);
        let [own, error, scale] = [1, 2, 3].map(|k| SEEN + k * sensors + i);
        // What it shows less than the ground, all of it off by the same share.
        let share = (s.value - s.by_ground * scene.ground_c) / SPAN_K;
        let off = state.x[error] + share * state.x[scale];
        let input = s.value + s.scene * state.x[own] + off;
        let lag = if state.x[LAG] < SOONEST {
            -gain * LATE_S * dot(s.by_turn, rate)
        } else if lag_s > 1e-4 {
            keep * dt_s / lag_s * (state.x[SEEN + i] - input)
        } else {
            0.0
        };
        let ([x, y, z], [north, west]) = (s.by_turn, s.by_lean);
        *slope = [
            (TURN, x),
            (TURN + 1, y),
            (TURN + 2, z),
            (RATE, -age_s * x),
            (RATE + 1, -age_s * y),
            (RATE + 2, -age_s * z),
            (GROUND, s.by_ground),
            (CONTRAST, s.by_contrast),
            (DEPTH, s.by_depth),
            (RADIANCE, s.by_radiance),
            (VIEW, s.by_view[0]),
            (VIEW + 1, s.by_view[1]),
            (VIEW + 2, s.by_view[2]),
            (LEAN, north),
            (LEAN + 1, west),
            (own, s.scene),
            (error, 1.0),
            (scale, share),
            (LAG, 0.0),
        ];
        slope.iter_mut().for_each(|(_, v)| *v *= gain);
        slope[18].1 = lag;
        state.x[SEEN + i] = keep * state.x[SEEN + i] + gain * input;
        state.plain[i] = keep * state.plain[i] + gain * s.value;
        state.off[i] = off;
    }
    // F·P·Fᵀ, with F other than one in these rows alone: the rows, then what they have among themselves; the columns are as
    // the rows.
    let seen = SEEN..SEEN + sensors;
    for (i, slope) in slopes[..sensors].iter().enumerate() {
        let mut row = state.p[SEEN + i];
        row[..n].iter_mut().for_each(|v| *v *= keep);
        for (k, c) in slope {
            row[..n].iter_mut().zip(&state.p[*k][..n]).for_each(|(v, p)| *v += c * p);
        }
        state.p[SEEN + i] = row;
    }
    for row in &mut state.p[seen.clone()] {
        for (i, slope) in slopes[..sensors].iter().enumerate() {
            row[SEEN + i] = keep * row[SEEN + i] + slope.iter().map(|(k, c)| c * row[*k]).sum::<f64>();
        }
    }
    for i in seen.clone() {
        let row = state.p[i];
        for k in (0..seen.start).chain(seen.end..n) {
            state.p[k][i] = row[k];
        }
    }
}

/// The sky as the state has it.
pub fn scene(state: &State) -> Scene {
    Scene {
        ground_c: state.x[GROUND],
        contrast_k: state.x[CONTRAST],
        ln_depth: state.x[DEPTH],
        radiance: state.x[RADIANCE],
        view: state.view(),
        lean: [state.x[LEAN], state.x[LEAN + 1]],
        beneath: state.beneath,
    }
}
