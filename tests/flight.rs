//! A real flight with three thermopile pairs beside an inertial reference: the report's scheme has
//! the error that was reckoned for it from its formula by another program, and the profile a smaller one. The
//! recording is not part of this repository: it is looked for beside it.

use irhorizon::attitude::{Attitude, Estimate};
use irhorizon::config::{self, Settings, settings::Method};
use irhorizon::fault::{ActiveFault, Evidence};
use irhorizon::frame::Frame;
use irhorizon::horizon::Horizon;
use irhorizon::recording::Recording;
use std::path::Path;

/// Two pairs 45° off the axes, one vertical, on a 10-bit converter.
const HEAD: &str = include_str!("heads/diagonal.toml");

fn mean(errors: &[f64]) -> f64 {
    errors.iter().sum::<f64>() / errors.len() as f64
}

fn rms(errors: &[f64]) -> f64 {
    (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt()
}

fn settings(method: Method) -> Settings {
    let mut settings = config::parse(&[("head.toml".into(), HEAD.into())]).unwrap().settings;
    settings.estimator.method = Some(method);
    // Every attitude counts, also those that are too uncertain to be given.
    settings.faults.sigma_limit_deg = 90.0;
    settings
}

/// The errors in flight (above 8 m/s), roll and pitch in degrees, and the trim learnt by its end.
fn flown(settings: &Settings) -> Option<([Vec<f64>; 2], Attitude)> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/flights/flight-b.csv");
    if !path.exists() {
        eprintln!("SKIPPED: there is no recording at {}", path.display());
        return None;
    }
    let mut reader = Recording::open(&path).unwrap().frames(Some(settings.head())).unwrap();
    let mut horizon = Horizon::new(settings, settings.head());
    let (mut frame, mut estimate) = (Frame::new(3), Estimate::default());
    let [mut roll, mut pitch] = [(); 2].map(|()| Vec::new());
    let mut out_of_scale = 0;
    while reader.next_frame(&mut frame).unwrap() {
        horizon.update(&frame, &[], &mut estimate);
        let scale = |f: &ActiveFault| matches!(f.evidence, Evidence::Limit { unit: "%", .. });
        out_of_scale += u32::from(estimate.faults.iter().any(scale));
        let reference = reader.reference();
        let flying = frame.aiding.ground_speed_m_s.is_some_and(|v| v > 8.0);
        if let (Some(a), true, Some(r), Some(p)) = (estimate.attitude, flying, reference.roll_deg, reference.pitch_deg)
        {
            roll.push(a.roll.to_degrees() - r);
            pitch.push(a.pitch.to_degrees() - p);
        }
    }
    println!(
        "{} frames in flight: roll rms {:.2}°, pitch rms {:.2}°, pitch bias {:.2}°; trim learnt {:.1}° {:.1}°",
        roll.len(),
        rms(&roll),
        rms(&pitch),
        mean(&pitch),
        estimate.trim.roll.to_degrees(),
        estimate.trim.pitch.to_degrees()
    );
    assert!(roll.len() > 400);
    // The head sees as it should, though GPS smooths its turns; the report's sine shows them larger than they are.
    let most = if settings.estimator.method == Some(Method::Profile) { 0 } else { 20 };
    assert!(out_of_scale <= most, "the scale is said to be wrong in {out_of_scale} frames");
    Some(([roll, pitch], estimate.trim))
}

#[test]
fn the_report_s_scheme_on_a_real_flight() {
    let Some(([roll, pitch], _)) = flown(&settings(Method::InverseSine)) else { return };
    assert!((rms(&roll) - 8.8).abs() < 0.1 && (rms(&pitch) - 13.5).abs() < 0.1);
}

/// By the reference, which the learner never sees, the head of this flight sits some 9° nose up; by the
/// angle of climb some 6°, as the reference itself flies 3° nose down: that bias no slow reference can take off.
#[test]
fn the_profile_trimmed_from_gps_alone_on_a_real_flight() {
    let mut untaught = settings(Method::Profile);
    untaught.head.learn_trim = false;
    let Some(([_, plain], _)) = flown(&untaught) else { return };
    let Some(([_, pitch], learnt)) = flown(&settings(Method::Profile)) else { return };
    assert!((5.0..6.5).contains(&learnt.pitch.to_degrees()) && learnt.roll.to_degrees().abs() < 1.0);
    assert!(mean(&pitch) < mean(&plain) - 3.0 && rms(&pitch) < rms(&plain) - 1.5, "while it learns");
    // As `irhorizonctl trim --save` keeps it.
    let mut kept = untaught;
    (kept.head.roll_trim_deg, kept.head.pitch_trim_deg) = (learnt.roll.to_degrees(), learnt.pitch.to_degrees());
    let Some(([roll, pitch], _)) = flown(&kept) else { return };
    assert!(rms(&roll) < 7.0 && rms(&pitch) < 8.5 && mean(&pitch) < 3.0, "with the trim it has learnt");
}
