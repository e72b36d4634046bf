//! Any bytes as a recording, through the daemon's own pipeline: an attitude is finite, and there is
//! one in the right modes only.
#![no_main]

use irhorizon::attitude::{Estimate, Mode};
use irhorizon::config::Settings;
use irhorizon::frame::Frame;
use irhorizon::horizon::Horizon;
use irhorizon::recording::Recording;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Ok(recording) = Recording::new(bytes, "fuzz.csv".into()) else { return };
    let Ok(mut reader) = recording.frames(None) else { return };
    let mut horizon = Horizon::new(&Settings::default(), reader.head().clone());
    let (mut frame, mut estimate) = (Frame::default(), Estimate::default());
    while reader.next_frame(&mut frame).expect("bytes in memory can be read") {
        horizon.update(&frame, &[], &mut estimate);
        let given = matches!(estimate.mode, Mode::Nominal | Mode::Degraded);
        assert_eq!(estimate.attitude.is_some(), given);
        if let Some(a) = estimate.attitude {
            assert!(a.roll.abs() <= std::f64::consts::PI && a.pitch.abs() <= std::f64::consts::FRAC_PI_2);
            assert!(estimate.sigma.roll >= 0.0 && estimate.sigma.pitch >= 0.0);
        }
    }
});
