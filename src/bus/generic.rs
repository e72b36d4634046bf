//! SMBus words over any `embedded-hal` I²C, with the packet error code in software.

use super::{BusError, PecBus, WordBus, pec};
use crate::source::Integrity;
use embedded_hal::i2c::{Error, ErrorKind, I2c};

/// One chip on an `embedded-hal` I²C that does combined write-read transfers.
#[derive(Debug)]
pub struct GenericBus<I> {
    i2c: I,
    address: u8,
    pec: bool,
}

impl<I: I2c> GenericBus<I> {
    /// The chip at `address` (7 bits), without PEC.
    pub fn new(i2c: I, address: u8) -> Self {
        Self { i2c, address, pec: false }
    }

    /// Gives the I²C back.
    pub fn release(self) -> I {
        self.i2c
    }
}

impl<I: I2c + Send> WordBus for GenericBus<I> {
    fn read_word(&mut self, command: u8) -> Result<u16, BusError> {
        let mut received = [0_u8; 3];
        let length = if self.pec { 3 } else { 2 };
        self.i2c.write_read(self.address, &[command], &mut received[..length]).map_err(|e| classify(&e))?;
        let word = u16::from_le_bytes([received[0], received[1]]);
        if self.pec && received[2] != pec::read_word(self.address, command, word) {
            return Err(BusError::Pec);
        }
        Ok(word)
    }

    fn write_word(&mut self, command: u8, word: u16) -> Result<(), BusError> {
        let [low, high] = word.to_le_bytes();
        let code = pec::write_word(self.address, command, word);
        let length = if self.pec { 4 } else { 3 };
        self.i2c.write(self.address, &[command, low, high, code][..length]).map_err(|e| classify(&e))
    }
}

impl<I: I2c + Send> PecBus for GenericBus<I> {
    fn pec(&self) -> Option<Integrity> {
        Some(Integrity::SoftwarePec)
    }

    fn set_pec(&mut self, on: bool) -> Result<(), BusError> {
        self.pec = on;
        Ok(())
    }
}

fn classify(error: &impl Error) -> BusError {
    match error.kind() {
        ErrorKind::NoAcknowledge(_) => BusError::NoAnswer,
        _ => BusError::Other(0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use embedded_hal::i2c::{ErrorType, NoAcknowledgeSource, Operation};
    use proptest::prelude::*;

    /// A chip of 256 words that sends the PEC and, when it is sent one, checks it.
    struct Memory {
        address: u8,
        words: [u16; 256],
        flip: u32,
        bytes_of_last_write: usize,
    }

    fn memory() -> Memory {
        Memory { address: 0x5A, words: [0; 256], flip: 0, bytes_of_last_write: 0 }
    }

    impl ErrorType for Memory {
        type Error = ErrorKind;
    }

    impl I2c for Memory {
        fn transaction(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), ErrorKind> {
            if address != self.address {
                return Err(ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address));
            }
            match operations {
                [Operation::Write([command]), Operation::Read(into)] => {
                    let [low, high] = self.words[usize::from(*command)].to_le_bytes();
                    let code = pec::pec(&[address << 1, *command, address << 1 | 1, low, high]);
                    let sent = (u32::from_le_bytes([low, high, code, 0]) ^ self.flip).to_le_bytes();
                    into.copy_from_slice(&sent[..into.len()]);
                    Ok(())
                }
                [Operation::Write(bytes)] => {
                    self.bytes_of_last_write = bytes.len();
                    if bytes.len() == 4 && pec::pec(&[address << 1, bytes[0], bytes[1], bytes[2]]) != bytes[3] {
                        return Err(ErrorKind::NoAcknowledge(NoAcknowledgeSource::Data));
                    }
                    self.words[usize::from(bytes[0])] = u16::from_le_bytes([bytes[1], bytes[2]]);
                    Ok(())
                }
                other => panic!("not an SMBus word: {} operations", other.len()),
            }
        }
    }

    proptest! {
        #[test]
        fn what_is_written_is_read_back(command: u8, word: u16, checked: bool) {
            let mut bus = GenericBus::new(memory(), 0x5A);
            bus.set_pec(checked).unwrap();
            bus.write_word(command, word).unwrap();
            prop_assert_eq!(bus.read_word(command), Ok(word));
            prop_assert_eq!(bus.release().bytes_of_last_write, if checked { 4 } else { 3 });
        }

        #[test]
        fn a_flipped_bit_is_seen_with_pec(command: u8, word: u16, bit in 0_u32..24) {
            let mut bus = GenericBus::new(memory(), 0x5A);
            bus.write_word(command, word).unwrap();
            bus.i2c.flip = 1 << bit;
            bus.set_pec(true).unwrap();
            prop_assert_eq!(bus.read_word(command), Err(BusError::Pec));
        }
    }

    #[test]
    fn nobody_at_the_address_is_no_answer() {
        let mut bus = GenericBus::new(memory(), 0x5B);
        assert_eq!(bus.read_word(7), Err(BusError::NoAnswer));
        assert_eq!(bus.write_word(7, 0), Err(BusError::NoAnswer));
    }

    #[test]
    fn linux_embedded_hal_fits() {
        fn fits<B: PecBus>() {}
        fits::<GenericBus<linux_embedded_hal::I2cdev>>();
    }
}
