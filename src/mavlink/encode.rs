//! Messages as bytes: MAVLink 2 frames, numbered, in a buffer that is used again.

use super::deframe::SIGNATURE;
use super::messages::Message;
use super::signing::{SIGNED, Signing};
use ::mavlink::{MAVLinkV2MessageRaw, MavHeader};

/// What makes frames of messages for one endpoint; each endpoint counts its own.
#[derive(Clone, Debug)]
pub struct Encoder {
    header: MavHeader,
    raw: MAVLinkV2MessageRaw,
}

impl Encoder {
    /// An encoder with these ids that begins at sequence 0.
    pub fn new(system_id: u8, component_id: u8) -> Self {
        let header = MavHeader { system_id: u32::from(system_id), component_id, sequence: 0 };
        Self { header, raw: MAVLinkV2MessageRaw::new() }
    }

    /// Changes the ids and goes on counting.
    pub fn identify(&mut self, system_id: u8, component_id: u8) {
        self.header.system_id = u32::from(system_id);
        self.header.component_id = component_id;
    }

    /// The frame of `message` with the next sequence number.
    pub fn encode(&mut self, message: &Message) -> &[u8] {
        self.write(message, 0);
        self.raw.raw_bytes()
    }

    /// The frame of `message` with the next sequence number, signed for link `link` at the time `wall`.
    pub fn encode_signed(&mut self, message: &Message, signing: &mut Signing, link: u8, wall: u64) -> &[u8] {
        self.write(message, SIGNED);
        // Header, payload, CRC; the frame's own length counts the signature once the flag is set.
        let end = 10 + usize::from(self.raw.payload_length()) + 2 + SIGNATURE;
        if let Some(frame) = self.raw.as_mut_slice().get_mut(..end) {
            signing.sign(frame, link, wall);
        }
        self.raw.raw_bytes()
    }

    fn write(&mut self, message: &Message, flags: u8) {
        *self.raw.incompatibility_flags_mut() = flags;
        message.serialize(self.header, &mut self.raw);
        self.header.sequence = self.header.sequence.wrapping_add(1);
    }
}

#[cfg(test)]
mod tests {
    use super::super::messages;
    use super::*;
    use crate::attitude::Attitude;
    use crate::fault::FaultKind;
    use crate::head::Head;
    use crate::mavlink::session::Seen;
    use crate::state::Moment;
    use crate::time::Time;
    use ::mavlink::MavlinkVersion;
    use ::mavlink::dialects::common::{MavMessage, MavState};
    use proptest::prelude::*;

    fn parse(bytes: &[u8]) -> (MavHeader, MavMessage) {
        ::mavlink::MavlinkReader::new(bytes).read_message(MavlinkVersion::V2).unwrap()
    }

    fn attitude(valid_at: Time, attitude: Attitude) -> Option<Message> {
        let moment = Moment { valid_at, attitude: Some(attitude), ..Moment::default() };
        messages::attitude(&Seen { moment, ..Seen::default() })
    }

    /// CRC-16/MCRF4XX, bit by bit: polynomial 0x1021 reflected, initial 0xffff.
    fn crc(bytes: impl IntoIterator<Item = u8>) -> u16 {
        bytes.into_iter().fold(0xffff, |crc: u16, byte| {
            (0..8).fold(crc ^ u16::from(byte), |c, _| if c & 1 == 1 { (c >> 1) ^ 0x8408 } else { c >> 1 })
        })
    }

    #[test]
    fn the_crc_of_this_test_is_the_catalogue_s() {
        assert_eq!(crc(*b"123456789"), 0x6f91);
    }

    #[test]
    fn attitude_on_the_wire() {
        let mut encoder = Encoder::new(1, 191);
        encoder.encode(&messages::heartbeat(MavState::MAV_STATE_ACTIVE));
        let message = attitude(Time::from_nanos(0x0102_0304 * 1_000_000), Attitude { roll: 0.5, pitch: -0.25 });
        // Little endian: time_boot_ms, roll, pitch; the zeros of yaw and the rates are cut off,
        // and the last two of pitch's four bytes are not zero.
        let payload = [0x04, 0x03, 0x02, 0x01, 0x00, 0x00, 0x00, 0x3f, 0x00, 0x00, 0x80, 0xbe];
        let mut expected = vec![0xfd, 12, 0, 0, 1, 1, 191, 30, 0, 0];
        expected.extend(payload);
        let crc = crc(expected[1..].iter().copied().chain([39]));
        expected.extend(crc.to_le_bytes());
        assert_eq!(encoder.encode(&message.unwrap()), expected);
    }

    #[test]
    fn heartbeat_on_the_wire() {
        let mut encoder = Encoder::new(255, 1);
        let mut expected = vec![0xfd, 9, 0, 0, 0, 255, 1, 0, 0, 0];
        // custom_mode, type, autopilot, base_mode, system_status, mavlink_version
        expected.extend([0, 0, 0, 0, 18, 8, 0, 5, 3]);
        let crc = crc(expected[1..].iter().copied().chain([50]));
        expected.extend(crc.to_le_bytes());
        assert_eq!(encoder.encode(&messages::heartbeat(MavState::MAV_STATE_CRITICAL)), expected);
    }

    #[test]
    fn values_and_texts_pass_the_crate_s_parser() {
        let mut encoder = Encoder::new(7, 191);
        let long = messages::fault_went(FaultKind::SensorLost(0), &Head::six());
        let (header, message) = parse(encoder.encode(&long));
        assert_eq!((header.system_id, header.component_id, header.sequence), (7, 191, 0));
        let MavMessage::STATUSTEXT(text) = message else { panic!("{message:?}") };
        assert_eq!(text.text.to_str().unwrap(), "irhorizon: sensor-lost:nose cleared");
        // A shorter message after a longer one in the same buffer.
        let (header, message) = parse(encoder.encode(&messages::contrast(Time::from_nanos(5_000_000), 21.5)));
        assert_eq!(header.sequence, 1);
        let MavMessage::NAMED_VALUE_FLOAT(value) = message else { panic!("{message:?}") };
        assert_eq!((value.name.to_str().unwrap(), value.value, value.time_boot_ms), ("ir_contr", 21.5, 5));
    }

    proptest! {
        #[test]
        fn every_attitude_comes_back(roll in -3.2_f64..3.2, pitch in -1.6_f64..1.6, nanos: u64, skip in 0_usize..300) {
            let mut encoder = Encoder::new(1, 191);
            for _ in 0..skip {
                encoder.encode(&messages::heartbeat(MavState::MAV_STATE_ACTIVE));
            }
            let time = Time::from_nanos(nanos);
            let sent = attitude(time, Attitude { roll, pitch }).unwrap();
            let bytes = encoder.encode(&sent).to_vec();
            let (header, message) = parse(&bytes);
            prop_assert_eq!(usize::from(header.sequence), skip % 256);
            let MavMessage::ATTITUDE(got) = message else { panic!("{message:?}") };
            prop_assert_eq!(got.roll, roll as f32);
            prop_assert_eq!(got.pitch, pitch as f32);
            prop_assert_eq!(u64::from(got.time_boot_ms), nanos / 1_000_000 % (1 << 32));
            prop_assert_eq!((got.yaw, got.rollspeed, got.pitchspeed, got.yawspeed), (0.0, 0.0, 0.0, 0.0));
        }
    }
}
