//! What the autopilot says of rates, speeds and itself, out of its messages.
//!
//! - [`clock`]: its clock beside ours; [`timesync`]: asking it for its time; pure;
//! - [`decode`]: values out of messages; pure;
//! - [`sense`]: in which units and directions body rates are said; pure;
//! - [`climb`]: which way is up in its climb; pure;
//! - [`choice`]: one source of body rates at a time; [`meter`]: how often something comes; pure;
//! - [`intervals`]: asking for what it does not send by itself; pure;
//! - [`listener`]: all of it together, into the [`Inbox`](crate::aiding::Inbox).

pub mod choice;
pub mod climb;
pub mod clock;
pub mod decode;
pub mod intervals;
pub mod listener;
pub mod meter;
pub mod sense;
pub mod timesync;

pub use listener::{Ask, Listener};
