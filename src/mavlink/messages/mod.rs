//! What this component says in MAVLink's terms (common.xml). Pure.
//!
//! - `state`: HEARTBEAT and SYS_STATUS, which say how it is.
//! - `attitude`: the attitude in its three forms.
//! - `values`: quality, contrast and standard deviation as named numbers.
//! - `text`: faults in words.
//! - `identity`: which component this is, and what it can do.
//! - `ack`: the answer to a command.

mod ack;
mod attitude;
mod identity;
mod state;
mod text;
mod values;

pub use ack::CommandAck;
pub use attitude::{attitude, covariance, quaternion};
pub use identity::{autopilot_version, component_information};
pub use state::{healthy, heartbeat, state, sys_status};
pub use text::{fault_came, fault_went, note};
pub use values::{contrast, quality, quality_value, sigma};

use crate::time::Time;
use ::mavlink::dialects::common::{
    ATTITUDE_DATA, ATTITUDE_QUATERNION_COV_DATA, ATTITUDE_QUATERNION_DATA, AUTOPILOT_VERSION_DATA, COMMAND_LONG_DATA,
    COMPONENT_INFORMATION_BASIC_DATA, HEARTBEAT_DATA, MESSAGE_INTERVAL_DATA, NAMED_VALUE_FLOAT_DATA, PARAM_ERROR_DATA,
    PARAM_VALUE_DATA, STATUSTEXT_DATA, SYS_STATUS_DATA, TIMESYNC_DATA,
};
use ::mavlink::{MAVLinkV2MessageRaw, MavHeader, MessageData};

macro_rules! sent {
    ($($(#[doc = $doc:literal])* $name:ident($data:ty),)*) => {
        /// A message that this component sends.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Message {
            $($(#[doc = $doc])* $name($data),)*
        }

        impl Message {
            /// Its number in the dialect.
            pub const fn id(&self) -> u32 {
                match self {
                    $(Self::$name(_) => <$data as MessageData>::ID,)*
                }
            }

            /// Writes its frame into `raw`, whose incompatibility flags stay.
            pub fn serialize(&self, header: MavHeader, raw: &mut MAVLinkV2MessageRaw) {
                match self {
                    $(Self::$name(m) => raw.serialize_message_data(header, m),)*
                }
            }
        }
    };
}

sent! {
    /// HEARTBEAT (0).
    Heartbeat(HEARTBEAT_DATA),
    /// SYS_STATUS (1).
    Status(SYS_STATUS_DATA),
    /// PARAM_VALUE (22).
    Param(PARAM_VALUE_DATA),
    /// ATTITUDE (30).
    Attitude(ATTITUDE_DATA),
    /// ATTITUDE_QUATERNION (31).
    Quaternion(ATTITUDE_QUATERNION_DATA),
    /// ATTITUDE_QUATERNION_COV (61).
    Covariance(ATTITUDE_QUATERNION_COV_DATA),
    /// COMMAND_ACK (77).
    Ack(CommandAck),
    /// COMMAND_LONG (76).
    Command(COMMAND_LONG_DATA),
    /// TIMESYNC (111).
    Timesync(TIMESYNC_DATA),
    /// AUTOPILOT_VERSION (148).
    Version(AUTOPILOT_VERSION_DATA),
    /// MESSAGE_INTERVAL (244).
    Interval(MESSAGE_INTERVAL_DATA),
    /// NAMED_VALUE_FLOAT (251).
    Value(NAMED_VALUE_FLOAT_DATA),
    /// STATUSTEXT (253).
    Text(STATUSTEXT_DATA),
    /// PARAM_ERROR (345).
    ParamError(PARAM_ERROR_DATA),
    /// COMPONENT_INFORMATION_BASIC (396).
    Component(COMPONENT_INFORMATION_BASIC_DATA),
}

/// Milliseconds since boot as MAVLink carries them: they wrap after 49.7 days.
pub const fn time_boot_ms(time: Time) -> u32 {
    time.as_millis() as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stamp_wraps_at_32_bits() {
        assert_eq!(time_boot_ms(Time::from_nanos(4_294_967_295_000_000)), u32::MAX);
        assert_eq!(time_boot_ms(Time::from_nanos(4_294_967_301_999_999)), 5);
    }
}
