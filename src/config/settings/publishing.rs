//! `[mavlink]` and `[dbus]`: where attitude goes.

use std::fmt;
use std::net::SocketAddr;
use std::path::PathBuf;

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

/// MAV_COMP_ID_AUTOPILOT1: the autopilot's component id.
pub const AUTOPILOT: u8 = 1;

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
