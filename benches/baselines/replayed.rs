//! A published scheme's attitude as `irhorizonctl replay` takes it.

use super::schemes::{self, Baseline};
use irhorizon::attitude::{Attitude, Estimate, Mode};
use irhorizon::frame::Frame;
use irhorizon::head::Head;

/// What `baseline` makes of `frame`, less `trim`; without standard deviations.
pub fn estimate(baseline: &mut dyn Baseline, head: &Head, frame: &Frame, trim: Attitude) -> Estimate {
    let attitude = schemes::update(baseline, head, frame).map(|(roll_deg, pitch_deg)| {
        let Attitude { roll, pitch } = Attitude::from_degrees(roll_deg, pitch_deg);
        Attitude { roll: roll - trim.roll, pitch: pitch - trim.pitch }
    });
    Estimate {
        time: frame.time,
        valid_at: frame.time,
        attitude,
        sigma: Attitude { roll: f64::NAN, pitch: f64::NAN },
        mode: if attitude.is_some() { Mode::Nominal } else { Mode::Starting },
        ..Estimate::default()
    }
}
