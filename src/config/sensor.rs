//! `[[sensor]]`.

use super::endpoint::ordinal;
use super::findings::Findings;
use super::raw::{Table, Value};
use super::section::Section;
use super::settings::{AdcInput, Ads1115Settings, DeviceSettings, Mlx90614Settings, PecPolicy, SensorSettings};
use super::source::Place;
use super::validate::line;
use crate::direction::Direction;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// As many sensors as a head may have.
const MOST: usize = 32;
/// The longest name of a sensor, characters.
const NAME_LENGTH: usize = 24;
const MLX_KEYS: [&str; 3] = ["object", "pec", "offset-c"];
const ADS_KEYS: [&str; 7] = ["input", "gain-v", "data-rate-sps", "mode", "neutral-v", "kelvin-per-v", "data-ready"];

/// A sensor with the places that checks across sensors point at.
pub struct Read<'a> {
    /// What it was read as.
    pub settings: SensorSettings,
    /// `sensor "nose"`.
    pub label: String,
    header: Place,
    table: &'a Table,
}

impl Read<'_> {
    /// The place of `key`'s value, or of the sensor's header.
    pub fn place(&self, key: &str) -> Place {
        self.table.get(key).map_or(self.header, |e| e.node.place)
    }
}

/// The sensors that could be read.
pub struct Sensors<'a> {
    /// Those in which nothing is wrong.
    pub good: Vec<Read<'a>>,
    /// Whether these are all of them.
    pub complete: bool,
}

impl Sensors<'_> {
    /// The sensors' settings. A data-ready line is its chip's: all the chip's sensors get it.
    pub fn settings(&self) -> Vec<SensorSettings> {
        let mut sensors: Vec<SensorSettings> = self.good.iter().map(|r| r.settings.clone()).collect();
        for sensor in &mut sensors {
            let DeviceSettings::Ads1115(a) = &mut sensor.device else { continue };
            a.data_ready = self.good.iter().find_map(|r| match &r.settings.device {
                DeviceSettings::Ads1115(o) if (&o.bus, o.address) == (&a.bus, a.address) => o.data_ready.clone(),
                _ => None,
            });
        }
        sensors
    }
}

/// Reads all sensors.
pub fn read<'a>(root: &mut Section<'a>, findings: &'a Findings<'a>) -> Sensors<'a> {
    let before = findings.count();
    let tables = root.list("sensor", "[[sensor]]");
    if let Some((place, _)) = tables.get(MOST) {
        findings.add(*place, format!("sensor: there are {}, and a head has {MOST} at most", tables.len()));
    }
    let mut names = BTreeMap::new();
    let mut good = Vec::new();
    for (i, (header, table)) in tables.into_iter().take(MOST).enumerate() {
        let name = match table.get("name").map(|e| &e.node.value) {
            Some(Value::String(name)) if !name.is_empty() => Some(name.as_str()),
            _ => None,
        };
        let nth = ordinal(i + 1);
        let twin = name.and_then(|n| names.get(n).copied());
        let label = match (name, twin) {
            (Some(name), None) => format!("sensor \"{}\"", super::source::quoted(name)),
            (Some(name), Some(_)) => format!("sensor \"{}\" ({nth})", super::source::quoted(name)),
            (None, _) => format!("sensor ({nth})"),
        };
        let mut section = Section::new(findings, table, header, "[[sensor]]", format!("{label}: "));
        if let (Some(name), None) = (name, twin) {
            names.insert(name, section.place("name"));
        }
        if let Some(first) = twin {
            let place = section.place("name");
            section.wrong("name", &format!("is taken: the sensor on {} has it", findings.line(first, place)));
        }
        let count = findings.count();
        let settings = sensor(&mut section);
        section.finish();
        if let Some(settings) = settings.filter(|_| findings.count() == count && twin.is_none()) {
            good.push(Read { settings, label, header, table });
        }
    }
    Sensors { good, complete: findings.count() == before }
}

fn sensor(s: &mut Section<'_>) -> Option<SensorSettings> {
    let name = name(s);
    let direction = direction(s, name);
    let power = line(s, "power");
    let bus = bus(s);
    if !s.has("kind") {
        s.missing("kind", "\"mlx90614\" or \"ads1115\"");
    }
    let device = match s.choice("kind", &[("mlx90614", true), ("ads1115", false)]) {
        Some(true) => mlx90614(s, bus).map(DeviceSettings::Mlx90614),
        Some(false) => ads1115(s, bus).map(DeviceSettings::Ads1115),
        None => {
            s.skip(&["address"]);
            s.skip(&MLX_KEYS);
            s.skip(&ADS_KEYS);
            None
        }
    };
    Some(SensorSettings { name: name?.to_owned(), direction: direction?, device: device?, power })
}

fn mlx90614(s: &mut Section<'_>, bus: Option<PathBuf>) -> Option<Mlx90614Settings> {
    s.foreign(&ADS_KEYS, "is a key of kind \"ads1115\", and this is an mlx90614");
    let address = address(s, 0x03, 0x77, "an I²C address lies in 0x03..0x77");
    let object = s.integer("object", 1, 2, "1, or 2 of a part with two fields of view").unwrap_or(1);
    let policies = [("auto", PecPolicy::Auto), ("required", PecPolicy::Required), ("off", PecPolicy::Off)];
    let pec = s.choice("pec", &policies).unwrap_or_default();
    let offset_c = s.range("offset-c", -5.0, 5.0, " K").unwrap_or(0.0);
    Some(Mlx90614Settings { bus: bus?, address: address?, object: u8::try_from(object).ok()?, pec, offset_c })
}

fn ads1115(s: &mut Section<'_>, bus: Option<PathBuf>) -> Option<Ads1115Settings> {
    s.foreign(&MLX_KEYS, "is a key of kind \"mlx90614\", and this is an ads1115");
    let address = address(s, 0x48, 0x4b, "an ADS1115's address lies in 0x48..0x4b");
    if !s.has("input") {
        s.missing("input", "the pins that the pair is wired to, for example \"ain0-ain1\"");
    }
    let input = s.choice("input", &AdcInput::NAMED);
    let gain_v = s.number("gain-v", "6.144, 4.096, 2.048, 1.024, 0.512 or 0.256 V full scale", |v| {
        [6.144, 4.096, 2.048, 1.024, 0.512, 0.256].contains(&v)
    });
    let rate = s.number("data-rate-sps", "8, 16, 32, 64, 128, 250, 475 or 860 samples a second", |v| {
        [8.0, 16.0, 32.0, 64.0, 128.0, 250.0, 475.0, 860.0].contains(&v)
    });
    let continuous = s.choice("mode", &[("single-shot", false), ("continuous", true)]).unwrap_or(false);
    let gain_v = gain_v.unwrap_or(2.048);
    let neutral_v = s.range("neutral-v", -6.144, 6.144, " V").unwrap_or(0.0);
    if neutral_v.abs() >= gain_v {
        s.wrong("neutral-v", &format!("is beyond the range of ±{gain_v} V: choose a larger gain-v"));
    }
    let kelvin = "K for each V, 0.001 to 1000000, negative for a pair wired inverted";
    if !s.has("kelvin-per-v") {
        s.missing("kelvin-per-v", kelvin);
    }
    let kelvin_per_v = s.number("kelvin-per-v", kelvin, |v| (1e-3..=1e6).contains(&v.abs()));
    let data_ready = line(s, "data-ready");
    Some(Ads1115Settings {
        bus: bus?,
        address: address?,
        input: input?,
        gain_v,
        data_rate_sps: rate.unwrap_or(860.0) as u16,
        continuous,
        neutral_v,
        kelvin_per_v: kelvin_per_v?,
        data_ready,
    })
}

fn name<'a>(s: &mut Section<'a>) -> Option<&'a str> {
    let expected = format!("a lower-case letter, then letters, digits and _, {NAME_LENGTH} at most");
    if !s.has("name") {
        s.missing("name", &expected);
    }
    let name = s.string("name", &expected)?;
    if is_name(name) {
        return Some(name);
    }
    let near: String = name
        .to_lowercase()
        .chars()
        .take(NAME_LENGTH + 1)
        .map(|c| if c.is_ascii_alphanumeric() { c } else { '_' })
        .collect();
    let hint = if is_name(&near) { format!("; \"{near}\" would do") } else { String::new() };
    s.wrong("name", &format!("is not a sensor's name: {expected}{hint}"));
    None
}

fn is_name(name: &str) -> bool {
    name.len() <= NAME_LENGTH
        && name.starts_with(|c: char| c.is_ascii_lowercase())
        && name.bytes().all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_')
}

fn bus(s: &mut Section<'_>) -> Option<PathBuf> {
    let expected = "the bus's device, for example \"/dev/i2c-1\"";
    if !s.has("bus") {
        s.missing("bus", expected);
    }
    let bus = Path::new(s.string("bus", expected)?);
    if bus.is_absolute() && bus.as_os_str().len() <= 255 {
        // Without doubled slashes, so that one bus is spelled one way.
        return Some(bus.components().collect());
    }
    s.wrong("bus", &format!("is not a path: {expected}"));
    None
}

fn address(s: &mut Section<'_>, low: i64, high: i64, expected: &str) -> Option<u8> {
    if !s.has("address") {
        s.missing("address", expected);
    }
    u8::try_from(s.integer("address", low, high, expected)?).ok()
}

fn direction(s: &mut Section<'_>, name: Option<&str>) -> Option<Direction> {
    let angles = "{ azimuth-deg = 45.0, elevation-deg = 0.0 }";
    if s.holds_table("direction") {
        let mut s = s.section("direction", angles, "direction.");
        let azimuth = s.range("azimuth-deg", -360.0, 360.0, "°, clockwise from the nose");
        let elevation = s.range("elevation-deg", -90.0, 90.0, "°, up positive");
        for key in ["azimuth-deg", "elevation-deg"] {
            if !s.has(key) {
                s.missing(key, &format!("a direction is {angles}"));
            }
        }
        s.finish();
        return Direction::from_angles(azimuth?, elevation?);
    }
    if s.has("direction") {
        return s.choice("direction", &Direction::NAMED);
    }
    s.skip(&["direction"]);
    let named = Direction::named(name?);
    if named.is_none() {
        let names = Direction::NAMED.map(|(n, _)| n).join(", ");
        s.missing("direction", &format!("its name is not one of {names}; say one of these, or {angles}"));
    }
    named
}
