//! A real flight with three thermopile pairs beside an inertial reference: the report's scheme has
//! the error that was reckoned for it from its formula by another program. The recording is not
//! part of this repository: it is looked for beside it.

use irhorizon::attitude::{Attitude, Estimate};
use irhorizon::config::{self, Settings};
use irhorizon::estimator::trim::{Learner, level};
use irhorizon::estimator::{Estimator, ProfileEstimator};
use irhorizon::frame::Frame;
use irhorizon::horizon::Horizon;
use irhorizon::recording::Recording;
use irhorizon::sky::{Averaging, FieldOfView, Response, Sky};
use std::path::Path;

/// Two pairs 45° off the axes, one vertical, on a 10-bit converter.
const HEAD: &str = include_str!("heads/diagonal.toml");

fn mean(errors: &[f64]) -> f64 {
    errors.iter().sum::<f64>() / errors.len() as f64
}

fn rms(errors: &[f64]) -> f64 {
    (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt()
}

/// The error in flight (above 8 m/s), roll and pitch in degrees, of what `estimate` gives for each frame.
fn errors(mut estimate: impl FnMut(&Frame) -> Option<Attitude>) -> Option<[Vec<f64>; 2]> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/flights/flight-b.csv");
    if !path.exists() {
        eprintln!("SKIPPED: there is no recording at {}", path.display());
        return None;
    }
    let mut reader = Recording::open(&path).unwrap().frames(Some(settings().head())).unwrap();
    let mut frame = Frame::new(3);
    let [mut roll, mut pitch] = [(); 2].map(|()| Vec::new());
    while reader.next_frame(&mut frame).unwrap() {
        let attitude = estimate(&frame);
        let reference = reader.reference();
        let flying = frame.aiding.ground_speed_m_s.is_some_and(|v| v > 8.0);
        if let (Some(a), true, Some(r), Some(p)) = (attitude, flying, reference.roll_deg, reference.pitch_deg) {
            roll.push(a.roll.to_degrees() - r);
            pitch.push(a.pitch.to_degrees() - p);
        }
    }
    println!("{} frames in flight: roll rms {:.2}°, pitch rms {:.2}°", roll.len(), rms(&roll), rms(&pitch));
    assert!(roll.len() > 400);
    Some([roll, pitch])
}

fn settings() -> Settings {
    config::parse(&[("head.toml".into(), HEAD.into())]).unwrap().settings
}

#[test]
fn the_report_s_scheme_on_a_real_flight() {
    let mut horizon = Horizon::new(&settings(), settings().head());
    let mut estimate = Estimate::default();
    let found = errors(|frame| {
        horizon.update(frame, &[], &mut estimate);
        estimate.attitude
    });
    let Some([roll, pitch]) = found else { return };
    assert!((rms(&roll) - 8.8).abs() < 0.1 && (rms(&pitch) - 13.5).abs() < 0.1);
}

/// Roll and pitch by the profile, with what is learnt from GPS beyond `trim`: their errors, and the trim at the end.
fn profile_trimmed(trim: Attitude, mut learner: Option<Learner>) -> Option<([Vec<f64>; 2], Attitude)> {
    let sky = Sky::NAMIBIA;
    let response = Response::new(sky.shape, FieldOfView::Gaussian { fwhm_deg: 90.0 }, Averaging::Temperature);
    let curve = response.pair_curve(sky.ground_c, sky.sky_max_k);
    let mut method = ProfileEstimator::new(settings().head(), curve, 3.0);
    let mut total = trim;
    let errors = errors(|frame| {
        let seen = method.update(frame).attitude?;
        if let Some(learner) = &mut learner {
            learner.update(level(seen, trim), &frame.aiding, frame.time);
            let learnt = learner.trim();
            total = Attitude { roll: trim.roll + learnt.roll, pitch: trim.pitch + learnt.pitch };
        }
        Some(level(seen, total))
    })?;
    let [roll, pitch] = &errors;
    println!("of that, bias: roll {:.2}°, pitch {:.2}°", mean(roll), mean(pitch));
    println!("trim at the end: roll {:.1}°, pitch {:.1}°", total.roll.to_degrees(), total.pitch.to_degrees());
    Some((errors, total))
}

/// By the reference, which the learner never sees, the head of this flight sits some 9° nose up; by the
/// angle of climb some 6°, as the reference itself flies 3° nose down.
#[test]
fn the_profile_trimmed_from_gps_alone_on_a_real_flight() {
    let Some(([roll, pitch], _)) = profile_trimmed(Attitude::default(), None) else { return };
    let untrimmed = [mean(&pitch), rms(&roll), rms(&pitch)];
    let Some(([roll, pitch], learnt)) = profile_trimmed(Attitude::default(), Some(Learner::default())) else { return };
    assert!((5.0..6.5).contains(&learnt.pitch.to_degrees()) && learnt.roll.to_degrees().abs() < 1.0);
    assert!(mean(&pitch) < untrimmed[0] - 3.0 && rms(&pitch) < untrimmed[2] - 1.5, "while it learns");
    assert!(rms(&roll) < untrimmed[1]);
    let Some(([roll, pitch], _)) = profile_trimmed(learnt, None) else { return };
    assert!(mean(&pitch) < 4.0 && rms(&pitch) < 8.6 && rms(&roll) < untrimmed[1], "with the trim it has learnt");
}
