//! Configuration in three steps: raw files, merged with their drop-ins, validated.
//!
//! - [`settings`]: what comes out at the end, every value in range.

pub mod settings;

pub use settings::Settings;
