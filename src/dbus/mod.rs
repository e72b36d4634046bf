//! D-Bus: attitude, faults and sensors for whoever asks, a signal for whoever listens.
//!
//! - [`service`]: the thread: connects, signals, connects again;
//! - [`info`]: what does not change from frame to frame, and what the service asks of the daemon;
//! - [`live`]: the state as clients see it, never staler than it says;
//! - `horizon`, `sensor`, `control`: the interfaces; `signal`: the horizon's changes;
//! - [`bus`]: which bus, and how it is reached;
//! - [`error`]: what can go wrong, with the next step.
//!
//! | interface | object | what it is |
//! |---|---|---|
//! | `org.irhorizon1.Horizon` | `/org/irhorizon1` | attitude, mode, faults: read-only properties |
//! | `org.irhorizon1.Stream` | `/org/irhorizon1` | `Frames`: a descriptor with a CSV line for each frame |
//! | `org.irhorizon1.Control` | `/org/irhorizon1` | `Reload`: what changes anything |
//! | `org.irhorizon1.Sensor` | `/org/irhorizon1/sensor/<name>` | a sensor: read-only properties |
//!
//! `org.freedesktop.DBus.ObjectManager` at `/org/irhorizon1` lists the sensors.

pub mod bus;
mod control;
pub mod error;
mod horizon;
pub mod info;
pub mod live;
mod sensor;
pub mod service;
mod signal;

pub use error::DbusError;
pub use info::{Control, SensorInfo, ServiceInfo};
pub use service::{Service, run};

/// The bus name.
pub const NAME: &str = "org.irhorizon1";
/// The object that stands for the whole instrument.
pub const PATH: &str = "/org/irhorizon1";
/// Attitude, mode and faults.
pub const HORIZON: &str = "org.irhorizon1.Horizon";
/// One sensor.
pub const SENSOR: &str = "org.irhorizon1.Sensor";
/// What changes anything.
pub const CONTROL: &str = "org.irhorizon1.Control";
/// Frames as they come.
pub const STREAM: &str = "org.irhorizon1.Stream";
/// The D-Bus error of a configuration that is not accepted; its text says where and why.
pub const ERROR_CONFIG: &str = "org.irhorizon1.Error.Config";
/// The D-Bus error of a daemon that cannot do what was asked now.
pub const ERROR_BUSY: &str = "org.irhorizon1.Error.Busy";
