//! `irhorizonctl`: asks the daemon questions over D-Bus, works on recordings without it.
//!
//! - [`client`]: the daemon asked over D-Bus; `answer`: its answers read;
//! - [`view`]: what the daemon says, as a client sees it; `status --format json` is this type.
//! - [`cli`]: the words of the command line; [`run`] does what they say.
//! - [`kit`]: what the commands are given: the daemon, the configuration, the pipeline.
//! - [`error`]: what goes wrong, and the exit codes.
//! - [`status`], [`prometheus`], [`sensors`]: the state as text; [`advice`]: what to do about a fault.
//! - [`watch`]: the live horizon.
//! - [`setup_args`]: the words of the commands that set a head up and look after it.
//! - [`doctor`]: what is wrong with an installation, and the next step.
//! - [`set_address`]: another address for an MLX90614; [`in_use`]: whether a daemon reads the bus.
//! - [`calibrate`]: trims, neutral voltages and offsets measured; [`save`](crate::save): files that no power cut leaves torn.
//! - [`wait`]: until attitude is given.
//! - [`trim`]: the head's trim as configuration.
//! - [`simulate`]: recordings of flights that never were.
//! - [`record`], [`replay`]: recordings out of the daemon, and through its pipeline.
//! - [`recording_args`], [`opening`]: the words of the commands on recordings, and what they share.
//! - [`score`]: methods side by side against a reference; [`plot`]: drawings.
//! - `name`: a name for a recording that was given none; `signals`: a polite end on request.

pub mod advice;
mod answer;
pub mod calibrate;
pub mod cli;
pub mod client;
pub mod doctor;
pub mod error;
pub mod in_use;
pub mod kit;
mod name;
pub mod opening;
pub mod plot;
pub mod prometheus;
pub mod record;
pub mod recording_args;
pub mod replay;
mod run;
pub mod score;
pub mod sensors;
pub mod set_address;
pub mod setup_args;
mod signals;
pub mod simulate;
pub mod status;
pub mod trim;
pub mod view;
pub mod wait;
pub mod watch;

pub use run::{main, run};
