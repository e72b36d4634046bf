//! `record`: the daemon's frames, or those of the sensors without it, into a file that always ends with a whole line.

mod offline;

use super::cli::RecordArgs;
use super::error::CtlError;
use super::kit::{Daemon, DaemonError, Kit};
use super::name::dated_name;
use crate::config::settings::BusAddress;
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::Errno;
use rustix::net::{RecvFlags, recv};
use std::fs::{File, OpenOptions};
use std::io::{self, ErrorKind, Write};
use std::os::fd::OwnedFd;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant, SystemTime};

/// The longest time that rows wait in memory, and that a request to end goes unheard.
const FLUSH_EVERY: Duration = Duration::from_millis(500);
/// As much as waits in memory, bytes.
const FLUSH_AT: usize = 64 * 1024;
/// The longest packet: a header with its configuration.
pub(super) const MAX_PACKET: usize = 1 << 20;

/// Something that rows are written to.
pub trait Sink: Write {
    /// Cuts it back to its first `len` bytes, where that can be done.
    fn cut(&mut self, _len: u64) -> io::Result<()> {
        Ok(())
    }

    /// Makes what was written last.
    fn finish(&mut self) -> io::Result<()> {
        self.flush()
    }
}

impl Sink for File {
    fn cut(&mut self, len: u64) -> io::Result<()> {
        self.set_len(len)
    }

    fn finish(&mut self) -> io::Result<()> {
        match self.sync_all() {
            // A pipe or a device has nothing to make last.
            Err(e) if e.kind() == ErrorKind::InvalidInput => Ok(()),
            other => other,
        }
    }
}

struct Plain<'a>(&'a mut dyn Write);

impl Write for Plain<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

impl Sink for Plain<'_> {}

/// Why a recording ended otherwise than the user wanted.
#[derive(Debug)]
pub enum End {
    /// The daemon closed the stream.
    Closed,
    /// The stream failed.
    Stream(io::Error),
    /// The sink failed.
    Sink(io::Error),
}

/// Whole lines on their way into a sink.
struct Lines<'a> {
    sink: &'a mut dyn Sink,
    waiting: Vec<u8>,
    written: u64,
    lines: u64,
}

impl Lines<'_> {
    fn push(&mut self, packet: &[u8]) {
        self.waiting.extend_from_slice(packet);
        if !packet.ends_with(b"\n") {
            self.waiting.push(b'\n');
        }
    }

    /// Writes what waits; on an error the sink is cut back to the last whole line.
    fn flush(&mut self) -> io::Result<()> {
        let mut done = 0;
        let result = loop {
            match self.sink.write(&self.waiting[done..]) {
                _ if done == self.waiting.len() => break self.sink.flush(),
                Ok(0) => break Err(ErrorKind::WriteZero.into()),
                Ok(n) => done += n,
                Err(e) if e.kind() == ErrorKind::Interrupted => {}
                Err(e) => break Err(e),
            }
        };
        let whole = self.waiting[..done].iter().rposition(|&b| b == b'\n').map_or(0, |i| i + 1);
        self.written += whole as u64;
        self.lines += self.waiting[..whole].iter().filter(|&&b| b == b'\n').count() as u64;
        if result.is_err() {
            let _ = self.sink.cut(self.written);
        }
        self.waiting.clear();
        result
    }
}

/// Copies the packets of `frames` into `sink` until `stop` is set or `limit` is over. Gives the
/// number of rows in the sink, and why it ended early if it did.
pub fn record(
    frames: &OwnedFd,
    sink: &mut dyn Sink,
    limit: Option<Duration>,
    stop: &AtomicBool,
) -> (u64, Result<(), End>) {
    let mut lines = Lines { sink, waiting: Vec::with_capacity(2 * FLUSH_AT), written: 0, lines: 0 };
    let mut packet = vec![0_u8; MAX_PACKET];
    let mut header_lines = None;
    let begun = Instant::now();
    let mut flushed = begun;
    let mut result = loop {
        let over = limit.is_some_and(|l| begun.elapsed() >= l);
        if over || stop.load(Ordering::Relaxed) {
            break Ok(());
        }
        let left = limit.map_or(FLUSH_EVERY, |l| l.saturating_sub(begun.elapsed()));
        match receive(frames, &mut packet, left.min(FLUSH_EVERY)) {
            Ok(Some(0)) => break Err(End::Closed),
            Ok(Some(n)) => {
                let bytes = &packet[..n];
                lines.push(bytes);
                if header_lines.is_none() {
                    header_lines = Some(lines.waiting.iter().filter(|&&b| b == b'\n').count() as u64);
                }
            }
            Ok(None) => {}
            Err(e) => break Err(End::Stream(e)),
        }
        if lines.waiting.len() >= FLUSH_AT || flushed.elapsed() >= FLUSH_EVERY {
            flushed = Instant::now();
            if let Err(e) = lines.flush() {
                break Err(End::Sink(e));
            }
        }
    };
    if !matches!(result, Err(End::Sink(_)))
        && let Err(e) = lines.flush().and_then(|()| lines.sink.finish())
    {
        result = Err(End::Sink(e));
    }
    (lines.lines.saturating_sub(header_lines.unwrap_or(0)), result)
}

/// The next packet's length, 0 at the end of the stream, `None` when `timeout` was over first.
pub(super) fn receive(frames: &OwnedFd, packet: &mut [u8], timeout: Duration) -> io::Result<Option<usize>> {
    let timeout = Timespec { tv_sec: timeout.as_secs() as i64, tv_nsec: i64::from(timeout.subsec_nanos()) };
    let mut fds = [PollFd::new(frames, PollFlags::IN)];
    match poll(&mut fds, Some(&timeout)) {
        Ok(0) | Err(Errno::INTR) => return Ok(None),
        Ok(_) => {}
        Err(e) => return Err(e.into()),
    }
    match recv(frames, packet, RecvFlags::DONTWAIT) {
        Ok((n, _)) => Ok(Some(n)),
        Err(Errno::AGAIN | Errno::INTR) => Ok(None),
        Err(e) => Err(e.into()),
    }
}

/// The daemon's stream of frames.
pub(super) fn frames(daemon: &mut dyn Daemon) -> Result<OwnedFd, CtlError> {
    daemon.frames().map_err(|e| match e {
        DaemonError::Absent(cause) | DaemonError::Silent(cause) => CtlError::NoDaemon(cause),
        DaemonError::Refused(cause) => CtlError::NoFrames(cause),
    })
}

/// Does what the command line says; how it ended goes to `err`.
pub fn command(
    args: &RecordArgs,
    bus: &BusAddress,
    kit: &Kit,
    stop: &AtomicBool,
    out: &mut dyn Write,
    err: &mut dyn Write,
) -> Result<(), CtlError> {
    let path = args.file.clone().unwrap_or_else(|| dated_name(SystemTime::now()));
    let to_stdout = path.as_os_str() == "-";
    if !to_stdout && !args.force && path.exists() {
        return Err(CtlError::Exists { path });
    }
    // No frames, no empty file.
    let (_sampling, frames) = if args.offline {
        let (sampling, frames) = offline::start(&args.config, bus, kit, err)?;
        (Some(sampling), frames)
    } else {
        (None, frames(&mut *(kit.connect)(bus)?)?)
    };
    let limit = args.seconds.map(Duration::from_secs_f64);
    let (rows, result) = if to_stdout {
        record(&frames, &mut Plain(out), limit, stop)
    } else {
        let mut file = create(&path, args.force)?;
        let _ = writeln!(err, "recording to {}, Ctrl-C ends it", path.display());
        record(&frames, &mut file, limit, stop)
    };
    match result {
        Ok(()) => {
            let _ = writeln!(err, "{rows} rows recorded to {}", path.display());
            Ok(())
        }
        Err(End::Closed) => Err(CtlError::StreamEnded { rows }),
        Err(End::Stream(source)) => Err(CtlError::Stream { rows, source }),
        Err(End::Sink(source)) if to_stdout => Err(CtlError::Output(source)),
        Err(End::Sink(source)) => Err(CtlError::Write { path, rows: Some(rows), source }),
    }
}

/// A new file at `path`; over one that is there only by `force`.
pub(super) fn create(path: &Path, force: bool) -> Result<File, CtlError> {
    let mut options = OpenOptions::new();
    options.write(true);
    if force {
        options.create(true).truncate(true)
    } else {
        options.create_new(true)
    };
    options.open(path).map_err(|source| match source.kind() {
        ErrorKind::AlreadyExists => CtlError::Exists { path: path.to_owned() },
        _ => CtlError::Write { path: path.to_owned(), rows: None, source },
    })
}

#[cfg(test)]
mod tests;
