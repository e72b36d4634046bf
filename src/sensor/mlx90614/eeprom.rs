//! Changing the MLX90614's address and configuration (datasheet 8.3.3, 8.4.5).
//!
//! A cell is erased (0 written), left 10 ms, written, left 10 ms and read back; it takes effect
//! after a power cycle. Only these two cells are ever written, and of the configuration only what
//! the factory did not calibrate with.

use super::driver::Mlx90614;
use super::registers::{ADDRESS, CONFIGURATION, Configuration, FACTORY_BITS};
use crate::bus::{BusError, PecBus, WordBus};
use std::fmt;
use std::time::Duration;

/// After an erase and after a write.
const PAUSE: Duration = Duration::from_millis(10);

/// A cell that was changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Change {
    /// What it held.
    pub from: u16,
    /// What it holds.
    pub to: u16,
}

/// Why a cell was not changed, and what it holds now.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EepromError {
    /// Not a 7-bit address that I²C leaves to chips: 0x08 to 0x77.
    BadAddress(u8),
    /// The new configuration would change bits that the factory calibrated with.
    FactoryBits {
        /// What the cell holds.
        holds: u16,
        /// What was asked for.
        asked: u16,
    },
    /// The cell holds this already; nothing was written.
    Unchanged(u16),
    /// The cell could not be read reliably; nothing was written.
    Unread {
        /// The cell.
        cell: u8,
        /// Why; `None` when it was read differently each time.
        error: Option<BusError>,
    },
    /// The sensor did not take the change; the cell holds what it held.
    Refused {
        /// The cell.
        cell: u8,
        /// What it holds.
        holds: u16,
        /// Why; `None` when every transfer succeeded and nothing changed.
        error: Option<BusError>,
    },
    /// The write failed, and the old value was put back.
    Restored {
        /// The cell.
        cell: u8,
        /// What it holds: the old value.
        holds: u16,
        /// What was asked for.
        asked: u16,
    },
    /// The write failed and the old value could not be put back.
    Damaged {
        /// The cell.
        cell: u8,
        /// What it held.
        held: u16,
        /// What it holds; `None` when it cannot be read.
        holds: Option<u16>,
        /// What was asked for.
        asked: u16,
    },
}

impl fmt::Display for EepromError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::BadAddress(a) => write!(f, "{a:#04x} is no address for a sensor; choose one from 0x08 to 0x77"),
            Self::FactoryBits { holds, asked } => write!(
                f,
                "{asked:#06x} would change factory calibration bits of cell 0x25, which holds {holds:#06x}; keep its \
                 bits 14 to 11, 7 and 3"
            ),
            Self::Unchanged(word) => write!(f, "the cell holds {word:#06x} already; nothing was written"),
            Self::Unread { cell, error: Some(e) } => {
                write!(f, "cell {cell:#04x} could not be read ({e}); nothing was written; see irhorizonctl doctor")
            }
            Self::Unread { cell, error: None } => write!(
                f,
                "cell {cell:#04x} reads differently each time; nothing was written; check the wiring and that only \
                 one sensor is on the bus"
            ),
            Self::Refused { cell, holds, error: Some(e) } => {
                write!(f, "the sensor refused the change of cell {cell:#04x} ({e}); it still holds {holds:#06x}")
            }
            Self::Refused { cell, holds, error: None } => write!(
                f,
                "the sensor ignored the change of cell {cell:#04x}; it still holds {holds:#06x}; writes need PEC, \
                 does the adapter have it?"
            ),
            Self::Restored { cell, holds, asked } => write!(
                f,
                "writing {asked:#06x} to cell {cell:#04x} failed; it holds its old value {holds:#06x} again; check \
                 the supply (3 V parts: 2.6 to 3.6 V) and try again"
            ),
            Self::Damaged { cell, held, holds: Some(now), asked } => write!(
                f,
                "writing {asked:#06x} to cell {cell:#04x} failed; it holds {now:#06x} now and held {held:#06x}; do \
                 not cut its power: try again, it answers at its old address until then"
            ),
            Self::Damaged { cell, held, holds: None, asked } => write!(
                f,
                "writing {asked:#06x} to cell {cell:#04x} failed and it cannot be read; it held {held:#06x}; try \
                 again; after a power cycle, address 0 reaches a sensor that is alone on its bus"
            ),
        }
    }
}

impl std::error::Error for EepromError {}

impl<B: WordBus> Mlx90614<B> {
    /// Gives the sensor the address `new` (7 bits) from its next power cycle on. The high byte of
    /// the cell stays. `pause` waits as long as it is told.
    pub fn set_address(&mut self, new: u8, pause: &mut dyn FnMut(Duration)) -> Result<Change, EepromError> {
        if !(0x08..=0x77).contains(&new) {
            return Err(EepromError::BadAddress(new));
        }
        let held = self.cell(ADDRESS)?;
        self.change(ADDRESS, held, held & 0xFF00 | u16::from(new), pause)
    }

    /// Gives the sensor the configuration `new` from its next power cycle on.
    pub fn set_configuration(
        &mut self,
        new: Configuration,
        pause: &mut dyn FnMut(Duration),
    ) -> Result<Change, EepromError> {
        let held = self.cell(CONFIGURATION)?;
        if (held ^ new.0) & FACTORY_BITS != 0 {
            return Err(EepromError::FactoryBits { holds: held, asked: new.0 });
        }
        self.change(CONFIGURATION, held, new.0, pause)
    }

    /// Reads a cell until two readings in a row agree, at most five times: what is written next is
    /// built on it, and not every bus checks its words.
    fn cell(&mut self, cell: u8) -> Result<u16, EepromError> {
        let mut last = self.word(cell);
        for _ in 0..4 {
            let again = self.word(cell);
            match again {
                Ok(word) if again == last => return Ok(word),
                _ => last = again,
            }
        }
        Err(EepromError::Unread { cell, error: last.err() })
    }

    fn change(
        &mut self,
        cell: u8,
        held: u16,
        asked: u16,
        pause: &mut dyn FnMut(Duration),
    ) -> Result<Change, EepromError> {
        if asked == held {
            return Err(EepromError::Unchanged(held));
        }
        let error = self.erase_and_write(cell, asked, pause).err();
        let mut holds = self.cell(cell).ok();
        if holds == Some(asked) {
            return Ok(Change { from: held, to: asked });
        }
        if holds == Some(held) {
            return Err(EepromError::Refused { cell, holds: held, error });
        }
        for _ in 0..3 {
            // Whether it worked is for the cell to say.
            let _ = self.erase_and_write(cell, held, pause);
            holds = self.cell(cell).ok().or(holds);
            if holds == Some(held) {
                return Err(EepromError::Restored { cell, holds: held, asked });
            }
        }
        Err(EepromError::Damaged { cell, held, holds: self.cell(cell).ok(), asked })
    }

    fn erase_and_write(&mut self, cell: u8, word: u16, pause: &mut dyn FnMut(Duration)) -> Result<(), BusError> {
        let erased = self.set_word(cell, 0);
        pause(PAUSE);
        erased?;
        let written = self.set_word(cell, word);
        pause(PAUSE);
        written
    }
}

/// A bus that checks the packet error code of writes only, which the sensor insists on: for parts
/// and adapters whose read PEC does not match (`pec = "off"`).
#[derive(Debug)]
pub struct PecOnWrite<B>(pub B);

impl<B: PecBus> WordBus for PecOnWrite<B> {
    fn read_word(&mut self, command: u8) -> Result<u16, BusError> {
        self.0.read_word(command)
    }

    fn write_word(&mut self, command: u8, word: u16) -> Result<(), BusError> {
        self.0.set_pec(true)?;
        let written = self.0.write_word(command, word);
        self.0.set_pec(false)?;
        written
    }
}

#[cfg(test)]
mod tests;
