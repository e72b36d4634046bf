//! The settings that may be changed by MAVLink, as parameters: 32-bit floats under names of up to 16 characters.
//!
//! Which values are good is the configuration's to say: a parameter is a key of it, and setting one is writing that
//! key. Switches are 0 and 1, choices count from 0.

use super::change::{Change, Section};
use crate::config::Settings;
use crate::config::settings::{EndpointSettings, OnFault};
use std::fmt::Write;

/// How a number is spelled in the configuration.
enum Kind {
    Number,
    Switch,
    Choice(&'static [(&'static str, OnFault)]),
}

use Kind::{Choice, Number, Switch};

/// A setting of the daemon: parameter, table, key.
struct Row(&'static str, &'static str, &'static str, Kind, fn(&Settings) -> f64);

const ROWS: &[Row] = &[
    Row("IRH_ROLL_TRIM", "head", "roll-trim-deg", Number, |s| s.head.roll_trim_deg),
    Row("IRH_PITCH_TRIM", "head", "pitch-trim-deg", Number, |s| s.head.pitch_trim_deg),
    Row("IRH_LEARN_TRIM", "head", "learn-trim", Switch, |s| switch(s.head.learn_trim)),
    Row("IRH_FOV", "head", "field-of-view-deg", Number, |s| s.head.field_of_view_deg),
    Row("IRH_RANGE_TC", "estimator", "range-time-constant-s", Number, |s| s.estimator.range_time_constant_s),
    Row("IRH_ROLL_LIMIT", "estimator", "roll-limit-deg", Number, |s| s.estimator.roll_limit_deg_for(s.method())),
    Row("IRH_ON_FAULT", "faults", "on-fault", Choice(&OnFault::NAMED), |s| choice(s.faults.on_fault)),
    Row("IRH_HOLD_S", "faults", "hold-s", Number, |s| s.faults.hold_s),
    Row("IRH_SIGMA_LIM", "faults", "sigma-limit-deg", Number, |s| s.faults.sigma_limit_deg),
    Row("IRH_LOW_CONTR", "faults", "low-contrast-c", Number, |s| s.faults.low_contrast_c),
    Row("IRH_ACCURACY", "faults", "accuracy-deg", Number, |s| s.faults.accuracy_deg),
    Row("IRH_WET_PCT", "faults", "wet-percent", Number, |s| s.faults.wet_percent),
    Row("IRH_OBSTRUCT", "faults", "obstructed-deg", Number, |s| s.faults.obstructed_deg),
    Row("IRH_DISAGREE", "faults", "disagree-deg", Number, |s| s.faults.disagree_deg),
    Row("IRH_STUCK_S", "faults", "stuck-after-s", Number, |s| s.faults.stuck_after_s),
    Row("IRH_LOST_S", "faults", "lost-after-s", Number, |s| s.faults.lost_after_s),
    Row("IRH_BACK_S", "faults", "back-after-s", Number, |s| s.faults.back_after_s),
    Row("IRH_STALE_S", "faults", "stale-after-s", Number, |s| s.faults.stale_after_s),
    Row("IRH_AIDING", "mavlink", "aiding", Switch, |s| switch(s.mavlink.aiding)),
    Row("IRH_YAW", "mavlink", "yaw", Switch, |s| switch(s.mavlink.yaw)),
    Row("IRH_SYS_STATUS", "mavlink", "sys-status", Switch, |s| switch(s.mavlink.sys_status)),
];

/// A setting of an endpoint: the end of the parameter's name, key. `IRH_E1_ATT_HZ` is of the first one.
struct StreamRow(&'static str, &'static str, Kind, fn(&EndpointSettings, f64) -> f64);

const STREAMS: &[StreamRow] = &[
    StreamRow("ATT_HZ", "attitude-hz", Number, |e, rate_hz| e.streams.attitude_hz.unwrap_or(rate_hz)),
    StreamRow("QUAT_HZ", "quaternion-hz", Number, |e, _| e.streams.quaternion_hz),
    StreamRow("COV_HZ", "covariance-hz", Number, |e, _| e.streams.covariance_hz),
    StreamRow("VAL_HZ", "values-hz", Number, |e, _| e.streams.values_hz),
    StreamRow("TEXTS", "texts", Switch, |e, _| switch(e.streams.texts)),
];

/// The most parameters that there are: of 16 endpoints.
pub const MOST: usize = ROWS.len() + 16 * STREAMS.len();

fn switch(on: bool) -> f64 {
    f64::from(u8::from(on))
}

fn choice(on_fault: OnFault) -> f64 {
    OnFault::NAMED.iter().position(|(_, v)| *v == on_fault).map_or(0.0, |i| i as f64)
}

impl Kind {
    /// `value` as the configuration spells it, or what is wanted instead.
    fn spell(&self, value: f32) -> Result<String, String> {
        match self {
            Number if value.is_finite() => Ok(value.to_string()),
            Number => Err("a finite number".into()),
            Switch if value == 0.0 || value == 1.0 => Ok((value == 1.0).to_string()),
            Switch => Err("0 or 1".into()),
            Choice(names) => match names.iter().enumerate().find(|(i, _)| *i as f32 == value) {
                Some((_, (name, _))) => Ok(format!("\"{name}\"")),
                None => {
                    let mut wanted = String::new();
                    for (i, (name, _)) in names.iter().enumerate() {
                        // Writing to a String does not fail.
                        let _ = write!(wanted, "{}{i} ({name})", if i > 0 { ", " } else { "" });
                    }
                    Err(wanted)
                }
            },
        }
    }
}

/// How many parameters there are.
pub fn count(settings: &Settings) -> usize {
    (ROWS.len() + settings.mavlink.endpoints.len() * STREAMS.len()).min(MOST)
}

/// The parameter of an index: one of the daemon, or one of an endpoint.
enum At<'a> {
    Daemon(&'static Row),
    Endpoint(usize, &'a EndpointSettings, &'static StreamRow),
}

fn at(settings: &Settings, index: usize) -> Option<At<'_>> {
    if let Some(row) = ROWS.get(index) {
        return Some(At::Daemon(row));
    }
    let beyond = index.checked_sub(ROWS.len())?;
    let number = beyond / STREAMS.len();
    let endpoint = settings.mavlink.endpoints.get(number).filter(|_| index < MOST)?;
    Some(At::Endpoint(number + 1, endpoint, STREAMS.get(beyond % STREAMS.len())?))
}

/// The name of the parameter at `index`.
pub fn name(settings: &Settings, index: usize) -> Option<String> {
    Some(match at(settings, index)? {
        At::Daemon(Row(name, ..)) => (*name).to_owned(),
        At::Endpoint(number, _, StreamRow(name, ..)) => format!("IRH_E{number}_{name}"),
    })
}

/// The value of the parameter at `index`.
pub fn value(settings: &Settings, index: usize) -> Option<f32> {
    let value = match at(settings, index)? {
        At::Daemon(Row(.., get)) => get(settings),
        At::Endpoint(_, endpoint, StreamRow(.., get)) => get(endpoint, settings.rate_hz),
    };
    Some(value as f32)
}

/// The index of the parameter called `name`: up to 16 bytes, zeros behind.
pub fn find(settings: &Settings, wanted: &[u8]) -> Option<usize> {
    let wanted = wanted.split(|b| *b == 0).next().unwrap_or_default();
    (0..count(settings)).find(|i| name(settings, *i).is_some_and(|n| n.as_bytes() == wanted))
}

/// The change that gives the parameter at `index` the value `value`; the error says what is wanted instead.
pub fn change(settings: &Settings, index: usize, value: f32) -> Result<Change, String> {
    match at(settings, index).ok_or("a parameter that there is")? {
        At::Daemon(Row(_, table, key, kind, _)) => {
            Ok(Change { section: Section::Table(table), key, value: kind.spell(value)? })
        }
        At::Endpoint(_, endpoint, StreamRow(_, key, kind, _)) => {
            let section = Section::Endpoint(endpoint.address.to_string());
            Ok(Change { section, key, value: kind.spell(value)? })
        }
    }
}

/// The trims of roll and pitch, °, to a thousandth.
pub fn trims(roll_deg: f64, pitch_deg: f64) -> [Change; 2] {
    [("roll-trim-deg", roll_deg), ("pitch-trim-deg", pitch_deg)].map(|(key, deg)| Change {
        section: Section::Table("head"),
        key,
        value: ((deg * 1000.0).round() / 1000.0 + 0.0).to_string(),
    })
}

#[cfg(test)]
mod tests;
