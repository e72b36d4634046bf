//! Recordings: CSV, one header line, a row for each frame.
//!
//! - [`mod@format`]: what the columns are called and what they mean.
//! - `number`: decimal numbers to and from text, fast and without allocation.
//! - `lines`: lines of bounded length.
//! - `open`: a recording up to its header; `error`: why it cannot be read.
//! - `reader`: frames out of it; `order`: which rows are taken, by their times; `tally`: what could not be used of it.
//! - `estimates`: what `replay` writes, read again.
//! - `writer`: frames into one.
//! - `tap`: frames as they come, for whoever records them.

mod error;
mod estimates;
pub mod format;
mod lines;
mod number;
mod open;
mod order;
mod reader;
mod tally;
mod tap;
mod writer;

pub use error::ReadError;
pub use estimates::{EstimateRow, Estimates};
pub use lines::MAX_LINE;
pub use number::{push_digits, push_fixed};
pub use open::Recording;
pub use reader::{Reader, Reference};
pub use tally::{RowFault, Tally};
pub use tap::Taps;
pub use writer::Writer;
