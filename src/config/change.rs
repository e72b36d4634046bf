//! What differs between two configurations, and whether a running daemon can take it up.

use super::Settings;
use super::settings::FaultSettings;

/// A part of the settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// `[daemon]`.
    Daemon,
    /// The `[[sensor]]`s.
    Sensors,
    /// `[head]`, but for the trims.
    Head,
    /// `[head] roll-trim-deg` and `pitch-trim-deg`.
    Trim,
    /// `[estimator]`.
    Estimator,
    /// `[faults]`, but for the lamp.
    Faults,
    /// `[faults] lamp`.
    Lamp,
    /// `[mavlink]` and its endpoints.
    Mavlink,
    /// `[dbus] bus`.
    DbusBus,
    /// `[dbus] update-hz`.
    DbusUpdate,
    /// `[simulation]`.
    Simulation,
}

impl Change {
    /// Whether the daemon must be restarted for it: its name on a bus stays where it is.
    pub const fn needs_restart(self) -> bool {
        matches!(self, Self::DbusBus)
    }

    /// Whether the sampling loop must begin anew for it, and with it the estimate.
    pub const fn begins_anew(self) -> bool {
        match self {
            Self::Daemon | Self::Sensors | Self::Head | Self::Estimator | Self::Lamp | Self::Simulation => true,
            Self::Trim | Self::Faults | Self::Mavlink | Self::DbusBus | Self::DbusUpdate => false,
        }
    }

    /// The part as the configuration spells it.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Daemon => "daemon",
            Self::Sensors => "sensor",
            Self::Head => "head",
            Self::Trim => "head.roll-trim-deg and pitch-trim-deg",
            Self::Estimator => "estimator",
            Self::Faults => "faults",
            Self::Lamp => "faults.lamp",
            Self::Mavlink => "mavlink",
            Self::DbusBus => "dbus.bus",
            Self::DbusUpdate => "dbus.update-hz",
            Self::Simulation => "simulation",
        }
    }
}

/// The parts in which `new` differs from `old`.
pub fn changes(old: &Settings, new: &Settings) -> Vec<Change> {
    let trims = |s: &Settings| (s.head.roll_trim_deg, s.head.pitch_trim_deg);
    let mut head = new.head.clone();
    (head.roll_trim_deg, head.pitch_trim_deg) = trims(old);
    let faults = FaultSettings { lamp: old.faults.lamp.clone(), ..new.faults.clone() };
    [
        (Change::Daemon, old.rate_hz != new.rate_hz || old.quiet != new.quiet),
        (Change::Sensors, old.sensors != new.sensors),
        (Change::Head, old.head != head),
        (Change::Trim, trims(old) != trims(new)),
        (Change::Estimator, old.estimator != new.estimator),
        (Change::Faults, old.faults != faults),
        (Change::Lamp, old.faults.lamp != new.faults.lamp),
        (Change::Mavlink, old.mavlink != new.mavlink),
        (Change::DbusBus, old.dbus.bus != new.dbus.bus),
        (Change::DbusUpdate, old.dbus.update_hz != new.dbus.update_hz),
        (Change::Simulation, old.simulation != new.simulation),
    ]
    .into_iter()
    .filter_map(|(change, differs)| differs.then_some(change))
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_another_bus_needs_a_restart() {
        let old = Settings::default();
        assert_eq!(changes(&old, &old), []);
        let mut new = old.clone();
        new.rate_hz = 20.0;
        new.faults.low_contrast_c = 3.0;
        new.head.roll_trim_deg = 2.0;
        new.dbus.bus = None;
        let changes = changes(&old, &new);
        assert_eq!(changes, [Change::Daemon, Change::Trim, Change::Faults, Change::DbusBus]);
        let restart: Vec<&str> = changes.iter().filter(|c| c.needs_restart()).map(|c| c.as_str()).collect();
        assert_eq!(restart, ["dbus.bus"]);
        let anew: Vec<&str> = changes.iter().filter(|c| c.begins_anew()).map(|c| c.as_str()).collect();
        assert_eq!(anew, ["daemon"]);
    }
}
