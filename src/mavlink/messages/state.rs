//! HEARTBEAT and SYS_STATUS: how this component is.

use super::Message;
use crate::attitude::Mode;
use crate::state::Moment;
use ::mavlink::dialects::common::{
    HEARTBEAT_DATA, MavAutopilot, MavModeFlag, MavState, MavSysStatusSensor, MavType, SYS_STATUS_DATA,
};

/// HEARTBEAT of an onboard controller that is no autopilot.
pub fn heartbeat(state: MavState) -> Message {
    Message::Heartbeat(HEARTBEAT_DATA {
        custom_mode: 0,
        mavtype: MavType::MAV_TYPE_ONBOARD_CONTROLLER,
        autopilot: MavAutopilot::MAV_AUTOPILOT_INVALID,
        base_mode: MavModeFlag::empty(),
        system_status: state,
        mavlink_version: 3,
    })
}

/// SYS_STATUS that speaks of the attitude alone (MAV_SYS_STATUS_AHRS): it is healthy while it may be trusted.
/// There is no battery, and of load and communication nothing is said.
pub fn sys_status(healthy: bool) -> Message {
    let attitude = MavSysStatusSensor::MAV_SYS_STATUS_AHRS;
    Message::Status(SYS_STATUS_DATA {
        onboard_control_sensors_present: attitude,
        onboard_control_sensors_enabled: attitude,
        onboard_control_sensors_health: if healthy { attitude } else { MavSysStatusSensor::empty() },
        load: 0,
        voltage_battery: u16::MAX,
        current_battery: -1,
        battery_remaining: -1,
        ..SYS_STATUS_DATA::DEFAULT
    })
}

/// Whether the attitude may be trusted.
pub const fn healthy(moment: &Moment) -> bool {
    matches!(state(moment), MavState::MAV_STATE_ACTIVE)
}

/// The MAV_STATE of a frame. "Calibrating and not flight-ready" while starting; active while
/// attitude goes out, degraded or not (STATUSTEXT tells the difference); critical while it is
/// withheld, or held or level and not measured: who steers by it must not take that for a reading.
/// MAV_STATE_EMERGENCY speaks of an airframe going down and is never ours to say.
pub const fn state(moment: &Moment) -> MavState {
    match moment.mode {
        Mode::Starting => MavState::MAV_STATE_CALIBRATING,
        Mode::Nominal | Mode::Degraded if moment.measured => MavState::MAV_STATE_ACTIVE,
        _ => MavState::MAV_STATE_CRITICAL,
    }
}
