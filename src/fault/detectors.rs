//! All detectors together: what speaks against the attitude, and whether it may be given.

use super::debounce::State;
use super::disagree::Disagree;
use super::inverted::Inverted;
use super::low_contrast::LowContrast;
use super::obstructed::Obstructed;
use super::sensors::SensorDetector;
use super::stuck::StuckSensors;
use super::wet::WetSensors;
use super::{ActiveFault, FaultKind};
use crate::attitude::Attitude;
use crate::config::settings::FaultSettings;
use crate::estimator::Solution;
use crate::frame::{Frame, Missing};
use crate::head::Head;

/// The detectors of one head.
#[derive(Clone, Debug)]
pub struct Detectors {
    low: LowContrast,
    inverted: Inverted,
    wet: WetSensors,
    obstructed: Obstructed,
    disagree: Disagree,
    stuck: StuckSensors,
    sensors: SensorDetector,
}

impl Detectors {
    /// For `head`, with the thresholds of `f`.
    pub fn new(f: &FaultSettings, head: &Head) -> Self {
        Self {
            low: LowContrast::new(head, f.low_contrast_c, f.accuracy_deg.to_radians()),
            inverted: Inverted::new(f.low_contrast_c),
            wet: WetSensors::new(head, 0.01 * f.wet_percent),
            obstructed: Obstructed::new(f.obstructed_deg.to_radians()),
            disagree: Disagree::new(f.disagree_deg.to_radians()),
            stuck: StuckSensors::new(head, f.stuck_after_s),
            sensors: SensorDetector::new(head.clone(), f.lost_after_s, f.back_after_s, f.stale_after_s),
        }
    }

    /// Takes up other thresholds and forgets nothing of what has been seen.
    pub fn retune(&mut self, f: &FaultSettings) {
        self.low.retune(f.low_contrast_c, f.accuracy_deg.to_radians());
        self.inverted.retune(f.low_contrast_c);
        self.wet.retune(0.01 * f.wet_percent);
        self.obstructed.retune(f.obstructed_deg.to_radians());
        self.disagree.retune(f.disagree_deg.to_radians());
        self.stuck.retune(f.stuck_after_s);
        self.sensors.retune(f.lost_after_s, f.back_after_s, f.stale_after_s);
    }

    /// Takes in a frame before the method does: which sensors are stuck is known then.
    pub fn hear(&mut self, frame: &Frame) {
        self.stuck.hear(frame);
    }

    /// Takes in what the method makes of the frame that was heard, and the reason for which each bus is down. Whether the
    /// contrast allows an attitude for all that is seen: a mere suspicion does not.
    pub fn update(&mut self, frame: &Frame, solution: &Solution, buses_down: &[Option<Missing>]) -> bool {
        let low = self.low.update(solution, frame);
        let inverted = self.inverted.update(solution, frame.time);
        self.wet.update(frame, solution, self.low.limit_k(), self.obstructed.is_active());
        // A scene of next to no contrast is no scene.
        if low == State::Clear {
            self.obstructed.update(solution, frame.time);
        } else {
            self.obstructed.rest();
        }
        self.disagree.hear(solution, frame.time);
        self.stuck.judge(frame, &solution.sensors);
        self.sensors.update(frame, buses_down);
        low == State::Clear && inverted == State::Clear && !self.wet.all()
    }

    /// Compares the airframe's attitude and its standard deviation with the turn and climb that are flown; `None`
    /// while there is none; whether a sensor is `left_out`. Gives what to add to the standard deviations.
    pub fn compare(&mut self, attitude: Option<(Attitude, Attitude)>, left_out: bool, frame: &Frame) -> Attitude {
        self.disagree.update(attitude, &frame.aiding, frame.time);
        self.disagree.doubt(left_out)
    }

    /// Whether sensor `i` is stuck.
    pub fn is_stuck(&self, i: usize) -> bool {
        self.stuck.is_stuck(i)
    }

    /// Adds what is there to `faults`, in the vocabulary's order.
    pub fn report(&self, faults: &mut Vec<ActiveFault>) {
        self.low.report(faults);
        self.inverted.report(faults);
        self.wet.report(faults);
        self.obstructed.report(faults);
        self.disagree.report(faults);
        self.stuck.report(faults);
        self.sensors.report(faults);
    }

    /// Whether each sensor that is not in `frame`, or not heard, has a fault of its own.
    pub fn name_all_missing(&self, frame: &Frame) -> bool {
        let mut readings = frame.readings.iter().enumerate();
        readings.all(|(i, reading)| reading.is_ok() || self.sensors.is_gone(i))
    }

    /// Whether a fault withholds the attitude whatever the method makes of it.
    pub fn withholds(&self, kind: FaultKind) -> bool {
        match kind {
            FaultKind::LowContrast | FaultKind::InvertedContrast | FaultKind::Stale => true,
            FaultKind::WetSensor(_) => self.wet.all(),
            // A sensor's does where the method lacks it; the others widen the standard deviations.
            _ => false,
        }
    }
}

#[cfg(test)]
mod tests;
