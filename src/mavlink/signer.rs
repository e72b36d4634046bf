//! The signing key with its file and clock: what signs and checks, and what is done while it cannot.

use super::deframe::Packet;
use super::encode::Encoder;
use super::messages::Message;
use super::pace::Pace;
use super::signing::{Key, Signing, Store, timestamp};
use crate::config::settings::MavlinkSettings;
use crate::save::state_folder;
use crate::time::Time;
use std::path::Path;
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread::{self, JoinHandle};
use std::time::{Duration, SystemTime};

/// Between two lines of the log on messages that are refused.
const TELL: Duration = Duration::from_secs(10);

/// What signs.
pub struct Signer {
    /// The reason while there is no key to be had: then nothing is sent, and nothing heeded.
    with: Result<(Signing, Keeper), String>,
    told: Pace,
}

/// A thread that keeps the timestamp, as the disk may take its time.
struct Keeper {
    sent: SyncSender<u64>,
    thread: JoinHandle<()>,
}

impl Signer {
    /// The signer that the configuration wants, if any.
    pub fn wanted(settings: &MavlinkSettings) -> Option<Self> {
        let path = settings.signing_key.as_deref()?;
        let with = open(path).map_err(|e| format!("MAVLink is silent: {e}")).inspect_err(|e| log::error!("{e}"));
        Some(Self { with, told: Pace::new(TELL, 0) })
    }

    /// Why there is no key.
    pub fn trouble(&self) -> Option<&str> {
        self.with.as_ref().err().map(String::as_str)
    }

    /// The signed frame of a message on link number `index`; empty without a key.
    pub fn encode<'a>(&mut self, encoder: &'a mut Encoder, message: &Message, index: usize) -> &'a [u8] {
        let link = u8::try_from(index).unwrap_or(u8::MAX);
        match &mut self.with {
            Ok((signing, _)) => encoder.encode_signed(message, signing, link, wall()),
            Err(_) => &[],
        }
    }

    /// Whether a message is signed well.
    pub fn admits(&mut self, now: Time, packet: &Packet<'_>) -> bool {
        let Ok((signing, _)) = &mut self.with else { return false };
        match signing.check(packet, wall()) {
            Ok(()) => true,
            Err(why) => {
                if self.told.take(now) {
                    let (system, component) = (packet.system_id, packet.component_id);
                    log::warn!("MAVLink: message {} of {system}/{component} is refused: {why}", packet.id);
                }
                false
            }
        }
    }

    /// Keeps the timestamp ahead of what is used.
    pub fn tend(&mut self) {
        if let Ok((signing, keeper)) = &self.with {
            // One that is busy is told the next time.
            let _ = keeper.sent.try_send(signing.sent());
        }
    }

    /// Nothing more will be signed.
    pub fn finish(self) {
        if let Ok((signing, Keeper { sent, thread })) = self.with {
            let _ = sent.send(signing.sent());
            drop(sent);
            let _ = thread.join();
        }
    }
}

fn open(path: &Path) -> Result<(Signing, Keeper), String> {
    let key = Key::load(path).map_err(|e| e.to_string())?;
    let folder = state_folder().unwrap_or_else(|| path.parent().unwrap_or(Path::new(".")).to_owned());
    let (mut store, start) = Store::open(&folder.join("signing-time"), wall()).map_err(|e| e.to_string())?;
    let signing = Signing::new(key, start.start, start.known);
    store.keep(signing.sent()).map_err(|e| e.to_string())?;
    let (sent, told) = sync_channel(1);
    let body = move || keep(store, told.into_iter());
    let thread = thread::Builder::new().name("signing-time".into()).stack_size(64 * 1024).spawn(body);
    Ok((signing, Keeper { sent, thread: thread.map_err(|e| format!("no thread to keep the signing time: {e}"))? }))
}

fn keep(mut store: Store, times: impl Iterator<Item = u64>) {
    let (mut last, mut failed) = (None, false);
    for sent in times {
        last = Some(sent);
        match store.keep(sent) {
            Ok(()) => failed = false,
            Err(e) => {
                if !std::mem::replace(&mut failed, true) {
                    log::error!("MAVLink: {e}");
                }
            }
        }
    }
    if let Some(Err(e)) = last.map(|sent| store.finish(sent)) {
        log::error!("MAVLink: {e}");
    }
}

fn wall() -> u64 {
    timestamp(SystemTime::now())
}
