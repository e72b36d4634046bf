//! Why an address was not changed, with the next step.

use crate::sensor::mlx90614::eeprom::EepromError;
use std::io;
use std::path::PathBuf;
use thiserror::Error;

/// Why an address was not changed.
#[derive(Debug, Error)]
pub enum SetAddressError {
    /// The bus fails.
    #[error("{0}")]
    Bus(String),
    /// There is no sensor.
    #[error("no MLX90614 answers on {}; is it wired and powered? Look with: i2cdetect -l, then -y and the bus's number", .0.display())]
    Nobody(PathBuf),
    /// There are several.
    #[error(
        "{} MLX90614 answer on {} (at {}): leave one only on the bus, so that it is sure which one is changed",
        .addresses.len(), .bus.display(), hex(.addresses)
    )]
    Several {
        /// The bus.
        bus: PathBuf,
        /// Where they answer.
        addresses: Vec<u8>,
    },
    /// Its words do not arrive whole.
    #[error(
        "what is read at {0:#04x} does not match its PEC: are two sensors there with one address, or wires too long? \
         Leave one sensor only. For a part that is known to send a wrong PEC: --no-read-pec"
    )]
    Damaged(u8),
    /// Somebody else has that address.
    #[error("{0:#04x} is taken by another chip on this bus: choose another one")]
    Taken(u8),
    /// The cell was not written.
    #[error("{0}")]
    Eeprom(EepromError),
    /// The user does not want it.
    #[error("nothing was written; answer y, or give --yes")]
    Declined,
    /// The user could not be asked.
    #[error("nobody can be asked; give --yes")]
    Ask(#[source] io::Error),
    /// It does not answer at its new address.
    #[error(
        "nobody answers at {0:#04x} yet: was its own supply off? Take it off for a second, and look with set-address again"
    )]
    NotBack(u8),
}

fn hex(addresses: &[u8]) -> String {
    addresses.iter().map(|a| format!("{a:#04x}")).collect::<Vec<_>>().join(", ")
}
