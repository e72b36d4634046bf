//! What the filter begins with.

use super::aid::Aid;
use super::around::Around;
use super::correct::Misfit;
use super::manoeuvre::Manoeuvre;
use super::moved::Moved;
use super::scene::SceneStrength;
use super::start::{Start, start};
use super::state::{CONTRAST, DEPTH, GROUND, LAG, LEAN, MAX_SENSORS, OFFSET, RADIANCE, RATE, SEEN, State, TURN, VIEW};
use super::{FieldEstimator, Tuning};
use crate::estimator::whiteness::Whiteness;
use crate::time::Time;

/// Half of a sensor's step: what keeps its sign below that is no motion.
const SILENT_K: f64 = 0.01;

/// The largest contrast there is, K: a desert at noon has 75 °C, and the driest zenith −100 °C.
const MOST_CONTRAST_K: f64 = 200.0;

/// How much moves, before it is seen: body rates about the nose and across it, the contrast, the sensors' own scenes.
pub fn paces(t: &Tuning) -> ([Whiteness; 2], [Whiteness; 2], Whiteness, SceneStrength) {
    let rate = Whiteness::new(0.1, (t.rate_learning, t.rate_learning), (0.1, 8.0));
    let contrast = Whiteness::new(0.15, (t.contrast.1, 0.5), (1.0, 200.0)).above(SILENT_K);
    // What a gyro errs by is small beside the readings' noise, and is always the same: it shows over longer, and is learnt
    // slowly, so that a gyro that fails is not taken for a coarse one.
    let gyro = Whiteness::new(0.4, (0.1, 0.05), (0.3, 5.0));
    let both = |w: Whiteness| [w.clone(), w];
    (both(rate), both(gyro), contrast, SceneStrength::new(t.scene.1, t.scene_learning_s))
}

impl FieldEstimator {
    /// Begins with what one frame says; `false` where that is not enough.
    pub(super) fn begin(&mut self, readings: &[Option<f64>; MAX_SENSORS], now: Time) -> bool {
        let start = start(&self.model, readings, self.needed().0, &self.tuning, self.sides.up(now))
            .filter(|start| self.is_of_this_world(start.scene.contrast_k));
        start.inspect(|start| self.begin_with(start, readings, now)).is_some()
    }

    /// Whether a sky can be colder than the ground, or warmer, by `contrast_k`, K. How many kelvin a pair's volts are nobody
    /// may have told.
    pub(super) fn is_of_this_world(&self, contrast_k: f64) -> bool {
        contrast_k.abs() <= MOST_CONTRAST_K || !self.model.is_absolute()
    }

    /// Begins with an attitude and a sky.
    pub(super) fn begin_with(&mut self, start: &Start, readings: &[Option<f64>; MAX_SENSORS], now: Time) {
        let t = self.tuning;
        self.last = Some((now, now));
        self.stuck.iter_mut().for_each(|s| s.begin(now));
        self.aid = Aid::default();
        self.misfit = Misfit::default();
        self.averaging = None;
        self.moved = Moved::default();
        (self.unlike, self.tilted) = (false, false);
        (self.unlike_s, self.found_s, self.off_s, self.askew_s) = (0.0, 0.0, 0.0, 0.0);
        let lately = self.scene.lately_unlike();
        (self.rates, self.gyro_errors, self.contrast, self.scene) = paces(&t);
        self.scene.begin(t.scene.0 * (start.scene.contrast_k.abs() / 35.0).min(1.0), lately);
        self.state = State::new(self.model.sensors());
        let s = &mut self.state;
        s.axes = start.axes;
        s.x[GROUND] = start.scene.ground_c;
        s.x[CONTRAST] = start.scene.contrast_k;
        s.x[DEPTH] = start.scene.ln_depth;
        s.x[RADIANCE] = start.scene.radiance;
        let sigmas = [
            (TURN, 0.1),
            (TURN + 1, 0.1),
            (TURN + 2, 0.1),
            (GROUND, 2.0),
            (CONTRAST, (0.15 * start.scene.contrast_k).hypot(1.0)),
            (DEPTH, t.depth.1),
            (RADIANCE, t.radiance.1),
            (VIEW, t.spread),
            (OFFSET, t.offset.0),
            (OFFSET + 1, t.offset.0),
        ];
        for (i, sigma) in sigmas {
            s.set_variance(i, sigma * sigma);
        }
        for (i, reading) in readings.iter().enumerate().take(self.model.sensors()) {
            let plain = self.model.seen(i, &s.axes, &start.scene).value;
            s.plain[i] = plain;
            s.x[SEEN + i] = reading.unwrap_or(plain);
            s.set_variance(SEEN + i, 1.0);
            s.set_variance(s.scene(i), self.scene.variance());
        }
        self.vertical_lately = self.state.vertical();
        self.set_form();
        self.set_rates();
    }

    /// Rates without a gyro, which begin at zero, or a gyro's bias. What only a gyro can tell goes with it, but for how
    /// slow the sensors are.
    pub(super) fn set_rates(&mut self) {
        let (bias, lag) = if self.gyro.in_use() { (self.bias_seen(), self.lag) } else { Default::default() };
        let (t, s, gyro) = (&self.tuning, &mut self.state, self.gyro.in_use());
        for (i, bias) in bias.into_iter().enumerate() {
            s.x[RATE + i] = -bias;
            s.set_variance(RATE + i, (if gyro { t.bias.0 } else { t.rate_sigma[i] }).powi(2));
        }
        for i in LEAN..LEAN + 2 {
            s.x[i] = 0.0;
            s.set_variance(i, if gyro { t.lean.0.powi(2) } else { 0.0 });
        }
        (s.lean2, s.lean_mean) = (t.lean.0.powi(2), [0.0; 2]);
        (self.leant, self.told) = (false, false);
        self.turned = 0.0;
        self.around = Around::default();
        self.manoeuvre = Manoeuvre::default();
        s.x[LAG] = lag;
        s.set_variance(LAG, if gyro { t.lag_sigma.powi(2) } else { 0.0 });
        self.set_askew();
        self.set_errors();
    }
}
