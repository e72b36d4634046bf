//! Every sensor by itself: attitude, ground, contrast and the sky's shape estimated together.
//!
//! An extended Kalman filter on the turn of the body, with the sky, the sensors' lag and what each sees
//! of a scene of its own among its states. The work is the same for every frame; nothing iterates but
//! the start, and that is bounded.
//!
//! - `state`: the states and their covariance; `tuning`: what the world is taken to be like;
//! - `model`: what a sensor should show; `start`, `begin`: where the filter begins;
//! - `look`: whether there is anything to see; `hear`: which readings are heard; `witness`: which sensor is not;
//! - `predict`: from frame to frame; `rates`: how fast it turns; `correct`: what the readings say; `directions`: what they
//!   look like;
//! - `scene`: how strong the sensors' own scenes are; `beneath`: how much of them lies on the ground; `noise`: how noisy the
//!   readings are;
//! - `around`: how far around it has looked; `change`: a scene that comes nearer; `doubt`: one that is found not to be alike
//!   all around; `lean`: how far its horizon is expected to lean;
//! - `form`: sensors that see in another form than said; `averaging`: how much they average in radiance; `calibration`:
//!   how far they are off; `expected`: states of which more is expected later;
//! - `stuck`: a sensor that always says the same; `gyro`: body rates, and when to believe them; `turns`: whether they turn as
//!   is seen; `drift`: a bias that has changed; `carried`: where they turn what was given before; `askew`: a gyro whose axes
//!   are not the head's; `rest`: whether what is seen moves;
//! - `aid`: the slow references; `reference_noise`: how much these are off;
//! - `unheard`: what a sensor left out might have been right about; `misjudged`: whether it is the wrong one;
//!   `alone`: what one tells whose opposite is not heard;
//! - `solution`: what is said of the attitude; `output`: angles and standard deviations.

mod aid;
mod alone;
mod around;
mod askew;
mod averaging;
mod begin;
mod beneath;
mod calibration;
mod carried;
mod change;
mod correct;
mod directions;
mod doubt;
mod drift;
mod expected;
mod form;
mod gyro;
mod hear;
mod hint;
mod lean;
mod look;
mod manoeuvre;
mod misjudged;
mod model;
mod moved;
mod noise;
mod output;
mod predict;
mod rates;
mod reference_noise;
mod rest;
mod scene;
mod solution;
mod start;
mod state;
mod stuck;
mod tuning;
mod turns;
mod unheard;
mod witness;

pub use state::MAX_SENSORS;
pub use tuning::Tuning;

use super::contrast_vector::ContrastSolver;
use super::sides::Sides;
use super::vector::{Vector, dot};
use super::whiteness::Whiteness;
use super::{Estimator, Solution};
use crate::attitude::Attitude;
use crate::frame::Frame;
use crate::head::Head;
use crate::sky::FieldOfView;
use crate::time::Time;
use aid::Aid;
use alone::Alone;
use around::Around;
use begin::paces;
use beneath::Beneath;
use carried::Carried;
use change::SceneChange;
use correct::Misfit;
use form::Form;
use gyro::Gyro;
use manoeuvre::Manoeuvre;
use model::Model;
use moved::Moved;
use noise::NoiseLevel;
use predict::{Pace, predict};
use rates::{correction, rates};
use scene::SceneStrength;
use state::{CONTRAST, LEAN, State};
use stuck::Stuck;
use turns::Turns;
use witness::Witnesses;

/// A frame later than this after the last begins anew, s.
const GAP_S: f64 = 2.0;
/// Without enough sensors the attitude is carried so long, s: by a motion model, by a gyro.
const CARRIED_S: (f64, f64) = (0.1, 1.0);
/// So long what is seen must be against all that is known for it to begin anew, s: in that time a sensor that films over
/// is found out.
const LOST_S: f64 = 0.5;
/// What the scene might hide before that fades in this time, s.
const HIDDEN_S: f64 = 10.0;
/// No more than that, rad: a moment's glare is no wall, and so much is withheld anyhow.
const MOST_HIDDEN: f64 = std::f64::consts::FRAC_PI_4;

/// The estimator of method `field`. For absolute sensors, five at least; pairs' channels are taken as
/// they come, three at least.
#[derive(Clone, Debug)]
pub struct FieldEstimator {
    model: Model,
    tuning: Tuning,
    state: State,
    /// The last frame, and the last with enough readings.
    last: Option<(Time, Time)>,
    stamps: [Option<Time>; MAX_SENSORS],
    /// What was heard of each at its stamp.
    latest: [Option<f64>; MAX_SENSORS],
    /// The die of each then, °C.
    ambient_c: [Option<f64>; MAX_SENSORS],
    stuck: [Stuck; MAX_SENSORS],
    is_stuck: [bool; MAX_SENSORS],
    witnesses: Witnesses,
    /// The pairs of the head, solved in each frame by themselves.
    pairs: ContrastSolver,
    head: Head,
    sides: Sides,
    seen_k: Option<f64>,
    /// When a frame was last solved by itself, if that showed no contrast.
    nothing_at: Option<Time>,
    /// Since when there is no contrast to see by, or one that is upside down; whether that has lasted.
    blind_since: Option<Time>,
    blind: bool,
    /// Since when there is a contrast again.
    back_at: Option<Time>,
    undecided_since: Option<Time>,
    gyro: Gyro,
    carried: Carried,
    turns: Turns,
    aid: Aid,
    /// Body rates about the nose, and across it.
    rates: [Whiteness; 2],
    /// The errors of a gyro about the same.
    gyro_errors: [Whiteness; 2],
    contrast: Whiteness,
    scene: SceneStrength,
    change: SceneChange,
    noise: NoiseLevel,
    misfit: Misfit,
    /// The scene has been found to be unlike a sky that is alike all around.
    unlike: bool,
    /// And the attitude has been doubted for it.
    tilted: bool,
    /// The horizon has been found to lean farther than expected.
    leant: bool,
    /// How it leans is known from slow references, heard lately or not long ago.
    told: bool,
    /// For how long one of these is being found, s.
    found_s: f64,
    /// For how long it has shown that the sensors are off, s.
    off_s: f64,
    /// For how long it has shown that a gyro's axes are askew, s.
    askew_s: f64,
    /// Whether they see in another form than said.
    form: Form,
    /// For how long what is seen has been against all that is known, s.
    lost_s: f64,
    /// For how long the scene has been unlike, less for how long it has not been since, s.
    unlike_s: f64,
    /// The variance of how much is averaged in radiance, while that cannot be told.
    averaging: Option<f64>,
    /// For how long, with a sensor left out, the others have told of what is no sky, s.
    astray_s: f64,
    /// Who tells alone.
    alone: Alone,
    /// For how long one reading has been far from what it was predicted, s.
    glitch_s: f64,
    /// Without a gyro, whether one begins.
    manoeuvre: Manoeuvre,
    /// How far it has turned about the vertical since it began, rad.
    turned: f64,
    /// How far around it has looked since it began.
    around: Around,
    /// Where the upward vertical has been lately, on (nose, left, up).
    vertical_lately: Vector,
    /// How much of what makes the scene unlike an even sky lies on the ground.
    beneath: Beneath,
    /// How far the sky's shape has moved.
    moved: Moved,
    /// The tilt that the scene might hide before it began anew, rad.
    hidden_before: f64,
    /// The logarithm of the sensors' time constant over the configured one, as a gyro has shown it.
    lag: f64,
}

impl FieldEstimator {
    /// For `head`, of which the first [`MAX_SENSORS`] are used, with the field of view of each. Makes its
    /// tables in a few milliseconds; nothing is allocated after that.
    pub fn new(head: &Head, field: FieldOfView, tuning: Tuning) -> Self {
        let model = Model::new(head, field);
        let (rates, gyro_errors, contrast, scene) = paces(&tuning);
        Self {
            state: State::new(model.sensors()),
            is_stuck: [false; MAX_SENSORS],
            witnesses: Witnesses::new(model.sensors()),
            pairs: ContrastSolver::new(head),
            head: head.clone(),
            sides: Sides::default(),
            seen_k: None,
            nothing_at: None,
            blind_since: None,
            blind: false,
            back_at: None,
            undecided_since: None,
            model,
            tuning,
            last: None,
            stamps: [None; MAX_SENSORS],
            latest: [None; MAX_SENSORS],
            ambient_c: [None; MAX_SENSORS],
            stuck: [Stuck::default(); MAX_SENSORS],
            gyro: Gyro::default(),
            carried: Carried::default(),
            turns: Turns::default(),
            aid: Aid::default(),
            rates,
            gyro_errors,
            contrast,
            scene,
            change: SceneChange::default(),
            noise: NoiseLevel::new(tuning.noise_k),
            misfit: Misfit::default(),
            unlike: false,
            tilted: false,
            leant: false,
            told: false,
            found_s: 0.0,
            off_s: 0.0,
            askew_s: 0.0,
            form: Form::default(),
            lost_s: 0.0,
            unlike_s: 0.0,
            averaging: None,
            astray_s: 0.0,
            alone: Alone::default(),
            glitch_s: 0.0,
            manoeuvre: Manoeuvre::default(),
            turned: 0.0,
            around: Around::default(),
            vertical_lately: [0.0, 0.0, 1.0],
            beneath: Beneath::default(),
            moved: Moved::default(),
            hidden_before: 0.0,
            lag: 0.0,
        }
    }

    /// How strong the sensors' own scenes are taken to be, K.
    pub fn scene_k(&self) -> f64 {
        self.scene.variance().sqrt()
    }

    /// How many readings a frame needs to begin with; to go on with, where the sky is known.
    fn needed(&self) -> (usize, usize) {
        if self.model.is_absolute() { (5, 4) } else { (3, 3) }
    }

    /// How much moves from this frame to the next.
    fn pace(&self) -> Pace {
        Pace {
            // Where scenes explain what a turn would, calm is not seen either.
            rate: [0, 1, 1].map(|i: usize| self.rates[i].factor().max(self.scene.unlike())),
            gyro: [0, 1, 1].map(|i: usize| self.gyro_errors[i].factor()),
            gyro_walk: self.gyro.walk(),
            contrast: self.contrast.factor(),
            scene_k2: self.scene.variance(),
            scene_change_k2_s: if self.gyro.in_use() { self.change.variance_s() } else { 0.0 },
            lean_walk: self.lean_walk(),
            depth_walk: self.depth_walk(),
            long_unlike: self.scene.long_unlike(),
        }
    }

    /// Carries what is known to a frame at `now`, `dt_s` after the last, and considers what its readings are worth.
    fn carry(&mut self, readings: &mut [Option<f64>; MAX_SENSORS], now: Time, dt_s: f64) {
        let pace = self.pace();
        predict(&mut self.state, &self.model, &self.tuning, dt_s, self.gyro.rates(), &pace);
        self.turned += dt_s * self.gyro.rates().map_or(0.0, |r| dot(r, self.state.vertical()).abs());
        self.around.update(dt_s * self.heading_rate(), self.state.vertical()[1], dt_s);
        self.tell_lag(dt_s);
        self.consult(readings, &pace, (now, dt_s));
        self.leave_out(readings, dt_s);
        self.consider_averaging(now);
        self.learn(readings, dt_s);
        self.doubt_form(readings, now, dt_s);
        self.doubt(now, dt_s);
        self.doubt_axes(dt_s);
        self.calibrate(dt_s);
    }
}

impl Estimator for FieldEstimator {
    fn judges_rates(&self) -> bool {
        true
    }

    fn rate_correction(&self) -> Option<Vector> {
        if self.gyro.in_use() { Some(correction(&self.state)) } else { self.gyro.heard().is_none().then_some([0.0; 3]) }
    }

    fn rates(&self) -> Option<Vector> {
        Some(rates(&self.state, &self.tuning, self.gyro.rates()))
    }

    fn set_trim(&mut self, trim: Attitude) {
        let turned = self.gyro.set_trim(trim);
        self.turn_axes(turned);
    }

    fn set_lag_s(&mut self, lag_s: f64) {
        if (0.0..=5.0).contains(&lag_s) {
            // What was learnt is a multiple of it.
            self.lag = if lag_s == self.tuning.lag_s { self.lag } else { 0.0 };
            self.tuning.lag_s = lag_s;
        }
    }

    fn update(&mut self, frame: &Frame) -> Solution {
        let (mut readings, Some(now)) = self.readings(frame) else { return Solution::default() };
        let dt_s = self.last.map_or(f64::INFINITY, |(last, _)| now.since(last));
        let contradicted = self.gyro.in_use() && self.turns.contradict();
        if contradicted {
            self.unlearn();
        }
        let misjudged = self.misjudged(dt_s);
        if misjudged {
            self.witnesses.acquit();
        }
        if self.gyro.update(&frame.aiding, now, dt_s, self.turns.contradict()) {
            self.set_rates();
        }
        self.carry_on(now);
        self.sides.carry(self.turning().filter(|_| dt_s < GAP_S).map(|rates| rates.map(|r| r * dt_s)));
        // What one sensor does must not be taken for the attitude, or for the gyro.
        let hidden = self.gyro.in_use().then(|| self.hidden(self.scene.seen_k()));
        let leans = if self.told { self.state.x[LEAN].hypot(self.state.x[LEAN + 1]) } else { 0.0 };
        let against = self.misfit.is_lost(self.state.x[CONTRAST], leans, hidden) && !self.undecided(now);
        self.lost_s = if against { self.lost_s + dt_s.clamp(0.0, 1.0) } else { 0.0 };
        let lost = self.lost_s > LOST_S;
        if lost {
            self.gyro.distrust();
            self.carried.doubt();
        }
        // A wall is still there when it begins anew.
        let hides = if lost { self.may_hide(f64::INFINITY).min(MOST_HIDDEN) } else { 0.0 };
        self.hidden_before = hides.max(self.hidden_before * (-dt_s.max(0.0) / HIDDEN_S).exp());
        if lost || contradicted || misjudged || !(0.0..GAP_S).contains(&dt_s) {
            let begun = self.begin(&self.lately(&readings, now), now);
            if begun {
                self.consider_averaging(now);
                self.look(frame, now);
            } else {
                self.last = None;
            }
            return if begun { self.said() } else { Solution::default() };
        }
        let enough = self.lately(&readings, now).iter().flatten().count() >= self.needed().1;
        let (_, full) = self.last.unwrap_or((now, now));
        let full = if enough { now } else { full };
        self.last = Some((now, full));
        if dt_s > 0.0 {
            self.carry(&mut readings, now, dt_s);
        }
        self.compare_turns(&readings, now);
        self.watch_bias(dt_s);
        self.correct(&readings, dt_s);
        self.watch_horizon(dt_s);
        self.find_alone(&readings, now, dt_s);
        self.look(frame, now);
        self.aid.update(&frame.aiding, &mut self.state, &self.tuning, (now, dt_s), self.gyro.rates());
        let carried_s = if self.gyro.in_use() { CARRIED_S.1 } else { CARRIED_S.0 };
        if !(self.state.is_sound() && self.is_of_this_world(self.state.x[CONTRAST])) {
            self.last = None;
            return Solution::default();
        }
        if now.since(full) > carried_s { Solution::default() } else { self.said() }
    }
}

#[cfg(test)]
mod tests;
