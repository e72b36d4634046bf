//! A made-up flight under a made-up sky, in place of the hardware.
//!
//! - [`noise`]: a generator of its own, so that the same seed gives the same bytes everywhere.
//! - [`flight`]: attitude against time, by a script; [`aerobatics`]: scripts over the top.
//! - [`trajectory`]: a flight with heading, speed and rates; [`aircraft`]: what flies it;
//!   [`manoeuvre`]: what its pilot does; [`turbulence`]: what the air does.
//! - [`scene`]: what is seen of a world that differs all around; [`feature`], [`ground`]: what makes
//!   it differ, [`straight`] what runs past; [`bundle`]: a field of view as rays; [`orientation`]: the airframe's axes in the world.
//! - [`head`]: what each sensor shows, with lag, noise and quantisation.
//! - [`instruments`]: what the gyro, the GPS and the airspeed sensor say.
//! - [`script`]: weather that changes and sensors that fail, played at given times.
//! - [`fault`]: what goes wrong on purpose, by its name.
//! - [`source`]: all of it as a source of frames.
//! - [`scenario`]: flights and scenes with names.

pub mod aerobatics;
pub mod aircraft;
pub mod bundle;
pub mod fault;
pub mod feature;
pub mod flight;
pub mod ground;
pub mod head;
pub mod instruments;
pub mod manoeuvre;
pub mod noise;
pub mod orientation;
pub mod scenario;
pub mod scene;
pub mod script;
pub mod source;
pub mod straight;
pub mod trajectory;
pub mod turbulence;

pub use fault::{Fault, FaultError};
pub use flight::{Flight, Waypoint};
pub use scenario::Scenario;
pub use script::{Outage, Weather};
pub use source::SimulatedSource;
