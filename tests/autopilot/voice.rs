//! What an autopilot of system 7 says, on a link that is 40 ms long each way and loses one message in five.

use irhorizon::attitude::Attitude;
use mavlink::dialects::common::{ATTITUDE_DATA, HEARTBEAT_DATA, MavAutopilot};
use mavlink::{MAVLinkV2MessageRaw, MavHeader, MessageData};
use std::time::Duration;

/// From the autopilot to us and back.
pub const WAY: Duration = Duration::from_millis(40);
/// Messages that are lost.
const LOST: f64 = 0.2;

/// Its messages, numbered, and which of them are lost.
pub struct Voice {
    chance: u64,
    sequence: u8,
}

impl Voice {
    pub fn new(seed: u64) -> Self {
        Self { chance: seed, sequence: 0 }
    }

    /// The next of its random numbers, 0 to 1.
    pub fn chance(&mut self) -> f64 {
        self.chance = self.chance.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.chance >> 33) as f64 / (1_u64 << 31) as f64
    }

    /// The bytes of a message with a number of their own; `None`: it is lost.
    pub fn say<M: MessageData>(&mut self, message: &M) -> Option<(u8, Vec<u8>)> {
        let mut raw = MAVLinkV2MessageRaw::new();
        raw.serialize_message_data(MavHeader { system_id: 7, component_id: 1, sequence: self.sequence }, message);
        self.sequence = self.sequence.wrapping_add(1);
        (self.chance() >= LOST).then(|| (self.sequence, raw.raw_bytes().to_vec()))
    }
}

pub fn heartbeat() -> HEARTBEAT_DATA {
    let autopilot = MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA;
    HEARTBEAT_DATA { autopilot, mavlink_version: 3, ..HEARTBEAT_DATA::DEFAULT }
}

/// ATTITUDE at `clock_ns` of its clock: the true one with what it is `wrong` by, its yaw, and body rates, °/s.
pub fn attitude(clock_ns: u64, truth: Attitude, wrong: Attitude, yaw: f32, rates: [f64; 3]) -> ATTITUDE_DATA {
    let [rollspeed, pitchspeed, yawspeed] = rates.map(|v| v.to_radians() as f32);
    ATTITUDE_DATA {
        time_boot_ms: (clock_ns / 1_000_000) as u32,
        roll: (truth.roll + wrong.roll) as f32,
        pitch: (truth.pitch + wrong.pitch) as f32,
        yaw,
        rollspeed,
        pitchspeed,
        yawspeed,
    }
}
