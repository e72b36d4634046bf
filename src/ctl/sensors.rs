//! The sensors as a table.

use super::status::finite;
use super::view::{Fault, Sensor, Status};
use crate::bus::explain::{Facts, Place, explain_missing};
use crate::frame::Missing;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

const TITLES: [&str; 12] =
    ["NAME", "LOOKS", "CHIP", "AT", "OBJECT", "OWN", "VOLTS", "RESIDUAL", "SETTLES", "CHECK", "STATE", "COUNTS"];
/// The columns that hold numbers stand to the right.
const RIGHT: std::ops::Range<usize> = 4..9;

/// A line for each sensor under a line of titles, columns aligned.
pub fn table(sensors: &[Sensor]) -> String {
    let mut rows = vec![TITLES.map(str::to_owned)];
    rows.extend(sensors.iter().map(cells));
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

/// Under the table: why each sensor gives nothing or is left out, and what to do about it; of one that gives nothing
/// by what this machine knows of its bus.
pub fn remedies(s: &Status) -> String {
    let lines: Vec<String> = s.sensors.iter().flat_map(|x| missing(x).or_else(|| rejected(x, &s.faults))).collect();
    lines.iter().enumerate().map(|(i, line)| format!("{}{line}\n", if i == 0 { "\n" } else { "" })).collect()
}

/// Why there is no measurement of `s`.
fn missing(s: &Sensor) -> Option<String> {
    let why = Missing::from_words(&s.state).filter(|m| !s.bus.is_empty() && *m != Missing::NotYet)?;
    let chip = if s.kind == "ads1115" { "ADS1115" } else { "MLX90614" };
    let bus = PathBuf::from(&s.bus);
    // The daemon's user counts, not ours: the one of its unit.
    let facts = Facts { user: Some("irhorizon".to_owned()), ..Facts::gather(Path::new("/"), &bus, s.address) };
    let place = Place { name: s.name.clone(), chip, bus, address: s.address };
    Some(explain_missing(&place, why, &facts))
}

/// The faults of `s` itself: `wet-sensor:nose`.
fn rejected(s: &Sensor, faults: &[Fault]) -> Option<String> {
    let own = faults.iter().filter(|f| f.name.split_once(':').is_some_and(|(_, name)| name == s.name));
    let lines: Vec<String> = own.map(|f| format!("{} ({}): {}", f.name, f.evidence, f.advice)).collect();
    (!lines.is_empty()).then(|| lines.join("\n"))
}

fn cells(s: &Sensor) -> [String; TITLES.len()] {
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
        s.state.clone(),
        counts.collect::<Vec<_>>().join(", "),
    ]
}
