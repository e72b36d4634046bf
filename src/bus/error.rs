//! What can go wrong with a transfer, by what the user can do about it.

use crate::frame::Missing;
use std::fmt;

/// Why a transfer failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BusError {
    /// No acknowledge at the address (ENXIO on virtual adapters, EREMOTEIO on bcm2835, ENODEV on
    /// `i2c-stub` while the adapter is still there).
    NoAnswer,
    /// The packet error code did not match (EBADMSG).
    Pec,
    /// The bus is held; the transfer timed out (ETIMEDOUT).
    Held,
    /// A kernel driver has claimed the address (EBUSY).
    Claimed,
    /// The adapter is not there, or went away.
    Gone,
    /// Another program of this project holds the bus.
    InUse,
    /// The device file may not be opened (EACCES, EPERM).
    Denied,
    /// Anything else, with its errno (0 when there is none).
    Other(i32),
}

impl BusError {
    /// The reason as a frame carries it.
    pub const fn missing(self) -> Missing {
        match self {
            Self::NoAnswer => Missing::NoAnswer,
            Self::Pec => Missing::BadPec,
            Self::Held => Missing::BusHeld,
            Self::Claimed => Missing::Claimed,
            Self::Gone => Missing::BusGone,
            Self::InUse => Missing::BusInUse,
            Self::Denied => Missing::Denied,
            Self::Other(_) => Missing::BusError,
        }
    }
}

impl fmt::Display for BusError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Other(errno) if *errno != 0 => {
                write!(f, "bus error: {}", std::io::Error::from_raw_os_error(*errno))
            }
            other => other.missing().fmt(f),
        }
    }
}

impl std::error::Error for BusError {}
