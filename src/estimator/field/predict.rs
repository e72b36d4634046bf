//! From one frame to the next: how the state moves, and what that leaves in doubt.

use super::model::{Model, Scene};
use super::state::{CONTRAST, DEPTH, GROUND, LAG, MAX, MAX_SENSORS, OFFSET, RADIANCE, RATE, SEEN, SIDE, State, TURN};
use super::tune::Tuning;
use crate::estimator::vector::{Vector, add_scaled, cross, length, rotation, unit};

/// Moves `state` on by `dt_s` with the body rates of a gyro (rad/s on nose, left, up), or by the
/// rates that are part of the state.
pub fn predict(state: &mut State, model: &Model, tuning: &Tuning, dt_s: f64, gyro: Option<Vector>, pace: &Pace) {
    let n = state.len();
    let correction = [state.x[RATE], state.x[RATE + 1], state.x[RATE + 2]];
    let mut rate = add_scaled(correction, 1.0, gyro.unwrap_or_default());
    if gyro.is_none() {
        // Nothing tells of the heading but the bank: a coordinated turn.
        let up = state.vertical();
        rate = add_scaled(rate, -9.81 / tuning.cruise_m_s * (up[1] / up[2].abs().max(0.3)).clamp(-2.0, 2.0), up);
    }
    let before = state.axes;

    // The core: the turn's error goes round with the body and grows with the rates' error.
    let turn = rate.map(|c| c * dt_s);
    state.rotate(turn);
    let back = rotation(turn.map(|c| -c));
    let keep = if gyro.is_some() { 1.0 } else { (-dt_s / tuning.rate_time_s).exp() };
    let scene_rate = 1.0 / tuning.scene_time_s + turning(state, rate, gyro) / tuning.scene_angle;
    let scene_keep = (-dt_s * scene_rate).exp();
    let core = |m: &mut [[f64; MAX]; MAX], rows: bool| {
        for j in 0..n {
            let at = |m: &[[f64; MAX]; MAX], i: usize| if rows { m[i][j] } else { m[j][i] };
            let old: Vector = std::array::from_fn(|i| at(m, TURN + i));
            let rates: Vector = std::array::from_fn(|i| at(m, RATE + i));
            for i in 0..3 {
                let turned = back[i][0] * old[0] + back[i][1] * old[1] + back[i][2] * old[2] + dt_s * rates[i];
                let (t, r) = (TURN + i, RATE + i);
                if rows {
                    m[t][j] = turned;
                    m[r][j] *= keep;
                } else {
                    m[j][t] = turned;
                    m[j][r] *= keep;
                }
            }
            for s in SEEN + model.len()..n {
                if rows {
                    m[s][j] *= scene_keep;
                } else {
                    m[j][s] *= scene_keep;
                }
            }
        }
    };
    core(&mut state.p, true);
    core(&mut state.p, false);
    for i in 0..3 {
        state.x[RATE + i] *= keep;
    }
    for s in SEEN + model.len()..n {
        state.x[s] *= scene_keep;
    }
    noise(state, model, tuning, dt_s, gyro.is_some(), pace, scene_keep);
    seen(state, model, tuning, dt_s, rate, &before);
}

/// How much more, or less, moves than the tuning says.
#[derive(Clone, Copy, Debug)]
pub struct Pace {
    /// Body rates without a gyro.
    pub rate: [f64; 3],
    /// The contrast.
    pub contrast: f64,
    /// How surely the scene is not alike all around, 0..1.
    pub unlike: f64,
    /// The sensors' own scenes, K.
    pub scene: f64,
}

/// How fast the head turns, rad/s: what it sees changes with that. Without a gyro the turn is that of
/// a coordinated one at 15 m/s.
fn turning(state: &State, rate: Vector, gyro: Option<Vector>) -> f64 {
    let turn = if gyro.is_some() {
        0.0
    } else {
        let [_, l, u] = state.vertical();
        (l / u.abs().max(0.3)).abs() * 9.81 / 15.0
    };
    length(rate) + turn
}

/// The process noise of everything but what the sensors show.
fn noise(state: &mut State, model: &Model, t: &Tuning, dt_s: f64, gyro: bool, pace: &Pace, scene_keep: f64) {
    for i in 0..3 {
        if gyro {
            state.add_variance(TURN + i, (t.gyro_walk).powi(2) * dt_s);
            state.add_variance(RATE + i, (t.bias_walk).powi(2) * dt_s);
        } else {
            let lost = -(-2.0 * dt_s / t.rate_time_s).exp_m1();
            state.add_variance(RATE + i, (pace.rate[i] * t.rate_sigma[i]).powi(2) * lost);
        }
    }
    let scale = state.x[CONTRAST].abs().max(1.0);
    state.add_variance(GROUND, t.ground_walk.powi(2) * dt_s);
    state.add_variance(CONTRAST, (pace.contrast * t.contrast_walk * scale).powi(2) * dt_s);
    state.add_variance(DEPTH, t.depth_walk.powi(2) * dt_s);
    for i in 0..2 {
        state.add_variance(OFFSET + i, t.offset_walk.powi(2) * dt_s);
    }
    for i in 0..4 {
        let walk = if gyro { t.side_walk + pace.unlike * t.unlike_walk } else { pace.unlike * t.blind_side_walk };
        state.add_variance(SIDE + i, walk.powi(2) * dt_s);
    }
    let lost = 1.0 - scene_keep * scene_keep;
    for i in 0..model.len() {
        state.add_variance(SEEN + model.len() + i, pace.scene.powi(2) * lost);
    }
}

/// What the sensors show follows what they see, behind by their lag.
fn seen(state: &mut State, model: &Model, tuning: &Tuning, dt_s: f64, rate: Vector, before: &[Vector; 3]) {
    let (n, sensors) = (state.len(), model.len());
    let lag_s = tuning.lag_s * state.x[LAG].clamp(-2.0, 2.0).exp();
    let keep = if lag_s > 1e-4 { (-dt_s / lag_s).exp() } else { 0.0 };
    // The age of what they see on the average over this step.
    let age_s = (lag_s - dt_s * keep / (1.0 - keep)).clamp(0.0, dt_s);
    let axes = aged(state, rate, age_s, before, dt_s);
    let scene = scene(state);
    let mut slopes = [[(0_usize, 0.0_f64); 16]; MAX_SENSORS];
    for (i, slope) in slopes[..sensors].iter_mut().enumerate() {
        let s = model.seen(i, &axes, &scene);
        let input = s.value + s.sky * state.x[SEEN + sensors + i];
        let gain = 1.0 - keep;
        let g = |k: usize, v: f64| (k, v * gain);
        let [x, y, z] = s.by_turn;
        *slope = [
            g(TURN, x),
            g(TURN + 1, y),
            g(TURN + 2, z),
            g(RATE, -age_s * x),
            g(RATE + 1, -age_s * y),
            g(RATE + 2, -age_s * z),
            g(GROUND, s.by_ground),
            g(CONTRAST, s.by_contrast),
            g(DEPTH, s.by_depth),
            g(RADIANCE, s.by_radiance),
            g(SIDE, s.by_side[0]),
            g(SIDE + 1, s.by_side[1]),
            g(SIDE + 2, s.by_side[2]),
            g(SIDE + 3, s.by_side[3]),
            g(SEEN + sensors + i, s.sky),
            (LAG, if lag_s > 1e-4 { keep * dt_s / lag_s * (state.x[SEEN + i] - input) } else { 0.0 }),
        ];
        state.x[SEEN + i] = keep * state.x[SEEN + i] + gain * input;
    }
    // Rows, then columns: F·P·Fᵀ with F other than one in these rows alone.
    for (i, slope) in slopes[..sensors].iter().enumerate() {
        let mut row = state.p[SEEN + i];
        for v in &mut row[..n] {
            *v *= keep;
        }
        for (k, c) in slope {
            for (v, p) in row[..n].iter_mut().zip(&state.p[*k][..n]) {
                *v += c * p;
            }
        }
        state.p[SEEN + i] = row;
    }
    for row in &mut state.p[..n] {
        for (i, slope) in slopes[..sensors].iter().enumerate() {
            row[SEEN + i] = keep * row[SEEN + i] + slope.iter().map(|(k, c)| c * row[*k]).sum::<f64>();
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
        side_k: std::array::from_fn(|i| state.x[SIDE + i]),
    }
}

/// The axes `age_s` before now.
fn aged(state: &State, rate: Vector, age_s: f64, before: &[Vector; 3], dt_s: f64) -> [Vector; 3] {
    if age_s >= dt_s {
        return *before;
    }
    state.axes.map(|a| unit(add_scaled(a, age_s, cross(rate, a))).unwrap_or(a))
}
