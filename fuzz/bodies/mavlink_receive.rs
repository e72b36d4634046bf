//! Any bytes as what arrives at an endpoint: no panic; what is found in a datagram is found in a stream in pieces; and
//! nothing without the key passes as signed.

use irhorizon::mavlink::deframe::{Deframer, MAX_FRAME, datagram};
use irhorizon::mavlink::heard::Heard;
use irhorizon::mavlink::signing::{Key, Signing};

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
