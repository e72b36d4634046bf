//! What others have published, to be compared with: a scheme a file.
//!
//! - [`report`]: inverse sine over a low-passed vertical pair;
//! - [`paparazzi`]: two arc tangents over the vertical pair;
//! - [`full_vector`]: the same with the vector's whole length under pitch;
//! - [`uavx`]: inverse sine over a peak that decays;
//! - [`ardupilot`]: straight lines.
//!
//! Written from the formulas alone, with nothing of the crate's estimators but the pairs' vector.

mod ardupilot;
mod full_vector;
mod paparazzi;
mod report;
mod uavx;

use irhorizon::estimator::contrast_vector::contrast_vector;
use irhorizon::frame::Frame;
use irhorizon::head::Head;

pub use ardupilot::ArduPilot;
pub use full_vector::FullVector;
pub use paparazzi::Paparazzi;
pub use report::Report;
pub use uavx::Uavx;

/// A published scheme.
pub trait Baseline {
    /// Takes in the signals `[x, y, z]` of the pairs along nose, left and up, K, seen at `time_s`;
    /// gives roll and pitch, °, where the formula has any.
    fn update(&mut self, time_s: f64, signals_k: [f64; 3]) -> Option<(f64, f64)>;
}

/// The schemes with their names, each at its start.
pub fn named() -> [(&'static str, Box<dyn Baseline>); 5] {
    [
        ("report", Box::new(Report::default())),
        ("paparazzi", Box::new(Paparazzi)),
        ("full-vector", Box::new(FullVector)),
        ("uavx", Box::new(Uavx::default())),
        ("ardupilot", Box::new(ArduPilot::default())),
    ]
}

/// What `baseline` makes of `frame`: nothing while the head's pairs do not span space.
pub fn update(baseline: &mut dyn Baseline, head: &Head, frame: &Frame) -> Option<(f64, f64)> {
    let signals_k = contrast_vector(head, frame)?;
    baseline.update(frame.sample_time()?.as_secs_f64(), signals_k)
}

/// The inverse sine of `signal` on `range` (one unit for both), °; ±90 beyond it. `None` without a range.
fn arc_sine_deg(signal: f64, range: f64) -> Option<f64> {
    (range > 0.0).then(|| (signal / range).clamp(-1.0, 1.0).asin().to_degrees())
}
