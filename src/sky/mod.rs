//! What a thermopile sees of a warm ground and a cold sky. Pure: tables made once, then looked up.
//!
//! - [`profile`]: the sky's temperature against elevation.
//! - [`family`]: one table for all skies of a family, whose shape is then estimated.
//! - [`field_of_view`]: how a sensor weighs what lies about its axis.
//! - [`response`]: both together: a sensor and a pair against the elevation of their axis, and back.
//!
//! Elevations are handed over as their sine wherever they come from an attitude: the sine of the
//! elevation of direction `b` is `b·u`, `u` the upward vertical.

pub mod family;
pub mod field_of_view;
pub mod profile;
pub mod response;

pub use family::Family;
pub use field_of_view::FieldOfView;
pub use profile::{Shape, Sky};
pub use response::{Averaging, PairCurve, Response};
