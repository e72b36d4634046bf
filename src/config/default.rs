//! What holds for everything that the configuration does not say.

use super::settings::{
    BusAddress, DbusSettings, EndpointAddress, EndpointSettings, EstimatorSettings, FaultSettings, FlightName,
    HeadSettings, MavlinkSettings, OnFault, Settings, SimulationSettings, SkyName, Streams,
};
use std::time::Duration;

/// The six named sensors (no `[[sensor]]` at all), hardware, nowhere to send MAVLink to.
impl Default for Settings {
    fn default() -> Self {
        Self {
            rate_hz: 50.0,
            quiet: Duration::from_millis(1),
            sensors: Vec::new(),
            head: HeadSettings {
                roll_trim_deg: 0.0,
                pitch_trim_deg: 0.0,
                learn_trim: true,
                field_of_view_deg: 90.0,
                lag_s: None,
            },
            estimator: EstimatorSettings { method: None, range_time_constant_s: 3.0, roll_limit_deg: None },
            faults: FaultSettings {
                on_fault: OnFault::Withhold,
                hold_s: 3.0,
                sigma_limit_deg: 20.0,
                low_contrast_c: 2.0,
                accuracy_deg: 5.0,
                wet_percent: 50.0,
                obstructed_deg: 4.0,
                disagree_deg: 12.0,
                stuck_after_s: 1.0,
                lost_after_s: 0.1,
                back_after_s: 0.1,
                stale_after_s: 0.5,
                lamp: None,
            },
            mavlink: MavlinkSettings {
                system_id: None,
                component_id: 191,
                autopilot_id: None,
                aiding: true,
                rates_hz: 100.0,
                yaw: false,
                sys_status: false,
                signing_key: None,
                endpoints: Vec::new(),
            },
            dbus: DbusSettings { bus: Some(BusAddress::System), update_hz: 10.0 },
            simulation: None,
        }
    }
}

/// An endpoint there with the default streams and no tlog.
impl From<EndpointAddress> for EndpointSettings {
    fn from(address: EndpointAddress) -> Self {
        Self { address, streams: Streams::default(), tlog: None }
    }
}

/// ATTITUDE for each frame, values once a second, faults in words.
impl Default for Streams {
    fn default() -> Self {
        Self { attitude_hz: None, quaternion_hz: 0.0, covariance_hz: 0.0, values_hz: 1.0, texts: true }
    }
}

/// A flight on a clear night.
impl Default for SimulationSettings {
    fn default() -> Self {
        Self { flight: FlightName::Demo, sky: SkyName::Namibia, noise_c: 0.08, lag_s: 0.1, seed: 1, faults: Vec::new() }
    }
}
