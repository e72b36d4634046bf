//! Faults: one vocabulary everywhere (D-Bus, recording, STATUSTEXT, status).
//!
//! - [`vocabulary`]: the kinds, an active fault, its evidence.

mod vocabulary;

pub use vocabulary::{ActiveFault, Evidence, FaultKind, FaultName};
