//! What an adapter can do, and how long it may take: the two requests of `i2c-dev` that no safe
//! crate has. The only unsafe code of this crate.

use rustix::io::Errno;
use rustix::ioctl::{Getter, IntegerSetter, ioctl};
use std::ffi::c_ulong;
use std::fmt;
use std::fs::OpenOptions;
use std::os::fd::AsFd;
use std::path::Path;
use std::time::Duration;

const I2C_TIMEOUT: u32 = 0x0702;
const I2C_FUNCS: u32 = 0x0705;

/// The functionality word of an adapter (`linux/i2c.h`, `I2C_FUNC_*`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Functions(pub u64);

impl Functions {
    /// Whether it transfers SMBus words both ways.
    pub const fn words(self) -> bool {
        const READ_AND_WRITE_WORD_DATA: u64 = 0x0060_0000;
        self.0 & READ_AND_WRITE_WORD_DATA == READ_AND_WRITE_WORD_DATA
    }

    /// Whether it checks and appends the packet error code.
    pub const fn pec(self) -> bool {
        self.0 & 0x0000_0008 != 0
    }

    /// Whether it does plain and combined I²C transfers (`I2C_RDWR`).
    pub const fn combined(self) -> bool {
        self.0 & 0x0000_0001 != 0
    }

    /// Asks the adapter behind an open `/dev/i2c-N`.
    fn ask(device: impl AsFd) -> Result<Self, Errno> {
        // SAFETY: I2C_FUNCS writes one unsigned long through its argument (`i2c-dev.c`).
        #[allow(unsafe_code)]
        let functions = unsafe { ioctl(device, Getter::<I2C_FUNCS, c_ulong>::new()) }?;
        #[allow(clippy::useless_conversion)] // c_ulong has 32 bits on 32-bit machines
        Ok(Self(u64::from(functions)))
    }
}

impl fmt::Display for Functions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let words = if self.words() { "SMBus words" } else { "no SMBus words" };
        let pec = if self.pec() { "PEC" } else { "no PEC" };
        let combined = if self.combined() { ", combined transfers" } else { "" };
        write!(f, "{words}, {pec}{combined} (functionality {:#010x})", self.0)
    }
}

/// Opens `/dev/i2c-N`, asks what it can do, makes it give up a transfer after `limit`, closes it.
pub fn prepare(bus: &Path, limit: Duration) -> std::io::Result<Functions> {
    let device = OpenOptions::new().read(true).write(true).open(bus)?;
    let functions = Functions::ask(&device)?;
    // An adapter that refuses keeps its own limit.
    let _ = limit_transfer_time(&device, limit);
    Ok(functions)
}

/// Limits how long the adapter waits for one transfer, in steps of 10 ms. It holds for the adapter
/// and so for its other users too; the kernel's own default is often a second, in which a held bus
/// would stop every other bus of this process.
fn limit_transfer_time(device: impl AsFd, limit: Duration) -> Result<(), Errno> {
    let tens = usize::try_from(limit.as_millis() / 10).unwrap_or(1).clamp(1, 100);
    // SAFETY: I2C_TIMEOUT takes an integer from 0 to INT_MAX by value (`i2c-dev.c`).
    #[allow(unsafe_code)]
    unsafe {
        ioctl(device, IntegerSetter::<I2C_TIMEOUT>::new_usize(tens))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_as_i2c_dev_names_them() {
        let stub = Functions(0x0c7f_0000);
        assert!(stub.words() && !stub.pec() && !stub.combined());
        let emulated = Functions(0x0eff_0009);
        assert!(emulated.words() && emulated.pec() && emulated.combined());
        assert!(!Functions(0x0020_0000).words(), "reading words is not writing them");
        assert_eq!(stub.to_string(), "SMBus words, no PEC (functionality 0x0c7f0000)");
    }

    #[test]
    fn what_is_no_adapter_has_no_functions() {
        assert!(prepare(Path::new("/dev/null"), Duration::from_millis(30)).is_err());
        let null = OpenOptions::new().write(true).open("/dev/null").unwrap();
        assert!(limit_transfer_time(&null, Duration::from_millis(30)).is_err());
    }
}
