//! Any bytes as what arrives at an endpoint: no panic; what is found in a datagram is found in a stream in pieces; and
//! nothing without the key passes as signed.

use irhorizon::mavlink::deframe::{Deframer, MAX_FRAME, datagram};
use irhorizon::mavlink::encode::Encoder;
use irhorizon::mavlink::heard::Heard;
use irhorizon::mavlink::messages;
use irhorizon::mavlink::signing::{Key, Signing};
use irhorizon::time::Time;

/// Good messages, signed and not, and what promises more than there is.
pub fn seeds() -> Vec<Vec<u8>> {
    let mut encoder = Encoder::new(1, 191);
    let mut other = Signing::new(Key::new([1; 32]), 0, 0);
    let messages = [messages::autopilot_version(), messages::component_information(Time::from_nanos(5))];
    let mut seeds: Vec<Vec<u8>> = Vec::new();
    for message in &messages {
        seeds.push([&[7], encoder.encode(message)].concat());
        seeds.push([&[30], encoder.encode_signed(message, &mut other, 1, 5)].concat());
    }
    // HEARTBEAT of a quadrotor, MAVLink 1 and its CRC; and headers that promise more.
    seeds.push(vec![255, 0xfe, 9, 7, 3, 1, 0, 0, 0, 0, 0, 2, 3, 0, 4, 3, 0xfd, 0xff, 0, 0xfe, 0xff]);
    seeds
}

/// The first byte is the length of the pieces.
pub fn receive(data: &[u8]) {
    let Some((piece, bytes)) = data.split_first() else { return };
    let mut signing = Signing::new(Key::new([0x5c; 32]), 0, 0);
    let mut found = 0;
    datagram(bytes, |packet| {
        found += 1;
        assert!(packet.bytes.len() <= MAX_FRAME && packet.payload.len() <= 255);
        let _ = Heard::new(&packet);
        assert!(signing.check(&packet, 0).is_err());
    });
    let mut stream = Deframer::default();
    let mut whole = 0;
    for piece in bytes.chunks(usize::from(*piece) + 1) {
        stream.take(piece, |packet| {
            whole += 1;
            let _ = Heard::new(&packet);
        });
    }
    // What lies behind a header that claims more bytes than there are is still to come.
    stream.take(&[0; MAX_FRAME], |_| whole += 1);
    // It may, with the zeros, turn out to be a message around one of the others.
    assert!(whole > 0 || found == 0);
}
