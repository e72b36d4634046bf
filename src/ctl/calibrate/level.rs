//! The trims of roll and pitch: what the head shows while the aircraft is level. Pure.

use super::Measured;
use super::average::{Mean, mean};
use super::error::CalibrateError;
use crate::attitude::Attitude;
use crate::ctl::trim;
use crate::ctl::view::{Status, Trim};
use crate::estimator::trim::shown;

/// What is to be done first.
pub const INSTRUCTIONS: &str = "Outdoors, with a free view of the horizon all around and higher above the ground than what stands \
                                on it, hold or put the aircraft level as in level flight, and still.";

/// A standard deviation of the daemon's above which an attitude is no measure, °.
const SIGMA_DEG: f64 = 5.0;
/// A range of roll or pitch above which the aircraft moves, °.
const STILL_DEG: f64 = 2.0;
/// A standard error above which a mean is not worth saving, °.
const ERROR_DEG: f64 = 0.2;
/// A trim above which it is no trim, °: the aircraft is not level, or a direction is wrong.
const LARGEST_DEG: f64 = 20.0;

/// Whether the daemon gives what can be averaged.
pub fn ready(s: &Status) -> Result<(), CalibrateError> {
    let (Some(_), Some(_)) = (s.roll_deg, s.pitch_deg) else { return Err(CalibrateError::Withheld(s.mode.clone())) };
    if s.mode != "nominal" {
        return Err(CalibrateError::Withheld(s.mode.clone()));
    }
    let sigma_deg = s.roll_sigma_deg.into_iter().chain(s.pitch_sigma_deg).fold(0.0, f64::max);
    if sigma_deg > SIGMA_DEG { Err(CalibrateError::Uncertain { sigma_deg, limit_deg: SIGMA_DEG }) } else { Ok(()) }
}

/// A head's trim as it was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Level {
    /// Roll shown, °.
    pub roll: Mean,
    /// Pitch shown, °.
    pub pitch: Mean,
    /// The largest standard deviations that the daemon gave with them, of roll and pitch, °.
    pub sigma_deg: [Option<f64>; 2],
    /// The trim by which they were shown, °.
    pub before: Trim,
    /// The one that makes them zero, °.
    pub after: Trim,
}

impl Level {
    /// Of what the daemon said at some times.
    pub fn of(looks: &[Status]) -> Result<Self, CalibrateError> {
        looks.iter().try_for_each(ready)?;
        let first = looks.first().ok_or(CalibrateError::TooFew)?;
        let all = |pick: fn(&Status) -> Option<f64>| -> Vec<f64> { looks.iter().filter_map(pick).collect() };
        let roll = mean(&all(|s| s.roll_deg)).ok_or(CalibrateError::TooFew)?;
        let pitch = mean(&all(|s| s.pitch_deg)).ok_or(CalibrateError::TooFew)?;
        for (what, m) in [("roll", roll), ("pitch", pitch)] {
            if m.range > STILL_DEG {
                return Err(CalibrateError::Moving {
                    what: what.to_owned(),
                    range: m.range,
                    limit: STILL_DEG,
                    unit: "°",
                });
            }
            if m.error > ERROR_DEG {
                return Err(CalibrateError::Moving {
                    what: what.to_owned(),
                    range: m.error,
                    limit: ERROR_DEG,
                    unit: "° of standard error",
                });
            }
        }
        let worst = |pick: fn(&Status) -> Option<f64>| looks.iter().filter_map(pick).reduce(f64::max);
        let sigma_deg = [worst(|s| s.roll_sigma_deg), worst(|s| s.pitch_sigma_deg)];
        let before = first.trim;
        let trim = Attitude::from_degrees(before.roll_deg, before.pitch_deg);
        let seen = Attitude::from_degrees(roll.value, pitch.value);
        // As the daemon takes the trim off: inverse-sine subtracts it, the others turn by it.
        let raw = if first.method == "inverse-sine" {
            Attitude { roll: seen.roll + trim.roll, pitch: seen.pitch + trim.pitch }
        } else {
            shown(seen, trim)
        };
        let after = Trim { roll_deg: raw.roll.to_degrees(), pitch_deg: raw.pitch.to_degrees(), ..Trim::default() };
        let largest = after.roll_deg.abs().max(after.pitch_deg.abs());
        if largest > LARGEST_DEG {
            return Err(CalibrateError::NotLevel { trim_deg: largest, limit_deg: LARGEST_DEG });
        }
        Ok(Self { roll, pitch, sigma_deg, before, after })
    }
}

/// The trims, told and as configuration.
pub(super) fn measure(looks: &[Status]) -> Result<Measured, CalibrateError> {
    let l = Level::of(looks)?;
    let line = |what: &str, m: Mean, sigma_deg: Option<f64>, before: f64, after: f64| {
        let (shown, scatter) = (zeroed(m.value), m.error);
        let sigma = sigma_deg.map_or_else(|| "unknown".to_owned(), |s| format!("{s:.2}°"));
        format!("{what:<6} shown {shown:+.2}°, scatter ±{scatter:.2}°, σ {sigma}; trim {before:+.2}° → {after:+.2}°\n")
    };
    let [roll_sigma, pitch_sigma] = l.sigma_deg;
    let told = line("roll", l.roll, roll_sigma, l.before.roll_deg, l.after.roll_deg)
        + &line("pitch", l.pitch, pitch_sigma, l.before.pitch_deg, l.after.pitch_deg);
    Ok(Measured { told, lines: trim::lines(l.after) })
}

/// Never "-0.00".
fn zeroed(value: f64) -> f64 {
    if value.abs() < 0.005 { 0.0 } else { value }
}
