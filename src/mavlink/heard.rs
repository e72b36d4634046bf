//! The messages that are heeded, out of all that arrive. Pure.

use super::deframe::Packet;
use super::service::Request;
use ::mavlink::dialects::common::{
    ATTITUDE_DATA, COMMAND_ACK_DATA, GLOBAL_POSITION_INT_DATA, GPS_RAW_INT_DATA, HEARTBEAT_DATA, HIGHRES_IMU_DATA,
    RAW_IMU_DATA, SCALED_IMU_DATA, TIMESYNC_DATA, VFR_HUD_DATA,
};
use ::mavlink::error::ParserError;
use ::mavlink::{MavlinkVersion, MessageData};

macro_rules! heard {
    ($($(#[doc = $doc:literal])* $name:ident($data:ident),)*) => {
        /// A message that is heeded, with its content.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Heard {
            /// A command or a parameter request.
            Request(Request),
            $($(#[doc = $doc])* $name($data),)*
        }

        impl Heard {
            /// The content of a message that is heeded. `None` for any other, and for one that holds a value which
            /// its enumeration has not, where that matters.
            pub fn new(packet: &Packet<'_>) -> Option<Self> {
                match packet.id {
                    $($data::ID => read::<$data>(packet).map(Self::$name),)*
                    _ => Request::new(packet).map(Self::Request),
                }
            }
        }
    };
}

heard! {
    /// HEARTBEAT (0).
    Heartbeat(HEARTBEAT_DATA),
    /// GPS_RAW_INT (24).
    GpsRaw(GPS_RAW_INT_DATA),
    /// SCALED_IMU (26).
    ScaledImu(SCALED_IMU_DATA),
    /// RAW_IMU (27).
    RawImu(RAW_IMU_DATA),
    /// ATTITUDE (30).
    Attitude(ATTITUDE_DATA),
    /// GLOBAL_POSITION_INT (33).
    GlobalPosition(GLOBAL_POSITION_INT_DATA),
    /// VFR_HUD (74).
    VfrHud(VFR_HUD_DATA),
    /// COMMAND_ACK (77).
    CommandAck(COMMAND_ACK_DATA),
    /// HIGHRES_IMU (105).
    HighresImu(HIGHRES_IMU_DATA),
    /// TIMESYNC (111).
    Timesync(TIMESYNC_DATA),
}

/// The byte of message `id` that holds a value of `enumeration`, where a value which that has not is read as its 0:
/// vehicles, autopilots and states of later dialects are `GENERIC` and `UNINIT`, kinds of GPS fix are none.
fn lenient(id: u32, enumeration: &str) -> Option<usize> {
    match (id, enumeration) {
        (HEARTBEAT_DATA::ID, "MavType") => Some(4),
        (HEARTBEAT_DATA::ID, "MavAutopilot") => Some(5),
        (HEARTBEAT_DATA::ID, "MavState") => Some(7),
        (GPS_RAW_INT_DATA::ID, "GpsFixType") => Some(28),
        _ => None,
    }
}

fn read<D: MessageData>(packet: &Packet<'_>) -> Option<D> {
    let version = if packet.v2 { MavlinkVersion::V2 } else { MavlinkVersion::V1 };
    let len = packet.payload.len();
    let mut payload = [0; 255];
    payload.get_mut(..len)?.copy_from_slice(packet.payload);
    // Each round mends one value; no message has more than three.
    for _ in 0..4 {
        match D::deser(version, payload.get(..len)?) {
            Ok(data) => return Some(data),
            Err(ParserError::InvalidEnum { enum_type, value }) if value != 0 => {
                *payload.get_mut(lenient(D::ID, enum_type)?)? = 0;
            }
            Err(_) => return None,
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use ::mavlink::dialects::common::{GpsFixType, MavAutopilot, MavState, MavType};

    fn hear(id: u32, payload: &[u8]) -> Option<Heard> {
        let signature = None;
        Heard::new(&Packet { bytes: &[], v2: true, system_id: 1, component_id: 1, sequence: 0, id, payload, signature })
    }

    #[test]
    fn a_heartbeat_of_something_yet_unknown_is_heard() {
        let Some(Heard::Heartbeat(h)) = hear(0, &[1, 2, 3, 4, 250, 3, 0x80, 251, 3]) else { panic!() };
        assert_eq!((h.mavtype, h.autopilot), (MavType::MAV_TYPE_GENERIC, MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA));
        assert_eq!((h.system_status, h.base_mode.bits()), (MavState::MAV_STATE_UNINIT, 0x80));
        let Some(Heard::Heartbeat(h)) = hear(0, &[1, 2, 3, 4, 250, 249, 0, 251]) else { panic!() };
        assert_eq!(h.autopilot, MavAutopilot::MAV_AUTOPILOT_GENERIC);
    }

    #[test]
    fn a_fix_of_an_unknown_kind_is_none() {
        let mut payload = [1; 30];
        payload[28] = 200;
        let Some(Heard::GpsRaw(g)) = hear(24, &payload) else { panic!() };
        assert_eq!(g.fix_type, GpsFixType::GPS_FIX_TYPE_NO_GPS);
    }

    #[test]
    fn what_nobody_heeds_is_not_heard() {
        assert_eq!(hear(33, &[]).map(|h| matches!(h, Heard::GlobalPosition(_))), Some(true));
        assert_eq!([2, 253, 77_777].map(|id| hear(id, &[1; 30])), [None, None, None]);
    }
}
