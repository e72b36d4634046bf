//! The neutral voltages: what pairs give while they see no difference. Pure.

use super::Measured;
use super::average::mean;
use super::error::CalibrateError;
use crate::config::Settings;
use crate::config::settings::{Ads1115Settings, DeviceSettings};
use crate::ctl::view::Status;
use std::fmt::Write as _;

/// What is to be done first.
pub const INSTRUCTIONS: &str = "Cover the whole head so that all sides see the same: indoors, a thick cloth around it that touches \
                                no sensor, a minute to settle.";

/// A range of a pair above which it does see something, K.
const STILL_K: f64 = 1.0;

/// The pairs of the configuration.
fn pairs(settings: &Settings) -> impl Iterator<Item = (&str, &Ads1115Settings)> {
    settings.sensors.iter().filter_map(|s| match &s.device {
        DeviceSettings::Ads1115(ads) => Some((s.name.as_str(), ads)),
        DeviceSettings::Mlx90614(_) => None,
    })
}

/// Whether the daemon reads the pairs of the configuration.
pub fn ready(status: &Status, settings: &Settings) -> Result<(), CalibrateError> {
    if pairs(settings).next().is_none() {
        return Err(CalibrateError::NoPairs);
    }
    pairs(settings).try_for_each(|(name, _)| volts(status, name).map(drop))
}

fn volts(status: &Status, name: &str) -> Result<f64, CalibrateError> {
    let silent = |why: &str| CalibrateError::Silent { sensor: name.to_owned(), why: why.to_owned() };
    let sensor = status.sensors.iter().find(|s| s.name == name).ok_or_else(|| silent("the daemon does not know it"))?;
    sensor.volts.ok_or_else(|| silent(if sensor.state == "ok" { "no voltage" } else { &sensor.state }))
}

/// The neutral voltages, told and as configuration.
pub(super) fn measure(looks: &[Status], settings: &Settings) -> Result<Measured, CalibrateError> {
    let mut measured = Measured { told: String::new(), lines: String::new() };
    for (name, ads) in pairs(settings) {
        let values: Vec<f64> = looks.iter().map(|s| volts(s, name)).collect::<Result<_, _>>()?;
        let m = mean(&values).ok_or(CalibrateError::TooFew)?;
        let range_k = m.range * ads.kelvin_per_v.abs();
        if range_k > STILL_K {
            let what = format!("what {name} sees");
            return Err(CalibrateError::Moving { what, range: range_k, limit: STILL_K, unit: " K" });
        }
        let _ = writeln!(
            measured.told,
            "{name:<8} {:.4} V ± {:.4} V; neutral {:.4} V before ({:+.2} K off)",
            m.value,
            m.error,
            ads.neutral_v,
            (m.value - ads.neutral_v) * ads.kelvin_per_v
        );
        // Tenths of a millivolt, and never "-0.0000".
        let tenths = (m.value * 1e4).round() / 1e4 + 0.0;
        let _ = writeln!(measured.lines, "[[sensor]]\nname = \"{name}\"\nneutral-v = {:.4}", tenths);
    }
    Ok(measured)
}
