//! Recordings: CSV, one header line, a row for each frame.
//!
//! - [`format`]: what the columns are called and what they mean.
//! - [`number`]: decimal numbers to and from text, fast and without allocation.
//! - [`lines`]: lines of bounded length.
//! - [`reader`]: frames out of a recording; [`tally`]: what could not be used of it.
//! - [`writer`]: frames into one.
//! - [`tap`]: frames as they come, for whoever records them.

pub mod format;
mod lines;
mod number;
mod reader;
mod tally;
mod tap;
mod writer;

pub use lines::MAX_LINE;
pub use number::{push_digits, push_fixed};
pub use reader::{ReadError, Reader, Recording, Reference};
pub use tally::{RowFault, Tally};
pub use tap::Taps;
pub use writer::Writer;
