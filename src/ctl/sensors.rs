//! The sensors as a table.

use super::status::finite;
use super::view::Sensor;
use crate::bus::explain::{Facts, Place, explain_missing};
use crate::frame::Missing;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

const TITLES: [&str; 11] =
    ["NAME", "LOOKS", "CHIP", "AT", "OBJECT", "OWN", "VOLTS", "SETTLES", "CHECK", "STATE", "COUNTS"];
/// The columns that hold numbers stand to the right.
const RIGHT: std::ops::Range<usize> = 4..8;

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

/// Under the table: why each sensor gives nothing, and what to do about it, by what this machine
/// knows of its bus.
pub fn remedies(sensors: &[Sensor]) -> String {
    let mut text = String::new();
    for s in sensors.iter().filter(|s| !s.bus.is_empty()) {
        let Some(why) = Missing::from_words(&s.state).filter(|m| *m != Missing::NotYet) else { continue };
        let chip = if s.kind == "ads1115" { "ADS1115" } else { "MLX90614" };
        let bus = PathBuf::from(&s.bus);
        // The daemon's user counts, not ours: the one of its unit.
        let facts = Facts { user: Some("irhorizon".to_owned()), ..Facts::gather(Path::new("/"), &bus, s.address) };
        let place = Place { name: s.name.clone(), chip, bus, address: s.address };
        let gap = if text.is_empty() { "\n" } else { "" };
        let _ = writeln!(text, "{gap}{}", explain_missing(&place, why, &facts));
    }
    text
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
        settles,
        s.integrity.clone(),
        s.state.clone(),
        counts.collect::<Vec<_>>().join(", "),
    ]
}
