//! Whether the daemon goes by what was saved: it may read another configuration. The header of its stream of frames says
//! what it runs with.

use super::LOOK_S;
use super::error::CalibrateError;
use crate::config::Settings;
use crate::ctl::error::CtlError;
use crate::ctl::kit::{Daemon, Kit};
use crate::ctl::record::{MAX_PACKET, frames, receive};
use crate::recording::Recording;
use std::path::Path;
use std::time::Duration;

/// So many looks before it is believed that the daemon goes by something else.
const LOOKS: usize = 10;
/// How long the header may take; it is sent before the stream is handed over.
const HEADER_LIMIT: Duration = Duration::from_secs(1);

/// Whether the daemon runs with the trims and the sensors of `config`.
pub(super) fn check(daemon: &mut dyn Daemon, config: &Path, kit: &Kit) -> Result<(), CtlError> {
    let saved = (kit.load)(config).map_err(CtlError::Config)?.settings;
    for _ in 0..LOOKS {
        if held(daemon, kit)?.is_some_and(|held| agree(&held, &saved)) {
            return Ok(());
        }
        (kit.pause)(Duration::from_secs_f64(LOOK_S));
    }
    Err(CalibrateError::OtherConfiguration(config.to_owned()).into())
}

/// Of all that `calibrate` measures.
fn agree(a: &Settings, b: &Settings) -> bool {
    let trim = |s: &Settings| (s.head.roll_trim_deg, s.head.pitch_trim_deg);
    trim(a) == trim(b) && a.sensors == b.sensors
}

/// What the daemon runs with, where it says so.
fn held(daemon: &mut dyn Daemon, kit: &Kit) -> Result<Option<Settings>, CtlError> {
    let frames = frames(daemon)?;
    let mut packet = vec![0; MAX_PACKET];
    let length = receive(&frames, &mut packet, HEADER_LIMIT).map_err(|source| CtlError::Stream { rows: 0, source })?;
    let header = &packet[..length.unwrap_or(0)];
    let recording = Recording::new(header, "the daemon's stream of frames".to_owned())?;
    recording.config().map(kit.parse).transpose().map_err(CtlError::Config)
}
