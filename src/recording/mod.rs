//! Recordings: CSV, one header line, a row for each frame.
//!
//! - [`tap`]: frames as they come, for whoever records them.

mod tap;

pub use tap::Taps;
