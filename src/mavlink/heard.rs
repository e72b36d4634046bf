//! The messages that are heeded, out of all that arrive. Pure.

use super::deframe::Packet;
use ::mavlink::dialects::common::{
    ATTITUDE_DATA, COMMAND_ACK_DATA, COMMAND_INT_DATA, COMMAND_LONG_DATA, GLOBAL_POSITION_INT_DATA, GPS_RAW_INT_DATA,
    HEARTBEAT_DATA, HIGHRES_IMU_DATA, PARAM_REQUEST_LIST_DATA, PARAM_REQUEST_READ_DATA, PARAM_SET_DATA, RAW_IMU_DATA,
    SCALED_IMU_DATA, TIMESYNC_DATA, VFR_HUD_DATA,
};
use ::mavlink::{MavlinkVersion, MessageData};

macro_rules! heard {
    ($($(#[doc = $doc:literal])* $name:ident($data:ident),)*) => {
        /// A message that is heeded, with its content.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Heard {
            $($(#[doc = $doc])* $name($data),)*
        }

        impl Heard {
            /// The content of a message that is heeded. `None` for any other, and for one that holds a value which
            /// its enumeration has not.
            pub fn new(packet: &Packet<'_>) -> Option<Self> {
                let version = if packet.v2 { MavlinkVersion::V2 } else { MavlinkVersion::V1 };
                match packet.id {
                    $($data::ID => $data::deser(version, packet.payload).ok().map(Self::$name),)*
                    _ => None,
                }
            }
        }
    };
}

heard! {
    /// HEARTBEAT (0).
    Heartbeat(HEARTBEAT_DATA),
    /// PARAM_REQUEST_READ (20).
    ParamRequestRead(PARAM_REQUEST_READ_DATA),
    /// PARAM_REQUEST_LIST (21).
    ParamRequestList(PARAM_REQUEST_LIST_DATA),
    /// PARAM_SET (23).
    ParamSet(PARAM_SET_DATA),
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
    /// COMMAND_INT (75).
    CommandInt(COMMAND_INT_DATA),
    /// COMMAND_LONG (76).
    CommandLong(COMMAND_LONG_DATA),
    /// COMMAND_ACK (77).
    CommandAck(COMMAND_ACK_DATA),
    /// HIGHRES_IMU (105).
    HighresImu(HIGHRES_IMU_DATA),
    /// TIMESYNC (111).
    Timesync(TIMESYNC_DATA),
}
