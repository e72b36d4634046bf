//! Which sensor is not to be heard: witnesses who each leave one out.
//!
//! A bank of small filters beside the main one: one hears every sensor, the others all but one. While all sensors
//! tell of one sky, the first explains what it hears best. When one sensor goes its own way, all witnesses that hear
//! it are surprised, and the one that does not is not: the sums of their surprises tell which sensor that is, and
//! what it should show.

mod filter;

use super::model::{Model, Scene};
use super::predict::Pace;
use super::state::MAX_SENSORS;
use super::tuning::Tuning;
use crate::estimator::Standing;
use crate::estimator::vector::{Vector, add_scaled, dot};
use filter::{Step, Witness};

/// Readings are averaged over this time before witnesses hear them, s.
const STEP_S: f64 = 0.05;
/// A pause longer than this begins anew, s.
const GAP_S: f64 = 1.0;
/// A sum of surprises never falls below, nor rises above.
const BOUNDS: (f64, f64) = (-5.0, 300.0);
/// From this sum on a sensor is doubted; from that one on it is left out, if it is so much ahead of all others,
const DOUBT: f64 = 8.0;
const CONVICT: f64 = 20.0;
const AHEAD: f64 = 5.0;
/// in so many steps.
const STEPS: u8 = 3;
/// As many sensors can be doubted at once; more are no sensors' matter.
const DOUBTED: usize = 2;
/// A reading this far from what the others say, K, as a share of the contrast and in standard deviations, may be
/// its sensor's matter,
const APART: (f64, f64, f64) = (0.5, 0.02, 2.5);
/// and no more when it has been nearer for this time, s, while it should have changed by so much: K and as a share
/// of the contrast. What is near for want of change proves nothing.
const BACK_S: f64 = 3.0;
const BACK: (f64, f64) = (1.0, 0.06);
/// What looks at the ground hardly changes: so long is enough in any case, s.
const BACK_AT_LAST_S: f64 = 20.0;
/// So far, K or as a share of the contrast, it must be to be left out: smaller ones are the scene's. A second sensor
/// must be so many times as far, and its sum as high.
const GUILTY: (f64, f64) = (1.0, 0.08);
const SECOND: f64 = 3.0;
/// Without it all others must fit together: their squared surprises' mean over some time, s.
const FIT: f64 = 1.7;
const FIT_S: f64 = 0.5;
/// Doubt of small matters ends after this time, s.
const DOUBT_S: f64 = 1.5;
/// The sky's shape is followed over this time, s, and not while any sensor surprises.
const SHAPE_S: f64 = 5.0;
/// As many sensors must be heard for one to be doubted.
const FEWEST: usize = 5;
/// A scene's least size, K and as a share of the contrast.
const SCENE: (f64, f64) = (0.25, 0.005);
/// Walks of ground, K, and contrast, as a share of it, for a second.
const WALK: (f64, f64) = (0.5, 0.1);
/// The same of a sky and a ground that change quickly: fog, a cloud, hail.
const QUICK: f64 = 0.7;
/// Body rates of aerobatics, rad/s rms.
const AEROBATIC: f64 = 1.5;
/// The cosine between two sensors that look apart.
const OPPOSED: f64 = -0.95;
/// Doubt of a gyro's rates: rad/s and as a share of them.
const GYRO: (f64, f64) = (0.01, 0.05);

/// What the main filter knows that witnesses are told.
#[derive(Clone, Copy, Debug)]
pub struct Known<'a> {
    /// The level axes.
    pub axes: [Vector; 3],
    /// The sky.
    pub sky: Scene,
    /// How much moves.
    pub pace: &'a Pace,
    /// The gyro's rates less their bias, rad/s.
    pub gyro: Option<Vector>,
    /// The sensors' time constant, s.
    pub lag_s: f64,
}

/// What is gathered until the next step.
#[derive(Clone, Copy, Debug, Default)]
struct Window {
    sum: [f64; MAX_SENSORS],
    count: [u16; MAX_SENSORS],
    turned: Vector,
    dt_s: f64,
}

/// One sensor before the witnesses.
#[derive(Clone, Copy, Debug, Default)]
struct Case {
    standing: Standing,
    surprise: f64,
    ahead: u8,
    expected_k: Option<f64>,
    residual_k: Option<f64>,
    near_s: f64,
    /// What it should have shown meanwhile, least and most.
    near_k: Option<(f64, f64)>,
    /// Whether it is far enough off to be left out.
    guilty: bool,
    /// How well all others fit together without it: 1 where there is nothing but noise.
    others_fit: f64,
    doubted_s: f64,
}

impl Case {
    /// Whether it surprises, and is as far from what the others say.
    fn is_suspect(&self) -> bool {
        self.standing != Standing::LeftOut && self.surprise > DOUBT && self.near_s == 0.0
    }
}

/// What there is to blame beside a sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Blames {
    /// The gyro: it is not heard.
    Gyro,
    /// A sky and a ground that change quickly: fog, a cloud, hail.
    Weather,
    /// The pilot, where there is no gyro: the body turns as it has not turned before.
    Pilot,
    /// Two sides at once: a valley. Two opposed sensors are not heard.
    Scene,
}

/// A witness by whom no sensor is to blame, and how much less that surprises.
#[derive(Clone, Debug)]
struct Other {
    blames: Blames,
    witness: Witness,
    surprise: f64,
}

/// The pairs of sensors that look apart.
fn opposed(model: &Model) -> impl Iterator<Item = (usize, usize)> {
    let n = model.sensors();
    let all = (0..n).flat_map(move |i| (i + 1..n).map(move |j| (i, j)));
    all.filter(|(i, j)| dot(model.direction(*i), model.direction(*j)) < OPPOSED)
}

/// The bank.
#[derive(Clone, Debug, Default)]
pub struct Witnesses {
    all: Option<Witness>,
    without: Vec<Witness>,
    /// Those by whom no sensor is to blame.
    others: Vec<Other>,
    cases: [Case; MAX_SENSORS],
    window: Window,
    /// The gyro's rates as the sensors show them.
    shown: Option<Vector>,
    /// The sky's shape: the logarithm of its depth, the share of averaging in radiance; the size of scenes, K; how much the
    /// body turns without a gyro.
    shape: [f64; 6],
}

impl Witnesses {
    /// With room for `sensors`.
    pub fn new(sensors: usize) -> Self {
        Self { without: Vec::with_capacity(sensors), others: Vec::with_capacity(2 + sensors / 2), ..Self::default() }
    }

    /// Where sensor `i` stands.
    pub fn standing(&self, i: usize) -> Standing {
        self.cases[i].standing
    }

    /// What the others say that sensor `i` should show, and what it shows more, K.
    pub fn of(&self, i: usize) -> (Option<f64>, Option<f64>) {
        (self.cases[i].expected_k, self.cases[i].residual_k)
    }

    /// Begins anew with the next step; what was left out stays so.
    pub fn restart(&mut self) {
        self.all = None;
        self.window = Window::default();
        self.shown = None;
    }

    /// Takes in the readings of a frame `dt_s` after the last.
    pub fn update(
        &mut self,
        model: &Model,
        t: &Tuning,
        known: &Known<'_>,
        readings: &[Option<f64>; MAX_SENSORS],
        dt_s: f64,
    ) {
        if !(0.0..GAP_S).contains(&dt_s) || self.shown.is_some() != known.gyro.is_some() {
            self.restart();
        }
        let w = &mut self.window;
        for (i, reading) in readings.iter().enumerate() {
            if let Some(reading) = reading {
                w.sum[i] += reading;
                w.count[i] += 1;
            }
        }
        self.shown = known.gyro.map(|rates| {
            let before = self.shown.unwrap_or(rates);
            let share = -(-dt_s / known.lag_s.max(1e-3)).exp_m1();
            add_scaled(before, share, std::array::from_fn(|i| rates[i] - before[i]))
        });
        w.turned = add_scaled(w.turned, dt_s, self.shown.unwrap_or_default());
        w.dt_s += dt_s;
        if w.dt_s >= STEP_S - 1e-3 && model.sensors() >= FEWEST {
            let window = std::mem::take(w);
            self.step(model, t, known, &window);
        }
    }

    fn step(&mut self, model: &Model, t: &Tuning, known: &Known<'_>, window: &Window) {
        let n = model.sensors();
        let own_k = known.pace.scene_k2.sqrt().max(SCENE.0).max(SCENE.1 * known.sky.contrast_k.abs());
        let [roll, pitch, yaw] = known.pace.rate;
        let now = [known.sky.ln_depth, known.sky.radiance, own_k, roll, pitch, yaw];
        let sound = self.all.iter().chain(&self.without).all(Witness::is_sound);
        if self.all.is_none() || !sound || self.without.len() != n {
            let mut all = Witness::new(known.axes, &known.sky, n, own_k);
            for (i, case) in self.cases.iter_mut().enumerate().take(n) {
                if case.standing == Standing::LeftOut {
                    all = all.deaf_to(i);
                } else {
                    *case = Case::default();
                }
            }
            self.shape = now;
            self.swear(model, all);
            return;
        }
        if self.cases[..n].iter().all(|c| c.surprise < 0.0) {
            let share = -(-window.dt_s / SHAPE_S).exp_m1();
            self.shape.iter_mut().zip(now).for_each(|(s, n)| *s += share * (n - *s));
        }
        let own_k = self.shape[2];
        let gyro = known.gyro.map(|_| window.turned.map(|a| a / window.dt_s));
        let rate = match gyro {
            Some(rates) => rates.map(|r| GYRO.0 + GYRO.1 * r.abs()),
            None => std::array::from_fn(|i| self.shape[3 + i] * t.rate_sigma[i]),
        };
        let motion = gyro.map_or(0.0, |r| r.iter().map(|c| c * c).sum::<f64>().sqrt());
        let keep = (-window.dt_s * (1.0 / t.scene_time_s + motion / t.scene_angle.0)).exp();
        let contrast = known.sky.contrast_k.abs().max(1.0);
        let step = Step {
            dt_s: window.dt_s,
            gyro,
            rate: (rate, t.rate_time_s),
            walk_k: [WALK.0, contrast * WALK.1.max(known.pace.contrast * t.contrast.0)],
            own: (own_k, keep),
            noise_k: t.noise_k,
            sky: Scene { ln_depth: self.shape[0], radiance: self.shape[1], ..known.sky },
        };
        let readings: [Option<f64>; MAX_SENSORS] =
            std::array::from_fn(|i| (window.count[i] > 0).then(|| window.sum[i] / f64::from(window.count[i])));
        let Some(all) = &mut self.all else { return };
        let whole = all.hear(model, &step, &readings);
        let drifting = Step { gyro: None, rate: (t.rate_sigma, t.rate_time_s), ..step };
        let aerobatic = Step { rate: ([AEROBATIC; 3], t.rate_time_s), ..step };
        let changing = Step { walk_k: [QUICK * contrast; 2], ..step };
        for other in &mut self.others {
            let step = match other.blames {
                Blames::Gyro => &drifting,
                Blames::Weather => &changing,
                Blames::Pilot => &aerobatic,
                Blames::Scene => &step,
            };
            let gain = other.witness.hear(model, step, &readings).likelihood - whole.likelihood;
            other.surprise = (other.surprise + gain).clamp(BOUNDS.0, BOUNDS.1);
        }
        let heard = (0..n).filter(|i| readings[*i].is_some() && self.cases[*i].standing != Standing::LeftOut).count();
        let many = if heard > FEWEST { 1.0 } else { SECOND };
        let apart_k = APART.0.max(APART.1 * contrast);
        for (i, witness) in self.without.iter_mut().enumerate() {
            let case = &mut self.cases[i];
            let testimony = if case.standing == Standing::LeftOut {
                whole
            } else {
                let testimony = witness.hear(model, &step, &readings);
                let gain = testimony.likelihood - whole.likelihood;
                case.surprise = (case.surprise + gain).clamp(BOUNDS.0, BOUNDS.1);
                testimony
            };
            case.expected_k = Some(testimony.expected[i]);
            case.residual_k = readings[i].map(|r| r - testimony.expected[i]);
            let far = case.residual_k.is_none_or(|r| r.abs() > apart_k.max(APART.2 * testimony.sigma_k[i]));
            let expected = testimony.expected[i];
            (case.near_s, case.near_k) = match case.near_k {
                _ if far => (0.0, None),
                None => (window.dt_s, Some((expected, expected))),
                Some((least, most)) => (case.near_s + window.dt_s, Some((least.min(expected), most.max(expected)))),
            };
            case.guilty = case.residual_k.is_some_and(|r| r.abs() > many * GUILTY.0.max(GUILTY.1 * contrast));
            case.others_fit += -(-window.dt_s / FIT_S).exp_m1() * (testimony.squared - case.others_fit);
            case.doubted_s = if case.standing == Standing::Doubted { case.doubted_s + window.dt_s } else { 0.0 };
        }
        self.judge(
            model,
            own_k,
            heard >= if gyro.is_some() { FEWEST } else { FEWEST + 1 },
            (many, BACK.0.max(BACK.1 * contrast)),
        );
    }

    /// From surprises to standings.
    fn judge(&mut self, model: &Model, own_k: f64, heard: bool, (many, back_k): (f64, f64)) {
        let n = model.sensors();
        for i in 0..n {
            let case = self.cases[i];
            let moved_k = case.near_k.map_or(0.0, |(least, most)| most - least);
            let back = case.near_s > BACK_S && moved_k > back_k || case.near_s > BACK_AT_LAST_S;
            if case.standing == Standing::LeftOut && back {
                self.cases[i] = Case::default();
                if let Some(all) = self.all.take() {
                    self.swear(model, all.hearing(i, own_k));
                }
                return;
            }
        }
        let small = |c: &Case| c.doubted_s > DOUBT_S && !c.guilty;
        if self.cases[..n].iter().any(small) && !self.cases[..n].iter().any(|c| c.doubted_s > 0.0 && c.guilty) {
            return self.restart();
        }
        // Once one is suspect all are as surprising that might be the cause as well.
        let most = self.cases[..n]
            .iter()
            .filter(|c| c.is_suspect())
            .map(|c| c.surprise)
            .fold(f64::INFINITY, |a, b| if a.is_finite() { a.max(b) } else { b });
        let heard = heard && self.elsewhere() < most - AHEAD;
        let plausible = |c: &Case| heard && c.standing != Standing::LeftOut && c.surprise > most - AHEAD;
        let count = self.cases[..n].iter().filter(|c| plausible(c)).count();
        let mut convicted = None;
        for (i, case) in self.cases[..n].iter_mut().enumerate() {
            let plausible = plausible(case);
            case.ahead = if plausible && count == 1 && case.guilty && case.others_fit < FIT && most > many * CONVICT {
                case.ahead + 1
            } else {
                0
            };
            if case.ahead >= STEPS {
                convicted = Some(i);
            }
            if case.standing != Standing::LeftOut {
                let doubted = plausible && count <= DOUBTED;
                case.standing = if doubted { Standing::Doubted } else { Standing::Heard };
            }
        }
        if let Some(k) = convicted {
            self.cases[k].standing = Standing::LeftOut;
            let all = self.without[k].clone();
            self.swear(model, all);
        }
    }

    /// Whether a sensor surprises, or few do, and it is not decided which is to be left out.
    pub fn undecided(&self) -> bool {
        let most =
            self.cases.iter().filter(|c| c.standing != Standing::LeftOut).map(|c| c.surprise).fold(0.0, f64::max);
        most > self.elsewhere().max(0.0)
    }

    /// How much less the readings surprise where neither sensor is to blame: the gyro is, or the weather.
    fn elsewhere(&self) -> f64 {
        self.others.iter().map(|o| o.surprise).fold(f64::NEG_INFINITY, f64::max)
    }

    /// All witnesses begin with what one of them knows.
    fn swear(&mut self, model: &Model, all: Witness) {
        let n = model.sensors();
        self.without.clear();
        self.without.extend((0..n).map(|i| all.deaf_to(i)));
        for case in &mut self.cases[..n] {
            (case.surprise, case.ahead, case.near_s) = (0.0, 0, 0.0);
            if case.standing == Standing::Doubted {
                case.standing = Standing::Heard;
            }
        }
        self.others.clear();
        let mut other = |blames, witness| self.others.push(Other { blames, witness, surprise: BOUNDS.0 });
        other(if self.shown.is_some() { Blames::Gyro } else { Blames::Pilot }, all.clone());
        other(Blames::Weather, all.clone());
        for (i, j) in opposed(model) {
            other(Blames::Scene, all.deaf_to(i).deaf_to(j));
        }
        self.all = Some(all);
    }
}

#[cfg(test)]
mod tests;
