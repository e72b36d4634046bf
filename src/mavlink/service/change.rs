//! A change of one setting: where it stands in the configuration, and what it is to be.

use crate::config::{self, Settings};
use std::fmt;

/// Where a setting stands in the configuration.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Section {
    /// A table: `head`, `faults`.
    Table(&'static str),
    /// The `[[mavlink.endpoint]]` of this address.
    Endpoint(String),
}

/// A setting with its new value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Change {
    /// Where it stands.
    pub section: Section,
    /// Its key there.
    pub key: &'static str,
    /// Its value as TOML.
    pub value: String,
}

impl Section {
    /// The lines that begin it.
    pub fn header(&self) -> String {
        match self {
            Self::Table(table) => format!("[{table}]\n"),
            Self::Endpoint(address) => {
                let address = address.replace('\\', "\\\\").replace('"', "\\\"");
                format!("[[mavlink.endpoint]]\naddress = \"{address}\"\n")
            }
        }
    }
}

impl Change {
    /// The change as a drop-in of the configuration.
    pub fn toml(&self) -> String {
        format!("{}{} = {}\n", self.section.header(), self.key, self.value)
    }
}

impl fmt::Display for Change {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.section {
            Section::Table(table) => write!(f, "{table}.{} = {}", self.key, self.value),
            Section::Endpoint(address) => write!(f, "{} = {} of {address}", self.key, self.value),
        }
    }
}

/// `settings` with `changes`, judged as the configuration's own files are. The error is the first reason against them.
pub fn apply(settings: &Settings, changes: &[Change]) -> Result<Settings, String> {
    let mut settings = settings.clone();
    for change in changes {
        settings = config::amend(&settings, &change.toml())
            .map_err(|e| e.errors.first().map_or_else(|| e.to_string(), |first| first.message.clone()))?;
    }
    Ok(settings)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::settings::{DeviceSettings, Mlx90614Settings, PecPolicy, SensorSettings};
    use crate::direction::Direction;

    fn change(table: &'static str, key: &'static str, value: &str) -> Change {
        Change { section: Section::Table(table), key, value: value.into() }
    }

    #[test]
    fn a_change_changes_nothing_else() {
        let mut old = Settings::default();
        // A direction that is no round number of degrees.
        for (i, name) in ["a", "b", "c", "d", "e", "f"].into_iter().enumerate() {
            let device = DeviceSettings::Mlx90614(Mlx90614Settings {
                bus: "/dev/i2c-1".into(),
                address: 0x10 + i as u8,
                object: 1,
                pec: PecPolicy::Auto,
                offset_c: 0.1 * i as f64,
            });
            let angle = i as f64;
            let direction = Direction::from_angles(angle * 61.1, (angle * 17.3).sin() * 50.0).unwrap();
            old.sensors.push(SensorSettings { name: name.into(), direction, device, power: None });
        }
        let new = apply(&old, &[change("head", "roll-trim-deg", "2.5"), change("faults", "on-fault", "\"hold\"")]);
        let mut expected = old.clone();
        expected.head.roll_trim_deg = 2.5;
        expected.faults.on_fault = crate::config::settings::OnFault::Hold;
        assert_eq!(new, Ok(expected));
    }

    #[test]
    fn what_the_configuration_would_refuse_is_refused() {
        let refused = |c: Change| apply(&Settings::default(), &[c]).unwrap_err();
        assert_eq!(
            refused(change("head", "roll-trim-deg", "46")),
            "head.roll-trim-deg = 46 is out of range: -45 to 45°"
        );
        assert!(refused(change("head", "roll-trim", "46")).contains("not a known"));
        let nowhere = Section::Endpoint("udpout:\"".into());
        assert!(!refused(Change { section: nowhere, key: "texts", value: "true".into() }).is_empty());
    }
}
