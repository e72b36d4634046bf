//! Six temperatures, one field: attitude, ground, contrast and the sky's shape estimated together.
//!
//! An extended Kalman filter whose work is the same for every frame.

mod adapt;
mod aid;
pub mod model;
mod predict;
mod start;
mod state;
pub mod tune;

use super::vector::{Vector, cross};
use super::{Estimator, Solution};
use crate::attitude::Attitude;
use crate::frame::Frame;
use crate::head::Head;
use crate::sky::FieldOfView;
use crate::time::Time;
use adapt::{SceneStrength, Whiteness};
use aid::Aid;
use model::Model;
use predict::Pace;
use state::{CONTRAST, DEPTH, GROUND, LAG, MAX_SENSORS, OFFSET, RADIANCE, RATE, SEEN, SIDE, State, TURN};
use tune::Tuning;

/// A frame later than this after the last begins anew, s.
const GAP_S: f64 = 2.0;
/// A gyro's sample older than this is none, s.
const GYRO_AGE_S: f64 = 0.25;

/// The estimator.
#[derive(Clone, Debug)]
pub struct FieldEstimator {
    model: Model,
    tuning: Tuning,
    needed: usize,
    state: State,
    last: Option<Time>,
    stamps: [Option<Time>; MAX_SENSORS],
    gyro: Option<(Vector, Time)>,
    gyro_mode: bool,
    aid: Aid,
    roll: Whiteness<1>,
    pitch: Whiteness<1>,
    contrast: Whiteness<1>,
    scene: SceneStrength,
}

impl FieldEstimator {
    /// For `head`.
    pub fn new(head: &Head, field: FieldOfView, tuning: Tuning) -> Self {
        let model = Model::new(head, field);
        let state = State::new(model.len());
        let needed = if model.is_absolute() { 5 } else { 3 };
        Self {
            model,
            tuning,
            needed,
            state,
            last: None,
            stamps: [None; MAX_SENSORS],
            gyro: None,
            gyro_mode: false,
            aid: Aid::default(),
            roll: Whiteness::new(0.1, (tuning.adapt, tuning.adapt), (0.1, 8.0), 1.0),
            pitch: Whiteness::new(0.1, (tuning.adapt, tuning.adapt), (0.1, 8.0), 1.0),
            contrast: Whiteness::new(0.15, (tuning.adapt_contrast, 0.5), (1.0, 200.0), 1.0),
            scene: SceneStrength::new(tuning.scene_start, tuning.scene_sigma),
        }
    }

    /// How strong the sensors' own scenes are taken to be, K.
    pub fn scene_k(&self) -> f64 {
        self.scene.variance.sqrt()
    }

    fn begin(&mut self, readings: &[Option<f64>; MAX_SENSORS]) -> bool {
        let Some(start) = start::start(&self.model, readings, self.needed, self.tuning.depth) else { return false };
        let t = self.tuning;
        self.state = State::new(self.model.len());
        let s = &mut self.state;
        s.axes = start.axes;
        s.x[GROUND] = start.scene.ground_c;
        s.x[CONTRAST] = start.scene.contrast_k;
        s.x[RADIANCE] = t.radiance.0;
        s.x[DEPTH] = start.scene.ln_depth;
        let variances = [
            (TURN, 0.01),
            (TURN + 1, 0.01),
            (TURN + 2, 0.01),
            (GROUND, 4.0),
            (CONTRAST, (0.15 * start.scene.contrast_k).powi(2) + 1.0),
            (DEPTH, t.depth.1.powi(2)),
            (RADIANCE, t.radiance.1.powi(2)),
            (OFFSET, t.offset_sigma.powi(2)),
            (OFFSET + 1, t.offset_sigma.powi(2)),
        ];
        for (i, v) in variances {
            s.set_variance(i, v);
        }
        for i in 0..self.model.len() {
            let seen = self.model.seen(i, &s.axes, &start.scene).value;
            s.x[SEEN + i] = readings[i].unwrap_or(seen);
            s.set_variance(SEEN + i, 1.0);
            let scene = s.scene(i);
            s.set_variance(scene, self.scene.variance);
        }
        self.set_rates();
        true
    }

    /// Learns from the innovations, tilt apart from the rest.
    fn adapt(&mut self, readings: &[Option<f64>; MAX_SENSORS], dt_s: f64) {
        let n = self.model.len();
        let scene = predict::scene(&self.state);
        let mut v = [0.0; MAX_SENSORS];
        let mut by = [0.0; MAX_SENSORS];
        let mut there = [0.0; MAX_SENSORS];
        let mut sky = [0.0; MAX_SENSORS];
        let (mut roll, mut pitch) = ([0.0; MAX_SENSORS], [0.0; MAX_SENSORS]);
        for i in 0..n {
            let Some(r) = readings[i] else { continue };
            v[i] = r - self.state.x[SEEN + i];
            let seen = self.model.seen(i, &self.state.axes, &scene);
            let [x, y, _] = seen.by_turn;
            by[i] = seen.by_contrast;
            there[i] = 1.0;
            sky[i] = seen.sky;
            (roll[i], pitch[i]) = (x, y);
        }
        let dot = |a: &[f64; MAX_SENSORS], b: &[f64; MAX_SENSORS]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        let normed = |a: &mut [f64; MAX_SENSORS]| {
            let l = dot(a, a).sqrt().max(1e-6);
            a.iter_mut().for_each(|c| *c /= l);
        };
        normed(&mut roll);
        let shared = dot(&roll, &pitch);
        pitch.iter_mut().zip(&roll).for_each(|(p, r)| *p -= shared * r);
        normed(&mut pitch);
        let (a, b) = (dot(&v, &roll), dot(&v, &pitch));
        if self.gyro_mode {
        } else {
            self.roll.update(&[a], dt_s);
            self.pitch.update(&[b], dt_s);
        }
        let shared = [dot(&by, &roll), dot(&by, &pitch)];
        by.iter_mut().enumerate().for_each(|(i, c)| *c -= shared[0] * roll[i] + shared[1] * pitch[i]);
        normed(&mut by);
        self.contrast.update(&[dot(&v, &by)], dt_s);
        if self.tuning.adapt_scene > 0.0 {
            let mut even = there;
            for known in [&roll, &pitch, &by] {
                let share = dot(&even, known);
                even.iter_mut().zip(known).for_each(|(e, k)| *e -= share * k);
            }
            normed(&mut even);
            let count = there.iter().sum::<f64>() as usize;
            let scenes = std::array::from_fn(|i| if i < n { sky[i] * self.state.x[self.state.scene(i)] } else { 0.0 });
            self.scene.update(&v, &scenes, dt_s, (self.tuning.attack_scene, self.tuning.adapt_scene), |pattern| {
                for known in [&roll, &pitch, &by, &even] {
                    let share = dot(pattern, known);
                    pattern.iter_mut().zip(known).for_each(|(e, k)| *e -= share * k);
                }
                count.saturating_sub(4)
            });
        }
    }

    fn set_rates(&mut self) {
        let t = &self.tuning;
        for i in 0..3 {
            self.state.x[RATE + i] = 0.0;
            let sigma = if self.gyro_mode { t.bias_sigma } else { t.rate_sigma[i] };
            self.state.set_variance(RATE + i, sigma * sigma);
        }
        for i in 0..4 {
            self.state.x[SIDE + i] = 0.0;
            let sigma = if i < 2 { t.side_sigma } else { t.ground_side_sigma };
            self.state.set_variance(SIDE + i, (if self.gyro_mode { sigma } else { t.blind_side }).powi(2));
        }
        self.state.set_variance(LAG, if self.gyro_mode { t.lag_sigma.powi(2) } else { 0.0 });
    }

    fn attitude(&self) -> (Attitude, Attitude) {
        let u = self.state.vertical();
        let attitude = Attitude { roll: u[1].atan2(u[2]), pitch: u[0].clamp(-1.0, 1.0).asin() };
        let flat = (u[1] * u[1] + u[2] * u[2]).max(1e-4);
        let mut roll = [0.0; 3];
        let mut pitch = [0.0; 3];
        for k in 0..3 {
            let mut axis = [0.0; 3];
            axis[k] = 1.0;
            let du = cross(u, axis);
            roll[k] = (u[2] * du[1] - u[1] * du[2]) / flat;
            pitch[k] = du[0] / flat.sqrt();
        }
        let sigma = |g: [f64; 3]| {
            let mut v = 0.0;
            for i in 0..3 {
                for j in 0..3 {
                    v += g[i] * g[j] * self.state.p[TURN + i][TURN + j];
                }
            }
            v.max(0.0).sqrt()
        };
        (attitude, Attitude { roll: sigma(roll), pitch: sigma(pitch) })
    }
}

impl Estimator for FieldEstimator {
    fn update(&mut self, frame: &Frame) -> Solution {
        let mut readings = [None; MAX_SENSORS];
        let mut newest: Option<Time> = None;
        for i in 0..self.model.len() {
            if let Some((value, time)) = self.model.reading(i, frame)
                && self.stamps[i].is_none_or(|s| time > s)
            {
                readings[i] = Some(value);
                self.stamps[i] = Some(time);
                newest = newest.max(Some(time));
            }
        }
        let Some(now) = newest else { return Solution::default() };
        let mut gyro = None;
        let dt_s = self.last.map_or(f64::INFINITY, |l| now.since(l));
        if let [Some(p), Some(q), Some(r)] = frame.aiding.gyro_deg_s {
            let rates = [p.to_radians(), -q.to_radians(), -r.to_radians()];
            let mean = self.gyro.map_or(rates, |(g, _)| std::array::from_fn(|i| 0.5 * (g[i] + rates[i])));
            self.gyro = Some((rates, now));
            if dt_s < GYRO_AGE_S {
                gyro = Some(mean);
            }
        } else if let Some((rates, time)) = self.gyro
            && now.since(time) < GYRO_AGE_S
        {
            gyro = Some(rates);
        }
        if gyro.is_some() != self.gyro_mode {
            self.gyro_mode = gyro.is_some();
            self.set_rates();
        }
        if dt_s > GAP_S || dt_s < 0.0 || !self.state.is_sound() {
            self.last = None;
            if !self.begin(&readings) {
                return Solution::default();
            }
        } else {
            let pace = Pace {
                rate: [self.roll.factor, self.pitch.factor, self.pitch.factor],
                contrast: self.contrast.factor,
                scene: self.scene.variance.sqrt(),
                unlike: self.scene.unlike(),
            };
            predict::predict(&mut self.state, &self.model, &self.tuning, dt_s, gyro, &pace);
            self.adapt(&readings, dt_s);
        }
        self.last = Some(now);
        let noise = self.tuning.noise_k.powi(2);
        for (i, reading) in readings.iter().enumerate().take(self.model.len()) {
            let Some(r) = reading else { continue };
            let innovation = r - self.state.x[SEEN + i];
            self.state.correct_one(SEEN + i, innovation, noise);
        }
        self.state.settle();
        if dt_s < GAP_S {
            self.aid.update(&frame.aiding, &mut self.state, &self.tuning, now, dt_s, gyro);
        }
        let (attitude, mut sigma) = self.attitude();
        if !self.gyro_mode {
            let doubt = self.scene.unlike() * self.tuning.doubt_k / (1.1 * self.state.x[CONTRAST].abs().max(1.0));
            sigma.roll = sigma.roll.hypot(doubt / attitude.pitch.cos().max(0.2));
            sigma.pitch = sigma.pitch.hypot(doubt);
        }
        let contrast = self.state.x[CONTRAST];
        Solution { attitude: Some(attitude), sigma, contrast_k: Some(contrast), seen_k: Some([0.0, 0.0, contrast]) }
    }
}
