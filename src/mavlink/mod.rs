//! Attitude, heartbeat and faults as MAVLink 2 messages.
//!
//! - [`messages`]: what an estimate is in MAVLink's terms; pure.
//! - [`session`]: which messages are due when; pure.
//! - [`decimator`]: a slower stream out of a faster one; pure.
//! - [`encode`]: messages as bytes, numbered.
//! - [`deframe`]: whole messages out of bytes, whatever is between them; pure.
//! - [`heard`]: those of them that are heeded; pure.
//! - [`pace`]: not too often; pure.
//! - [`service`]: what is answered to commands and parameter requests; pure.
//! - [`signing`]: messages signed, and those that arrive checked.
//! - [`identity`]: which autopilot is listened to, whose system this is a part of; pure.
//! - [`aiding`]: what that autopilot says of rates and speeds, on its way to the frames.
//! - [`trouble`]: what can go wrong with an endpoint, in words.
//! - [`endpoint`]: the sockets and ttys, with their statistics.
//! - [`tlog`]: what went out and came in, in a file.
//! - [`station`]: what is heeded, and in whose name messages go out; [`signer`]: the key with its file.
//! - [`link`]: an endpoint with its stream, and with those who ask there.
//! - [`publisher`]: the thread that ties them to the shared state; [`switchboard`]: between it and the daemon.

pub mod aiding;
pub mod decimator;
pub mod deframe;
pub mod encode;
pub mod endpoint;
pub mod heard;
pub mod identity;
pub mod link;
pub mod messages;
pub mod pace;
pub mod publisher;
pub mod service;
pub mod session;
pub mod signer;
pub mod signing;
pub mod station;
pub mod switchboard;
pub mod tlog;
pub mod trouble;
