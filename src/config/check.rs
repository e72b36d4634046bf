//! Checks across sensors: places, chips, GPIO lines; warnings.

use super::findings::Findings;
use super::sensor::{Read, Sensors};
use super::settings::{AUTOPILOT, DeviceSettings, LineSettings, MavlinkSettings, Method, Settings};
use super::source::Place;
use crate::direction::Direction;

/// Runs every check; `lamp` is the place of `[faults] lamp`.
pub fn check(settings: &Settings, sensors: &Sensors<'_>, lamp: Place, findings: &Findings<'_>) {
    for (i, sensor) in sensors.good.iter().enumerate() {
        let on_chip = |o: &&Read<'_>| same_chip(o, sensor);
        if let Some(first) = sensors.good[..i].iter().find(on_chip) {
            chip(sensor, first, findings);
        }
        if let Some(twin) = sensors.good[..i].iter().find(|o| same_chip(o, sensor) && same_input(o, sensor)) {
            taken(sensor, twin, findings);
        }
        if let DeviceSettings::Ads1115(a) = &sensor.settings.device
            && a.continuous
            && let Some(other) = sensors.good.iter().enumerate().find(|(j, o)| *j != i && on_chip(o)).map(|(_, o)| o)
        {
            let place = sensor.place("mode");
            findings.add(
                place,
                format!(
                    "{}: mode = \"continuous\" needs the chip to itself, and {} ({}) is on it: use \"single-shot\"",
                    sensor.label,
                    other.label,
                    findings.line(other.place(""), place)
                ),
            );
        }
    }
    lines(settings, sensors, lamp, findings);
}

fn same_chip(a: &Read<'_>, b: &Read<'_>) -> bool {
    let (a, b) = (&a.settings.device, &b.settings.device);
    a.bus() == b.bus() && a.address() == b.address()
}

/// Whether two sensors of one chip read the same object or input; those of different kinds cannot
/// both be there at all.
fn same_input(a: &Read<'_>, b: &Read<'_>) -> bool {
    match (&a.settings.device, &b.settings.device) {
        (DeviceSettings::Mlx90614(a), DeviceSettings::Mlx90614(b)) => a.object == b.object,
        (DeviceSettings::Ads1115(a), DeviceSettings::Ads1115(b)) => a.input == b.input,
        _ => true,
    }
}

fn taken(sensor: &Read<'_>, twin: &Read<'_>, findings: &Findings<'_>) {
    let (device, other) = (&sensor.settings.device, &twin.settings.device);
    let at = format!("address {:#04x} on {}", device.address(), device.bus().display());
    let (key, what, advice) = match (device, other) {
        (DeviceSettings::Mlx90614(_), DeviceSettings::Mlx90614(_)) => {
            ("address", at, "; each needs an address of its own")
        }
        (DeviceSettings::Ads1115(_), DeviceSettings::Ads1115(_)) => ("input", format!("the input of {at}"), ""),
        (DeviceSettings::Ads1115(_), _) => ("address", at, ", an mlx90614: one address, one chip"),
        (DeviceSettings::Mlx90614(_), _) => ("address", at, ", an ads1115: one address, one chip"),
    };
    let place = sensor.place(key);
    let line = findings.line(twin.place(key), place);
    findings.add(place, format!("{}: {what} is taken by {} ({line}){advice}", sensor.label, twin.label));
}

/// What belongs to the whole chip must be said alike by all its sensors.
fn chip(sensor: &Read<'_>, first: &Read<'_>, findings: &Findings<'_>) {
    let key = match (&sensor.settings.device, &first.settings.device) {
        (DeviceSettings::Mlx90614(a), DeviceSettings::Mlx90614(b)) if a.pec != b.pec => "pec",
        (DeviceSettings::Ads1115(a), DeviceSettings::Ads1115(b))
            if a.data_ready.is_some() && b.data_ready.is_some() && a.data_ready != b.data_ready =>
        {
            "data-ready"
        }
        _ if sensor.settings.power.is_some()
            && first.settings.power.is_some()
            && sensor.settings.power != first.settings.power =>
        {
            "power"
        }
        _ => return,
    };
    let place = sensor.place(key);
    let line = findings.line(first.place(key), place);
    let problem = format!("is set for the whole chip, and {} ({line}) sets it otherwise", first.label);
    findings.add(place, format!("{}: {key} {problem}", sensor.label));
}

/// A GPIO line in use.
struct Use<'a> {
    line: &'a LineSettings,
    /// Uses for the same purpose may share a line.
    purpose: String,
    place: Place,
    label: String,
}

/// Nothing uses a GPIO line that something else uses.
fn lines(settings: &Settings, sensors: &Sensors<'_>, lamp: Place, findings: &Findings<'_>) {
    let mut uses: Vec<Use<'_>> = Vec::new();
    for s in &sensors.good {
        let mut add = |line, key, purpose| {
            uses.push(Use { line, purpose, place: s.place(key), label: format!("{}: {key}", s.label) });
        };
        if let Some(line) = &s.settings.power {
            add(line, "power", "power".into());
        }
        if let DeviceSettings::Ads1115(a) = &s.settings.device
            && let Some(line) = &a.data_ready
        {
            add(line, "data-ready", format!("{} {}", a.bus.display(), a.address));
        }
    }
    if let Some(line) = &settings.faults.lamp {
        uses.push(Use { line, purpose: "lamp".into(), place: lamp, label: "faults.lamp".into() });
    }
    for (i, this) in uses.iter().enumerate() {
        let same = |u: &&Use<'_>| u.line.chip == this.line.chip && u.line.line == this.line.line;
        let Some(first) = uses[..i].iter().find(same) else { continue };
        let problem = if this.purpose != first.purpose {
            "is taken by"
        } else if this.line.active_low != first.line.active_low {
            "has another active-low in"
        } else {
            continue;
        };
        let LineSettings { chip, line, .. } = this.line;
        let there = findings.line(first.place, this.place);
        findings
            .add(this.place, format!("{}: GPIO line {line} of {chip} {problem} {} ({there})", this.label, first.label));
    }
}

/// What an upright pair shows of a clear sky, K.
const CLEAR_SKY_K: f64 = 50.0;

/// What is allowed but hardly meant.
pub fn warnings(settings: &Settings) -> Vec<String> {
    let mut warnings = Vec::new();
    let head = settings.head();
    // `field` uses every sensor by itself.
    let in_pairs = settings.method() != Method::Field;
    for (i, s) in head.sensors.iter().enumerate() {
        if in_pairs && !head.pairs.iter().any(|p| p.uses(i)) {
            warnings.push(format!("sensor \"{}\": no sensor looks the opposite way, so nothing uses it", s.name));
        }
        if Direction::named(&s.name).is_some_and(|d| d.dot(s.direction.components()) < 0.999) {
            warnings.push(format!("sensor \"{}\": in spite of its name it looks {}", s.name, s.direction));
        }
    }
    for s in &settings.sensors {
        if let DeviceSettings::Ads1115(a) = &s.device {
            let range_k = (a.gain_v - a.neutral_v.abs()) * a.kelvin_per_v.abs();
            if range_k < CLEAR_SKY_K {
                warnings.push(format!(
                    "sensor \"{}\": its range ends {range_k:.0} K from neutral, and a clear sky shows {CLEAR_SKY_K:.0} K: choose \
                     a larger gain-v",
                    s.name
                ));
            }
        }
    }
    let MavlinkSettings { system_id, component_id, autopilot_id, .. } = settings.mavlink;
    if component_id == AUTOPILOT && (system_id.is_none() || system_id == autopilot_id) {
        warnings.push(
            "mavlink.component-id = 1 is the autopilot's own: what this daemon sends is taken for the autopilot's; leave \
             191, or give system-id a number of its own"
                .into(),
        );
    }
    if settings.mavlink.endpoints.is_empty() && settings.dbus.bus.is_none() {
        warnings.push("no [[mavlink.endpoint]], and dbus.bus = \"none\": the attitude goes nowhere".into());
    }
    warnings
}
