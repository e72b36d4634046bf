//! Thermopiles in, attitude out: the daemon on a kernel's buses.
//!
//! `tests/kernel/run` runs this in the virtual machine; a plain `cargo test` does not.
//!
//! - [`rig`], [`adapter`]: the daemon, and the modules, buses and lines under it;
//! - [`sky`]: what sensors see, and what the report's scheme must make of it;
//! - [`mlx`], [`adc`]: sensors that the test moves;
//! - [`hardware`], [`lines`]: the source of frames and GPIO lines by themselves;
//! - [`faults`]: what goes wrong on a bus, how soon it is told and over;
//! - [`names`]: what goes wrong in flight, by which name D-Bus and MAVLink tell it; [`turning`]: the flight,
//!   [`radio`]: who listens to MAVLink;
//! - [`setup`]: doctor and set-address on a kernel's bus;
//! - [`flight`], [`attitude`]: attitudes flown through; `check.py` is the listener's side of it.

mod adapter;
mod adc;
mod attitude;
#[path = "../dbus_bus/mod.rs"]
mod dbus_bus;
mod faults;
mod flight;
mod hardware;
mod lines;
mod mlx;
mod names;
mod radio;
mod rig;
mod setup;
mod sky;
#[path = "../stalls/mod.rs"]
mod stalls;
mod turning;
