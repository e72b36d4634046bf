//! The filter's state: values, covariance, and the two things done with them.

use super::beneath;
use crate::estimator::linear::{consider, gain};
use crate::estimator::vector::{Vector, cross, dot, product, rotation, unit};
use crate::sky::family::View;
use std::ops::Range;

/// The most sensors that a head may have.
pub const MAX_SENSORS: usize = 8;

/// Where each state stands. Rotation error on (nose, left, up), rad.
pub const TURN: usize = 0;
/// Correction to the body rates, rad/s: minus the gyro's bias, or the rates themselves without one.
pub const RATE: usize = 3;
/// The ground's temperature, °C.
pub const GROUND: usize = 6;
/// What a vertical pair shows, K.
pub const CONTRAST: usize = 7;
/// The logarithm of the sky's optical depth, as [`Family`](crate::sky::family::Family) counts it.
pub const DEPTH: usize = 8;
/// How far the horizon that the sensors see leans up to north and to west, where it is warmer, rad.
pub const LEAN: usize = 9;
/// What coordinated turns and climb say more than the thermopiles: roll and pitch, rad.
pub const OFFSET: usize = 11;
/// The logarithm of the sensors' time constant over the configured one, down to [`SOONEST`]. What it is below that is how late
/// a gyro is, as a multiple of [`LATE_S`].
pub const LAG: usize = 13;
/// The least and the most that this may be.
pub const LAGGED: (f64, f64) = (-3.0, 2.0);
/// Sensors are no sooner than what filters them, within its tolerance.
pub const SOONEST: f64 = -0.15;
/// A gyro is as likely to be so late as the time constant to be e times as long, s.
pub const LATE_S: f64 = 0.1;
/// How else the sensors see than they are said to: wider, and as two other forms, a [`View`].
pub const VIEW: usize = 14;
/// How much of what they see the sensors average in radiance: 0 none of it, and all in temperature, 1 all of it.
pub const RADIANCE: usize = 17;
/// How far a gyro's axes are turned from the head's, rad about nose, left and up.
pub const ASKEW: usize = 18;
/// How much too little a gyro shows about each of these, as a multiple of a share that is as likely.
pub const SCALE: usize = 21;
/// What each sensor shows, lag included; then each sensor's own scene; then what each shows too much wherever it looks;
/// then what it shows too much of the sky.
pub const SEEN: usize = 24;

/// A sensor's scale is expected to be off by so much that it adds as much as its constant error where the sky is so much
/// colder than the ground, K.
pub const SPAN_K: f64 = 15.0;

/// The most states.
pub const MAX: usize = SEEN + 4 * MAX_SENSORS;

/// Values and covariance. States beyond [`State::size`] are not used.
#[derive(Clone, Debug)]
pub struct State {
    /// The level axes north, west, up, on the body's axes: rows.
    pub axes: [Vector; 3],
    /// All values; the turn's three are zero between updates.
    pub x: [f64; MAX],
    /// What each sensor would show without a scene of its own: of the attitude and the sky alone.
    pub plain: [f64; MAX_SENSORS],
    /// What each sensor shows too much there, K.
    pub off: [f64; MAX_SENSORS],
    /// Covariance.
    pub p: [[f64; MAX]; MAX],
    /// The variance that each lean was expected to have, with what its walk has added, rad².
    pub lean2: f64,
    /// What leans are expected about: what is known of them, rad up to north and west.
    pub lean_mean: [f64; 2],
    /// The variance of a gyro's axes, rad².
    pub askew2: f64,
    /// The same of what each sensor shows too much, K²; zero while nothing is learnt of it.
    pub error2: f64,
    /// The share that what looks straight down sees of a scene, as a sensor that looks up sees all of it.
    pub beneath: f64,
    /// The states of which readings tell.
    told: [bool; MAX],
    sensors: usize,
}

impl State {
    /// The sensors' time constant where `configured_s` is configured, s.
    pub fn lag_s(&self, configured_s: f64) -> f64 {
        configured_s * self.x[LAG].clamp(SOONEST, LAGGED.1).exp()
    }

    /// How late a gyro's rates are, s.
    pub fn late_s(&self) -> f64 {
        LATE_S * (SOONEST - self.x[LAG]).clamp(0.0, SOONEST - LAGGED.0)
    }

    /// Level, heading north, everything else zero and certain.
    pub fn new(sensors: usize) -> Self {
        let mut state = Self {
            axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            x: [0.0; MAX],
            plain: [0.0; MAX_SENSORS],
            off: [0.0; MAX_SENSORS],
            p: [[0.0; MAX]; MAX],
            lean2: 0.0,
            lean_mean: [0.0; 2],
            askew2: 0.0,
            error2: 0.0,
            beneath: beneath::LEAST,
            told: [true; MAX],
            sensors: sensors.min(MAX_SENSORS),
        };
        state.tell(LEAN..LEAN + 2, false);
        state
    }

    /// How many states there are: without the sensors' errors while nothing is learnt of these.
    pub fn size(&self) -> usize {
        if self.error2 > 0.0 { self.errors().end } else { self.errors().start }
    }

    /// The state of sensor `i`'s own scene, K.
    pub fn scene(&self, i: usize) -> usize {
        SEEN + self.sensors + i
    }

    /// The states of what each sensor shows too much wherever it looks, K; then of what it shows too much of the sky, K where
    /// that is [`SPAN_K`] colder than the ground.
    pub fn errors(&self) -> Range<usize> {
        SEEN + 2 * self.sensors..SEEN + 4 * self.sensors
    }

    /// How else the sensors see than they are said to.
    pub fn view(&self) -> View {
        std::array::from_fn(|k| self.x[VIEW + k])
    }

    /// The upward vertical on (nose, left, up).
    pub fn vertical(&self) -> Vector {
        self.axes[2]
    }

    /// Makes state `i` independent of all others, with this variance.
    pub fn set_variance(&mut self, i: usize, variance: f64) {
        for j in 0..self.size() {
            self.p[i][j] = 0.0;
            self.p[j][i] = 0.0;
        }
        self.p[i][i] = variance;
    }

    /// Adds process noise to state `i`.
    pub fn add_variance(&mut self, i: usize, variance: f64) {
        self.p[i][i] += variance;
    }

    /// Adds an error along these states, all of it by one cause: a variance of 1 of it.
    pub fn widen(&mut self, along: &[(usize, f64)]) {
        for (i, a) in along {
            for (j, b) in along {
                self.p[*i][*j] += a * b;
            }
        }
    }

    /// Takes in a measurement `h·x + noise` that differs from its prediction by `innovation`.
    pub fn correct(&mut self, h: &[(usize, f64)], innovation: f64, variance: f64) {
        let n = self.size();
        let mut ph = [0.0; MAX];
        for (i, v) in ph[..n].iter_mut().enumerate() {
            *v = h.iter().map(|(k, c)| self.p[i][*k] * c).sum();
        }
        let s = h.iter().map(|(k, c)| ph[*k] * c).sum::<f64>() + variance;
        gain(&mut self.x, &mut self.p, n, &ph, s, innovation);
    }

    /// The variance of `h·x`.
    pub fn variance_of(&self, h: &[(usize, f64)]) -> f64 {
        h.iter().map(|(i, a)| a * h.iter().map(|(j, b)| b * self.p[*i][*j]).sum::<f64>()).sum()
    }

    /// Whether readings tell of these states; from the beginning on, of all but how the horizon leans: that looks like an
    /// attitude, and what does not is a scene's shape, which nobody knows.
    pub fn tell(&mut self, states: Range<usize>, told: bool) {
        self.told[states].fill(told);
    }

    /// Takes in a reading of state `i`. Nothing is learnt from it of what readings do not tell: that is considered.
    pub fn read(&mut self, i: usize, innovation: f64, variance: f64) {
        let (ph, n) = (self.p[i], self.size());
        let learnt = self.learnt(&ph);
        consider(&mut self.x, &mut self.p, n, (&ph, &learnt), ph[i] + variance, innovation);
    }

    /// Moves state `i` into its bounds, and the others of which readings tell as they go with it. How well all are known stays.
    pub fn bound(&mut self, i: usize, (least, most): (f64, f64)) {
        let beyond = self.x[i] - self.x[i].clamp(least, most);
        if beyond != 0.0 {
            let (n, column) = (self.size(), self.p[i]);
            let share = beyond / column[i].max(f64::MIN_POSITIVE);
            let learnt = self.learnt(&column);
            self.x[..n].iter_mut().zip(&learnt).for_each(|(x, l)| *x -= share * l);
        }
    }

    /// What of `column` of the covariance readings tell. Where a warm side is expected it is nothing of a turn about the vertical:
    /// it would be told by that side, which is known no better, and a small error of either would make the other grow.
    fn learnt(&self, column: &[f64; MAX]) -> [f64; MAX] {
        let mut learnt = std::array::from_fn(|k| if self.told[k] { column[k] } else { 0.0 });
        if self.p[LEAN][LEAN] > 0.0 {
            let up = self.vertical();
            let about_it = dot([learnt[TURN], learnt[TURN + 1], learnt[TURN + 2]], up);
            (0..3).for_each(|k| learnt[TURN + k] -= about_it * up[k]);
        }
        learnt
    }

    /// Turns the body by `turn`, rad: the axes go the other way.
    pub fn rotate(&mut self, turn: Vector) {
        let m = rotation(turn.map(|c| -c));
        self.axes = self.axes.map(|a| product(&m, a));
    }

    /// Turns the level axes by `angle` about the vertical, counterclockwise from above. The body stays, and
    /// so does what is warm around it.
    pub fn turn_heading(&mut self, angle: f64) {
        let turn = self.vertical().map(|c| -angle * c);
        self.rotate(turn);
        let (sin, cos) = angle.sin_cos();
        let turned = |north: f64, west: f64| (cos * north + sin * west, cos * west - sin * north);
        let n = self.size();
        (self.x[LEAN], self.x[LEAN + 1]) = turned(self.x[LEAN], self.x[LEAN + 1]);
        self.lean_mean = turned(self.lean_mean[0], self.lean_mean[1]).into();
        for j in 0..n {
            (self.p[LEAN][j], self.p[LEAN + 1][j]) = turned(self.p[LEAN][j], self.p[LEAN + 1][j]);
        }
        for row in &mut self.p[..n] {
            (row[LEAN], row[LEAN + 1]) = turned(row[LEAN], row[LEAN + 1]);
        }
    }

    /// Takes the turn found by corrections into the axes, and squares these.
    pub fn settle(&mut self) {
        let turn = [self.x[TURN], self.x[TURN + 1], self.x[TURN + 2]];
        self.rotate(turn);
        self.x[TURN..TURN + 3].fill(0.0);
        let up = unit(self.axes[2]).unwrap_or([0.0, 0.0, 1.0]);
        let along = dot(self.axes[0], up);
        let north = unit(std::array::from_fn(|i| self.axes[0][i] - along * up[i])).unwrap_or([1.0, 0.0, 0.0]);
        self.axes = [north, cross(up, north), up];
    }

    /// Whether every number is one, and every variance is none below zero.
    pub fn is_sound(&self) -> bool {
        let n = self.size();
        self.x[..n].iter().all(|v| v.is_finite())
            && (0..n).all(|i| self.p[i][i] >= 0.0 && self.p[i][..n].iter().all(|v| v.is_finite()))
    }
}
