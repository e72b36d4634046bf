//! ADS1115: a 16-bit ADC with four pins and a multiplexer, for amplified thermopile pairs.
//!
//! - [`registers`]: bits and units.
//! - [`driver`]: set up, start, ask, read.
//! - [`timing`]: how long conversions take.
//! - [`ready`]: the ALERT/RDY line, heard or silent.
//! - [`setup`]: from configuration to a chip's plan.
//! - [`converter`]: from a start to a result that is believed.
//! - [`chip`]: one chip with its pairs, as the hardware source walks over it.
//!
//! Source: Texas Instruments SBAS444. The chip knows no packet error code; instead every reading
//! is confirmed by reading back the settings it was made with.

pub mod chip;
pub mod converter;
pub mod driver;
pub mod ready;
pub mod registers;
pub mod setup;
pub mod timing;

#[cfg(test)]
mod fake;
#[cfg(test)]
mod tests;
pub use chip::{Ads1115Chip, OpenBus, OpenLine};
pub use setup::{Plan, SetupError};
