//! Faults: one vocabulary everywhere (D-Bus, recording, STATUSTEXT, status).
//!
//! - `vocabulary`: the kinds, an active fault, its evidence;
//! - [`debounce`]: hysteresis in time;
//! - [`contrast`]: `low-contrast`, `inverted-contrast`;
//! - [`sensors`]: `sensor-lost`, `sensor-saturated`, `bus-down`, `stale`.

pub mod contrast;
pub mod debounce;
pub mod sensors;
mod vocabulary;

pub use vocabulary::{ActiveFault, Evidence, FaultKind, FaultName};
