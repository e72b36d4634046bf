//! The validated configuration: every value in range, every name resolved.

mod publishing;
mod sensor;
mod simulation;

pub use super::method::Method;
pub use publishing::{
    AUTOPILOT, BusAddress, DbusSettings, EndpointAddress, EndpointSettings, MavlinkSettings, Streams,
};
pub use sensor::{
    AdcInput, Ads1115Settings, DeviceSettings, LineSettings, Mlx90614Settings, PecPolicy, SensorSettings,
};
pub use simulation::{FlightName, SimulationSettings, SkyName};

use crate::head::{Head, Sensor, SensorKind};
use std::time::Duration;

/// Everything the daemon is told.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Scans a second, 1 to 200.
    pub rate_hz: f64,
    /// The quiet time left on a bus before each read, 0 to 20 ms (`[daemon] quiet-ms`).
    pub quiet: Duration,
    /// The sensors, each name once, no two in one place; none means the six named ones (simulation
    /// and replay).
    pub sensors: Vec<SensorSettings>,
    /// How the head sits on the airframe.
    pub head: HeadSettings,
    /// How attitude is estimated.
    pub estimator: EstimatorSettings,
    /// When and how it is withheld.
    pub faults: FaultSettings,
    /// Where attitude goes by MAVLink.
    pub mavlink: MavlinkSettings,
    /// Where it is shown on D-Bus.
    pub dbus: DbusSettings,
    /// A flight through a made-up sky in place of the hardware.
    pub simulation: Option<SimulationSettings>,
}

impl Settings {
    /// The head that these sensors make, with the buses in order of first mention.
    pub fn head(&self) -> Head {
        if self.sensors.is_empty() {
            return Head::six();
        }
        let mut buses: Vec<String> = Vec::new();
        let sensors = self
            .sensors
            .iter()
            .map(|s| {
                let path = s.device.bus().to_string_lossy().into_owned();
                let bus = buses.iter().position(|b| *b == path).unwrap_or_else(|| {
                    buses.push(path);
                    buses.len() - 1
                });
                let kind = match &s.device {
                    DeviceSettings::Mlx90614(m) => SensorKind::Absolute { offset_k: m.offset_c },
                    DeviceSettings::Ads1115(a) => {
                        SensorKind::Pair { neutral_v: a.neutral_v, kelvin_per_v: a.kelvin_per_v }
                    }
                };
                Sensor { name: s.name.clone(), direction: s.direction, kind, bus: Some(bus) }
            })
            .collect();
        Head::new(sensors, buses)
    }

    /// The method of estimation for these sensors.
    pub fn method(&self) -> Method {
        self.estimator.method_for(&self.head())
    }
}

/// `[head]`.
#[derive(Clone, Debug, PartialEq)]
pub struct HeadSettings {
    /// The roll that the head shows in level flight, °: taken off what is estimated. ±45.
    pub roll_trim_deg: f64,
    /// The pitch that the head shows in level flight, °: taken off what is estimated. ±45.
    pub pitch_trim_deg: f64,
    /// Whether what trims are missing is learnt in flight from GPS and airspeed.
    pub learn_trim: bool,
    /// The sensors' full field of view between half-power points, °: 5 to 150.
    pub field_of_view_deg: f64,
    /// The sensors' first-order time constant, s: 0 to 5. `None`: what their registers say, and where
    /// they say nothing [`HeadSettings::UNSAID_LAG_S`].
    pub lag_s: Option<f64>,
}

impl HeadSettings {
    /// The time constant of sensors of which nobody says anything, s.
    pub const UNSAID_LAG_S: f64 = 0.1;
}

/// `[estimator]`.
#[derive(Clone, Debug, PartialEq)]
pub struct EstimatorSettings {
    /// Which method; `None`: [`Method::usual`] for the head.
    pub method: Option<Method>,
    /// The time constant of the range's low-pass filter, s: 0.1 to 60.
    pub range_time_constant_s: f64,
    /// The largest roll given, °; 0 = no limit. `None`: [`Method::usual_roll_limit_deg`].
    pub roll_limit_deg: Option<f64>,
}

impl EstimatorSettings {
    /// The method for `head`: the chosen one, or the usual one.
    pub fn method_for(&self, head: &Head) -> Method {
        self.method.unwrap_or_else(|| Method::usual(head))
    }

    /// The limit of roll for `method`, °, 0 = none: the chosen one, or the method's own.
    pub fn roll_limit_deg_for(&self, method: Method) -> f64 {
        self.roll_limit_deg.unwrap_or(method.usual_roll_limit_deg())
    }
}

/// What ATTITUDE does while it must not be trusted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OnFault {
    /// It is not sent.
    #[default]
    Withhold,
    /// The last one stands in for a while, ever less sure.
    Hold,
    /// It eases to level.
    Level,
}

impl OnFault {
    /// All with their names.
    pub const NAMED: [(&'static str, Self); 3] =
        [("withhold", Self::Withhold), ("hold", Self::Hold), ("level", Self::Level)];

    /// The word that configuration spells it by.
    pub fn as_str(self) -> &'static str {
        Self::NAMED.iter().find(|(_, v)| *v == self).map_or("", |(name, _)| name)
    }
}

/// `[faults]`.
#[derive(Clone, Debug, PartialEq)]
pub struct FaultSettings {
    /// What ATTITUDE does while it must not be trusted.
    pub on_fault: OnFault,
    /// With [`OnFault::Hold`], how long the last attitude stands in, s: 0.1 to 30.
    pub hold_s: f64,
    /// The standard deviation, °, above which an attitude is not given: 2 to 90.
    pub sigma_limit_deg: f64,
    /// The least contrast below which attitude is withheld, K: 0.2 to 20.
    pub low_contrast_c: f64,
    /// The accuracy wanted of one scan, °, 0.5 to 30: a contrast at which the sensors' noise alone is worse is low.
    pub accuracy_deg: f64,
    /// The share of a film in what a sensor sees from which it is wet, %: 20 to 95.
    pub wet_percent: f64,
    /// The tilt that a scene might hide from which it is obstructed, °: 1 to 45.
    pub obstructed_deg: f64,
    /// The difference to the bank and climb being flown from which roll and pitch disagree with them, °: 2 to 90.
    pub disagree_deg: f64,
    /// How long a sensor must say the same while it should not, s: 0.2 to 60.
    pub stuck_after_s: f64,
    /// How long a sensor may give nothing before it is lost, s: 0.02 to 5.
    pub lost_after_s: f64,
    /// How long a sensor must give readings again before the fault ends, s: 0.02 to 5.
    pub back_after_s: f64,
    /// The age of the newest measurement at which the attitude is stale, s: 0.05 to 10.
    pub stale_after_s: f64,
    /// A lamp that is lit while attitude is withheld.
    pub lamp: Option<LineSettings>,
}
