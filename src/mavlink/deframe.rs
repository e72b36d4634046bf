//! Whole messages out of bytes, whatever is between them. Pure.
//!
//! A length is only a claim until the CRC over it holds: where it does not, the search goes on at the very next
//! byte, so that a forged or damaged header swallows nothing of what follows. Messages of which the dialect knows
//! nothing have no CRC to check, and are passed over in the same way.

use ::mavlink::Message;
use ::mavlink::dialects::common::MavMessage;

/// The most bytes that a message has: MAVLink 2, 255 of payload, signed.
pub const MAX_FRAME: usize = 10 + 255 + 2 + SIGNATURE;

/// Bytes of a signature: link id, timestamp, the signature itself.
pub const SIGNATURE: usize = 13;

/// First byte of a MAVLink 2 message.
const V2: u8 = 0xfd;

/// First byte of a MAVLink 1 message.
const V1: u8 = 0xfe;

/// The one incompatibility flag there is: the message is signed.
const SIGNED: u8 = 1;

/// A whole message whose CRC holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Packet<'a> {
    /// All of its bytes, signature included.
    pub bytes: &'a [u8],
    /// Whether it is MAVLink 2.
    pub v2: bool,
    /// The sender's system.
    pub system_id: u8,
    /// The sender's component.
    pub component_id: u8,
    /// The sender's count of messages.
    pub sequence: u8,
    /// Which message.
    pub id: u32,
    /// Its payload; MAVLink 2 leaves zeros at the end out.
    pub payload: &'a [u8],
    /// Link id, timestamp and signature, of a message that is signed; not yet checked.
    pub signature: Option<&'a [u8]>,
}

impl<'a> Packet<'a> {
    /// The message at the start of `bytes`.
    fn at_start(bytes: &'a [u8]) -> Result<Self, Not> {
        let v2 = match bytes.first() {
            None => return Err(Not::Yet),
            Some(&V2) => true,
            Some(&V1) => false,
            Some(_) => return Err(Not::Message),
        };
        let header = if v2 { 10 } else { 6 };
        let Some(head) = bytes.get(..header) else { return Err(Not::Yet) };
        let signed = v2 && head[2] & SIGNED != 0;
        if v2 && head[2] & !SIGNED != 0 {
            return Err(Not::Message);
        }
        let end = header + usize::from(head[1]);
        let whole = end + 2 + if signed { SIGNATURE } else { 0 };
        let id = if v2 { u32::from_le_bytes([head[7], head[8], head[9], 0]) } else { u32::from(head[5]) };
        // There is no extra CRC of 0 in the dialect but for ids that it has not.
        let extra = MavMessage::extra_crc(id);
        if extra == 0 {
            return Err(Not::Foreign(whole));
        }
        let Some(frame) = bytes.get(..whole) else { return Err(Not::Yet) };
        let crc = u16::from_le_bytes([frame[end], frame[end + 1]]);
        if ::mavlink::calculate_crc(&frame[1..end], extra) != crc {
            return Err(Not::Whole);
        }
        let ids = if v2 { &head[4..7] } else { &head[2..5] };
        Ok(Self {
            bytes: frame,
            v2,
            sequence: ids[0],
            system_id: ids[1],
            component_id: ids[2],
            id,
            payload: &frame[header..end],
            signature: signed.then(|| &frame[end + 2..]),
        })
    }
}

/// Why there is no message at the start of some bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Not {
    /// More bytes are needed to tell.
    Yet,
    /// It is none.
    Message,
    /// It may be one of so many bytes that the dialect has not.
    Foreign(usize),
    /// It looks like one that the dialect has, but its CRC does not hold.
    Whole,
}

/// What was passed over.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Skipped {
    /// Bytes that belong to no message of the dialect.
    pub bytes: u64,
    /// What looked like a message of the dialect, but for its CRC; not what another message may have in it.
    pub bad_crc: u64,
}

impl Skipped {
    /// Passes over the start of `bytes`, which is `not` one of a message; gives the rest. `foreign` bytes may belong to a message
    /// that the dialect has not.
    fn over<'a>(&mut self, bytes: &'a [u8], not: Not, foreign: &mut usize) -> &'a [u8] {
        match not {
            Not::Foreign(length) if *foreign == 0 => *foreign = length,
            Not::Whole if *foreign == 0 => self.bad_crc += 1,
            _ => {}
        }
        let rest = next(bytes);
        let passed = bytes.len() - rest.len();
        self.bytes += passed as u64;
        *foreign = foreign.saturating_sub(passed);
        rest
    }
}

/// Gives `heed` every message in a datagram. What is cut off at its end is lost.
pub fn datagram(mut bytes: &[u8], mut heed: impl FnMut(Packet<'_>)) -> Skipped {
    let (mut skipped, mut foreign) = (Skipped::default(), 0);
    while !bytes.is_empty() {
        match Packet::at_start(bytes) {
            Ok(packet) => {
                (bytes, foreign) = (&bytes[packet.bytes.len()..], 0);
                heed(packet);
            }
            Err(not) => bytes = skipped.over(bytes, not, &mut foreign),
        }
    }
    skipped
}

/// What follows the first byte, from the next one on with which a message may begin.
fn next(bytes: &[u8]) -> &[u8] {
    let start = bytes.iter().skip(1).position(|b| matches!(*b, V1 | V2));
    start.map_or(&[], |i| &bytes[i + 1..])
}

/// Messages out of a stream, which come in pieces.
#[derive(Clone, Debug)]
pub struct Deframer {
    buffer: [u8; 2 * MAX_FRAME],
    held: usize,
    /// So many of the next bytes may belong to a message that the dialect has not.
    foreign: usize,
}

impl Default for Deframer {
    fn default() -> Self {
        Self { buffer: [0; 2 * MAX_FRAME], held: 0, foreign: 0 }
    }
}

impl Deframer {
    /// Takes in what has arrived and gives `heed` every message that is whole now.
    pub fn take(&mut self, mut bytes: &[u8], mut heed: impl FnMut(Packet<'_>)) -> Skipped {
        let mut skipped = Skipped::default();
        while !bytes.is_empty() {
            let taken = bytes.len().min(self.buffer.len() - self.held);
            self.buffer[self.held..self.held + taken].copy_from_slice(&bytes[..taken]);
            self.held += taken;
            bytes = &bytes[taken..];
            self.drain(&mut skipped, &mut heed);
        }
        skipped
    }

    /// Forgets a message begun: the stream is another one.
    pub fn clear(&mut self) {
        (self.held, self.foreign) = (0, 0);
    }

    fn drain(&mut self, skipped: &mut Skipped, heed: &mut impl FnMut(Packet<'_>)) {
        let mut rest = &self.buffer[..self.held];
        loop {
            match Packet::at_start(rest) {
                Ok(packet) => {
                    (rest, self.foreign) = (&rest[packet.bytes.len()..], 0);
                    heed(packet);
                }
                // At most one message less a byte stays: there is always room for more.
                Err(Not::Yet) => break,
                Err(not) => rest = skipped.over(rest, not, &mut self.foreign),
            }
        }
        let left = rest.len();
        self.buffer.copy_within(self.held - left..self.held, 0);
        self.held = left;
    }
}

#[cfg(test)]
mod tests {
    use super::super::encode::Encoder;
    use super::super::messages;
    use super::*;
    use ::mavlink::dialects::common::MavState;
    use proptest::prelude::*;

    fn frames(count: usize) -> Vec<Vec<u8>> {
        let mut encoder = Encoder::new(1, 191);
        (0..count).map(|_| encoder.encode(&messages::heartbeat(MavState::MAV_STATE_ACTIVE)).to_vec()).collect()
    }

    #[test]
    fn a_forged_length_swallows_nothing() {
        let mut bytes = vec![0xfd, 0xff, 0x00, 0xfe, 0xff];
        bytes.extend(frames(12).concat());
        let mut sequences = Vec::new();
        datagram(&bytes, |p| sequences.push(p.sequence));
        assert_eq!(sequences, (0..12).collect::<Vec<u8>>());
        let mut stream = Deframer::default();
        sequences.clear();
        stream.take(&bytes, |p| sequences.push(p.sequence));
        // The forged header claims more bytes than have come yet: what it hides comes with them.
        stream.take(&[0; 300], |p| sequences.push(p.sequence));
        assert_eq!(sequences, (0..12).collect::<Vec<u8>>());
    }

    #[test]
    fn what_is_passed_over_is_counted() {
        let mut bytes = [b"noise".to_vec(), frames(3).concat(), b"more".to_vec()].concat();
        assert_eq!(datagram(&bytes, |_| {}), Skipped { bytes: 9, bad_crc: 0 });
        // The last byte of the second of three heartbeats of 21 bytes.
        bytes[5 + 2 * 21 - 1] ^= 1;
        let mut stream = Deframer::default();
        let mut seen = 0;
        assert_eq!(stream.take(&bytes, |_| seen += 1), Skipped { bytes: 9 + 21, bad_crc: 1 });
        assert_eq!(seen, 2);
    }

    /// A message of ArduPilot's, 163, with what looks like the headers of others in it, and a heartbeat that is damaged.
    #[test]
    fn what_another_dialect_says_is_not_damaged() {
        let mut ahrs = vec![0xfd, 28, 0, 0, 1, 1, 1, 163, 0, 0];
        ahrs.extend([0xfe, 9, 7, 3, 1, 0, 0, 0, 0, 0, 2, 3, 0, 0xfd, 9, 0, 0, 7, 3, 1, 0, 0, 0, 1, 2, 3, 4, 5, 9, 9]);
        let mut bytes = [ahrs, frames(2).concat()].concat();
        *bytes.last_mut().unwrap() ^= 1;
        for piece in [1, 30, bytes.len()] {
            let (mut stream, mut bad_crc, mut seen) = (Deframer::default(), 0, 0);
            bytes.chunks(piece).for_each(|piece| bad_crc += stream.take(piece, |_| seen += 1).bad_crc);
            assert_eq!((seen, bad_crc), (1, 1), "{piece} at a time");
        }
        assert_eq!(datagram(&bytes, |_| {}).bad_crc, 1);
    }

    #[test]
    fn both_versions_are_read() {
        // HEARTBEAT of system 3, component 1: a quadrotor of ArduPilot, MAVLink 1.
        let mut v1 = vec![0xfe, 9, 7, 3, 1, 0, 0, 0, 0, 0, 2, 3, 0, 4, 3];
        v1.extend(::mavlink::calculate_crc(&v1[1..], 50).to_le_bytes());
        let mut seen = Vec::new();
        datagram(&v1, |p| seen.push((p.v2, p.system_id, p.component_id, p.sequence, p.id, p.payload.len())));
        assert_eq!(seen, [(false, 3, 1, 7, 0, 9)]);
    }

    proptest! {
        #[test]
        fn a_stream_in_any_pieces_between_any_noise_gives_every_message(
            count in 1_usize..20,
            noise in prop::collection::vec(prop::collection::vec(0_u8..0xfd, 0..40), 20),
            piece in 1_usize..400,
        ) {
            let bytes: Vec<u8> = frames(count).into_iter().zip(noise).flat_map(|(f, n)| [n, f].concat()).collect();
            let mut stream = Deframer::default();
            let mut seen = Vec::new();
            for piece in bytes.chunks(piece) {
                stream.take(piece, |p| seen.push(p.sequence));
            }
            prop_assert_eq!(seen, (0..count as u8).collect::<Vec<u8>>());
        }

        #[test]
        fn no_bytes_panic(bytes in prop::collection::vec(any::<u8>(), 0..2000), piece in 1_usize..700) {
            let mut stream = Deframer::default();
            // Any bytes may be a message: its checksum has 16 bits.
            let (mut skipped, mut seen, mut by_datagram) = (0, 0, 0);
            bytes.chunks(piece).for_each(|piece| skipped += stream.take(piece, |_| seen += 1).bytes);
            let skipped = skipped + stream.held as u64;
            let passed_over = datagram(&bytes, |_| by_datagram += 1).bytes;
            for (skipped, seen) in [(skipped, seen), (passed_over, by_datagram)] {
                prop_assert!(skipped == bytes.len() as u64 || seen > 0 && skipped < bytes.len() as u64);
            }
        }
    }
}
