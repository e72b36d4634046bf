//! A bus of fake chips.

use irhorizon::bus::{BusError, PecBus, WordBus};
use irhorizon::source::Integrity;
use std::cell::{Cell, RefCell};

/// A chip on the bus /dev/i2c-1.
#[derive(Clone, Default)]
pub struct Chip {
    pub address: u8,
    pub words: Vec<(u8, u16)>,
    /// It takes writes only with PEC, and keeps its address until its power is cycled.
    pub mlx: bool,
    pub claimed: bool,
    /// Its packet error code does not match.
    pub damaged: bool,
}

thread_local! {
    pub static CHIPS: RefCell<Vec<Chip>> = const { RefCell::new(Vec::new()) };
    pub static ADAPTER_HAS_PEC: Cell<bool> = const { Cell::new(true) };
    pub static WRITES: Cell<usize> = const { Cell::new(0) };
}

pub fn mlx(address: u8) -> Chip {
    let words =
        vec![(0x06, 14728), (0x07, 14100), (0x2E, 0xBE00 | u16::from(address)), (0x3C, 1), (0x3D, 2), (0x3E, 3)];
    let words = words.into_iter().chain([(0x3F, u16::from(address))]).collect();
    Chip { address, words, mlx: true, ..Chip::default() }
}

pub fn adc() -> Chip {
    // It heeds two bits of a command: 0x2E reads register 2, and so on.
    let words = (0..=255).map(|c: u8| (c, [0x0000, 0x8385, 0x0080, 0xFF7F][usize::from(c & 3)])).collect();
    Chip { address: 0x48, words, ..Chip::default() }
}

pub struct Wire {
    pub address: u8,
    pub checked: bool,
}

impl Wire {
    fn chip<T>(&self, act: impl FnOnce(&mut Chip) -> Result<T, BusError>) -> Result<T, BusError> {
        CHIPS.with_borrow_mut(|c| c.iter_mut().find(|c| c.address == self.address).map_or(Err(BusError::NoAnswer), act))
    }
}

impl WordBus for Wire {
    fn read_word(&mut self, command: u8) -> Result<u16, BusError> {
        let checked = self.checked;
        self.chip(|c| match c.words.iter().find(|(w, _)| *w == command) {
            _ if checked && c.damaged => Err(BusError::Pec),
            Some((_, word)) => Ok(*word),
            None => Ok(0xFFFF),
        })
    }

    fn write_word(&mut self, command: u8, word: u16) -> Result<(), BusError> {
        WRITES.set(WRITES.get() + 1);
        let checked = self.checked;
        self.chip(|c| {
            assert!(c.mlx && command == 0x2E, "only that cell of a sensor is written");
            if let Some(cell) = c.words.iter_mut().find(|(w, _)| *w == command).filter(|_| checked) {
                // Writing sets bits, erasing clears them.
                cell.1 = if word == 0 { 0 } else { cell.1 | word };
            }
            Ok(())
        })
    }
}

impl PecBus for Wire {
    fn pec(&self) -> Option<Integrity> {
        ADAPTER_HAS_PEC.get().then_some(Integrity::Pec)
    }

    fn set_pec(&mut self, on: bool) -> Result<(), BusError> {
        self.checked = on && ADAPTER_HAS_PEC.get();
        Ok(())
    }
}

pub fn chips(chips: &[Chip]) {
    CHIPS.set(chips.to_vec());
    WRITES.set(0);
}

pub fn cell(address: u8) -> u16 {
    CHIPS.with_borrow(|c| c.iter().find(|c| c.address == address).unwrap().words[2].1)
}
