//! SMBus words, the only way in and out of the sensors.
//!
//! - `error`: what can go wrong with a transfer.
//! - [`linux`]: words through `/dev/i2c-N`; `adapter`: what the adapter behind it can do.
//! - `hold`: one program at a time on a bus.
//! - [`generic`]: words over any `embedded-hal` I²C, with [`pec`] in software.
//! - [`explain`]: an error in words, with the user's next step.
//!
//! A driver is written over a [`WordBus`]: one chip at its address, words low byte first.

mod adapter;
mod error;
pub mod explain;
pub mod generic;
mod hold;
pub mod linux;
pub mod pec;

pub use adapter::Functions;
pub use error::BusError;

use crate::frame::Missing;
use crate::source::Integrity;

/// One chip on a bus: SMBus Read Word and Write Word, low byte first.
pub trait WordBus: Send {
    /// Reads the word behind `command`.
    fn read_word(&mut self, command: u8) -> Result<u16, BusError>;

    /// Writes `word` behind `command`.
    fn write_word(&mut self, command: u8, word: u16) -> Result<(), BusError>;
}

/// A [`WordBus`] that can check the packet error code.
pub trait PecBus: WordBus {
    /// How words are checked while the check is on; `None` where there is no such check.
    fn pec(&self) -> Option<Integrity>;

    /// Turns the check on or off; without effect where there is none. Off at first.
    fn set_pec(&mut self, on: bool) -> Result<(), BusError>;
}

impl<B: WordBus + ?Sized> WordBus for Box<B> {
    fn read_word(&mut self, command: u8) -> Result<u16, BusError> {
        (**self).read_word(command)
    }

    fn write_word(&mut self, command: u8, word: u16) -> Result<(), BusError> {
        (**self).write_word(command, word)
    }
}

impl<B: PecBus + ?Sized> PecBus for Box<B> {
    fn pec(&self) -> Option<Integrity> {
        (**self).pec()
    }

    fn set_pec(&mut self, on: bool) -> Result<(), BusError> {
        (**self).set_pec(on)
    }
}

/// What went well and what did not on a device, since start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Words read and accepted.
    pub reads: u64,
    /// Transfers tried again after a failure.
    pub retries: u64,
    /// Transfers without an acknowledge.
    pub no_answer: u64,
    /// Words whose packet error code did not match.
    pub bad_pec: u64,
    /// Transfers that timed out on a held bus.
    pub held: u64,
    /// Other transfer errors.
    pub other: u64,
    /// Words with the sensor's error bit set.
    pub error_flag: u64,
    /// Conversions at the end of the range, or impossible.
    pub out_of_range: u64,
    /// Conversions not ready in time.
    pub not_ready: u64,
    /// Times the device was opened again.
    pub reopened: u64,
    /// Times the device was power-cycled.
    pub power_cycles: u64,
}

impl Counters {
    /// Each count with the name that D-Bus and reports give it.
    pub const fn named(&self) -> [(&'static str, u64); 11] {
        [
            ("reads", self.reads),
            ("retries", self.retries),
            ("no-answer", self.no_answer),
            ("bad-pec", self.bad_pec),
            ("held", self.held),
            ("other", self.other),
            ("error-flag", self.error_flag),
            ("out-of-range", self.out_of_range),
            ("not-ready", self.not_ready),
            ("reopened", self.reopened),
            ("power-cycles", self.power_cycles),
        ]
    }

    /// Counts one failed transfer or rejected word.
    pub fn failed(&mut self, why: Missing) {
        let counter = match why {
            Missing::NoAnswer => &mut self.no_answer,
            Missing::BadPec => &mut self.bad_pec,
            Missing::BusHeld => &mut self.held,
            Missing::ErrorFlag => &mut self.error_flag,
            Missing::Saturated | Missing::Impossible => &mut self.out_of_range,
            Missing::NotReady => &mut self.not_ready,
            Missing::BusError | Missing::Claimed | Missing::BusGone | Missing::BusInUse | Missing::Denied => {
                &mut self.other
            }
            Missing::NotYet | Missing::PoweredOff | Missing::Empty => return,
        };
        *counter += 1;
    }
}
