//! Attitude from the infrared horizon.
//!
//! One way through the house, every dependency pointing inward:
//!
//! ```text
//! bus ─► sensor ─► Frame ─► estimator ─► Estimate ─► publishers: mavlink · dbus · recording · log
//!  simulation, replay ─► Frame   └─► fault ──┘
//! ```
//!
//! | module | what it is |
//! |---|---|
//! | [`time`], [`direction`], [`frame`], [`attitude`], [`head`] | the nouns: instants, where sensors look, a scan, what is said of it |
//! | [`sky`], [`estimator`], [`fault`], [`horizon`] | the pure core: no clock, file, socket or thread |
//! | [`bus`], [`gpio`], [`sensor`] | the hardware: SMBus words, lines, chips |
//! | [`simulation`], [`recording`] | the other two sources of frames, and where frames are kept |
//! | [`source`], [`state`], [`clock`] | the trait of the three sources, the one shared state, the one clock |
//! | [`mavlink`], [`dbus`] | the publishers |
//! | [`plot`] | drawings of a flight and of the sky |
//! | [`config`] | what the daemon is told, validated |
//! | [`daemon`], [`ctl`] | the two commands |
#![deny(unsafe_code, clippy::unwrap_used)]

pub mod aiding;
pub mod attitude;
pub mod bus;
pub mod clock;
pub mod config;
pub mod ctl;
pub mod daemon;
pub mod dbus;
pub mod direction;
pub mod estimator;
pub mod fault;
pub mod frame;
pub mod gpio;
pub mod head;
pub mod horizon;
pub mod mavlink;
pub mod plot;
pub mod recording;
pub mod save;
pub mod sensor;
pub mod simulation;
pub mod sky;
pub mod source;
pub mod state;
pub mod time;
