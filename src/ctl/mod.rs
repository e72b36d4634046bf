//! `irhorizonctl`: asks the daemon questions over D-Bus, works on recordings without it.
//!
//! - [`client`]: the daemon asked over D-Bus; `answer`: its answers read;
//! - [`view`]: what the daemon says, as a client sees it; `status --format json` is this type.

mod answer;
pub mod client;
pub mod view;
