//! The chip's four registers over SMBus words: set up, start, ask, read.

use super::registers::{
    CONFIG, CONVERSION, Config, Conversion, Gain, HI_THRESH, LO_THRESH, Queue, READY_HI, READY_LO, Rate,
};
use crate::bus::{BusError, WordBus};
use crate::config::settings::AdcInput;
use crate::frame::Missing;
use std::fmt;

/// COMP_MODE 4, which says nothing while the comparator is off: written 1 then, 0 after a reset. So the settings of no
/// channel are those after a reset, and a supply that drops is seen whatever is measured.
const MARK: u16 = 0x0010;
/// The bits that read back as written: the settings, the mark, COMP_QUE 1:0 (off after a reset).
const KEPT: u16 = Config::SETTINGS | MARK | 0x0003;

/// The register's word for `config`, with the mark where the comparator is off.
fn word(config: Config) -> u16 {
    config.encode() | if config.queue == Queue::Off { MARK } else { 0 }
}

/// What one conversion measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Channel {
    /// The pins.
    pub input: AdcInput,
    /// Full scale.
    pub gain: Gain,
    /// Conversions a second.
    pub rate: Rate,
}

/// Why there is no voltage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AdcError {
    /// A transfer failed.
    Bus(BusError),
    /// A register does not hold what was written: another chip, or one that lost its supply.
    Foreign {
        /// The register.
        register: u8,
        /// What was written.
        wrote: u16,
        /// What was read.
        found: u16,
    },
    /// The conversion did not finish in its time.
    NotReady,
    /// A code at the end of the range.
    Saturated,
}

impl AdcError {
    /// The reason as a frame carries it.
    pub const fn missing(self) -> Missing {
        match self {
            Self::Bus(e) => e.missing(),
            Self::Foreign { .. } => Missing::Impossible,
            Self::NotReady => Missing::NotReady,
            Self::Saturated => Missing::Saturated,
        }
    }
}

impl fmt::Display for AdcError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Bus(e) => e.fmt(f),
            Self::Foreign { register, wrote, found } => write!(
                f,
                "register {register} holds {found:#06x} after {wrote:#06x} was written: not an ADS1115, or its supply \
                 dropped; check address and wiring"
            ),
            other => other.missing().fmt(f),
        }
    }
}

impl std::error::Error for AdcError {}

impl From<BusError> for AdcError {
    fn from(e: BusError) -> Self {
        Self::Bus(e)
    }
}

/// An ADS1115 behind a bus.
#[derive(Debug)]
pub struct Ads1115<B: WordBus + ?Sized> {
    config: Config,
    bus: Box<B>,
}

impl<B: WordBus + ?Sized> Ads1115<B> {
    /// The chip behind `bus`; nothing is transferred yet. `conversion` is the mode of every
    /// conversion, `ready_line` whether ALERT/RDY is to tell their ends.
    pub fn new(bus: Box<B>, conversion: Conversion, ready_line: bool) -> Self {
        let queue = if ready_line { Queue::One } else { Queue::Off };
        Self { config: Config { conversion, queue, ..Config::default() }, bus }
    }

    /// Stops what the chip does, sets it up, and sees whether registers keep what they are told.
    /// Gives the rate of a conversion from before that may still be under way.
    pub fn prepare(&mut self, channel: Channel) -> Result<Option<Rate>, AdcError> {
        let before = Config::decode(self.read_register(CONFIG)?);
        // Written with OS clear in single-shot mode: powers down after the conversion under way.
        let Channel { input, gain, rate } = channel;
        let idle =
            Config { os: false, input, gain, rate, conversion: Conversion::SingleShot, queue: self.config.queue };
        self.write_register(CONFIG, word(idle))?;
        if self.config.queue != Queue::Off {
            self.write_register(LO_THRESH, READY_LO)?;
            self.write_register(HI_THRESH, READY_HI)?;
            self.expect(LO_THRESH, READY_LO, u16::MAX)?;
            self.expect(HI_THRESH, READY_HI, u16::MAX)?;
        }
        self.expect(CONFIG, word(idle), KEPT)?;
        Ok((!before.os).then_some(before.rate))
    }

    /// Starts a conversion of `channel`, or conversions all the time. While a single one is under
    /// way the chip ignores the start (datasheet: OS): see that it is idle first.
    pub fn start(&mut self, channel: Channel) -> Result<(), AdcError> {
        let Channel { input, gain, rate } = channel;
        self.config = Config { os: true, input, gain, rate, ..self.config };
        self.write_register(CONFIG, word(self.config))
    }

    /// Whether no conversion is under way, whichever it was.
    pub fn is_idle(&mut self) -> Result<bool, AdcError> {
        Ok(Config::decode(self.read_register(CONFIG)?).os)
    }

    /// Whether the conversion started last is done; in continuous mode, whether the chip is still
    /// set to it. Errors when the chip's settings are not the ones written.
    pub fn is_ready(&mut self) -> Result<bool, AdcError> {
        let found = self.expect(CONFIG, word(self.config), KEPT)?;
        Ok(self.config.conversion == Conversion::Continuous || Config::decode(found).os)
    }

    /// The last conversion, V.
    pub fn read(&mut self) -> Result<f64, AdcError> {
        let code = self.read_register(CONVERSION)?;
        self.config.gain.volts(code.cast_signed()).ok_or(AdcError::Saturated)
    }

    fn expect(&mut self, register: u8, wrote: u16, mask: u16) -> Result<u16, AdcError> {
        let found = self.read_register(register)?;
        if (found ^ wrote) & mask == 0 { Ok(found) } else { Err(AdcError::Foreign { register, wrote, found }) }
    }

    // The chip sends the high byte first, SMBus takes it for the low one.

    fn read_register(&mut self, register: u8) -> Result<u16, AdcError> {
        Ok(self.bus.read_word(register)?.swap_bytes())
    }

    fn write_register(&mut self, register: u8, word: u16) -> Result<(), AdcError> {
        Ok(self.bus.write_word(register, word.swap_bytes())?)
    }
}
