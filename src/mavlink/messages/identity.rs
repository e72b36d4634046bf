//! Which component this is, and what it can do.

use super::{Message, time_boot_ms};
use crate::time::Time;
use ::mavlink::dialects::common::{AUTOPILOT_VERSION_DATA, COMPONENT_INFORMATION_BASIC_DATA, MavProtocolCapability};

/// FIRMWARE_VERSION_TYPE_OFFICIAL, the last byte of a version.
const OFFICIAL: u8 = 255;

/// What this component can do: parameters are 32-bit floats that hold the number itself.
fn capabilities() -> MavProtocolCapability {
    MavProtocolCapability::MAV_PROTOCOL_CAPABILITY_MAVLINK2
        | MavProtocolCapability::MAV_PROTOCOL_CAPABILITY_COMMAND_INT
        | MavProtocolCapability::MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_C_CAST
}

/// `major.minor.patch` as MAVLink packs it.
fn packed(version: &str) -> u32 {
    let mut parts = version.split(['.', '-', '+']).map(|p| p.parse::<u8>().unwrap_or(0));
    let mut part = || parts.next().unwrap_or(0);
    u32::from_be_bytes([part(), part(), part(), OFFICIAL])
}

/// AUTOPILOT_VERSION, which every component may send: the daemon's version as that of its firmware.
pub fn autopilot_version() -> Message {
    Message::Version(AUTOPILOT_VERSION_DATA {
        capabilities: capabilities(),
        flight_sw_version: packed(env!("CARGO_PKG_VERSION")),
        ..AUTOPILOT_VERSION_DATA::DEFAULT
    })
}

/// COMPONENT_INFORMATION_BASIC at `now`.
pub fn component_information(now: Time) -> Message {
    Message::Component(COMPONENT_INFORMATION_BASIC_DATA {
        capabilities: capabilities(),
        time_boot_ms: time_boot_ms(now),
        vendor_name: "irhorizon".into(),
        model_name: "infrared horizon".into(),
        software_version: env!("CARGO_PKG_VERSION").into(),
        ..COMPONENT_INFORMATION_BASIC_DATA::DEFAULT
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_are_packed_a_byte_each() {
        assert_eq!(packed("1.2.3"), 0x0102_03ff);
        assert_eq!(packed("0.10.0-rc1"), 0x000a_00ff);
        assert_eq!(packed("garbage"), 0x0000_00ff);
        let Message::Version(v) = autopilot_version() else { panic!() };
        // MAVLINK2, COMMAND_INT, PARAM_ENCODE_C_CAST of MAV_PROTOCOL_CAPABILITY; no serial number.
        assert_eq!((v.capabilities.bits(), v.uid), (8192 | 8 | 131_072, 0));
    }

    #[test]
    fn the_component_has_a_name_and_a_version() {
        let Message::Component(c) = component_information(Time::from_nanos(7_000_000)) else { panic!() };
        assert_eq!(c.software_version.to_str(), Ok(env!("CARGO_PKG_VERSION")));
        assert_eq!((c.vendor_name.to_str(), c.time_boot_ms), (Ok("irhorizon"), 7));
    }
}
