//! Sensors that are off by as much as a datasheet allows, under an even sky and with an autopilot: what they look like until
//! that is known is not said to be a wall.

use irhorizon::attitude::Estimate;
use irhorizon::config::Settings;
use irhorizon::fault::FaultKind;
use irhorizon::frame::{Frame, Sample, Value};
use irhorizon::horizon::Horizon;
use irhorizon::simulation::Scenario;
use irhorizon::source::FrameSource;
use irhorizon::time::Time;

/// What each shows too much, K: the datasheet of the MLX90614 allows half a kelvin.
const OFF_K: [[f64; 6]; 3] =
    [[0.2, 0.1, -0.5, 0.3, 0.1, 0.4], [-0.1, 0.5, -0.3, 0.0, -0.4, 0.3], [0.4, -0.3, 0.2, -0.4, 0.3, -0.1]];
/// Five minutes.
const FRAMES: u64 = 15_000;

/// For how long `obstructed` is said under a clear sky, s.
fn obstructed_s(seed: u64, off_k: [f64; 6]) -> f64 {
    let scenario = Scenario::named("clear-dry").unwrap();
    let (mut source, mut frame) = (scenario.source(seed), Frame::new(scenario.head().sensors.len()));
    let mut horizon = Horizon::new(&Settings::default(), scenario.head());
    let (mut estimate, mut said) = (Estimate::default(), 0_u32);
    for i in 0..FRAMES {
        source.scan(Time::from_nanos(i * 20_000_000), &mut frame);
        for (reading, off_k) in frame.readings.iter_mut().zip(off_k) {
            if let Ok(Sample { value: Value::Absolute { object_c, .. }, .. }) = reading {
                *object_c += off_k;
            }
        }
        horizon.update(&frame, &[], &mut estimate);
        said += u32::from(estimate.faults.iter().any(|f| f.kind == FaultKind::Obstructed));
    }
    f64::from(said) * 0.02
}

/// Without what is done for that it is said for half a minute in three of these nine flights, just when the errors have been
/// found. In humid air errors of half a kelvin may hide 4° until they are, and it is said that they do.
#[test]
fn sensors_that_are_off_are_no_wall() {
    for seed in 71..80 {
        let off_k = OFF_K[seed as usize % 3];
        assert_eq!(obstructed_s(seed, off_k), 0.0, "flight {seed}, {off_k:?} K");
    }
}
