//! One witness: what can be told of attitude, ground and contrast without hearing some of the sensors.
//!
//! A small extended Kalman filter of the attitude *as the sensors show it*: their lag turns it all alike, so that it
//! need not be a state here.

use super::super::model::{Model, Scene, Seen};
use super::super::start::Start;
use super::super::state::MAX_SENSORS;
use crate::estimator::linear::gain;
use crate::estimator::vector::{Vector, cross, dot, product, rotation, unit};

const TURN: usize = 0;
const RATE: usize = 3;
const GROUND: usize = 6;
const CONTRAST: usize = 7;
/// Then each sensor's own scene.
const OWN: usize = 8;
const MAX: usize = OWN + MAX_SENSORS;

/// What all witnesses are told of one step.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// How long it is, s.
    pub dt_s: f64,
    /// Mean body rates of a gyro over it, rad/s on nose, left, up.
    pub gyro: Option<Vector>,
    /// Whether that has been seen to turn rightly.
    pub proven: bool,
    /// Without a gyro: rms of the body rates, rad/s, and how long they last, s.
    pub rate: ([f64; 3], f64),
    /// Walks of ground and contrast, K for a second.
    pub walk_k: [f64; 2],
    /// A sensor's own scene: its size, K, and the share of it that is left after the step.
    pub own: (f64, f64),
    /// Noise of a reading, K.
    pub noise_k: f64,
    /// The sky's shape; ground and contrast are a witness's own.
    pub sky: Scene,
}

/// A witness.
#[derive(Clone, Debug)]
pub struct Witness {
    axes: [Vector; 3],
    x: [f64; MAX],
    p: [[f64; MAX]; MAX],
    sensors: usize,
    /// The sensors that it does not hear.
    deaf: [bool; MAX_SENSORS],
}

/// What a witness makes of the readings of one step.
#[derive(Clone, Copy, Debug, Default)]
pub struct Testimony {
    /// The logarithm of their probability density, but for a constant.
    pub likelihood: f64,
    /// The mean square of how far they are from what they should be, in standard deviations.
    pub squared: f64,
    /// What each sensor should show.
    pub expected: [f64; MAX_SENSORS],
    /// The standard deviation of a reading from that, K.
    pub sigma_k: [f64; MAX_SENSORS],
}

/// A reading farther from its prediction than this many standard deviations is no less likely, and weighs less.
const FARTHEST: f64 = 4.0;
/// What a reading that is not heard costs of the likelihood's logarithm: as much as one of two standard deviations.
pub const UNHEARD: f64 = 2.0;

impl Witness {
    /// Begins with an attitude, the sky, and their doubts: rad, K.
    pub fn new(axes: [Vector; 3], sky: &Scene, sensors: usize, own_k: f64) -> Self {
        let mut made = Self {
            axes,
            x: [0.0; MAX],
            p: [[0.0; MAX]; MAX],
            sensors: sensors.min(MAX_SENSORS),
            deaf: [false; MAX_SENSORS],
        };
        (made.x[GROUND], made.x[CONTRAST]) = (sky.ground_c, sky.contrast_k);
        let sigmas = [0.03, 0.03, 0.03, 0.1, 0.1, 0.1, 0.5, 0.5];
        let own = [own_k; MAX_SENSORS];
        for (i, s) in sigmas.iter().chain(&own).enumerate() {
            made.p[i][i] = s * s;
        }
        made
    }

    /// The same, without hearing sensor `i`.
    pub fn deaf_to(&self, i: usize) -> Self {
        let mut other = self.clone();
        other.deaf[i] = true;
        other
    }

    /// The same, hearing sensor `i` again.
    pub fn hearing(&self, i: usize, own_k: f64) -> Self {
        let mut other = self.clone();
        other.deaf[i] = false;
        other.forget(OWN + i, own_k);
        other
    }

    /// What to begin with by what it knows, under a sky that is else as `sky` is.
    pub fn told(&self, sky: &Scene) -> Start {
        let scene = Scene { ground_c: self.x[GROUND], contrast_k: self.x[CONTRAST], ..*sky };
        Start { axes: self.axes, scene, misfit_k2: 0.0 }
    }

    /// Makes state `i` zero, independent of all others.
    fn forget(&mut self, i: usize, sigma: f64) {
        self.x[i] = 0.0;
        self.p[i] = [0.0; MAX];
        self.p.iter_mut().for_each(|row| row[i] = 0.0);
        self.p[i][i] = sigma * sigma;
    }

    /// Which way is up.
    pub fn up(&self) -> Vector {
        self.axes[2]
    }

    /// Whether every number is one.
    pub fn is_sound(&self) -> bool {
        self.x.iter().all(|v| v.is_finite()) && (0..MAX).all(|i| self.p[i][i].is_finite() && self.p[i][i] >= 0.0)
    }

    fn size(&self) -> usize {
        OWN + self.sensors
    }

    /// Moves on by a step and takes in its readings.
    pub fn hear(&mut self, model: &Model, step: &Step, readings: &[Option<f64>; MAX_SENSORS]) -> Testimony {
        self.predict(step);
        let sky = Scene { ground_c: self.x[GROUND], contrast_k: self.x[CONTRAST], ..step.sky };
        let mut testimony = Testimony::default();
        let (before, mut heard) = (self.x, 0.0);
        for i in 0..self.sensors {
            let seen = model.seen(i, &self.axes, &sky);
            let h = slopes(&seen, i);
            let moved: f64 = h.iter().map(|(k, c)| c * (self.x[*k] - before[*k])).sum();
            let expected = seen.value + seen.scene * before[OWN + i] + moved;
            let mut ph = [0.0; MAX];
            let n = self.size();
            for (row, v) in self.p[..n].iter().zip(&mut ph) {
                *v = h.iter().map(|(k, c)| c * row[*k]).sum();
            }
            let variance = h.iter().map(|(k, c)| c * ph[*k]).sum::<f64>() + step.noise_k * step.noise_k;
            testimony.expected[i] = expected;
            testimony.sigma_k[i] = variance.sqrt();
            let Some(reading) = readings[i] else { continue };
            testimony.likelihood -= 0.5 * variance.ln();
            if self.deaf[i] {
                testimony.likelihood -= UNHEARD;
                continue;
            }
            let innovation = reading - expected;
            let squared = innovation * innovation / variance;
            testimony.likelihood -= 0.5 * squared.min(FARTHEST * FARTHEST);
            testimony.squared += squared;
            heard += 1.0;
            let doubted = variance * (squared / (FARTHEST * FARTHEST)).max(1.0);
            gain(&mut self.x, &mut self.p, n, &ph, doubted, innovation);
        }
        self.settle();
        testimony.squared /= f64::max(heard, 1.0);
        testimony
    }

    fn predict(&mut self, step: &Step) {
        let n = self.size();
        let dt_s = step.dt_s;
        let own_rates = [self.x[RATE], self.x[RATE + 1], self.x[RATE + 2]];
        let rates = step.gyro.unwrap_or(own_rates);
        let keep = if step.gyro.is_some() { 0.0 } else { (-dt_s / step.rate.1).exp() };
        let carried = if step.gyro.is_some() { 0.0 } else { dt_s };
        let turn = rates.map(|r| r * dt_s);
        self.rotate(turn);
        let back = rotation(turn.map(|c| -c));
        let turns = [self.p[TURN], self.p[TURN + 1], self.p[TURN + 2]];
        for (i, from) in back.iter().enumerate() {
            let mut row = self.p[RATE + i].map(|v| carried * v);
            for (share, turn) in from.iter().zip(&turns) {
                row[..n].iter_mut().zip(&turn[..n]).for_each(|(v, t)| *v += share * t);
            }
            self.p[TURN + i] = row;
            self.p[RATE + i].iter_mut().for_each(|v| *v *= keep);
            self.x[RATE + i] *= keep;
        }
        let (own_k, own_keep) = step.own;
        self.x[OWN..n].iter_mut().for_each(|v| *v *= own_keep);
        self.p[OWN..n].iter_mut().for_each(|row| row.iter_mut().for_each(|v| *v *= own_keep));
        for row in &mut self.p[..n] {
            let moved = product(&back, [row[TURN], row[TURN + 1], row[TURN + 2]]);
            for i in 0..3 {
                row[TURN + i] = moved[i] + carried * row[RATE + i];
                row[RATE + i] *= keep;
            }
            row[OWN..n].iter_mut().for_each(|v| *v *= own_keep);
        }
        for i in 0..3 {
            let sigma = step.rate.0[i];
            if step.gyro.is_some() {
                self.p[TURN + i][TURN + i] += sigma * sigma * dt_s * dt_s;
            } else {
                self.p[RATE + i][RATE + i] += sigma * sigma * (1.0 - keep * keep);
            }
        }
        for (i, walk) in step.walk_k.iter().enumerate() {
            self.p[GROUND + i][GROUND + i] += walk * walk * dt_s;
        }
        for i in OWN..n {
            self.p[i][i] += own_k * own_k * (1.0 - own_keep * own_keep);
        }
    }

    /// Turns the body by `turn`, rad: the axes go the other way.
    fn rotate(&mut self, turn: Vector) {
        let m = rotation(turn.map(|c| -c));
        self.axes = self.axes.map(|a| product(&m, a));
    }

    fn settle(&mut self) {
        self.rotate([self.x[TURN], self.x[TURN + 1], self.x[TURN + 2]]);
        self.x[TURN..TURN + 3].fill(0.0);
        let up = unit(self.axes[2]).unwrap_or([0.0, 0.0, 1.0]);
        let along = dot(self.axes[0], up);
        let level: Vector = std::array::from_fn(|i| self.axes[0][i] - along * up[i]);
        let north = unit(level).or_else(|| unit(cross([0.0, 1.0, 0.0], up))).unwrap_or([1.0, 0.0, 0.0]);
        self.axes = [north, cross(up, north), up];
    }
}

fn slopes(seen: &Seen, i: usize) -> [(usize, f64); 6] {
    let [x, y, z] = seen.by_turn;
    [
        (TURN, x),
        (TURN + 1, y),
        (TURN + 2, z),
        (GROUND, seen.by_ground),
        (CONTRAST, seen.by_contrast),
        (OWN + i, seen.scene),
    ]
}
