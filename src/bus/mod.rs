//! SMBus words, the only way in and out of the sensors.
//!
//! - [`error`]: what can go wrong with a transfer.
//!
//! A driver is written over a [`WordBus`]: one chip at its address, words low byte first.

mod error;

pub use error::BusError;

/// One chip on a bus: SMBus Read Word and Write Word, low byte first.
pub trait WordBus: Send {
    /// Reads the word behind `command`.
    fn read_word(&mut self, command: u8) -> Result<u16, BusError>;

    /// Writes `word` behind `command`.
    fn write_word(&mut self, command: u8, word: u16) -> Result<(), BusError>;
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
