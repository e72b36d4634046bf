//! Sensors that are off a little, as all are, before any turn has been flown: straight on, and on the ground.

use super::*;
use crate::frame::Value;
use crate::simulation::aircraft::Aircraft;
use crate::simulation::flight::{Flight, Waypoint};
use crate::simulation::manoeuvre::Style;
use crate::simulation::trajectory::Trajectory;

/// What each sensor shows too much, K: the datasheet of the MLX90614 allows half a kelvin.
const OFF_K: [f64; 6] = [0.2, -0.1, -0.2, 0.1, 0.1, -0.1];

/// The rms error of roll and pitch together from the twentieth second on, °; then the largest; `tell` may change what the
/// instruments say.
fn errors(scene: &str, contrast_k: f64, bank_deg: f64, seed: u64, tell: impl Fn(&mut Aiding, f64)) -> (f64, f64) {
    const SECONDS: f64 = 150.0;
    let at = |time_s, roll_deg| Waypoint { time_s, roll_deg, pitch_deg: 2.0 };
    let waypoints = vec![at(0.0, 0.0), at(110.0, 0.0), at(113.0, bank_deg), at(SECONDS, bank_deg)];
    let style = Style::Scripted(Flight::scripted(waypoints).with_turbulence(0.4, 0.2, seed));
    let trajectory = Trajectory::fly(&Aircraft::default(), &style, SECONDS + 1.0, seed);
    let scenario = Scenario::named(scene).unwrap().with_contrast(contrast_k).lasting(1.0);
    let (mut source, head) = (scenario.source(seed).with_trajectory(trajectory), scenario.head());
    let mut e = FieldEstimator::new(&head, scenario.field(), Tuning::default());
    let mut frame = Frame::new(head.sensors.len());
    let (mut squares, mut worst, mut count) = (0.0, 0.0_f64, 0.0);
    for i in 0..(SECONDS * 50.0) as u32 {
        let s = f64::from(i) * 0.02;
        let now = Time::from_secs_f64(100.0 + s);
        source.scan(now, &mut frame);
        for (reading, off_k) in frame.readings.iter_mut().zip(OFF_K) {
            if let Ok(Sample { value: Value::Absolute { object_c, .. }, .. }) = reading {
                *object_c += off_k;
            }
        }
        tell(&mut frame.aiding, s);
        if let Some(a) = e.update(&frame).attitude.filter(|_| s > 20.0) {
            let truth: Attitude = source.truth_at(now);
            let off = (a.roll - truth.roll).hypot(a.pitch - truth.pitch).to_degrees();
            (squares, worst, count) = (squares + off * off, worst.max(off), count + 1.0);
        }
    }
    assert!(count > 1000.0);
    ((squares / count).sqrt(), worst)
}

/// Of a horizon that leans and of sensors that are off nothing tells there: with all instruments it was worse than without.
#[test]
fn straight_on_sensors_that_are_off_are_no_lean() {
    for seed in 1..4 {
        let (all, none) = (|_: &mut Aiding, _| {}, |a: &mut Aiding, _| *a = Aiding::default());
        let [all, none] = [errors("clear-dry", 40.0, 0.0, seed, all), errors("clear-dry", 40.0, 0.0, seed, none)];
        println!("{seed}: {all:.1?}°, without {none:.1?}°");
        assert!(all.0 < 1.7 && all.1 < 3.0, "{all:?}");
    }
}
