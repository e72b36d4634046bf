//! How fast the aircraft turns, as an estimate has it: by its thermopiles alone, and with a gyro whose bias it learns.

use irhorizon::attitude::Estimate;
use irhorizon::config::Settings;
use irhorizon::config::settings::Method;
use irhorizon::frame::{Aiding, Frame};
use irhorizon::head::Head;
use irhorizon::horizon::Horizon;
use irhorizon::simulation::Scenario;
use irhorizon::source::FrameSource;
use irhorizon::time::Time;

/// The gyro's bias that is added, °/s.
const BIAS: [f64; 3] = [0.5, -0.8, 0.3];

/// What the rates err by of what they are, rms, about x, y, z; the first 20 s of 120 s at 50 Hz are left out.
fn off(scenario: &str, with_gyro: bool) -> [f64; 3] {
    let mut source = Scenario::named(scenario).unwrap().lasting(120.0).source(3);
    let mut horizon = Horizon::new(&Settings::default(), Head::six());
    horizon.set_lag_s(0.1);
    let (mut frame, mut estimate) = (Frame::new(6), Estimate::default());
    let (mut off, mut are) = ([0.0; 3], [0.0; 3]);
    for i in 0..6000 {
        source.scan(Time::from_nanos(i * 20_000_000), &mut frame);
        let truth = frame.aiding.gyro_deg_s.map(|rate| rate.unwrap());
        frame.aiding = Aiding::default();
        if with_gyro {
            frame.aiding.gyro_deg_s = std::array::from_fn(|k| Some(truth[k] + BIAS[k]));
        }
        horizon.update(&frame, &[], &mut estimate);
        if i >= 1000 {
            let rates = estimate.rates.expect("rates");
            for k in 0..3 {
                off[k] += (rates[k].to_degrees() - truth[k]).powi(2);
                are[k] += truth[k].powi(2);
            }
        }
    }
    let shares = std::array::from_fn(|k| (off[k] / are[k]).sqrt());
    println!("{scenario}, {}: {shares:.2?} of what they are", if with_gyro { "with a gyro" } else { "alone" });
    shares
}

#[test]
fn rates_are_known_to_a_part_without_a_gyro_and_well_with_one() {
    for (scenario, most) in [("clear-dry", 0.5), ("overcast", 0.7), ("scattered", 0.5)] {
        assert!(off(scenario, false).iter().all(|share| *share < most));
        assert!(off(scenario, true).iter().all(|share| *share < 0.1));
    }
}

#[test]
fn other_methods_have_none() {
    let mut source = Scenario::named("clear-dry").unwrap().source(3);
    for method in [Method::Profile, Method::InverseSine] {
        let mut settings = Settings::default();
        settings.estimator.method = Some(method);
        let mut horizon = Horizon::new(&settings, Head::six());
        let (mut frame, mut estimate) = (Frame::new(6), Estimate::default());
        for i in 0..100 {
            source.scan(Time::from_nanos(i * 20_000_000), &mut frame);
            horizon.update(&frame, &[], &mut estimate);
        }
        assert!(estimate.attitude.is_some() && estimate.rates.is_none(), "{method:?}");
    }
}
