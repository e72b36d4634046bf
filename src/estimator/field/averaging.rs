//! How much the sensors average in radiance, and whether that can be told.

use super::FieldEstimator;
use super::state::RADIANCE;
use crate::estimator::Standing;
use crate::time::Time;

/// A sensor looks up whose axis' sine above the wings' plane is larger.
const UP: f64 = 0.5;
/// One that was not heard for longer is missing, s.
const MISSING_S: f64 = 1.0;

impl FieldEstimator {
    /// Takes it for certain while it cannot be told. Without a gyro, and without a sensor that looks up, it is learnt from what
    /// the model leaves, goes to its bounds, and takes the sky's depth and the field of view with it.
    pub(super) fn consider_averaging(&mut self, now: Time) {
        let looks_up = |i: usize| {
            self.model.direction(i)[2] > UP
                && self.hearing(i).standing == Standing::Heard
                && self.stamps[i].is_some_and(|at| now.since(at) < MISSING_S)
        };
        let told = self.gyro.in_use() || (0..self.model.sensors()).any(looks_up);
        if !told && self.averaging.is_none() {
            self.averaging = Some(self.state.p[RADIANCE][RADIANCE]);
            self.state.set_variance(RADIANCE, 0.0);
        } else if let (true, Some(variance)) = (told, self.averaging) {
            self.averaging = None;
            self.state.set_variance(RADIANCE, variance);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{FieldEstimator, Tuning};
    use super::*;
    use crate::estimator::Estimator;
    use crate::frame::{Aiding, Frame, Missing};
    use crate::simulation::Scenario;
    use crate::sky::Averaging;
    use crate::source::FrameSource;

    /// The share and its variance after each of these ends, s, of a flight in humid air; between the first two nobody looks up.
    fn after(averaging: Averaging, ends: [u32; 3], aided: bool) -> [(f64, f64); 3] {
        let scenario = Scenario::named("clear-humid").unwrap().with_averaging(averaging);
        let (mut source, head) = (scenario.source(3), scenario.head());
        let up = head.sensors.iter().position(|s| s.name == "up").unwrap();
        let mut e = FieldEstimator::new(&head, scenario.field(), Tuning::default());
        let mut frame = Frame::new(head.sensors.len());
        let mut now = 0;
        ends.map(|end| {
            for i in now..end * 50 {
                source.scan(Time::from_secs_f64(100.0 + f64::from(i) * 0.02), &mut frame);
                if !aided {
                    frame.aiding = Aiding::default();
                }
                if (ends[0] * 50..ends[1] * 50).contains(&i) {
                    frame.readings[up] = Err(Missing::NoAnswer);
                }
                e.update(&frame);
            }
            now = end * 50;
            (e.state.x[RADIANCE], e.state.p[RADIANCE][RADIANCE])
        })
    }

    #[test]
    fn all_or_nothing_of_it_is_told_in_humid_air() {
        for aided in [false, true] {
            for (averaging, truth) in [(Averaging::Temperature, 0.0), (Averaging::Radiance, 1.0)] {
                let [.., (share, variance)] = after(averaging, [120; 3], aided);
                let sigma = variance.sqrt();
                assert!((share - truth).abs() < 0.2 && sigma < 0.15, "{averaging:?}, aided {aided}: {share} {sigma}");
            }
        }
    }

    #[test]
    fn without_a_sensor_that_looks_up_and_a_gyro_it_is_kept() {
        let [before, without, again] = after(Averaging::Radiance, [10, 40, 41], false);
        // It is missing after a second.
        assert!((without.0 - before.0).abs() < 0.2 && without.1 == 0.0, "{before:?} {without:?}");
        assert!(again.1 > 0.0, "{again:?}");
        let [.., with_gyro, _] = after(Averaging::Radiance, [10, 40, 41], true);
        assert!(with_gyro.1 > 0.0);
    }
}
