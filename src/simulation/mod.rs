//! A made-up flight under a made-up sky, in place of the hardware.
//!
//! - [`noise`]: a generator of its own, so that the same seed gives the same bytes everywhere.
//! - [`flight`]: attitude against time.
//! - [`head`]: what each sensor shows, with lag, noise and quantisation.
//! - [`script`]: weather that changes and sensors that fail, played at given times.
//! - [`source`]: all of it as a source of frames.

pub mod flight;
pub mod head;
pub mod noise;
pub mod script;
pub mod source;

pub use flight::{Flight, Waypoint};
pub use script::{Outage, Weather};
pub use source::SimulatedSource;
