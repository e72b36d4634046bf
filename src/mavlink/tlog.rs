//! The tlog of an endpoint: before each frame, sent or received, the µs since 1970 in eight bytes, big endian.
//!
//! The thread that sends never waits for a disk: it leaves its frames in memory, where a thread of the tlog's own
//! fetches them. When that has fallen too far behind, frames are left out and counted.

use super::endpoint::stats::{About, EndpointStats};
use crate::clock;
use crate::time::Time;
use std::fs::{File, OpenOptions};
use std::io::{Error, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// As many bytes as wait for the disk: more than a minute of ATTITUDE at 50 Hz to one endpoint.
const MOST_BYTES: usize = 256 * 1024;

/// How often the disk is written to while little comes.
const PERIOD: Duration = Duration::from_millis(500);

/// The time between two attempts to write.
const RETRY: Duration = Duration::from_secs(1);

/// Where frames wait.
#[derive(Debug, Default)]
struct Desk {
    waiting: Mutex<Waiting>,
    called: Condvar,
}

#[derive(Debug)]
struct Waiting {
    bytes: Vec<u8>,
    closing: bool,
}

impl Default for Waiting {
    fn default() -> Self {
        Self { bytes: Vec::with_capacity(MOST_BYTES), closing: false }
    }
}

impl Desk {
    fn lock(&self) -> MutexGuard<'_, Waiting> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for `span`, or until somebody calls.
    fn wait(&self, span: Duration) -> MutexGuard<'_, Waiting> {
        let (guard, _) = self
            .called
            .wait_timeout_while(self.lock(), span, |w| !w.closing && w.bytes.len() < MOST_BYTES / 2)
            .unwrap_or_else(PoisonError::into_inner);
        guard
    }
}

/// A tlog that is written to.
#[derive(Debug)]
pub struct Tlog {
    path: PathBuf,
    desk: Arc<Desk>,
    stats: Arc<EndpointStats>,
    thread: JoinHandle<()>,
}

impl Tlog {
    /// Begins one, or goes on with the one that is at `path`. What is left out is counted in `stats`.
    pub fn new(path: &Path, stats: Arc<EndpointStats>) -> Option<Self> {
        let desk = Arc::new(Desk::default());
        let path = path.to_owned();
        let mut clerk =
            Clerk { path: path.clone(), desk: Arc::clone(&desk), stats: Arc::clone(&stats), file: None, warned: false };
        let thread = std::thread::Builder::new().name("tlog".into()).stack_size(128 * 1024).spawn(move || clerk.run());
        match thread {
            Ok(thread) => Some(Self { path, desk, stats, thread }),
            Err(e) => {
                let text = format!("{}: no tlog, as the system gives no thread: {e}", path.display());
                log::error!("{text}");
                stats.set_error(About::Tlog, text);
                None
            }
        }
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes a frame, stamped now.
    pub fn write(&self, frame: &[u8]) {
        let since_1970 = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        let stamp = u64::try_from(since_1970.as_micros()).unwrap_or(u64::MAX).to_be_bytes();
        let mut waiting = self.desk.lock();
        let before = waiting.bytes.len();
        if before + stamp.len() + frame.len() > MOST_BYTES {
            drop(waiting);
            self.stats.tlog_lost(1);
            return;
        }
        waiting.bytes.extend_from_slice(&stamp);
        waiting.bytes.extend_from_slice(frame);
        if before < MOST_BYTES / 2 && waiting.bytes.len() >= MOST_BYTES / 2 {
            self.desk.called.notify_one();
        }
    }

    /// Ends it, and waits until all is written or `end` has come.
    pub fn finish(self, end: Time) {
        self.close();
        while !self.thread.is_finished() && clock::now() < end {
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    fn close(&self) {
        self.desk.lock().closing = true;
        self.desk.called.notify_one();
    }
}

impl Drop for Tlog {
    fn drop(&mut self) {
        self.close();
    }
}

/// Who writes.
struct Clerk {
    path: PathBuf,
    desk: Arc<Desk>,
    stats: Arc<EndpointStats>,
    file: Option<File>,
    warned: bool,
}

impl Clerk {
    fn run(&mut self) {
        let mut fetched: Vec<u8> = Vec::with_capacity(MOST_BYTES);
        let mut written = 0;
        loop {
            let closing = {
                let mut waiting = self.desk.wait(PERIOD);
                if written == fetched.len() {
                    written = 0;
                    fetched.clear();
                    std::mem::swap(&mut fetched, &mut waiting.bytes);
                }
                waiting.closing
            };
            match self.write(&fetched, &mut written) {
                Ok(()) => {}
                Err(_) if closing => return,
                Err(e) => self.wait_for_better(&e),
            }
            if closing && self.desk.lock().bytes.is_empty() {
                return;
            }
        }
    }

    /// Writes what is not yet `written`. A frame that was cut by a full disk is finished when there is room again.
    fn write(&mut self, bytes: &[u8], written: &mut usize) -> Result<(), Error> {
        while *written < bytes.len() {
            let file = match &mut self.file {
                Some(file) => file,
                none => none.insert(OpenOptions::new().append(true).create(true).open(&self.path)?),
            };
            match file.write(&bytes[*written..]) {
                Ok(0) => return Err(ErrorKind::WriteZero.into()),
                Ok(n) => *written += n,
                Err(e) if e.kind() == ErrorKind::Interrupted => {}
                Err(e) => return Err(e),
            }
        }
        if self.warned && !bytes.is_empty() {
            self.warned = false;
            self.tell(String::new());
            log::info!("{}: the tlog is written again", self.path.display());
        }
        Ok(())
    }

    /// Shows what is wrong, unless the endpoint has done with this tlog.
    fn tell(&self, text: String) {
        let waiting = self.desk.lock();
        if !waiting.closing {
            self.stats.set_error(About::Tlog, text);
        }
    }

    fn wait_for_better(&mut self, error: &Error) {
        if !self.warned {
            self.warned = true;
            let text = format!(
                "{}: the tlog cannot be written: {error}; will try again (df {0}; the unit wants ReadWritePaths=)",
                self.path.display()
            );
            log::warn!("{text}");
            self.tell(text);
        }
        let end = std::time::Instant::now() + RETRY;
        while !self.desk.lock().closing && std::time::Instant::now() < end {
            std::thread::sleep(Duration::from_millis(50));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn finish(tlog: Tlog) {
        tlog.finish(clock::now() + Duration::from_secs(10));
    }

    fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("irhorizon-tlog-{name}-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).unwrap();
        folder
    }

    #[test]
    fn each_frame_has_its_stamp_and_a_second_run_goes_on() {
        let folder = folder("stamps");
        let path = folder.join("a.tlog");
        let stats = Arc::new(EndpointStats::default());
        for frame in [b"first", b"again"] {
            let tlog = Tlog::new(&path, Arc::clone(&stats)).unwrap();
            tlog.write(frame);
            finish(tlog);
        }
        let bytes = std::fs::read(&path).unwrap();
        assert_eq!(bytes.len(), 2 * (8 + 5));
        assert_eq!((&bytes[8..13], &bytes[21..26]), (&b"first"[..], &b"again"[..]));
        let stamp = |i: usize| u64::from_be_bytes(bytes[i..i + 8].try_into().unwrap());
        let now_usec = SystemTime::now().duration_since(UNIX_EPOCH).unwrap().as_micros() as u64;
        assert!(stamp(0) <= stamp(13) && now_usec - stamp(13) < 60_000_000);
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn a_disk_that_takes_nothing_costs_frames_and_no_time() {
        let stats = Arc::new(EndpointStats::default());
        let tlog = Tlog::new(Path::new("/dev/full"), Arc::clone(&stats)).unwrap();
        let begun = std::time::Instant::now();
        for _ in 0..10_000 {
            tlog.write(&[0; 92]);
        }
        assert!(begun.elapsed() < Duration::from_secs(1), "{:?}", begun.elapsed());
        let lost = stats.view().tlog_lost;
        assert!((4_000..10_000).contains(&lost), "{lost} of 10000 frames of 100 bytes, where 256 KiB wait");
        assert!(tlog.desk.lock().bytes.len() <= MOST_BYTES);
        while stats.view().last_error.is_empty() && begun.elapsed() < Duration::from_secs(10) {
            std::thread::sleep(Duration::from_millis(5));
        }
        let said = stats.view().last_error;
        assert!(said.starts_with("/dev/full: the tlog cannot be written: No space left"), "{said}");
        finish(tlog);
    }

    #[test]
    fn a_folder_that_comes_later_is_found() {
        let folder = folder("later");
        let path = folder.join("sub/a.tlog");
        let stats = Arc::new(EndpointStats::default());
        let tlog = Tlog::new(&path, Arc::clone(&stats)).unwrap();
        tlog.write(b"frame");
        std::thread::sleep(Duration::from_millis(700));
        assert_ne!(stats.view().last_error, "");
        std::fs::create_dir(folder.join("sub")).unwrap();
        for _ in 0..100 {
            if path.exists() && path.metadata().unwrap().len() == 13 {
                break;
            }
            std::thread::sleep(Duration::from_millis(50));
        }
        assert_eq!(std::fs::read(&path).unwrap()[8..], *b"frame");
        // The writer says so only after the last byte; one that is closing says nothing any more.
        for _ in 0..100 {
            if stats.view().last_error.is_empty() {
                break;
            }
            std::thread::sleep(Duration::from_millis(50));
        }
        assert_eq!(stats.view().last_error, "");
        finish(tlog);
        std::fs::remove_dir_all(folder).unwrap();
    }
}
