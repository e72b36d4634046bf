//! SMBus words through `/dev/i2c-N`: one descriptor a chip, SMBus requests only, so that every
//! adapter serves, `i2c-stub` included.

use super::adapter::{Functions, prepare};
use super::hold::Hold;
use super::{BusError, PecBus, WordBus};
use crate::source::Integrity;
use i2cdev::core::I2CDevice;
use i2cdev::linux::{LinuxI2CDevice, LinuxI2CError};
use rustix::io::Errno;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The longest that one transfer may take. SMBus devices let go of the clock after 25 to 35 ms
/// (SMBus specification, T_TIMEOUT).
const TRANSFER_LIMIT: Duration = Duration::from_millis(30);

/// One chip on a Linux I²C adapter.
#[derive(Debug)]
pub struct LinuxBus {
    device: LinuxI2CDevice,
    path: PathBuf,
    functions: Functions,
    _hold: Hold,
}

impl LinuxBus {
    /// Opens `bus` (`/dev/i2c-N`) for the chip at `address`, without PEC. Fails with
    /// [`BusError::Claimed`] when a kernel driver holds the address, with [`BusError::InUse`] when another program has
    /// opened the bus so, and with [`BusError::Other`]`(EOPNOTSUPP)` when the adapter transfers no SMBus words.
    pub fn open(bus: &Path, address: u8) -> Result<Self, BusError> {
        let functions = Self::functions_of(bus)?;
        let device = LinuxI2CDevice::new(bus, u16::from(address)).map_err(|e| opening(errno(&e)))?;
        if !functions.words() {
            return Err(BusError::Other(Errno::OPNOTSUPP.raw_os_error()));
        }
        Ok(Self { device, path: bus.to_owned(), functions, _hold: Hold::take(bus)? })
    }

    /// What the adapter can do.
    pub fn functions(&self) -> Functions {
        self.functions
    }

    /// What the adapter behind `bus` can do; limits its patience on the way.
    pub fn functions_of(bus: &Path) -> Result<Functions, BusError> {
        prepare(bus, TRANSFER_LIMIT).map_err(|e| opening(e.raw_os_error().unwrap_or(0)))
    }

    fn transfer_error(&self, error: &LinuxI2CError) -> BusError {
        transfer(errno(error), || self.path.exists())
    }
}

impl WordBus for LinuxBus {
    fn read_word(&mut self, command: u8) -> Result<u16, BusError> {
        self.device.smbus_read_word_data(command).map_err(|e| self.transfer_error(&e))
    }

    fn write_word(&mut self, command: u8, word: u16) -> Result<(), BusError> {
        self.device.smbus_write_word_data(command, word).map_err(|e| self.transfer_error(&e))
    }
}

impl PecBus for LinuxBus {
    fn pec(&self) -> Option<Integrity> {
        self.functions.pec().then_some(Integrity::Pec)
    }

    fn set_pec(&mut self, on: bool) -> Result<(), BusError> {
        self.device.set_smbus_pec(on && self.functions.pec()).map_err(|e| self.transfer_error(&e))
    }
}

fn errno(error: &LinuxI2CError) -> i32 {
    match error {
        LinuxI2CError::Errno(errno) => *errno,
        LinuxI2CError::Io(e) => e.raw_os_error().unwrap_or(0),
    }
}

/// What an errno means while the device file is opened and given its address.
fn opening(errno: i32) -> BusError {
    match Errno::from_raw_os_error(errno) {
        Errno::NOENT | Errno::NXIO | Errno::NODEV => BusError::Gone,
        Errno::ACCESS | Errno::PERM => BusError::Denied,
        Errno::BUSY => BusError::Claimed,
        _ => BusError::Other(errno),
    }
}

/// What an errno means after a transfer (kernel documentation, `i2c/fault-codes`). `node_exists`
/// is asked where the errno alone does not tell a silent chip from an adapter that went away.
fn transfer(errno: i32, node_exists: impl FnOnce() -> bool) -> BusError {
    match Errno::from_raw_os_error(errno) {
        Errno::NXIO | Errno::REMOTEIO => BusError::NoAnswer,
        Errno::BADMSG => BusError::Pec,
        Errno::TIMEDOUT | Errno::BUSY => BusError::Held,
        Errno::SHUTDOWN => BusError::Gone,
        _ if !node_exists() => BusError::Gone,
        Errno::NODEV => BusError::NoAnswer,
        _ => BusError::Other(errno),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_errno_of_a_transfer_has_its_meaning() {
        // asm-generic/errno-base.h and errno.h
        for (number, there, gone) in [
            (6, BusError::NoAnswer, BusError::NoAnswer),
            (121, BusError::NoAnswer, BusError::NoAnswer),
            (19, BusError::NoAnswer, BusError::Gone),
            (74, BusError::Pec, BusError::Pec),
            (110, BusError::Held, BusError::Held),
            (16, BusError::Held, BusError::Held),
            (108, BusError::Gone, BusError::Gone),
            (5, BusError::Other(5), BusError::Gone),
            (11, BusError::Other(11), BusError::Gone),
        ] {
            assert_eq!(transfer(number, || true), there, "errno {number}");
            assert_eq!(transfer(number, || false), gone, "errno {number}, node gone");
        }
    }

    #[test]
    fn every_errno_of_opening_has_its_meaning() {
        for (number, meaning) in [
            (2, BusError::Gone),
            (6, BusError::Gone),
            (19, BusError::Gone),
            (13, BusError::Denied),
            (1, BusError::Denied),
            (16, BusError::Claimed),
            (25, BusError::Other(25)),
        ] {
            assert_eq!(opening(number), meaning, "errno {number}");
        }
    }

    #[test]
    fn a_bus_that_is_not_there_is_gone_and_a_file_is_no_bus() {
        assert_eq!(LinuxBus::open(Path::new("/dev/i2c-none"), 0x5A).err(), Some(BusError::Gone));
        assert_eq!(LinuxBus::open(Path::new("/dev/null"), 0x5A).err(), Some(BusError::Other(25)));
    }
}
