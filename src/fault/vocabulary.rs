//! The kinds of fault, and what is kept of an active one.

use crate::frame::Missing;
use crate::time::Time;
use std::fmt;

/// A kind of fault; sensors and buses by their index in the head's list.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum FaultKind {
    /// Fog, heavy overcast: the vertical pair sees too little difference.
    LowContrast,
    /// Ground colder than sky: hail.
    InvertedContrast,
    /// A film of water or dirt dominates what a sensor sees.
    WetSensor(usize),
    /// Ridge, valley or cloud beside: the scene is not a horizon.
    Obstructed,
    /// Roll is not that of the turn being flown, by GPS and gyro.
    RollDisagrees,
    /// Pitch is not that of the climb being flown, by GPS.
    PitchDisagrees,
    /// A sensor says the same whatever the aircraft does.
    SensorStuck(usize),
    /// A sensor has given no measurement for a while.
    SensorLost(usize),
    /// A sensor has stood at the end of its range for a while.
    SensorSaturated(usize),
    /// A bus is absent, held, or may not be opened.
    BusDown(usize),
    /// The newest measurement, or the newest that tells of an attitude, is too old.
    Stale,
}

/// What speaks for a fault, in numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Evidence {
    /// A value beside the limit that it crossed.
    Limit {
        /// The value seen last.
        value: f64,
        /// The limit.
        limit: f64,
        /// The unit of both ("K", "s", "%", "°").
        unit: &'static str,
    },
    /// The reason why there is no measurement, and how many reads in a row it has failed.
    Missing {
        /// The reason given last.
        reason: Missing,
        /// Failed reads in a row, the most of them while the fault has been there.
        failures: u32,
    },
}

impl fmt::Display for Evidence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Limit { value, limit, unit } => write!(f, "{value:.2} {unit}, limit {limit:.2} {unit}"),
            Self::Missing { reason, failures: 1 } => write!(f, "{reason}, 1 read"),
            Self::Missing { reason, failures } => write!(f, "{reason}, {failures} reads in a row"),
        }
    }
}

/// A fault that is there now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActiveFault {
    /// Which.
    pub kind: FaultKind,
    /// Since when.
    pub since: Time,
    /// What speaks for it.
    pub evidence: Evidence,
}

/// The names that a fault's indices stand for.
pub trait FaultName {
    /// The name of sensor `index`.
    fn sensor(&self, index: usize) -> &str;
    /// The path of bus `index`.
    fn bus(&self, index: usize) -> &str;
}

impl FaultKind {
    /// Whether it is a sensor's or a bus's own.
    pub fn is_of_sensors(self) -> bool {
        use FaultKind::{BusDown, SensorLost, SensorSaturated, SensorStuck, WetSensor};
        matches!(self, WetSensor(_) | SensorStuck(_) | SensorLost(_) | SensorSaturated(_) | BusDown(_))
    }

    /// The fault as D-Bus, recordings, STATUSTEXT and `status` spell it: `sensor-lost:nose`.
    pub fn display<'a>(self, names: &'a dyn FaultName) -> impl fmt::Display + 'a {
        struct Named<'a>(FaultKind, &'a dyn FaultName);
        impl fmt::Display for Named<'_> {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                match self.0 {
                    FaultKind::LowContrast => f.write_str("low-contrast"),
                    FaultKind::InvertedContrast => f.write_str("inverted-contrast"),
                    FaultKind::WetSensor(i) => write!(f, "wet-sensor:{}", self.1.sensor(i)),
                    FaultKind::Obstructed => f.write_str("obstructed"),
                    FaultKind::RollDisagrees => f.write_str("roll-disagrees"),
                    FaultKind::PitchDisagrees => f.write_str("pitch-disagrees"),
                    FaultKind::SensorStuck(i) => write!(f, "sensor-stuck:{}", self.1.sensor(i)),
                    FaultKind::SensorLost(i) => write!(f, "sensor-lost:{}", self.1.sensor(i)),
                    FaultKind::SensorSaturated(i) => write!(f, "sensor-saturated:{}", self.1.sensor(i)),
                    FaultKind::BusDown(i) => write!(f, "bus-down:{}", self.1.bus(i)),
                    FaultKind::Stale => f.write_str("stale"),
                }
            }
        }
        Named(self, names)
    }
}
