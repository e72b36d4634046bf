//! Commands and parameter requests out of their payloads. The numbers stay numbers: a command that the dialect does
//! not know wants an answer as well.

use super::Ids;
use crate::mavlink::deframe::Packet;
use ::mavlink::MessageData;
use ::mavlink::dialects::common::{
    COMMAND_INT_DATA, COMMAND_LONG_DATA, PARAM_REQUEST_LIST_DATA, PARAM_REQUEST_READ_DATA, PARAM_SET_DATA,
};

/// What somebody asks of a component.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request {
    /// Whom it is for; 0 is everybody.
    pub target: Ids,
    /// What it is.
    pub what: What,
}

/// What is asked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum What {
    /// COMMAND_LONG (76) or COMMAND_INT (75).
    Command(Command),
    /// PARAM_REQUEST_READ (20): by its index, or by its name where that is -1.
    ParamRead {
        /// Its place in the list.
        index: i16,
        /// Its name.
        name: ParamId,
    },
    /// PARAM_REQUEST_LIST (21).
    ParamList,
    /// PARAM_SET (23); the type is left out, the value is the number itself.
    ParamSet {
        /// Its name.
        name: ParamId,
        /// The value.
        value: f32,
    },
}

/// A parameter's name as it goes over the wire: up to 16 bytes, zeros behind.
pub type ParamId = [u8; 16];

/// A command, MAV_CMD.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Command {
    /// Its number, in the dialect or not.
    pub number: u16,
    /// Its seven parameters; of COMMAND_INT the fifth and sixth are whole numbers.
    pub params: [f32; 7],
    /// How often it was sent before; always 0 of COMMAND_INT.
    pub confirmation: u8,
}

/// A payload, zeros behind its end: MAVLink 2 leaves them out.
struct Fields<'a>(&'a [u8]);

impl Fields<'_> {
    fn bytes<const N: usize>(&self, at: usize) -> [u8; N] {
        std::array::from_fn(|i| self.0.get(at + i).copied().unwrap_or(0))
    }

    fn u8(&self, at: usize) -> u8 {
        let [byte] = self.bytes(at);
        byte
    }

    fn f32(&self, at: usize) -> f32 {
        f32::from_le_bytes(self.bytes(at))
    }

    fn i32(&self, at: usize) -> i32 {
        i32::from_le_bytes(self.bytes(at))
    }

    fn ids(&self, at: usize) -> Ids {
        Ids { system: self.u8(at), component: self.u8(at + 1) }
    }
}

impl Request {
    /// The request that a message is, if it is one.
    pub fn new(packet: &Packet<'_>) -> Option<Self> {
        let f = Fields(packet.payload);
        let command = |fifth, sixth, confirmation| {
            What::Command(Command {
                number: u16::from_le_bytes(f.bytes(28)),
                params: [f.f32(0), f.f32(4), f.f32(8), f.f32(12), fifth, sixth, f.f32(24)],
                confirmation,
            })
        };
        let (target, what) = match packet.id {
            COMMAND_LONG_DATA::ID => (f.ids(30), command(f.f32(16), f.f32(20), f.u8(32))),
            COMMAND_INT_DATA::ID => (f.ids(30), command(f.i32(16) as f32, f.i32(20) as f32, 0)),
            PARAM_REQUEST_READ_DATA::ID => {
                (f.ids(2), What::ParamRead { index: i16::from_le_bytes(f.bytes(0)), name: f.bytes(4) })
            }
            PARAM_REQUEST_LIST_DATA::ID => (f.ids(0), What::ParamList),
            PARAM_SET_DATA::ID => (f.ids(4), What::ParamSet { name: f.bytes(6), value: f.f32(0) }),
            _ => return None,
        };
        Some(Self { target, what })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ::mavlink::MavlinkVersion;
    use ::mavlink::dialects::common::{MavCmd, MavFrame, MavParamType};

    fn read<D: MessageData>(data: &D) -> Request {
        let mut payload = [0; 255];
        let len = data.ser(MavlinkVersion::V2, &mut payload);
        packet(D::ID, &payload[..len])
    }

    fn packet(id: u32, payload: &[u8]) -> Request {
        let ids =
            Packet { bytes: &[], v2: true, system_id: 1, component_id: 1, sequence: 0, id, payload, signature: None };
        Request::new(&ids).unwrap()
    }

    #[test]
    fn what_the_crate_writes_is_read() {
        let long = COMMAND_LONG_DATA {
            command: MavCmd::MAV_CMD_REQUEST_MESSAGE,
            param1: 1.5,
            param5: 5.5,
            param7: 7.5,
            target_system: 3,
            target_component: 191,
            confirmation: 4,
            ..COMMAND_LONG_DATA::DEFAULT
        };
        let params = [1.5, 0.0, 0.0, 0.0, 5.5, 0.0, 7.5];
        let command = Command { number: 512, params, confirmation: 4 };
        let target = Ids { system: 3, component: 191 };
        assert_eq!(read(&long), Request { target, what: What::Command(command) });
        let int = COMMAND_INT_DATA {
            command: MavCmd::MAV_CMD_PREFLIGHT_CALIBRATION,
            x: 2,
            y: -3,
            z: 0.5,
            frame: MavFrame::MAV_FRAME_MISSION,
            target_system: 3,
            target_component: 191,
            ..COMMAND_INT_DATA::DEFAULT
        };
        let params = [0.0, 0.0, 0.0, 0.0, 2.0, -3.0, 0.5];
        assert_eq!(
            read(&int),
            Request { target, what: What::Command(Command { number: 241, params, confirmation: 0 }) }
        );
        let name = *b"IRH_ROLL_TRIM\0\0\0";
        let set = PARAM_SET_DATA {
            param_value: -2.5,
            target_system: 3,
            target_component: 191,
            param_id: "IRH_ROLL_TRIM".into(),
            param_type: MavParamType::MAV_PARAM_TYPE_REAL32,
        };
        assert_eq!(read(&set), Request { target, what: What::ParamSet { name, value: -2.5 } });
        let get = PARAM_REQUEST_READ_DATA {
            param_index: -1,
            target_system: 3,
            target_component: 191,
            param_id: "IRH_ROLL_TRIM".into(),
        };
        assert_eq!(read(&get), Request { target, what: What::ParamRead { index: -1, name } });
        let list = PARAM_REQUEST_LIST_DATA { target_system: 3, target_component: 191 };
        assert_eq!(read(&list), Request { target, what: What::ParamList });
    }

    #[test]
    fn commands_that_nobody_knows_keep_their_number() {
        let mut payload = [0; 33];
        payload[28..32].copy_from_slice(&[0x39, 0xa0, 3, 191]);
        let Request { target, what: What::Command(c) } = packet(76, &payload) else { panic!() };
        assert_eq!((c.number, target.component), (0xa039, 191));
        let Request { what: What::Command(c), .. } = packet(76, &[]) else { panic!() };
        assert_eq!(c.number, 0);
    }
}
