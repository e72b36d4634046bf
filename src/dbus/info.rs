//! What does not change from frame to frame, and what the service asks of the daemon.

use crate::attitude::Attitude;
use crate::config::settings::{DeviceSettings, Settings};
use crate::ctl::view::Endpoint;
use crate::head::Head;
use std::sync::Arc;
use std::sync::mpsc::Receiver;
use std::time::Duration;

/// What the service says beside the frames.
#[derive(Clone, Debug, PartialEq)]
pub struct ServiceInfo {
    /// The head.
    pub head: Head,
    /// The sensors, in the head's order.
    pub sensors: Vec<SensorInfo>,
    /// The method of estimation.
    pub method: &'static str,
    /// The configured trim.
    pub trim: Attitude,
    /// From one signal to the next.
    pub update: Duration,
    /// The age of the newest frame beyond which the attitude is not shown any more.
    pub overdue: Duration,
}

/// What is configured of a sensor.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SensorInfo {
    /// Its name.
    pub name: String,
    /// `mlx90614`, `ads1115` or `simulated`.
    pub kind: &'static str,
    /// Its bus, empty when simulated.
    pub bus: String,
    /// Its address there, 0 when simulated.
    pub address: u8,
    /// Where it looks.
    pub direction: String,
}

impl ServiceInfo {
    /// What the service says of these settings.
    pub fn new(settings: &Settings) -> Self {
        let head = settings.head();
        let sensors = head.sensors.iter().enumerate().map(|(i, sensor)| {
            let (name, direction) = (sensor.name.clone(), sensor.direction.to_string());
            // A simulated head need not be configured.
            let Some(device) = settings.sensors.get(i).map(|s| &s.device).filter(|_| settings.simulation.is_none())
            else {
                return SensorInfo { name, kind: "simulated", direction, ..SensorInfo::default() };
            };
            let kind = match device {
                DeviceSettings::Mlx90614(_) => "mlx90614",
                DeviceSettings::Ads1115(_) => "ads1115",
            };
            SensorInfo {
                name,
                kind,
                bus: device.bus().to_string_lossy().into_owned(),
                address: device.address(),
                direction,
            }
        });
        let sensors = sensors.collect();
        Self {
            sensors,
            trim: Attitude::from_degrees(settings.head.roll_trim_deg, settings.head.pitch_trim_deg),
            method: settings.estimator.method_for(&head).as_str(),
            head,
            update: seconds(1.0 / settings.dbus.update_hz),
            overdue: seconds(settings.faults.stale_after_s + 2.0 / settings.rate_hz),
        }
    }
}

/// A duration, whatever the number: a day in place of what is none.
fn seconds(s: f64) -> Duration {
    Duration::try_from_secs_f64(s).unwrap_or(Duration::from_secs(86_400))
}

/// What the service asks of the daemon. No method may block: they run on the service's thread.
pub trait Control: Send + Sync {
    /// What holds now; asked again whenever the state's generation has changed.
    fn info(&self) -> Arc<ServiceInfo>;

    /// The MAVLink endpoints.
    fn endpoints(&self) -> Vec<Endpoint>;

    /// Asks for a reload of the configuration and gives where the outcome will come: an error with
    /// the text for the user when the new configuration is not accepted and the old one goes on.
    fn reload(&self) -> Receiver<Result<(), String>>;
}
