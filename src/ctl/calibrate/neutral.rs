//! What sensors show while all sides are the same: the neutral voltages of pairs, and how far digital sensors are from
//! each other. Pure.

use super::Measured;
use super::average::mean;
use super::error::CalibrateError;
use crate::config::Settings;
use crate::config::settings::{Ads1115Settings, DeviceSettings, Mlx90614Settings};
use crate::ctl::view::{Sensor, Status};
use std::fmt::Write as _;

/// What is to be done first.
pub const INSTRUCTIONS: &str = "Cover the whole head so that all sides see the same: indoors, a thick cloth around it that touches \
                                no sensor, a minute to settle.";

/// A range of a pair above which it does see something, K.
const STILL_K: f64 = 1.0;
/// The largest standard error of a digital sensor's offset, K.
const SURE_K: f64 = 0.05;
/// The largest offset, K: the datasheet allows a sensor half a kelvin near room temperature.
const LARGEST_K: f64 = 2.0;

/// The pairs of the configuration.
fn pairs(settings: &Settings) -> impl Iterator<Item = (&str, &Ads1115Settings)> {
    settings.sensors.iter().filter_map(|s| match &s.device {
        DeviceSettings::Ads1115(ads) => Some((s.name.as_str(), ads)),
        DeviceSettings::Mlx90614(_) => None,
    })
}

/// The digital sensors of the configuration, if there is one to compare another with.
fn digital(settings: &Settings) -> Vec<(&str, &Mlx90614Settings)> {
    let sensors = settings.sensors.iter().filter_map(|s| match &s.device {
        DeviceSettings::Mlx90614(mlx) => Some((s.name.as_str(), mlx)),
        DeviceSettings::Ads1115(_) => None,
    });
    let sensors: Vec<_> = sensors.collect();
    if sensors.len() > 1 { sensors } else { Vec::new() }
}

/// Whether the daemon reads the sensors of the configuration.
pub fn ready(status: &Status, settings: &Settings) -> Result<(), CalibrateError> {
    let digital = digital(settings);
    if pairs(settings).next().is_none() && digital.is_empty() {
        return Err(CalibrateError::NothingNeutral);
    }
    pairs(settings).try_for_each(|(name, _)| volts(status, name).map(drop))?;
    digital.iter().try_for_each(|(name, _)| object_c(status, name).map(drop))
}

fn volts(status: &Status, name: &str) -> Result<f64, CalibrateError> {
    given(status, name, "no voltage", |s| s.volts)
}

fn object_c(status: &Status, name: &str) -> Result<f64, CalibrateError> {
    given(status, name, "no temperature", |s| s.object_c)
}

fn given(status: &Status, name: &str, lacking: &str, value: fn(&Sensor) -> Option<f64>) -> Result<f64, CalibrateError> {
    let silent = |why: &str| CalibrateError::Silent { sensor: name.to_owned(), why: why.to_owned() };
    let sensor = status.sensors.iter().find(|s| s.name == name).ok_or_else(|| silent("the daemon does not know it"))?;
    value(sensor).ok_or_else(|| silent(if sensor.state == "ok" { lacking } else { &sensor.state }))
}

/// Neutral voltages and offsets, told and as configuration.
pub(super) fn measure(looks: &[Status], settings: &Settings) -> Result<Measured, CalibrateError> {
    let mut measured = Measured { told: String::new(), lines: String::new() };
    measure_pairs(looks, settings, &mut measured)?;
    measure_digital(looks, &digital(settings), &mut measured)?;
    Ok(measured)
}

/// What each gives by itself.
fn measure_pairs(looks: &[Status], settings: &Settings, measured: &mut Measured) -> Result<(), CalibrateError> {
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
        // Tenths of a millivolt.
        let _ = writeln!(measured.lines, "[[sensor]]\nname = \"{name}\"\nneutral-v = {:.4}", rounded(m.value, 1e4));
    }
    Ok(())
}

/// How far each is from the mean of all, look by look: that the whole head warms up meanwhile does not matter.
fn measure_digital(
    looks: &[Status],
    sensors: &[(&str, &Mlx90614Settings)],
    measured: &mut Measured,
) -> Result<(), CalibrateError> {
    let look = |s: &Status| -> Result<Vec<f64>, CalibrateError> {
        let shown: Vec<f64> = sensors.iter().map(|(name, _)| object_c(s, name)).collect::<Result<_, _>>()?;
        let all = shown.iter().sum::<f64>() / shown.len() as f64;
        Ok(shown.iter().map(|k| k - all).collect())
    };
    let apart: Vec<Vec<f64>> = looks.iter().map(look).collect::<Result<_, _>>()?;
    for (i, (name, mlx)) in sensors.iter().enumerate() {
        let values: Vec<f64> = apart.iter().map(|k| k[i]).collect();
        let m = mean(&values).ok_or(CalibrateError::TooFew)?;
        if m.value.abs() > LARGEST_K {
            let sensor = (*name).to_owned();
            return Err(CalibrateError::NotCovered { sensor, apart: m.value, limit: LARGEST_K });
        }
        if m.error > SURE_K {
            let what = format!("how far {name} is from the others");
            return Err(CalibrateError::Unsure { what, error: m.error, limit: SURE_K });
        }
        let _ = writeln!(
            measured.told,
            "{name:<8} {:+.2} K ± {:.2} K against the others; offset {:+.2} K before",
            m.value, m.error, mlx.offset_c
        );
        let _ = writeln!(measured.lines, "[[sensor]]\nname = \"{name}\"\noffset-c = {:.2}", rounded(m.value, 1e2));
    }
    Ok(())
}

/// In whole shares of one, and never "-0.0000".
fn rounded(value: f64, shares: f64) -> f64 {
    (value * shares).round() / shares + 0.0
}
