//! Messages signed by a key that both sides hold, and the check of those that arrive (MAVLink 2 message signing). Pure:
//! the wall clock comes in as an argument.
//!
//! With a key, every message that goes out is signed and **no message without a good signature is heeded**: no
//! heartbeat, no aiding, no command, nor anything of MAVLink 1, which cannot be signed. The exception that the protocol
//! allows, RADIO_STATUS of a telemetry radio, makes no difference: it is not heeded here in any case.
//!
//! A signature is 13 bytes behind the CRC: the link's number, a timestamp in units of 10 µs since 2015, and the first
//! 48 bits of SHA-256 over the key and all of the frame before them. Timestamps of one sender on one link only ever
//! rise; so a message that was recorded cannot be played again.
//!
//! - [`key`]: the key, out of its file.
//! - [`store`]: the timestamp, kept over a restart.
//!
//! The hash is sha2's own, not that of the `mavlink` crate's signing feature: that reads the system's clock itself,
//! forgets the timestamp with the process, and prints its key.

pub mod key;
pub mod store;

pub use key::{Key, KeyError};
pub use store::{Store, StoreError};

use super::deframe::{Packet, SIGNATURE};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::time::{Duration, SystemTime};
use thiserror::Error;

/// Bytes of the signature proper, at the end.
const PROPER: usize = 6;

/// The bit of the incompatibility flags that says a frame is signed.
pub const SIGNED: u8 = 1;

/// 2015-01-01 00:00 UTC after 1970, s.
const EPOCH_S: u64 = 1_420_070_400;

/// A minute in units of 10 µs.
pub const MINUTE: u64 = 60 * 100_000;

/// The largest timestamp: 48 bits, in the year 2104.
const LAST: u64 = (1 << 48) - 1;

/// As many senders' links as are remembered.
const MOST: usize = 256;

/// The timestamp of `wall`; 0 before 2015.
pub fn timestamp(wall: SystemTime) -> u64 {
    let since = wall.duration_since(SystemTime::UNIX_EPOCH).unwrap_or(Duration::ZERO);
    let since = since.saturating_sub(Duration::from_secs(EPOCH_S));
    u64::try_from(since.as_micros() / 10).unwrap_or(LAST).min(LAST)
}

/// Why a message is not heeded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum Refused {
    /// It has no signature.
    #[error("it is not signed: give its sender the signing key, or take signing-key out of the configuration")]
    Unsigned,
    /// It has another key's signature, or was changed.
    #[error("its signature is wrong: does its sender have the same signing key?")]
    Wrong,
    /// It is not newer than the last one of this sender on this link.
    #[error("its timestamp is not new: it was sent before, or two senders share a system, component and link id")]
    Replayed,
    /// It is the first of its sender on this link, and more than a minute old.
    #[error("its timestamp is more than a minute old: set its sender's clock")]
    Old,
    /// There are too many senders.
    #[error("there are {MOST} signing senders already")]
    TooMany,
}

/// The key with the timestamps of what was sent and heard.
#[derive(Clone, Debug)]
pub struct Signing {
    key: Key,
    /// The last timestamp given to a message.
    sent: u64,
    /// The newest timestamp known to be past: of the wall clock, of a message heard.
    known: u64,
    streams: BTreeMap<(u8, u8, u8), u64>,
}

impl Signing {
    /// With `key`; `start` is the timestamp from which on none was used before, `known` one that is past for sure. See
    /// [`Store::open`].
    pub fn new(key: Key, start: u64, known: u64) -> Self {
        Self { key, sent: start.saturating_sub(1), known, streams: BTreeMap::new() }
    }

    /// The last timestamp that was used: what [`Store::keep`] is to be told.
    pub fn sent(&self) -> u64 {
        self.sent
    }

    /// A timestamp for one message, never the same twice and never a smaller one, whatever `wall` does.
    pub fn stamp(&mut self, wall: u64) -> u64 {
        self.known = self.known.max(wall).min(LAST);
        self.sent = (self.sent + 1).max(self.known).min(LAST);
        self.sent
    }

    /// Signs `frame` on link `link` at the time `wall`: a whole frame whose flags say that it is signed, with room for
    /// the signature at its end.
    pub fn sign(&mut self, frame: &mut [u8], link: u8, wall: u64) {
        let stamp = self.stamp(wall);
        sign(&self.key, frame, link, stamp);
    }

    /// Whether `packet` may be heeded at the time `wall`.
    pub fn check(&mut self, packet: &Packet<'_>, wall: u64) -> Result<(), Refused> {
        let Some((link, stamp, proper)) = packet.signature.and_then(parts) else { return Err(Refused::Unsigned) };
        let before = packet.bytes.len().saturating_sub(PROPER);
        let hash = hash(&self.key, packet.bytes.get(..before).unwrap_or_default());
        // All bytes are looked at, so that the time taken tells nothing of the right ones.
        if hash.iter().zip(proper).fold(0, |wrong, (a, b)| wrong | (a ^ b)) != 0 {
            return Err(Refused::Wrong);
        }
        self.known = self.known.max(wall).min(LAST);
        let stream = (packet.system_id, packet.component_id, link);
        match self.streams.get(&stream) {
            Some(last) if stamp <= *last => return Err(Refused::Replayed),
            Some(_) => {}
            None if stamp.saturating_add(MINUTE) < self.known => return Err(Refused::Old),
            None => self.make_room()?,
        }
        self.streams.insert(stream, stamp);
        // The protocol's rule: whoever is ahead is followed. Only holders of the key are.
        self.known = self.known.max(stamp);
        Ok(())
    }

    /// Forgets a stream whose messages would be refused as too old in any case, if there are too many.
    fn make_room(&mut self) -> Result<(), Refused> {
        if self.streams.len() < MOST {
            return Ok(());
        }
        let oldest = self.streams.iter().min_by_key(|(_, stamp)| **stamp).map(|(stream, stamp)| (*stream, *stamp));
        match oldest {
            Some((stream, stamp)) if stamp.saturating_add(MINUTE) < self.known => {
                self.streams.remove(&stream);
                Ok(())
            }
            _ => Err(Refused::TooMany),
        }
    }
}

fn hash(key: &Key, signed: &[u8]) -> [u8; PROPER] {
    let whole = Sha256::new().chain_update(key.bytes()).chain_update(signed).finalize();
    std::array::from_fn(|i| whole.get(i).copied().unwrap_or(0))
}

/// Link, timestamp and signature proper.
fn parts(signature: &[u8]) -> Option<(u8, u64, &[u8])> {
    let (link, rest) = signature.split_first()?;
    let (stamp, proper) = rest.split_at_checked(6)?;
    let stamp = stamp.iter().rev().fold(0, |stamp, b| stamp << 8 | u64::from(*b));
    (proper.len() == PROPER).then_some((*link, stamp, proper))
}

fn sign(key: &Key, frame: &mut [u8], link: u8, stamp: u64) {
    let Some((_, signature)) = frame.split_last_chunk_mut::<SIGNATURE>() else { return };
    signature[0] = link;
    signature[1..7].copy_from_slice(&stamp.to_le_bytes()[..6]);
    let before = frame.len() - PROPER;
    let (signed, proper) = frame.split_at_mut(before);
    proper.copy_from_slice(&hash(key, signed));
}

#[cfg(test)]
mod tests;
