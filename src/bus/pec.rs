//! The packet error code of SMBus: CRC-8, polynomial x⁸ + x² + x + 1, initial value 0
//! (System Management Bus specification, "Packet Error Checking").

/// The packet error code over `bytes`: every byte of the transfer, addresses with their
/// read/write bit included.
pub fn pec(bytes: &[u8]) -> u8 {
    bytes
        .iter()
        .fold(0, |crc, byte| (0..8).fold(crc ^ byte, |c: u8, _| if c & 0x80 == 0 { c << 1 } else { (c << 1) ^ 0x07 }))
}

/// The code of a Write Word: address and W, command, word.
pub fn write_word(address: u8, command: u8, word: u16) -> u8 {
    let [low, high] = word.to_le_bytes();
    pec(&[address << 1, command, low, high])
}

/// The code of a Read Word: address and W, command, address and R, word.
pub fn read_word(address: u8, command: u8, word: u16) -> u8 {
    let [low, high] = word.to_le_bytes();
    pec(&[address << 1, command, address << 1 | 1, low, high])
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_datasheets_vectors() {
        assert_eq!(pec(&[0xB4, 0x07, 0xB5, 0xD2, 0x3A]), 0x30);
        assert_eq!(pec(&[0xB4, 0x06, 0xB5, 0xDF, 0x3A]), 0xCF);
        assert_eq!(pec(&[0x00, 0x2E, 0x00, 0x00]), 0x6F);
        assert_eq!(read_word(0x5A, 0x07, 0x3AD2), 0x30);
        assert_eq!(read_word(0x5A, 0x06, 0x3ADF), 0xCF);
        assert_eq!(write_word(0x00, 0x2E, 0x0000), 0x6F);
        assert_eq!(pec(&[0x5A << 1, 0xFF]), 0xE8, "the sleep command");
    }

    #[test]
    fn it_is_the_remainder_of_a_division() {
        // The same by long division of polynomials, for every pair of bytes.
        for message in 0..=u16::MAX {
            let mut dividend = u32::from(message) << 8;
            for bit in (8..24).rev() {
                if dividend & 1 << bit != 0 {
                    dividend ^= 0x107 << (bit - 8);
                }
            }
            assert_eq!(u32::from(pec(&message.to_be_bytes())), dividend);
        }
    }

    proptest! {
        #[test]
        fn one_or_two_flipped_bits_are_always_seen(
            address in 0x03_u8..0x78, command: u8, word: u16, a in 0_u32..24, b in 0_u32..24,
        ) {
            // The received part of a read: low byte, high byte, code.
            let [low, high] = word.to_le_bytes();
            let sent = u32::from_le_bytes([low, high, read_word(address, command, word), 0]);
            let flips = if a == b { 1 << a } else { 1 << a | 1 << b };
            let [low, high, code, _] = (sent ^ flips).to_le_bytes();
            prop_assert_ne!(read_word(address, command, u16::from_le_bytes([low, high])), code);
        }

        #[test]
        fn a_burst_of_up_to_eight_bits_is_always_seen(
            address in 0x03_u8..0x78, command: u8, word: u16, pattern in 1_u8.., shift in 0_u32..17,
        ) {
            let [low, high] = word.to_le_bytes();
            let sent = u32::from_be_bytes([0, low, high, read_word(address, command, word)]);
            let [_, low, high, code] = (sent ^ (u32::from(pattern) << shift)).to_be_bytes();
            prop_assert_ne!(read_word(address, command, u16::from_le_bytes([low, high])), code);
        }
    }
}
