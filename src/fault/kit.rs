//! What the detectors' tests share: frames, solutions, and what is reported of them.

use super::{ActiveFault, Evidence, FaultKind};
use crate::direction::Direction;
use crate::estimator::Solution;
use crate::frame::{Frame, Sample, Value};
use crate::head::{Head, Sensor, SensorKind};
use crate::time::Time;

pub fn at(time_s: f64) -> Time {
    Time::from_secs_f64(time_s)
}

/// Sensors that show these temperatures and have this one of their own, °C, read just now.
pub fn frame(time_s: f64, objects_c: &[f64], ambient_c: Option<f64>) -> Frame {
    let time = at(time_s);
    let reading = |object_c: &f64| Ok(Sample { value: Value::Absolute { object_c: *object_c, ambient_c }, time });
    Frame { time, readings: objects_c.iter().map(reading).collect(), ..Frame::default() }
}

/// `count` sensors of one kind, all of which look up.
pub fn alike(count: usize, kind: SensorKind) -> Head {
    let sensor = |i| Sensor { name: format!("s{i}"), direction: Direction::UP, kind, bus: None };
    Head::new((0..count).map(sensor).collect(), vec![])
}

/// A frame in which a contrast of `z` kelvin was seen along the vertical.
pub fn seen(z: f64) -> Solution {
    Solution { seen_k: Some([0.0, 0.0, z]), contrast_k: Some(z), ..Solution::default() }
}

/// What a detector reports.
pub fn told(report: impl FnOnce(&mut Vec<ActiveFault>)) -> Vec<(FaultKind, Evidence)> {
    let mut faults = Vec::new();
    report(&mut faults);
    faults.into_iter().map(|f| (f.kind, f.evidence)).collect()
}

/// The number in a fault's evidence with its unit.
pub fn value((_, evidence): &(FaultKind, Evidence)) -> (f64, &'static str) {
    match *evidence {
        Evidence::Limit { value, unit, .. } => (value, unit),
        Evidence::Missing { .. } => panic!("{evidence}"),
    }
}
