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
//! | [`estimator`], [`fault`] | the pure core: no clock, file, socket or thread |
//! | [`bus`], [`source`] | the shell inwards: SMBus words, sources of frames |
//! | [`config`] | what the daemon is told, validated |
//! | [`sensor`] | chips: MLX90614, ADS1115 |
//! | [`gpio`] | lines: data-ready edges, power switch, fault lamp |
//! | [`recording`] | CSV recordings, live frames for whoever records |
//! | [`ctl`] | the command that asks |
//! | [`state`], [`clock`] | the one shared state, the one clock |
#![deny(unsafe_code)]

pub mod attitude;
pub mod bus;
pub mod clock;
pub mod config;
pub mod ctl;
pub mod direction;
pub mod estimator;
pub mod fault;
pub mod frame;
pub mod gpio;
pub mod head;
pub mod recording;
pub mod sensor;
pub mod source;
pub mod state;
pub mod time;
