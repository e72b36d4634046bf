//! A head that sits askew beside an autopilot's gyro, as most do: the filter learns how the gyro's axes lie, and the trim
//! that is learnt at the same time turns them under it.

use irhorizon::attitude::Estimate;
use irhorizon::config::Settings;
use irhorizon::estimator::trim::level;
use irhorizon::frame::Frame;
use irhorizon::horizon::Horizon;
use irhorizon::simulation::Scenario;
use irhorizon::simulation::aircraft::Aircraft;
use irhorizon::source::FrameSource;
use irhorizon::time::Time;

/// How far the head looks up from the airframe, and the airframe from where it flies, °.
const NOSE_UP_DEG: f64 = 5.0;
const ATTACK_DEG: f64 = 2.5;
/// Eight flights of five minutes, of which the first 20 s are left out; in three of them what the axes do looks for a while
/// more like sensors that are off.
const SEEDS: std::ops::Range<u64> = 5..13;
const FRAMES: std::ops::Range<u64> = 1000..15_000;

/// The daemon's defaults under `scene`: rms of roll and pitch against what the trim of the moment makes of the truth, °; what
/// is within 2σ, %.
fn flown(scene: &str) -> ([f64; 2], [f64; 2]) {
    let aircraft = Aircraft { attack_deg: NOSE_UP_DEG + ATTACK_DEG, wind_m_s: [3.0, -4.0], ..Aircraft::default() };
    let scenario = Scenario::named(scene).unwrap().with_aircraft(aircraft);
    let (sin, cos) = NOSE_UP_DEG.to_radians().sin_cos();
    let (mut squares, mut within, mut count) = ([0.0; 2], [0.0; 2], 0.0);
    for seed in SEEDS {
        let (mut source, mut frame) = (scenario.source(seed), Frame::new(scenario.head().sensors.len()));
        let mut horizon = Horizon::new(&Settings::default(), scenario.head());
        let mut estimate = Estimate::default();
        for i in 0..FRAMES.end {
            let tick = Time::from_nanos(i * 20_000_000);
            source.scan(tick, &mut frame);
            let [p, q, r] = frame.aiding.gyro_deg_s.map(|rate| rate.unwrap_or(f64::NAN));
            frame.aiding.gyro_deg_s = [cos * p + sin * r, q, cos * r - sin * p].map(Some);
            horizon.update(&frame, &[], &mut estimate);
            let Some(is) = estimate.attitude.filter(|_| i >= FRAMES.start) else { continue };
            let truth = level(source.truth_at(tick), estimate.trim);
            let errors = [(is.roll - truth.roll, estimate.sigma.roll), (is.pitch - truth.pitch, estimate.sigma.pitch)];
            for (k, (error, sigma)) in errors.into_iter().enumerate() {
                squares[k] += error * error;
                within[k] += f64::from(u8::from(error.abs() < 2.0 * sigma));
            }
            count += 1.0;
        }
    }
    assert_eq!(count, (SEEDS.count() * FRAMES.count()) as f64, "{scene}: withheld");
    (squares.map(|s| (s / count).sqrt().to_degrees()), within.map(|w| 100.0 * w / count))
}

#[test]
fn a_gyro_in_the_airframe_helps_a_head_that_is_not() {
    for (scene, [roll_deg, pitch_deg]) in
        [("clear-dry", [0.2, 0.2]), ("scattered", [0.9, 0.9]), ("patchwork", [1.0, 1.0]), ("warm-slope", [1.0, 0.9])]
    {
        let ([roll, pitch], within) = flown(scene);
        println!("{scene}: {roll:.2} / {pitch:.2}; 2 sigma {within:.0?} %");
        assert!(roll <= roll_deg && pitch <= pitch_deg, "{scene}: {roll} / {pitch}");
        assert!(within.iter().all(|w| *w >= 95.0), "{scene}: {within:?}");
    }
}
