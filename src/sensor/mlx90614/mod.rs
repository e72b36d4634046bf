//! The MLX90614, a digital thermopile on SMBus (Melexis datasheet 3901090614).
//!
//! - [`registers`]: addresses, conversions, the configuration register and its settling times.
//! - [`driver`]: the chip over any word bus.
//! - [`eeprom`]: changing its address and configuration, guarded.
//! - [`chip`]: the chip as the hardware source walks over it.

pub mod chip;
pub mod driver;
pub mod eeprom;
pub mod registers;

pub use chip::Mlx90614Chip;
pub use driver::{Mlx90614, Object};
