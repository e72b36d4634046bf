//! The sensors as a table.

use super::status::{duration, finite};
use super::view::{Fault, Sensor, Status};
use crate::bus::explain::{Facts, Place, explain_missing};
use crate::frame::Missing;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

const TITLES: [&str; 12] =
    ["NAME", "LOOKS", "CHIP", "AT", "OBJECT", "OWN", "VOLTS", "RESIDUAL", "SETTLES", "CHECK", "STATE", "COUNTS"];
/// The fault of which this table says what to look at.
const LOST: &str = "sensor-lost:";
/// The columns that hold numbers stand to the right.
const RIGHT: std::ops::Range<usize> = 4..9;

/// A line for each sensor under a line of titles, columns aligned.
pub fn table(s: &Status) -> String {
    let mut rows = vec![TITLES.map(str::to_owned)];
    rows.extend(s.sensors.iter().map(|x| cells(x, &s.faults)));
    let widths: [usize; TITLES.len()] =
        std::array::from_fn(|i| rows.iter().map(|r| r[i].chars().count()).max().unwrap_or(0));
    let mut text = String::new();
    for row in rows {
        let mut line = String::new();
        for (i, (cell, width)) in row.iter().zip(widths).enumerate() {
            let _ = match RIGHT.contains(&i) {
                true => write!(line, "{cell:>width$}  "),
                false => write!(line, "{cell:<width$}  "),
            };
        }
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text
}

/// Under the table: each sensor's faults, why it gives nothing or is left out, and what to do about it; of one that gives
/// nothing by what this machine knows of its bus.
pub fn remedies(s: &Status) -> String {
    let lines: Vec<String> = s.sensors.iter().flat_map(|x| remedy(x, &s.faults)).collect();
    lines.iter().enumerate().map(|(i, line)| format!("{}{line}\n", if i == 0 { "\n" } else { "" })).collect()
}

/// The faults of `s` itself, since when and what to do, and why there is no measurement of it.
fn remedy(s: &Sensor, faults: &[Fault]) -> Vec<String> {
    let why = missing(s, faults).and_then(|why| explain(s, why));
    let line = |f: &Fault| {
        let known = format!("{} for {} ({})", f.name, duration(f.for_s), f.evidence);
        // What to look at is said here.
        if f.name.starts_with(LOST) || f.advice.is_empty() { known } else { format!("{known}: {}", f.advice) }
    };
    own(s, faults).map(line).chain(why).collect()
}

/// `wet-sensor:nose`.
fn own<'a>(s: &'a Sensor, faults: &'a [Fault]) -> impl Iterator<Item = &'a Fault> {
    faults.iter().filter(|f| f.name.split_once(':').is_some_and(|(_, name)| name == s.name))
}

/// Why there is no measurement of `s`: of now, or of a fault that is not over yet.
fn missing(s: &Sensor, faults: &[Fault]) -> Option<Missing> {
    let told = |f: &Fault| f.evidence.split(", ").next().and_then(Missing::from_words);
    Missing::from_words(&s.state).or_else(|| own(s, faults).find_map(told))
}

/// What to look at where there is no measurement of `s`.
fn explain(s: &Sensor, why: Missing) -> Option<String> {
    if s.bus.is_empty() || why == Missing::NotYet {
        return None;
    }
    let chip = if s.kind == "ads1115" { "ADS1115" } else { "MLX90614" };
    let bus = PathBuf::from(&s.bus);
    // The daemon's user counts, not ours: the one of its unit.
    let facts = Facts { user: Some("irhorizon".to_owned()), ..Facts::gather(Path::new("/"), &bus, s.address) };
    let place = Place { name: s.name.clone(), chip, bus, address: s.address };
    Some(explain_missing(&place, why, &facts))
}

fn cells(s: &Sensor, faults: &[Fault]) -> [String; TITLES.len()] {
    let value = |v: Option<f64>, decimals: usize, unit: &str| {
        finite(v).map_or_else(|| "-".to_owned(), |v| format!("{v:.decimals$} {unit}"))
    };
    let at = if s.bus.is_empty() { "-".to_owned() } else { format!("{} {:#04x}", s.bus, s.address) };
    let settles = if s.settling_s > 0.0 { format!("{:.2} s", s.settling_s) } else { "-".to_owned() };
    let counts = s.counters.iter().filter(|(_, n)| *n > 0).map(|(name, n)| format!("{name} {n}"));
    [
        s.name.clone(),
        s.direction.clone(),
        s.kind.clone(),
        at,
        value(s.object_c, 2, "°C"),
        value(s.ambient_c, 2, "°C"),
        value(s.volts, 5, "V"),
        finite(s.residual_c)
            .map_or_else(|| "-".to_owned(), |k| format!("{:+.2} K", if k.abs() < 0.005 { 0.0 } else { k })),
        settles,
        s.integrity.clone(),
        missing(s, faults).map_or_else(|| s.state.clone(), |why| why.to_string()),
        counts.collect::<Vec<_>>().join(", "),
    ]
}
