//! A real flight with three thermopile pairs beside an inertial reference: the report's scheme has
//! the error that was reckoned for it from its formula by another program. The recording is not
//! part of this repository: it is looked for beside it.

use irhorizon::attitude::Estimate;
use irhorizon::config;
use irhorizon::config::settings::Method;
use irhorizon::frame::Frame;
use irhorizon::horizon::Horizon;
use irhorizon::recording::Recording;
use std::path::Path;

/// Two pairs 45° off the axes, one vertical, on a 10-bit converter.
const HEAD: &str = include_str!("heads/diagonal.toml");

fn rms(errors: &[f64]) -> f64 {
    (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt()
}

#[test]
fn the_report_s_scheme_on_a_real_flight() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/flights/flight-b.csv");
    if !path.exists() {
        eprintln!("SKIPPED: there is no recording at {}", path.display());
        return;
    }
    let mut settings = config::parse(&[("head.toml".into(), HEAD.into())]).unwrap().settings;
    settings.estimator.method = Some(Method::InverseSine);
    let mut reader = Recording::open(&path).unwrap().frames(Some(settings.head())).unwrap();
    let mut horizon = Horizon::new(&settings, settings.head());
    let (mut frame, mut estimate) = (Frame::new(3), Estimate::default());
    let (mut roll, mut pitch) = (Vec::new(), Vec::new());
    while reader.next_frame(&mut frame).unwrap() {
        horizon.update(&frame, &[], &mut estimate);
        let reference = reader.reference();
        let flying = frame.aiding.ground_speed_m_s.is_some_and(|v| v > 8.0);
        if let (Some(a), true, Some(r), Some(p)) = (estimate.attitude, flying, reference.roll_deg, reference.pitch_deg)
        {
            roll.push(a.roll.to_degrees() - r);
            pitch.push(a.pitch.to_degrees() - p);
        }
    }
    println!("{} frames in flight: roll rms {:.2}°, pitch rms {:.2}°", roll.len(), rms(&roll), rms(&pitch));
    assert!(roll.len() > 400);
    assert!((rms(&roll) - 8.8).abs() < 0.1 && (rms(&pitch) - 13.5).abs() < 0.1);
}
