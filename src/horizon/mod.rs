//! The core put together: a frame goes in, an estimate comes out. The daemon and `replay` run this.
//!
//! - `build`: the estimator that the settings ask for;
//! - [`mounting`]: from the head's axes to the airframe's;
//! - `lack`: whether a sensor's fault withholds it;
//! - [`output`]: what is said of it, also while it cannot be trusted: `continuity`, `sigma_limit`, `stand_in`.

mod build;
mod continuity;
mod lack;
pub mod mounting;
pub mod output;
mod sigma_limit;
mod stand_in;

use crate::attitude::{Attitude, Estimate, Mode};
use crate::config::Settings;
use crate::config::settings::Method;
use crate::estimator::trim::Learner;
use crate::estimator::vector::Vector;
use crate::estimator::{Estimator, Standing};
use crate::fault::erratic::ErraticSensors;
use crate::fault::{ActiveFault, Detectors, FaultKind};
use crate::frame::{Frame, Missing};
use crate::head::Head;
use lack::Lack;
use mounting::Mounting;
use output::{Output, Verdict};

/// The largest roll given, rad.
enum RollLimit {
    /// There is none.
    None,
    /// The method has it built in.
    BuiltIn(f64),
    /// It is put on the method's roll.
    Here(f64),
}

/// An estimator beside the fault detectors.
pub struct Horizon {
    estimator: Box<dyn Estimator>,
    detectors: Detectors,
    head: Head,
    erratic: ErraticSensors,
    lack: Lack,
    /// What the attitude was withheld for last.
    withheld_for: Vec<ActiveFault>,
    /// A frame without what cannot be, and that without the sensors that are stuck.
    possible: Frame,
    heard: Frame,
    /// The airframe's attitude, as the method had it last, and its standard deviation; none while a fault withholds it.
    last: Option<(Attitude, Attitude)>,
    mounting: Mounting,
    roll_limit: RollLimit,
    /// The configuration says the sensors' lag.
    lag_said: bool,
    /// What the configured trim leaves; `None` where that is not to be learnt.
    learner: Option<Learner>,
    output: Output,
}

impl Horizon {
    /// For `head` as `settings` say.
    pub fn new(settings: &Settings, head: Head) -> Self {
        let f = &settings.faults;
        let method = settings.estimator.method_for(&head);
        let built_in = method == Method::InverseSine;
        let limit_deg = settings.estimator.roll_limit_deg_for(method);
        let trim = Attitude::from_degrees(settings.head.roll_trim_deg, settings.head.pitch_trim_deg);
        let mut estimator = build::estimator(settings, method, &head);
        estimator.set_trim(trim);
        Self {
            estimator,
            mounting: if built_in { Mounting::Offset(trim) } else { Mounting::Turned(trim) },
            roll_limit: match limit_deg {
                ..=0.0 => RollLimit::None,
                // As the method reckons it, but for its last digits.
                _ if built_in => RollLimit::BuiltIn(limit_deg.to_radians() * (1.0 - 1e-9)),
                _ => RollLimit::Here(limit_deg.to_radians()),
            },
            lag_said: settings.head.lag_s.is_some(),
            detectors: Detectors::new(f, &head),
            erratic: ErraticSensors::new(&head),
            lack: Lack::new(f.back_after_s),
            withheld_for: Vec::with_capacity(2 * head.sensors.len() + head.buses.len() + 8),
            possible: Frame::new(head.sensors.len()),
            heard: Frame::new(head.sensors.len()),
            head,
            last: None,
            learner: (settings.head.learn_trim && !built_in).then(Learner::default),
            output: Output::new(f),
        }
    }

    /// Takes up trims, thresholds and what is done on a fault, and forgets nothing of what has been seen.
    pub fn retune(&mut self, settings: &Settings) {
        let trim = Attitude::from_degrees(settings.head.roll_trim_deg, settings.head.pitch_trim_deg);
        match &mut self.mounting {
            Mounting::Offset(t) => *t = trim,
            // What was learnt was learnt of the old trim.
            Mounting::Turned(t) if *t != trim => {
                *t = trim;
                self.learner = self.learner.as_ref().map(|_| Learner::default());
            }
            Mounting::Turned(_) => {}
        }
        let learnt = self.learner.as_ref().map_or_else(Attitude::default, Learner::trim);
        self.estimator.set_trim(Attitude { roll: trim.roll + learnt.roll, pitch: trim.pitch + learnt.pitch });
        self.detectors.retune(&settings.faults);
        self.lack.retune(settings.faults.back_after_s);
        self.output.retune(&settings.faults);
    }

    /// The time constant that the sensors say they have, s; what the configuration says stays.
    pub fn set_lag_s(&mut self, lag_s: f64) {
        if !self.lag_said {
            self.estimator.set_lag_s(lag_s);
        }
    }

    /// Whether it is told if the body rates of a gyro are those that are seen.
    pub fn judges_rates(&self) -> bool {
        self.estimator.judges_rates()
    }

    /// What is to be added to the body rates of a gyro, rad/s on the head's (nose, left, up); `None` where they are not
    /// believed.
    pub fn rate_correction(&self) -> Option<Vector> {
        self.estimator.rate_correction()
    }

    /// The largest roll given, rad.
    pub fn roll_limit(&self) -> f64 {
        match self.roll_limit {
            RollLimit::None => f64::INFINITY,
            RollLimit::BuiltIn(limit) | RollLimit::Here(limit) => limit,
        }
    }

    /// Takes in `frame`, with the reason for which each bus is down, and brings `estimate` up to
    /// date.
    ///
    /// An attitude is given only where the method has one and no detector as much as suspects it.
    /// A frame that gives none without being a fault (one missed read) leaves the estimate with its
    /// old stamp: publishers send nothing new. Too many of them in a row are `stale`.
    pub fn update(&mut self, frame: &Frame, buses_down: &[Option<Missing>], estimate: &mut Estimate) {
        self.hear(frame);
        let solution = self.estimator.update(&self.heard);
        let trusted = self.detectors.update(&self.possible, &solution, buses_down);
        let left_out = solution.sensors.iter().any(|s| s.standing != Standing::Heard);
        let doubt = self.detectors.compare(self.last, left_out, frame);
        estimate.faults.clear();
        self.detectors.report(&mut estimate.faults);
        estimate.residuals_k.clear();
        let sensors = solution.sensors.iter().map(|s| s.residual_k);
        estimate.residuals_k.extend(sensors.take(self.head.sensors.len()));
        estimate.hint = solution.hint.filter(|_| trusted);
        if solution.contrast_k.is_some() {
            estimate.contrast_k = solution.contrast_k;
        }

        let solved = solution.attitude.is_some();
        let stands = estimate.faults.iter().any(|f| f.kind.is_of_sensors());
        let lacks = self.lack.update(stands, solved, self.detectors.name_all_missing(&self.possible), frame.time);
        let verdict = match solution.attitude {
            _ if lacks => Verdict::Withheld,
            Some(seen) if trusted => self.given(seen, solution.sigma, doubt, frame, estimate),
            None if trusted && estimate.faults.is_empty() => Verdict::Nothing,
            _ if estimate.faults.iter().any(|f| self.detectors.withholds(f.kind)) => Verdict::Withheld,
            // Suspected, not yet a fault; or one missed read beside one.
            _ => Verdict::Nothing,
        };
        self.output.update(verdict, frame.time, self.possible.sample_time(), estimate);
        self.name_reason(estimate);
        let stale = estimate.faults.iter().any(|f| f.kind == FaultKind::Stale);
        if stale {
            estimate.contrast_k = None;
        }
        if stale || verdict == Verdict::Withheld {
            self.last = None;
        }
    }

    /// No attitude is missing for no reason: that fault is named until there is one, or another fault.
    fn name_reason(&mut self, estimate: &mut Estimate) {
        let withheld = match estimate.mode {
            Mode::Starting | Mode::Nominal => false,
            Mode::Degraded => !estimate.measured,
            Mode::Faulted => true,
        };
        if withheld && estimate.faults.is_empty() {
            estimate.faults.extend_from_slice(&self.withheld_for);
        } else if withheld {
            self.withheld_for.clone_from(&estimate.faults);
        }
    }

    /// Takes in what was published of the last estimate, which may have been carried on: what stands in for an attitude goes
    /// on from there.
    pub fn published(&mut self, estimate: &Estimate) {
        if let Some(attitude) = estimate.attitude {
            self.output.published(attitude, estimate.sigma);
        }
    }

    /// Copies a frame without what cannot be, and without the sensors that are stuck.
    fn hear(&mut self, frame: &Frame) {
        self.possible.clone_from(frame);
        self.erratic.take_out(&mut self.possible);
        self.detectors.hear(&self.possible);
        self.heard.clone_from(&self.possible);
        for (i, reading) in self.heard.readings.iter_mut().enumerate() {
            if self.detectors.is_stuck(i) {
                *reading = Err(Missing::Empty);
            }
        }
    }

    /// Takes the mounting off `seen`, learns of it where nothing speaks against that, and limits roll.
    fn given(
        &mut self,
        seen: Attitude,
        sigma: Attitude,
        doubt: Attitude,
        frame: &Frame,
        estimate: &mut Estimate,
    ) -> Verdict {
        let (mut mounting, mut sigma, mut departed) = (self.mounting, sigma, Attitude::default());
        if let (Some(learner), Mounting::Turned(configured)) = (&mut self.learner, self.mounting) {
            // A head that sits askew disagrees until that is learnt.
            let askew = |f: &ActiveFault| matches!(f.kind, FaultKind::RollDisagrees | FaultKind::PitchDisagrees);
            if estimate.faults.iter().all(askew) {
                learner.update(mounting.to_body(seen), &frame.aiding, frame.time);
            }
            let (learnt, of_trim) = (learner.trim(), learner.sigma());
            let total = Attitude { roll: configured.roll + learnt.roll, pitch: configured.pitch + learnt.pitch };
            mounting = Mounting::Turned(total);
            self.estimator.set_trim(total);
            sigma = Attitude { roll: sigma.roll.hypot(of_trim.roll), pitch: sigma.pitch.hypot(of_trim.pitch) };
            departed = learner.departed();
            estimate.trim = learnt;
        }
        estimate.rates = self.estimator.rates().map(|rates| mounting.rates_to_body(rates));
        let body = mounting.to_body(seen);
        let (limits, limit) = match self.roll_limit {
            RollLimit::None => (false, f64::INFINITY),
            RollLimit::BuiltIn(limit) => (seen.roll.abs() >= limit, f64::INFINITY),
            RollLimit::Here(limit) => (body.roll.abs() >= limit, limit),
        };
        let roll = body.roll.clamp(-limit, limit);
        self.last = Some((body, sigma));
        let doubt = Attitude { roll: doubt.roll.max(departed.roll), pitch: doubt.pitch.max(departed.pitch) };
        let sigma = Attitude { roll: sigma.roll.hypot(doubt.roll), pitch: sigma.pitch.hypot(doubt.pitch) };
        // What the limit has taken away is not known any better than that.
        let sigma = Attitude { roll: sigma.roll.hypot(body.roll - roll), ..sigma };
        Verdict::Given { attitude: Attitude { roll, ..body }, sigma, limited: limits, degraded: false }
    }
}

#[cfg(test)]
mod tests;
