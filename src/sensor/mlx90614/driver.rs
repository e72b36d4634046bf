//! The MLX90614 over any word bus.

use super::registers::{self, Configuration};
use crate::bus::{BusError, WordBus};
use crate::frame::Missing;

/// Which of a dual-zone part's two fields of view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Object {
    /// Object 1: the only one of single-zone parts.
    One,
    /// Object 2.
    Two,
}

impl Object {
    /// From the configuration's number: 1 or 2.
    pub const fn from_number(number: u8) -> Option<Self> {
        match number {
            1 => Some(Self::One),
            2 => Some(Self::Two),
            _ => None,
        }
    }
}

/// One MLX90614.
#[derive(Debug)]
pub struct Mlx90614<B> {
    bus: B,
}

impl<B: WordBus> Mlx90614<B> {
    /// The chip at the other end of `bus`.
    pub fn new(bus: B) -> Self {
        Self { bus }
    }

    /// The bus, to turn its checks on and off.
    pub fn bus(&mut self) -> &mut B {
        &mut self.bus
    }

    /// The temperature of what it looks at, °C: −70 to 382.19.
    pub fn object_c(&mut self, object: Object) -> Result<f64, Missing> {
        let command = match object {
            Object::One => registers::OBJECT_1,
            Object::Two => registers::OBJECT_2,
        };
        registers::object_c(self.word(command).map_err(BusError::missing)?)
    }

    /// Its die temperature, °C: −40 to 125.
    pub fn ambient_c(&mut self) -> Result<f64, Missing> {
        registers::ambient_c(self.word(registers::AMBIENT).map_err(BusError::missing)?)
    }

    /// The two raw IR channels.
    pub fn raw_ir(&mut self) -> Result<[i32; 2], BusError> {
        Ok([registers::raw_ir(self.word(registers::RAW_IR_1)?), registers::raw_ir(self.word(registers::RAW_IR_2)?)])
    }

    /// Configuration register 1.
    pub fn configuration(&mut self) -> Result<Configuration, BusError> {
        self.word(registers::CONFIGURATION).map(Configuration)
    }

    /// The emissivity that it reckons with, 0 to 1.
    pub fn emissivity(&mut self) -> Result<f64, BusError> {
        self.word(registers::EMISSIVITY).map(registers::emissivity)
    }

    /// The identity that the factory gave it, first cell in the highest 16 bits.
    pub fn identity(&mut self) -> Result<u64, BusError> {
        registers::IDENTITY.iter().try_fold(0, |id, cell| Ok(id << 16 | u64::from(self.word(*cell)?)))
    }

    /// The cell that holds its address in the low byte: the one that it has from its next power cycle on.
    pub fn address_cell(&mut self) -> Result<u16, BusError> {
        self.word(registers::ADDRESS)
    }

    pub(super) fn word(&mut self, command: u8) -> Result<u16, BusError> {
        self.bus.read_word(command)
    }

    pub(super) fn set_word(&mut self, command: u8, word: u16) -> Result<(), BusError> {
        self.bus.write_word(command, word)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Words(Vec<(u8, u16)>);

    impl WordBus for Words {
        fn read_word(&mut self, command: u8) -> Result<u16, BusError> {
            self.0.iter().find(|(c, _)| *c == command).map(|(_, w)| *w).ok_or(BusError::NoAnswer)
        }

        fn write_word(&mut self, _: u8, _: u16) -> Result<(), BusError> {
            panic!("reading never writes")
        }
    }

    #[test]
    fn every_quantity_is_at_its_address() {
        let mut chip = Mlx90614::new(Words(vec![
            (0x04, 0x0010),
            (0x05, 0x8020),
            (0x06, 14683), // 20.51 °C
            (0x07, 13658), // 0.01 °C
            (0x08, 12158), // −29.99 °C
            (0x24, 0xFFFF),
            (0x25, 0x9FB4),
            (0x2E, 0xBE5A),
            (0x3C, 0x0123),
            (0x3D, 0x4567),
            (0x3E, 0x89AB),
            (0x3F, 0xCDEF),
        ]));
        assert!((chip.ambient_c().unwrap() - 20.51).abs() < 1e-9);
        assert!((chip.object_c(Object::One).unwrap() - 0.01).abs() < 1e-9);
        assert!((chip.object_c(Object::Two).unwrap() + 29.99).abs() < 1e-9);
        assert_eq!(chip.raw_ir(), Ok([16, -32]));
        assert_eq!(chip.configuration(), Ok(Configuration(0x9FB4)));
        assert_eq!(chip.emissivity(), Ok(1.0));
        assert_eq!(chip.address_cell(), Ok(0xBE5A));
        assert_eq!(chip.identity(), Ok(0x0123_4567_89AB_CDEF));
    }

    #[test]
    fn a_transfer_that_fails_is_no_temperature() {
        let mut chip = Mlx90614::new(Words(vec![(0x07, 0x8000 | 14683)]));
        assert_eq!(chip.object_c(Object::One), Err(Missing::ErrorFlag));
        assert_eq!(chip.object_c(Object::Two), Err(Missing::NoAnswer));
        assert_eq!(chip.identity(), Err(BusError::NoAnswer));
    }
}
