//! The validated configuration: every value in range, every name resolved.

pub use super::method::Method;

use crate::direction::Direction;
use crate::head::{Head, Sensor, SensorKind};
use crate::simulation::Fault;
use std::fmt;
use std::net::SocketAddr;
use std::path::PathBuf;
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
                    DeviceSettings::Mlx90614(_) => SensorKind::Absolute,
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

/// One `[[sensor]]`.
#[derive(Clone, Debug, PartialEq)]
pub struct SensorSettings {
    /// Lower-case letters, digits and `_`, a letter first.
    pub name: String,
    /// Where it looks; for a pair, the direction whose rising raises its signal.
    pub direction: Direction,
    /// The chip it is read from.
    pub device: DeviceSettings,
    /// A line that feeds it, to power-cycle it when it hangs.
    pub power: Option<LineSettings>,
}

/// The chip a sensor is read from.
#[derive(Clone, Debug, PartialEq)]
pub enum DeviceSettings {
    /// A digital thermopile.
    Mlx90614(Mlx90614Settings),
    /// A channel of an ADC that carries a pair's difference.
    Ads1115(Ads1115Settings),
}

impl DeviceSettings {
    /// The bus it is on.
    pub fn bus(&self) -> &PathBuf {
        match self {
            Self::Mlx90614(m) => &m.bus,
            Self::Ads1115(a) => &a.bus,
        }
    }

    /// Its address on the bus, 7 bits.
    pub fn address(&self) -> u8 {
        match self {
            Self::Mlx90614(m) => m.address,
            Self::Ads1115(a) => a.address,
        }
    }
}

/// A digital thermopile (`kind = "mlx90614"`).
#[derive(Clone, Debug, PartialEq)]
pub struct Mlx90614Settings {
    /// `/dev/i2c-N`.
    pub bus: PathBuf,
    /// 0x03 to 0x77.
    pub address: u8,
    /// Which of a dual-zone part's objects: 1 or 2.
    pub object: u8,
    /// What to do about the packet error code.
    pub pec: PecPolicy,
}

/// What to do about the packet error code of an MLX90614.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PecPolicy {
    /// Check it where the adapter can, say so where it cannot.
    #[default]
    Auto,
    /// Without it the sensor counts as lost.
    Required,
    /// Never check it: for parts and adapters whose read PEC does not match.
    Off,
}

/// A channel of an ADC (`kind = "ads1115"`).
#[derive(Clone, Debug, PartialEq)]
pub struct Ads1115Settings {
    /// `/dev/i2c-N`.
    pub bus: PathBuf,
    /// 0x48 to 0x4b.
    pub address: u8,
    /// The pins.
    pub input: AdcInput,
    /// Full scale, V: 6.144, 4.096, 2.048, 1.024, 0.512 or 0.256.
    pub gain_v: f64,
    /// Samples a second: 8, 16, 32, 64, 128, 250, 475 or 860.
    pub data_rate_sps: u16,
    /// Convert all the time (needs the chip to itself) instead of once for each scan.
    pub continuous: bool,
    /// The pair's voltage when it sees no difference, V.
    pub neutral_v: f64,
    /// Kelvin for a volt; negative for a pair wired inverted; never 0.
    pub kelvin_per_v: f64,
    /// The line that ALERT/RDY is wired to; without it the conversion is waited for and polled.
    pub data_ready: Option<LineSettings>,
}

/// Which pins an ADC channel measures: ADS1115 datasheet, MUX 14:12.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AdcInput {
    /// `ain0-ain1`
    Ain0Ain1,
    /// `ain0-ain3`
    Ain0Ain3,
    /// `ain1-ain3`
    Ain1Ain3,
    /// `ain2-ain3`
    Ain2Ain3,
    /// `ain0`, against ground.
    Ain0,
    /// `ain1`, against ground.
    Ain1,
    /// `ain2`, against ground.
    Ain2,
    /// `ain3`, against ground.
    Ain3,
}

impl AdcInput {
    /// All inputs with the names that configuration spells them by, in the order of the MUX codes.
    pub const NAMED: [(&'static str, Self); 8] = [
        ("ain0-ain1", Self::Ain0Ain1),
        ("ain0-ain3", Self::Ain0Ain3),
        ("ain1-ain3", Self::Ain1Ain3),
        ("ain2-ain3", Self::Ain2Ain3),
        ("ain0", Self::Ain0),
        ("ain1", Self::Ain1),
        ("ain2", Self::Ain2),
        ("ain3", Self::Ain3),
    ];
}

/// A GPIO line.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct LineSettings {
    /// The chip's label (`pinctrl-bcm2711`), or `/dev/gpiochipN`.
    pub chip: String,
    /// The line's offset on it.
    pub line: u32,
    /// Whether the line is active when low.
    pub active_low: bool,
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

/// Where a MAVLink endpoint goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum EndpointAddress {
    /// `udpout:host:port`: datagrams are sent there.
    UdpOut(SocketAddr),
    /// `udpin:address:port`: datagrams go to whoever was heard last on that port.
    UdpIn(SocketAddr),
    /// `tcpout:host:port`: a stream to the server there.
    TcpOut(SocketAddr),
    /// `tcpin:address:port`: a stream to each client that connects there.
    TcpIn(SocketAddr),
    /// `serial:/dev/…:baud`.
    Serial {
        /// The tty.
        path: PathBuf,
        /// Bits a second.
        baud: u32,
    },
}

impl fmt::Display for EndpointAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UdpOut(to) => write!(f, "udpout:{to}"),
            Self::UdpIn(at) => write!(f, "udpin:{at}"),
            Self::TcpOut(to) => write!(f, "tcpout:{to}"),
            Self::TcpIn(at) => write!(f, "tcpin:{at}"),
            Self::Serial { path, baud } => write!(f, "serial:{}:{baud}", path.display()),
        }
    }
}

/// What an endpoint is sent unasked, and how often.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Streams {
    /// ATTITUDE messages a second, at most the daemon's rate; `None`: one for each frame; 0: none.
    pub attitude_hz: Option<f64>,
    /// ATTITUDE_QUATERNION messages a second, 0 = none.
    pub quaternion_hz: f64,
    /// ATTITUDE_QUATERNION_COV messages a second, 0 = none.
    pub covariance_hz: f64,
    /// Rounds of NAMED_VALUE_FLOAT a second, 0 = none.
    pub values_hz: f64,
    /// Whether faults are told as STATUSTEXT.
    pub texts: bool,
}

/// One `[[mavlink.endpoint]]`.
#[derive(Clone, Debug, PartialEq)]
pub struct EndpointSettings {
    /// Where it goes.
    pub address: EndpointAddress,
    /// What goes there unasked.
    pub streams: Streams,
    /// A tlog of all that goes out and comes in there.
    pub tlog: Option<PathBuf>,
}

/// `[mavlink]`.
#[derive(Clone, Debug, PartialEq)]
pub struct MavlinkSettings {
    /// The system that this daemon is a part of, 1 to 255; `None`: the autopilot's, 1 until it is heard.
    pub system_id: Option<u8>,
    /// 1 to 255; 191 is MAV_COMP_ID_ONBOARD_COMPUTER.
    pub component_id: u8,
    /// The system whose autopilot is listened to, 1 to 255; `None`: the first autopilot heard.
    pub autopilot_id: Option<u8>,
    /// Whether rates, GPS and airspeed of the autopilot aid the attitude.
    pub aiding: bool,
    /// How often the autopilot is asked for its body rates, Hz: 1 to 200; 0: it is asked for nothing.
    pub rates_hz: f64,
    /// Whether ATTITUDE carries the autopilot's yaw while that is heard, instead of 0.
    pub yaw: bool,
    /// Whether SYS_STATUS is sent as well.
    pub sys_status: bool,
    /// The file with the 32 bytes of the signing key; `None`: nothing is signed, and unsigned commands are taken.
    pub signing_key: Option<PathBuf>,
    /// The endpoints.
    pub endpoints: Vec<EndpointSettings>,
}

/// `[dbus]`.
#[derive(Clone, Debug, PartialEq)]
pub struct DbusSettings {
    /// Which bus; `None`: none (`bus = "none"`).
    pub bus: Option<BusAddress>,
    /// PropertiesChanged signals a second, 0.1 to 50.
    pub update_hz: f64,
}

/// A D-Bus message bus.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum BusAddress {
    /// The system bus.
    System,
    /// The session bus.
    Session,
    /// A D-Bus address: `unix:path=/run/…`.
    Address(String),
}

/// A sky of the report's figure 6.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SkyName {
    /// Night, 16 °C, a clear and cold sky.
    Namibia,
    /// Afternoon, 5 °C, a humid one.
    Durham,
}

impl SkyName {
    /// Both skies with their names.
    pub const NAMED: [(&'static str, Self); 2] = [("namibia", Self::Namibia), ("durham", Self::Durham)];
}

/// What a simulated aircraft does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlightName {
    /// It flies: turns, climbs and descents in mild turbulence.
    Demo,
    /// It stands level, with a head that is mounted a little askew.
    Parked,
}

impl FlightName {
    /// Both with their names.
    pub const NAMED: [(&'static str, Self); 2] = [("demo", Self::Demo), ("parked", Self::Parked)];
}

/// `[simulation]`, present only while `enabled = true`.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulationSettings {
    /// What the aircraft does.
    pub flight: FlightName,
    /// Which sky.
    pub sky: SkyName,
    /// Noise of each sensor, K rms: 0 to 5.
    pub noise_c: f64,
    /// First-order lag of each sensor, s: 0 to 5.
    pub lag_s: f64,
    /// The seed of the noise: the same seed, the same flight.
    pub seed: u64,
    /// What goes wrong on purpose; the sensors named are there.
    pub faults: Vec<Fault>,
}
