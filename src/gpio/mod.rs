//! GPIO lines: data-ready edges in, power switch and fault lamp out.
//!
//! - `error`: what can go wrong with a line.
//! - [`lines`]: a chip by its label, name or path; a line on it.
//! - [`edge`]: data-ready as falling edges that the kernel queues.
//! - [`output`]: a line that is switched.
//! - [`pin`]: the same two traits over any embedded-hal pin.
//! - [`lamp`]: what the fault lamp shows.

pub mod edge;
mod error;
pub mod lamp;
pub mod lines;
pub mod output;
pub mod pin;

pub use error::GpioError;

use std::time::Duration;

/// Something that is switched on and off.
pub trait Switch: Send {
    /// Switches it on or off.
    fn set(&mut self, on: bool) -> Result<(), GpioError>;
}

/// A signal that a conversion has ended.
pub trait DataReady: Send {
    /// Waits for the signal, at most `timeout`; `false` when it did not come. One that came since
    /// [`clear`](Self::clear) counts.
    fn wait(&mut self, timeout: Duration) -> Result<bool, GpioError>;

    /// Forgets the signals that have come.
    fn clear(&mut self);
}
