//! The signing key with its file and clock: what signs and checks, and what is done while it cannot.

use super::deframe::Packet;
use super::encode::Encoder;
use super::messages::Message;
use super::pace::Pace;
use super::signing::{Key, Signing, Store, timestamp};
use crate::config::kept;
use crate::config::settings::MavlinkSettings;
use crate::time::Time;
use std::path::Path;
use std::time::{Duration, SystemTime};

/// Between two lines of the log on messages that are refused.
const TELL: Duration = Duration::from_secs(10);

/// What signs.
pub struct Signer {
    /// `None` while there is no key to be had: then nothing is sent, and nothing heeded.
    with: Option<(Signing, Store)>,
    told: Pace,
    failed: bool,
}

impl Signer {
    /// The signer that the configuration wants, if any.
    pub fn wanted(settings: &MavlinkSettings) -> Option<Self> {
        let path = settings.signing_key.as_deref()?;
        let with = open(path).inspect_err(|e| log::error!("MAVLink is silent: {e}")).ok();
        Some(Self { with, told: Pace::new(TELL, 0), failed: false })
    }

    /// The signed frame of a message on link number `index`; empty without a key.
    pub fn encode<'a>(&mut self, encoder: &'a mut Encoder, message: &Message, index: usize) -> &'a [u8] {
        let link = u8::try_from(index).unwrap_or(u8::MAX);
        match &mut self.with {
            Some((signing, _)) => encoder.encode_signed(message, signing, link, wall()),
            None => &[],
        }
    }

    /// Whether a message is signed well.
    pub fn admits(&mut self, now: Time, packet: &Packet<'_>) -> bool {
        let Some((signing, _)) = &mut self.with else { return false };
        match signing.check(packet, wall()) {
            Ok(()) => true,
            Err(why) => {
                if self.told.free_at() <= now {
                    self.told.take(now);
                    let (system, component) = (packet.system_id, packet.component_id);
                    log::warn!("MAVLink: message {} of {system}/{component} is refused: {why}", packet.id);
                }
                false
            }
        }
    }

    /// Keeps the timestamp ahead of what is used.
    pub fn tend(&mut self) {
        let Some((signing, store)) = &mut self.with else { return };
        match store.keep(signing.sent()) {
            Ok(()) => self.failed = false,
            Err(e) if !self.failed => {
                log::error!("MAVLink: {e}");
                self.failed = true;
            }
            Err(_) => {}
        }
    }

    /// Nothing more will be signed.
    pub fn finish(self) {
        if let Some((signing, store)) = self.with
            && let Err(e) = store.finish(signing.sent())
        {
            log::error!("MAVLink: {e}");
        }
    }
}

fn open(path: &Path) -> Result<(Signing, Store), String> {
    let key = Key::load(path).map_err(|e| e.to_string())?;
    let folder = kept::folder(path);
    let (mut store, start) = Store::open(&folder.join("signing-time"), wall()).map_err(|e| e.to_string())?;
    let signing = Signing::new(key, start.start, start.known);
    store.keep(signing.sent()).map_err(|e| e.to_string())?;
    Ok((signing, store))
}

fn wall() -> u64 {
    timestamp(SystemTime::now())
}
