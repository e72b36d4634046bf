//! Faults: one vocabulary everywhere (D-Bus, recording, STATUSTEXT, status).
//!
//! - `vocabulary`: the kinds, an active fault, its evidence;
//! - [`detectors`]: all detectors together;
//! - [`low_contrast`]: `low-contrast`; [`noise`]: the noise that its limit follows from;
//! - [`inverted`]: ground and sky exchanged, `inverted-contrast`;
//! - [`wet`]: `wet-sensor`; [`stuck`]: `sensor-stuck`;
//! - [`obstructed`]: a scene that is no horizon, `obstructed`; [`disagree`]: `roll-disagrees`, `pitch-disagrees`;
//! - [`wired`]: the same two, of a head that is wired otherwise than configured;
//! - [`erratic`]: readings that jump as no scene does are none;
//! - [`sensors`]: `sensor-lost`, `sensor-saturated`, `bus-down`, `stale`;
//! - [`debounce`]: hysteresis in time.

pub mod debounce;
pub mod detectors;
pub mod disagree;
pub mod erratic;
pub mod inverted;
#[cfg(test)]
mod kit;
pub mod low_contrast;
pub mod noise;
pub mod obstructed;
pub mod sensors;
pub mod stuck;
mod vocabulary;
pub mod wet;
pub mod wired;

pub use detectors::Detectors;
pub use vocabulary::{ActiveFault, Evidence, FaultKind, FaultName};
