//! Which autopilot is listened to, and whose system this daemon is a part of. Pure.

use super::deframe::Packet;
use crate::config::settings::AUTOPILOT;
use std::ops::RangeInclusive;

/// HEARTBEAT, whose bytes are looked at as they are: a parser refuses a kind of vehicle that it does not know.
const HEARTBEAT: u32 = 0;
/// MAV_AUTOPILOT_INVALID: no autopilot.
const INVALID: u8 = 8;
/// MAV_AUTOPILOT_ARDUPILOTMEGA.
const ARDUPILOT: u8 = 3;
/// Where HEARTBEAT says what flies (MAV_TYPE), and those that bank to turn: generic, fixed wing, flapping wing, VTOL.
const TYPE_AT: usize = 4;
const AEROPLANES: [RangeInclusive<u8>; 3] = [0..=1, 16..=16, 19..=25];
/// Where it says which autopilot it is of.
const KIND_AT: usize = 5;
/// Where it says its mode, and MAV_MODE_FLAG_SAFETY_ARMED there.
const MODE_AT: usize = 6;
const ARMED: u8 = 128;

/// What a message has told of who is there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Notice {
    /// Nothing new.
    Nothing,
    /// The autopilot that is listened to was heard for the first time: its system.
    Autopilot(u8),
    /// Another autopilot was heard, for the first time: its system. It is not listened to.
    Another(u8),
}

/// Who is who. The first autopilot stays the one that is listened to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Identity {
    system_id: Option<u8>,
    autopilot_id: Option<u8>,
    /// The system of the autopilot that was heard, and what kind of autopilot it is.
    heard: Option<(u8, u8)>,
    aeroplane: bool,
    armed: bool,
    told: bool,
}

impl Identity {
    /// With the configured `system-id` and `autopilot-id`.
    pub const fn new(system_id: Option<u8>, autopilot_id: Option<u8>) -> Self {
        Self { system_id, autopilot_id, heard: None, aeroplane: false, armed: false, told: false }
    }

    /// A new configuration. The autopilot stays unless another one is asked for.
    pub fn configure(&mut self, system_id: Option<u8>, autopilot_id: Option<u8>) {
        let heard = self.heard.filter(|(id, _)| autopilot_id.is_none_or(|wanted| wanted == *id));
        *self = Self { system_id, autopilot_id, heard, told: false, ..*self };
    }

    /// Takes in a message.
    pub fn hear(&mut self, packet: &Packet<'_>) -> Notice {
        let (id, component) = (packet.system_id, packet.component_id);
        // MAVLink 2 leaves zeros at the end out.
        let at = |i: usize| packet.payload.get(i).copied().unwrap_or(0);
        let kind = at(KIND_AT);
        if packet.id != HEARTBEAT || component != AUTOPILOT || id == 0 || kind == INVALID {
            return Notice::Nothing;
        }
        let listened = self.heard.map(|(id, _)| id).or(self.autopilot_id);
        if listened.is_none_or(|listened| listened == id) {
            let first = self.heard.replace((id, kind)).is_none();
            self.aeroplane = AEROPLANES.iter().any(|types| types.contains(&at(TYPE_AT)));
            self.armed = at(MODE_AT) & ARMED != 0;
            return if first { Notice::Autopilot(id) } else { Notice::Nothing };
        }
        if std::mem::replace(&mut self.told, true) { Notice::Nothing } else { Notice::Another(id) }
    }

    /// The system of the autopilot that is listened to, once it was heard.
    pub fn autopilot(&self) -> Option<u8> {
        self.heard.map(|(id, _)| id)
    }

    /// Whether that autopilot said that what it flies turns by banking and climbs where its nose points.
    pub fn is_aeroplane(&self) -> bool {
        self.aeroplane
    }

    /// Whether that autopilot said that its motors are armed.
    pub fn is_armed(&self) -> bool {
        self.armed
    }

    /// Whether that autopilot is an ArduPilot.
    pub fn is_ardupilot(&self) -> bool {
        self.heard.is_some_and(|(_, kind)| kind == ARDUPILOT)
    }

    /// Whether a message is of that autopilot.
    pub fn is_of_autopilot(&self, packet: &Packet<'_>) -> bool {
        packet.component_id == AUTOPILOT && self.autopilot() == Some(packet.system_id)
    }

    /// The system that this daemon is a part of: as configured, else the autopilot's, else 1.
    pub fn system_id(&self) -> u8 {
        self.system_id.or(self.autopilot()).or(self.autopilot_id).unwrap_or(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn heartbeat(system_id: u8, component_id: u8, payload: &[u8]) -> Packet<'_> {
        Packet { bytes: &[], v2: true, system_id, component_id, sequence: 0, id: 0, payload, signature: None }
    }

    /// Of a kind of vehicle that nobody knows yet.
    fn of(kind: u8) -> [u8; 9] {
        [0, 0, 0, 0, 250, kind, 81, 4, 3]
    }

    #[test]
    fn the_first_autopilot_stays() {
        let mut who = Identity::new(None, None);
        assert_eq!(who.system_id(), 1);
        assert_eq!(who.hear(&heartbeat(255, 190, &of(8))), Notice::Nothing, "a ground station");
        assert_eq!(who.hear(&heartbeat(9, 1, &of(8))), Notice::Nothing, "no autopilot");
        assert_eq!(who.hear(&heartbeat(9, 191, &of(3))), Notice::Nothing, "another component");
        assert_eq!(who.hear(&heartbeat(0, 1, &of(3))), Notice::Nothing, "everybody");
        assert_eq!(who.hear(&heartbeat(7, 1, &of(3))), Notice::Autopilot(7));
        assert_eq!(who.hear(&heartbeat(8, 1, &of(12))), Notice::Another(8));
        assert_eq!(who.hear(&heartbeat(8, 1, &of(12))), Notice::Nothing, "said once");
        assert_eq!((who.system_id(), who.autopilot(), who.is_ardupilot()), (7, Some(7), true));
        assert!(who.is_of_autopilot(&heartbeat(7, 1, &[])) && !who.is_of_autopilot(&heartbeat(7, 191, &[])));
    }

    #[test]
    fn what_is_configured_holds() {
        let mut who = Identity::new(Some(42), Some(8));
        assert_eq!(who.hear(&heartbeat(7, 1, &of(3))), Notice::Another(7));
        assert_eq!(who.autopilot(), None);
        assert_eq!(who.hear(&heartbeat(8, 1, &of(12))), Notice::Autopilot(8));
        assert_eq!((who.system_id(), who.is_ardupilot()), (42, false));
        who.configure(None, Some(8));
        assert_eq!((who.system_id(), who.autopilot()), (8, Some(8)), "the autopilot stays");
        who.configure(None, Some(9));
        assert_eq!((who.system_id(), who.autopilot()), (9, None));
    }

    #[test]
    fn zeros_left_out_are_a_generic_autopilot() {
        let mut who = Identity::new(None, None);
        assert_eq!(who.hear(&heartbeat(3, 1, &[0, 0, 0, 0, 1])), Notice::Autopilot(3));
    }

    #[test]
    fn what_flies_is_said_by_each_heartbeat() {
        let mut who = Identity::new(None, None);
        assert!(!who.is_aeroplane(), "before any");
        // MAV_TYPE: generic, fixed wing, quadrotor, helicopter, rover, hexarotor, flapping wing, VTOL with tilting rotors,
        // dodecarotor, one that nobody knows yet.
        let said = [0, 1, 2, 4, 10, 13, 16, 21, 29, 250].map(|what| {
            who.hear(&heartbeat(3, 1, &[0, 0, 0, 0, what, 3, 81, 4, 3]));
            who.is_aeroplane()
        });
        assert_eq!(said, [true, true, false, false, false, false, true, true, false, false]);
        who.configure(Some(9), None);
        who.hear(&heartbeat(4, 1, &[0, 0, 0, 0, 1, 3, 81, 4, 3]));
        assert!(!who.is_aeroplane(), "another's");
    }
}
