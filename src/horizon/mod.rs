//! The core put together: a frame goes in, an estimate comes out. The daemon and `replay` run this.

use crate::attitude::{Attitude, Estimate, Mode};
use crate::config::Settings;
use crate::config::settings::Method;
use crate::estimator::trim::{Learner, level};
use crate::estimator::{Estimator, InverseSineEstimator};
use crate::fault::FaultKind;
use crate::fault::contrast::ContrastDetector;
use crate::fault::sensors::SensorDetector;
use crate::frame::{Frame, Missing};
use crate::head::Head;

/// An estimator beside the fault detectors.
pub struct Horizon {
    estimator: Box<dyn Estimator>,
    contrast: ContrastDetector,
    sensors: SensorDetector,
    trim: Attitude,
    /// What the configured trim leaves; `None` where that is not to be learnt.
    learner: Option<Learner>,
}

impl Horizon {
    /// For `head` as `settings` say.
    pub fn new(settings: &Settings, head: Head) -> Self {
        let e = &settings.estimator;
        let f = &settings.faults;
        let estimator = match e.method {
            Method::InverseSine => Box::new(InverseSineEstimator::new(
                head.clone(),
                settings.head.field_of_view_deg,
                e.range_time_constant_s,
                e.roll_limit_deg,
            )),
        };
        Self {
            estimator,
            contrast: ContrastDetector::new(f.low_contrast_c),
            sensors: SensorDetector::new(head, f.lost_after_s, f.back_after_s, f.stale_after_s),
            trim: Attitude::from_degrees(settings.head.roll_trim_deg, settings.head.pitch_trim_deg),
            learner: (settings.head.learn_trim && learns(e.method)).then(Learner::default),
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

    /// Trims `seen`, and learns from it where nothing speaks against it.
    fn publish(&mut self, seen: Attitude, sigma: Attitude, frame: &Frame, estimate: &mut Estimate) {
        let configured = self.trim;
        let Some(learner) = &mut self.learner else {
            estimate.attitude =
                Some(Attitude { roll: seen.roll - configured.roll, pitch: seen.pitch - configured.pitch });
            estimate.sigma = sigma;
            return;
        };
        if estimate.faults.is_empty() {
            learner.update(level(seen, configured), &frame.aiding, frame.time);
        }
        let (learnt, of_trim) = (learner.trim(), learner.sigma());
        let total = Attitude { roll: configured.roll + learnt.roll, pitch: configured.pitch + learnt.pitch };
        estimate.attitude = Some(level(seen, total));
        estimate.sigma = Attitude { roll: sigma.roll.hypot(of_trim.roll), pitch: sigma.pitch.hypot(of_trim.pitch) };
        estimate.trim = learnt;
    }
}

/// Whether a method's trim is learnt; the report's stays as it was published.
fn learns(method: Method) -> bool {
    !matches!(method, Method::InverseSine)
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
