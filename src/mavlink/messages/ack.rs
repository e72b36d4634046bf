//! COMMAND_ACK with the fields of MAVLink 2, and of any command: the dialect's own knows neither the sender that it
//! answers nor numbers of commands that are not in the dialect.

use ::mavlink::bytes::Bytes;
use ::mavlink::bytes_mut::BytesMut;
use ::mavlink::dialects::common::{COMMAND_ACK_DATA, MavMessage, MavResult};
use ::mavlink::error::ParserError;
use ::mavlink::{MavlinkVersion, MessageData};

/// COMMAND_ACK (77).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CommandAck {
    /// The command's number.
    pub command: u16,
    /// What became of it.
    pub result: MavResult,
    /// How far it is, %; 255 where that is not said.
    pub progress: u8,
    /// Whose command it was: the system.
    pub target_system: u8,
    /// Whose command it was: the component.
    pub target_component: u8,
}

impl MessageData for CommandAck {
    type Message = MavMessage;
    const ID: u32 = COMMAND_ACK_DATA::ID;
    const NAME: &'static str = COMMAND_ACK_DATA::NAME;
    const EXTRA_CRC: u8 = COMMAND_ACK_DATA::EXTRA_CRC;
    const ENCODED_LEN: usize = 10;

    fn ser(&self, version: MavlinkVersion, payload: &mut [u8]) -> usize {
        let mut bytes = BytesMut::new(payload);
        bytes.put_u16_le(self.command);
        bytes.put_u8(self.result as u8);
        if matches!(version, MavlinkVersion::V1) {
            return bytes.len();
        }
        bytes.put_u8(self.progress);
        bytes.put_i32_le(0);
        bytes.put_u8(self.target_system);
        bytes.put_u8(self.target_component);
        let len = bytes.len();
        ::mavlink::utils::remove_trailing_zeroes(&payload[..len])
    }

    fn deser(version: MavlinkVersion, payload: &[u8]) -> Result<Self, ParserError> {
        let plain = COMMAND_ACK_DATA::deser(version, payload)?;
        let mut whole = [0; Self::ENCODED_LEN];
        let there = payload.len().min(whole.len());
        whole[..there].copy_from_slice(&payload[..there]);
        let mut bytes = Bytes::new(&whole);
        let command = bytes.get_u16_le()?;
        let [progress, target_system, target_component] = [whole[3], whole[8], whole[9]];
        Ok(Self { command, result: plain.result, progress, target_system, target_component })
    }
}
