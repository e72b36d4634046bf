//! The timestamp over a restart: a machine without a clock battery wakes in the past, and a timestamp must never be
//! used twice.
//!
//! The file holds one number: the timestamp up to which any may have been used. It is written ahead of use, a block of
//! two minutes at a time and so about once a minute, and exactly at the end. A start goes on from it, or from the wall
//! clock where that is later.

use super::MINUTE;
use crate::save::{FileSystem, replace};
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// What is written ahead of use, in units of 10 µs.
const BLOCK: u64 = 2 * MINUTE;

/// Why a timestamp is not kept.
#[derive(Debug, Error)]
pub enum StoreError {
    /// The file cannot be read.
    #[error("the signing timestamp {path} cannot be read: {source}; the daemon's user needs its directory to itself")]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// The file cannot be written.
    #[error("the signing timestamp {path} cannot be written: {source}; make room, and see who owns its directory")]
    Write {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// It holds something else.
    #[error(
        "the signing timestamp {path} holds no timestamp; set the machine's clock, then remove the file: recorded \
         messages are refused by the clock then"
    )]
    Garbage {
        /// The file.
        path: PathBuf,
    },
}

/// The file that keeps the timestamp.
#[derive(Debug)]
pub struct Store {
    path: PathBuf,
    /// What the file says: every timestamp used so far is below.
    reserved: u64,
}

/// Where to go on after a restart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Start {
    /// No timestamp from here on was used before.
    pub start: u64,
    /// A timestamp that is past for sure.
    pub known: u64,
}

impl Store {
    /// The store in `path`, and where to go on at the time `wall`. A file that is not there yet is a first start.
    pub fn open(path: &Path, wall: u64) -> Result<(Self, Start), StoreError> {
        let mut text = String::new();
        let read = File::open(path).and_then(|f| f.take(64).read_to_string(&mut text));
        let garbage = || StoreError::Garbage { path: path.into() };
        let reserved = match read {
            Ok(_) => text.trim_end().parse().ok().filter(|t| *t < 1 << 48).ok_or_else(garbage)?,
            Err(e) if e.kind() == io::ErrorKind::NotFound => 0,
            Err(e) if e.kind() == io::ErrorKind::InvalidData => return Err(garbage()),
            Err(source) => return Err(StoreError::Read { path: path.into(), source }),
        };
        let start = Start { start: reserved.max(wall), known: reserved.saturating_sub(BLOCK).max(wall) };
        Ok((Self { path: path.into(), reserved }, start))
    }

    /// Sees to it that timestamps a little beyond `sent` may be used. To be called before the first message and then
    /// every few seconds; it writes about once a minute. A write waits for the disk.
    pub fn keep(&mut self, sent: u64) -> Result<(), StoreError> {
        if sent.saturating_add(BLOCK / 2) < self.reserved { Ok(()) } else { self.write(sent.saturating_add(BLOCK)) }
    }

    /// Notes that `sent` was the last one: nothing more will be signed.
    pub fn finish(mut self, sent: u64) -> Result<(), StoreError> {
        self.write(sent.saturating_add(1))
    }

    fn write(&mut self, reserved: u64) -> Result<(), StoreError> {
        replace(&mut FileSystem, &self.path, format!("{reserved}\n").as_bytes())
            .map_err(|source| StoreError::Write { path: self.path.clone(), source })?;
        self.reserved = reserved;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Folder(PathBuf);

    impl Folder {
        fn new(name: &str) -> Self {
            let path = std::env::temp_dir().join(format!("irhorizon-stamp-{}-{name}", std::process::id()));
            std::fs::create_dir_all(&path).unwrap();
            Self(path)
        }

        fn file(&self) -> PathBuf {
            self.0.join("timestamp")
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = std::fs::remove_dir_all(&self.0);
        }
    }

    #[test]
    fn a_start_never_goes_back_whatever_the_clock_says() {
        let folder = Folder::new("back");
        let wall = 100 * MINUTE;
        let (mut store, start) = Store::open(&folder.file(), wall).unwrap();
        assert_eq!(start, Start { start: wall, known: wall });
        store.keep(wall).unwrap();
        // Killed after a minute and a half, without a word; the clock wakes an hour early.
        let used = wall + MINUTE * 3 / 2;
        store.keep(used).unwrap();
        drop(store);
        let (store, start) = Store::open(&folder.file(), wall - 60 * MINUTE).unwrap();
        assert!(start.start > used && start.start <= used + 2 * MINUTE, "{start:?}");
        assert!(start.known <= used && start.known >= wall, "{start:?}");
        // Ended in good order: nothing is skipped.
        store.finish(start.start + 5).unwrap();
        assert_eq!(Store::open(&folder.file(), 0).unwrap().1.start, start.start + 6);
        assert_eq!(Store::open(&folder.file(), wall * 2).unwrap().1, Start { start: wall * 2, known: wall * 2 });
    }

    #[test]
    fn it_is_written_about_once_a_minute_and_ahead_of_use() {
        let folder = Folder::new("pace");
        let (mut store, _) = Store::open(&folder.file(), 0).unwrap();
        let mut said = Vec::new();
        // Ten minutes, a look each second.
        for second in 0..600 {
            let sent = second * 100_000;
            store.keep(sent).unwrap();
            let kept: u64 = std::fs::read_to_string(folder.file()).unwrap().trim().parse().unwrap();
            assert!(kept > sent + 100_000);
            said.push(kept);
        }
        said.dedup();
        assert!((9..=11).contains(&said.len()), "{} writes", said.len());
        assert!(said.is_sorted());
    }

    #[test]
    fn trouble_is_told_with_the_next_step() {
        let folder = Folder::new("trouble");
        for garbage in ["", "-5\n", "12x", "999999999999999999999", "281474976710656"] {
            std::fs::write(folder.file(), garbage).unwrap();
            assert!(matches!(Store::open(&folder.file(), 0), Err(StoreError::Garbage { .. })), "{garbage:?}");
        }
        std::fs::write(folder.file(), [0xff; 4]).unwrap();
        assert!(matches!(Store::open(&folder.file(), 0), Err(StoreError::Garbage { .. })));
        assert!(matches!(Store::open(&folder.0, 0), Err(StoreError::Read { .. })));
        let (mut store, _) = Store::open(&folder.0.join("not/there"), 0).unwrap();
        assert!(matches!(store.keep(1), Err(StoreError::Write { .. })));
    }
}
