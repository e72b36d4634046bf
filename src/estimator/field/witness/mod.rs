//! Which sensor is not to be heard: witnesses who each leave one out.
//!
//! A bank of small filters beside the main one: one hears every sensor, the others all but one. While all sensors
//! tell of one sky, the first explains what it hears best. When one sensor goes its own way, all witnesses that hear
//! it are surprised, and the one that does not is not: the sums of their surprises tell which sensor that is, and
//! what it should show.
//!
//! - `filter`: a witness; `case`: what speaks against one sensor; `follow`: whether it follows what it should show; `film`:
//!   whether it shows its own die; `other`: what else there is to blame;
//! - `steady`: whether the sky is as it was, but for one sensor;
//! - `judge`: from surprises to standings; `rival`: whether it was the sensor on the other side.

mod case;
mod film;
mod filter;
mod follow;
mod judge;
mod other;
mod rival;
mod steady;

use super::gyro::shown;
use super::model::{Model, Scene};
use super::predict::Pace;
use super::start::Start;
use super::state::MAX_SENSORS;
use super::tuning::Tuning;
use crate::attitude::Attitude;
use crate::estimator::Standing;
use crate::estimator::vector::{Vector, add_scaled};
use case::{Case, Heard};
use filter::{Step, Witness};
use judge::is_upright;
pub use judge::level_pairs;
use other::Other;
use rival::Rival;
use steady::SteadySky;

/// Readings are averaged over this time before witnesses hear them, s.
const STEP_S: f64 = 0.05;
/// A pause longer than this begins anew, s.
const GAP_S: f64 = 2.0;
/// A sum of surprises never falls below, nor rises above.
const BOUNDS: (f64, f64) = (-5.0, 300.0);
/// The sky's shape is followed over this time, s, and not while any sensor surprises.
const SHAPE_S: f64 = 5.0;
/// As many sensors must be heard for one to be doubted.
const FEWEST: usize = 5;
/// A scene's least size, K and as a share of the contrast; and under an even sky, where a film is seen the sooner.
const SCENE: (f64, f64) = (0.25, 0.005);
const EVEN_SCENE: (f64, f64) = (0.1, 0.002);
/// Scenes that have become so many times stronger than they usually are may be what one sensor does.
const NEW: f64 = 2.0;
/// Walks of ground, K, and contrast, as a share of it, for a second.
const WALK: (f64, f64) = (0.5, 0.1);
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
    /// Whether that has been seen to turn rightly.
    pub proven: bool,
    /// How strong scenes usually are, K.
    pub usual_k: f64,
    /// Whether hardly any has been seen, for long enough.
    pub even: bool,
    /// Noise of a reading, K.
    pub noise_k: f64,
    /// The sensors' time constant, s.
    pub lag_s: f64,
    /// The temperature of each sensor's die, °C, where it is read.
    pub ambient_c: [Option<f64>; MAX_SENSORS],
}

/// What is gathered until the next step.
#[derive(Clone, Copy, Debug, Default)]
struct Window {
    sum: [f64; MAX_SENSORS],
    count: [u16; MAX_SENSORS],
    turned: Vector,
    dt_s: f64,
}

/// The bank.
#[derive(Clone, Debug, Default)]
pub struct Witnesses {
    all: Option<Witness>,
    without: Vec<Witness>,
    /// Those by whom no sensor is to blame.
    others: Vec<Other>,
    /// Those by whom the sky is as it was, where there is no gyro.
    steady: SteadySky,
    cases: [Case; MAX_SENSORS],
    /// The other verdict beside the last.
    rival: Option<Rival>,
    /// What is to be believed from now on, after the other verdict has been found right.
    revised: Option<Start>,
    window: Window,
    /// The gyro's rates as the sensors show them.
    shown: Option<Vector>,
    /// The sky's shape: the logarithm of its depth, how much is averaged in radiance, the field of view; the size of scenes, K;
    /// how much the body turns without a gyro.
    shape: [f64; 9],
    /// Whether the sky is even, and no gyro tells of turns.
    even: bool,
}

impl Witnesses {
    /// With room for `sensors`.
    pub fn new(sensors: usize) -> Self {
        Self {
            without: Vec::with_capacity(sensors),
            others: Vec::with_capacity(2 + sensors / 2),
            steady: SteadySky::new(sensors),
            ..Self::default()
        }
    }

    /// Where sensor `i` stands.
    pub fn standing(&self, i: usize) -> Standing {
        self.cases[i].standing
    }

    /// What the others say that sensor `i` should show, and what it shows more, K.
    pub fn of(&self, i: usize) -> (Option<f64>, Option<f64>) {
        (self.cases[i].expected_k, self.cases[i].residual_k)
    }

    /// How much sensor `i` does not follow of what it should show, 0..1; where it is heard, or nothing has changed, nobody
    /// knows.
    pub fn lost(&self, i: usize) -> Option<f64> {
        self.cases[i].lost()
    }

    /// How surely sensor `i`, which is not heard, goes another way than it should, as no film does: 0..1.
    pub fn strays(&self, i: usize) -> f64 {
        self.cases[i].strays()
    }

    /// Whether sensor `i` is left out and shows its die as it never did before: it is that one.
    pub fn sees_film(&self, i: usize) -> bool {
        self.cases[i].standing == Standing::LeftOut && self.cases[i].shows_die_anew()
    }

    /// Whether nothing is amiss but sensor `i`, which is left out.
    pub fn blames_only(&self, i: usize) -> bool {
        self.cases[i].standing == Standing::LeftOut && self.cases[i].is_all_there_is()
    }

    /// Whether a film that grows on one that looks up or down, where no wall comes, may be all that is amiss.
    pub fn may_see_film(&self, model: &Model) -> bool {
        (0..model.sensors()).any(|i| is_upright(model, i) && self.cases[i].may_have_film())
    }

    /// What attitude and sky are, once another sensor than before is found to be to blame.
    pub fn revised(&mut self) -> Option<Start> {
        self.revised.take()
    }

    /// How far roll and pitch may be off as another sensor may be to blame than the one left out, rad.
    pub fn spread(&self) -> Attitude {
        let (Some(all), Some(rival)) = (&self.all, &self.rival) else { return Attitude::default() };
        rival.spread(all.up())
    }

    /// Begins anew with the next step; what was left out stays so.
    pub fn restart(&mut self) {
        self.all = None;
        self.rival = None;
        self.window = Window::default();
        self.shown = None;
    }

    /// Nothing of what was said against any sensor holds.
    pub fn acquit(&mut self) {
        self.cases = Default::default();
        self.restart();
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
            self.steady.forget();
        }
        let w = &mut self.window;
        for (i, reading) in readings.iter().enumerate() {
            if let Some(reading) = reading {
                w.sum[i] += reading;
                w.count[i] += 1;
            }
        }
        self.shown = known.gyro.map(|rates| shown(self.shown.unwrap_or(rates), rates, dt_s, known.lag_s));
        w.turned = add_scaled(w.turned, dt_s, self.shown.unwrap_or_default());
        w.dt_s += dt_s;
        if w.dt_s >= STEP_S - 1e-3 && model.sensors() >= FEWEST {
            let window = std::mem::take(w);
            self.step(model, t, known, &window);
        }
    }

    fn step(&mut self, model: &Model, t: &Tuning, known: &Known<'_>, window: &Window) {
        let n = model.sensors();
        // Beside a gyro no film is taken for a turn meanwhile, and a wall must not be taken for a film.
        self.even = known.gyro.is_none() && known.even;
        let (least_k, share) = if self.even { EVEN_SCENE } else { SCENE };
        let least_k = least_k.max(share * known.sky.contrast_k.abs());
        let own_k = known.pace.scene_k2.sqrt().min(NEW * known.usual_k).max(least_k);
        let [roll, pitch, yaw] = known.pace.rate;
        let [spread, one, other] = known.sky.view;
        let now = [known.sky.ln_depth, known.sky.radiance, spread, one, other, own_k, roll, pitch, yaw];
        let rival = self.rival.as_ref().map(|r| &r.witness);
        let sound = self.all.iter().chain(&self.without).chain(rival).all(Witness::is_sound);
        if self.all.is_none() || !sound || self.without.len() != n {
            let mut all = Witness::new(known.axes, &known.sky, n, own_k);
            for (i, case) in self.cases.iter_mut().enumerate().take(n) {
                if case.standing == Standing::LeftOut {
                    all = all.deaf_to(i);
                } else {
                    *case = case.anew();
                }
            }
            (self.shape, self.rival) = (now, None);
            self.swear(model, all);
            return;
        }
        if self.cases[..n].iter().all(|c| c.surprise < 0.0) {
            let share = -(-window.dt_s / SHAPE_S).exp_m1();
            self.shape.iter_mut().zip(now).for_each(|(s, n)| *s += share * (n - *s));
        }
        let [ln_depth, radiance, spread, one, other, own_k, turning @ ..] = self.shape;
        let gyro = known.gyro.map(|_| window.turned.map(|a| a / window.dt_s));
        let rate = match gyro {
            Some(rates) => rates.map(|r| GYRO.0 + GYRO.1 * r.abs()),
            None => std::array::from_fn(|i| turning[i] * t.rate_sigma[i]),
        };
        let motion = gyro.map_or(0.0, |r| r.iter().map(|c| c * c).sum::<f64>().sqrt());
        let keep = (-window.dt_s * (1.0 / t.scene_time_s + motion / t.scene_angle)).exp();
        let contrast = known.sky.contrast_k.abs().max(1.0);
        let step = Step {
            dt_s: window.dt_s,
            gyro,
            proven: known.proven,
            rate: (rate, t.rate_time_s),
            walk_k: [WALK.0, contrast * WALK.1.max(known.pace.contrast * t.contrast.0)],
            own: (own_k, keep),
            noise_k: known.noise_k,
            sky: Scene { ln_depth, radiance, view: [spread, one, other], ..known.sky },
        };
        let readings: [Option<f64>; MAX_SENSORS] =
            std::array::from_fn(|i| (window.count[i] > 0).then(|| window.sum[i] / f64::from(window.count[i])));
        if gyro.is_none() && self.disbelieves_change(model, known, &step, &readings) {
            return;
        }
        let Some(all) = &mut self.all else { return };
        let whole = all.hear(model, &step, &readings);
        for other in &mut self.others {
            other.hear(model, &step, &readings, t, whole.likelihood);
        }
        let heard = (0..n).filter(|i| readings[*i].is_some() && self.cases[*i].standing != Standing::LeftOut).count();
        let second = heard <= FEWEST;
        for (i, witness) in self.without.iter_mut().enumerate() {
            let case = &mut self.cases[i];
            let (reading, ambient_c, ground_c) = (readings[i], known.ambient_c[i], known.sky.ground_c);
            let heard = Heard { reading, ambient_c, dt_s: window.dt_s, contrast, ground_c, second };
            if case.standing == Standing::LeftOut {
                case.hear(i, &heard, &whole);
            } else {
                let testimony = witness.hear(model, &step, &readings);
                case.surprise += testimony.likelihood - whole.likelihood;
                case.hear(i, &heard, &testimony);
            }
        }
        self.bound();
        if let Some(rival) = &mut self.rival {
            rival.hear(model, &step, &readings, whole.expected[rival.left_out]);
            if self.reconsider(model, &step.sky) {
                return;
            }
        }
        let enough = heard >= if gyro.is_some() { FEWEST } else { FEWEST + 1 };
        self.judge(model, own_k, enough, second);
    }

    /// Keeps the sums within bounds. Where all others fit without the one that leads they stay as far apart as they are: who it
    /// is is to be seen however much surprises. At a wall, in a valley, none fits, and all come to the bound.
    fn bound(&mut self) {
        let most = self.cases.iter().map(|c| c.surprise).fold(BOUNDS.1, f64::max);
        let fits = self.cases.iter().any(|c| c.surprise >= most && c.explains_all());
        let over = if fits { most - BOUNDS.1 } else { 0.0 };
        let others = self.others.iter_mut().map(|o| &mut o.surprise);
        let heard = self.cases.iter_mut().filter(|c| c.standing != Standing::LeftOut);
        let sums = heard.map(|c| &mut c.surprise).chain(others);
        sums.for_each(|sum| *sum = (*sum - over).clamp(BOUNDS.0, BOUNDS.1));
    }

    /// All witnesses begin with what one of them knows.
    fn swear(&mut self, model: &Model, all: Witness) {
        let n = model.sensors();
        self.without.clear();
        self.without.extend((0..n).map(|i| all.deaf_to(i)));
        self.cases[..n].iter_mut().for_each(Case::reopen);
        self.others.clear();
        self.others.extend(Other::all(model, &all, self.shown.is_some()));
        self.all = Some(all);
    }
}

#[cfg(test)]
mod tests;
