//! The core put together: a frame goes in, an estimate comes out. The daemon and `replay` run this.
//!
//! - `build`: the estimator that the settings ask for;
//! - [`mounting`]: from the head's axes to the airframe's.

mod build;
pub mod mounting;

use crate::attitude::{Attitude, Estimate, Mode};
use crate::config::Settings;
use crate::config::settings::Method;
use crate::estimator::Estimator;
use crate::estimator::trim::Learner;
use crate::fault::FaultKind;
use crate::fault::contrast::ContrastDetector;
use crate::fault::sensors::SensorDetector;
use crate::frame::{Frame, Missing};
use crate::head::Head;
use mounting::Mounting;

/// An estimator beside the fault detectors.
pub struct Horizon {
    estimator: Box<dyn Estimator>,
    contrast: ContrastDetector,
    sensors: SensorDetector,
    mounting: Mounting,
    /// The largest roll given, rad; `None` where there is no limit or the method has it built in.
    roll_limit: Option<f64>,
    /// The configuration says the sensors' lag.
    lag_said: bool,
    /// What the configured trim leaves; `None` where that is not to be learnt.
    learner: Option<Learner>,
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
            roll_limit: (limit_deg > 0.0 && !built_in).then(|| limit_deg.to_radians()),
            lag_said: settings.head.lag_s.is_some(),
            contrast: ContrastDetector::new(f.low_contrast_c),
            sensors: SensorDetector::new(head, f.lost_after_s, f.back_after_s, f.stale_after_s),
            learner: (settings.head.learn_trim && !built_in).then(Learner::default),
        }
    }

    /// The time constant that the sensors say they have, s; what the configuration says stays.
    pub fn set_lag_s(&mut self, lag_s: f64) {
        if !self.lag_said {
            self.estimator.set_lag_s(lag_s);
        }
    }

    /// Takes in `frame`, with the reason for which each bus is down, and brings `estimate` up to
    /// date.
    ///
    /// An attitude is given only where the method has one and no detector as much as suspects it.
    /// A frame that gives none without being a fault (one missed read) leaves the estimate with its
    /// old stamp: publishers send nothing new.
    pub fn update(&mut self, frame: &Frame, buses_down: &[Option<Missing>], estimate: &mut Estimate) {
        let solution = self.estimator.update(frame);
        let trusted = self.contrast.update(&solution, frame.time);
        self.sensors.update(frame, buses_down);
        estimate.faults.clear();
        self.contrast.report(&mut estimate.faults);
        self.sensors.report(&mut estimate.faults);
        if solution.contrast_k.is_some() {
            estimate.contrast_k = solution.contrast_k;
        }

        match solution.attitude {
            Some(a) if trusted => {
                self.publish(a, solution.sigma, frame, estimate);
                estimate.mode = if estimate.faults.is_empty() { Mode::Nominal } else { Mode::Degraded };
            }
            None if trusted && estimate.faults.is_empty() => return,
            _ if estimate.faults.iter().any(|f| withholds(f.kind, solution.attitude.is_some())) => {
                estimate.attitude = None;
                estimate.mode = Mode::Faulted;
            }
            // Suspected, not yet a fault: nothing new is said.
            _ => return,
        }
        estimate.time = frame.sample_time().unwrap_or(estimate.time);
    }

    /// Takes the mounting off `seen`, learns of it where nothing speaks against that, and limits roll.
    fn publish(&mut self, seen: Attitude, sigma: Attitude, frame: &Frame, estimate: &mut Estimate) {
        let (mut mounting, mut sigma) = (self.mounting, sigma);
        if let (Some(learner), Mounting::Turned(configured)) = (&mut self.learner, self.mounting) {
            if estimate.faults.is_empty() {
                learner.update(mounting.to_body(seen), &frame.aiding, frame.time);
            }
            let (learnt, of_trim) = (learner.trim(), learner.sigma());
            let total = Attitude { roll: configured.roll + learnt.roll, pitch: configured.pitch + learnt.pitch };
            mounting = Mounting::Turned(total);
            self.estimator.set_trim(total);
            sigma = Attitude { roll: sigma.roll.hypot(of_trim.roll), pitch: sigma.pitch.hypot(of_trim.pitch) };
            estimate.trim = learnt;
        }
        let body = mounting.to_body(seen);
        let roll = self.roll_limit.map_or(body.roll, |limit| body.roll.clamp(-limit, limit));
        estimate.attitude = Some(Attitude { roll, ..body });
        // What the limit has taken away is not known any better than that.
        estimate.sigma = Attitude { roll: sigma.roll.hypot(body.roll - roll), ..sigma };
    }
}

/// Whether a fault withholds the attitude; a sensor's does where the method has none without it.
fn withholds(kind: FaultKind, solved: bool) -> bool {
    match kind {
        FaultKind::LowContrast | FaultKind::InvertedContrast | FaultKind::Stale => true,
        FaultKind::SensorLost(_) | FaultKind::SensorSaturated(_) | FaultKind::BusDown(_) => !solved,
    }
}

#[cfg(test)]
mod tests;
