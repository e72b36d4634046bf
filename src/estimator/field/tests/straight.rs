//! Straight on, before any turn, with sensors that are off a little, as all are.

use super::*;
use crate::frame::Value;
use crate::simulation::aircraft::Aircraft;
use crate::simulation::flight::{Flight, Waypoint};
use crate::simulation::manoeuvre::Style;
use crate::simulation::trajectory::Trajectory;

/// What each sensor shows too much, K: the datasheet of the MLX90614 allows half a kelvin.
const OFF_K: [f64; 6] = [0.2, -0.1, -0.2, 0.1, 0.1, -0.1];
const SECONDS: f64 = 150.0;

/// The error of roll and pitch together from the twentieth second on, °: rms, and the largest.
fn errors(seed: u64, aided: bool) -> (f64, f64) {
    let at = |time_s| Waypoint { time_s, roll_deg: 0.0, pitch_deg: 2.0 };
    let flight = Flight::scripted(vec![at(0.0), at(SECONDS)]).with_turbulence(0.4, 0.2, seed);
    let trajectory = Trajectory::fly(&Aircraft::default(), &Style::Scripted(flight), SECONDS + 1.0, seed);
    let scenario = Scenario::named("clear-dry").unwrap().lasting(1.0);
    let (mut source, head) = (scenario.source(seed).with_trajectory(trajectory), scenario.head());
    let mut e = FieldEstimator::new(&head, scenario.field(), Tuning::default());
    let mut frame = Frame::new(head.sensors.len());
    let (mut squares, mut largest, mut count) = (0.0, 0.0_f64, 0.0);
    for i in 0..(SECONDS * 50.0) as u32 {
        let s = f64::from(i) * 0.02;
        let now = Time::from_secs_f64(100.0 + s);
        source.scan(now, &mut frame);
        for (reading, off_k) in frame.readings.iter_mut().zip(OFF_K) {
            if let Ok(Sample { value: Value::Absolute { object_c, .. }, .. }) = reading {
                *object_c += off_k;
            }
        }
        if !aided {
            frame.aiding = Aiding::default();
        }
        if let Some(a) = e.update(&frame).attitude.filter(|_| s > 20.0) {
            let truth: Attitude = source.truth_at(now);
            let off = (a.roll - truth.roll).hypot(a.pitch - truth.pitch).to_degrees();
            (squares, largest, count) = (squares + off * off, largest.max(off), count + 1.0);
        }
    }
    assert!(count > 1000.0);
    ((squares / count).sqrt(), largest)
}

/// Of a horizon that leans and of sensors that are off nothing tells there: with all instruments they were taken for a lean, and
/// the attitude was off by four times as much as without any.
#[test]
fn sensors_that_are_off_are_no_lean() {
    for seed in 1..4 {
        let [aided, alone] = [true, false].map(|aided| errors(seed, aided));
        println!("{seed}: {aided:.1?}°, without instruments {alone:.1?}°");
        assert!(aided.0 < 1.7 && aided.1 < 3.0, "{aided:?}");
    }
}
