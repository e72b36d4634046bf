//! What goes wrong, in one line with the next step, and the exit codes.

use super::calibrate::CalibrateError;
use super::in_use::InUse;
use super::kit::{Cause, DaemonError};
use super::set_address::SetAddressError;
use crate::config;
use crate::recording::ReadError;
use crate::simulation::FaultError;
use std::error::Error;
use std::fmt::Write as _;
use std::io;
use std::path::PathBuf;
use thiserror::Error;

/// All went well; for `status`: nominal.
pub const EXIT_OK: u8 = 0;
/// The command failed; for `status`: degraded.
pub const EXIT_FAILED: u8 = 1;
/// For `status`: attitude is withheld, the daemon is faulted or still starting.
pub const EXIT_WITHHELD: u8 = 2;
/// There is no daemon to ask.
pub const EXIT_NO_DAEMON: u8 = 3;
/// The command line makes no sense (EX_USAGE of sysexits).
pub const EXIT_USAGE: u8 = 64;

/// Why a command failed.
#[derive(Debug, Error)]
pub enum CtlError {
    /// The daemon does not answer.
    #[error("{}", chain(&**.0))]
    NoDaemon(Cause),
    /// No sensor can be reached.
    #[error("{0}")]
    Unreachable(String),
    /// There is no stream of frames: the daemon refuses it, or this system.
    #[error("{}", chain(&**.0))]
    NoFrames(Cause),
    /// A daemon reads the bus.
    #[error(transparent)]
    InUse(#[from] InUse),
    /// An address was not changed.
    #[error(transparent)]
    SetAddress(#[from] SetAddressError),
    /// Nothing was calibrated.
    #[error(transparent)]
    Calibrate(#[from] CalibrateError),
    /// The daemon was not ready in time.
    #[error("not ready after {seconds} s: mode {mode}{}; see irhorizonctl status, irhorizonctl doctor", because(.faults))]
    NotReady {
        /// How long was waited.
        seconds: f64,
        /// The mode at the end.
        mode: String,
        /// The names of the active faults.
        faults: Vec<String>,
    },
    /// The stream of frames ended before the user ended it.
    #[error(
        "the daemon ended the stream of frames after {rows} rows: it was stopped, or its configuration has changed; what was recorded until there is whole"
    )]
    StreamEnded {
        /// Rows recorded.
        rows: u64,
    },
    /// The stream of frames cannot be read.
    #[error("reading the daemon's stream of frames failed after {rows} rows; what was recorded is whole")]
    Stream {
        /// Rows recorded.
        rows: u64,
        /// The system's reason.
        source: io::Error,
    },
    /// A configuration is not good.
    #[error("the configuration is not usable; correct it and see irhorizonctl validate")]
    Config(#[source] Cause),
    /// A recording cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A file is there already.
    #[error("{path} is there already; give another name, or --force to overwrite it")]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// A replay would overwrite what it reads.
    #[error("{path} is the recording itself; give --output another name")]
    OverItself {
        /// The file.
        path: PathBuf,
    },
    /// No row gave a frame.
    #[error("{path} has no usable row: nothing was replayed, nothing written")]
    NothingToReplay {
        /// The recording.
        path: PathBuf,
    },
    /// There is nothing to score against.
    #[error("{path} has no column {column}: a reference to score against is ref_roll_deg and ref_pitch_deg")]
    NoReference {
        /// The recording.
        path: PathBuf,
        /// The column looked for.
        column: &'static str,
    },
    /// No row is left to score.
    #[error("none of the {rows} rows of {path} is left to score; left out: {left_out}")]
    NothingToScore {
        /// The recording.
        path: PathBuf,
        /// Its usable rows.
        rows: u64,
        /// Which are left out, and how to have them in.
        left_out: String,
    },
    /// No row is left to draw.
    #[error("no row of {path} is left to draw{}", between(*.times_s))]
    NothingToPlot {
        /// The recording.
        path: PathBuf,
        /// The times of its first and last row, s.
        times_s: Option<(f64, f64)>,
    },
    /// No row that is left has an error to draw.
    #[error("none of the {rows} rows of {path} that are left to draw has both an attitude and a reference")]
    NoErrors {
        /// The recording.
        path: PathBuf,
        /// Its usable rows within the times asked for.
        rows: u64,
    },
    /// Two of what is scored have one name.
    #[error("two are called {0}: give each --beside a name of its own, and none a method's that is scored")]
    SameName(String),
    /// Estimates of another flight.
    #[error("no row of {path} has the time of a row of {recording}; is it of the same flight?")]
    OtherFlight {
        /// The estimates.
        path: PathBuf,
        /// The recording.
        recording: PathBuf,
    },
    /// A method that the head does not allow.
    #[error("method {method} needs {needs}, and this head has not; see --method all")]
    MethodNotAllowed {
        /// The method.
        method: &'static str,
        /// What it needs.
        needs: &'static str,
    },
    /// A fault that this head cannot have.
    #[error("--fault cannot be: {0}")]
    Fault(#[from] FaultError),
    /// A file cannot be written.
    #[error("writing {path} failed{}{}", forbidden(.source), kept(*.rows))]
    Write {
        /// The file.
        path: PathBuf,
        /// The rows that are in it, when it is a recording.
        rows: Option<u64>,
        /// The system's reason.
        source: io::Error,
    },
    /// Standard output cannot be written.
    #[error("writing to standard output failed")]
    Output(#[source] io::Error),
    /// There is no terminal to draw on.
    #[error("watch needs a terminal; use --once for one picture or --json for a line each")]
    NoTerminal,
    /// The terminal does not do what it is asked.
    #[error("the terminal failed; use --once for one picture or --json for a line each")]
    Terminal(#[source] io::Error),
}

fn kept(rows: Option<u64>) -> String {
    rows.map(|n| format!("; the file ends whole after {n} rows")).unwrap_or_default()
}

fn forbidden(reason: &io::Error) -> &'static str {
    if reason.kind() == io::ErrorKind::PermissionDenied { " (sudo?)" } else { "" }
}

fn because(faults: &[String]) -> String {
    if faults.is_empty() { String::new() } else { format!(" ({})", faults.join(", ")) }
}

fn between(times_s: Option<(f64, f64)>) -> String {
    match times_s {
        None => ": it has no usable row".to_owned(),
        Some((first, last)) => {
            let [first, last] = [first, last].map(|s| (100.0 * s).round() / 100.0);
            format!(": its times are {first} to {last} s; see --from and --to")
        }
    }
}

impl From<DaemonError> for CtlError {
    /// A daemon that was asked for its state and refuses it, or does not answer, counts as none.
    fn from(error: DaemonError) -> Self {
        match error {
            DaemonError::Absent(cause) | DaemonError::Silent(cause) | DaemonError::Refused(cause) => {
                Self::NoDaemon(cause)
            }
        }
    }
}

impl CtlError {
    /// The process's exit code.
    pub fn code(&self) -> u8 {
        match self {
            Self::NoDaemon(_) => EXIT_NO_DAEMON,
            Self::Fault(_) | Self::SameName(_) => EXIT_USAGE,
            _ => EXIT_FAILED,
        }
    }

    /// The error for a person to read: in one line, but for what is wrong in a configuration, which points to its lines.
    pub fn text(&self) -> String {
        match self {
            Self::Config(cause) if cause.to_string().contains('\n') => {
                let lines: Vec<String> = cause.to_string().lines().map(printable).collect();
                format!("{self}:\n{}", lines.join("\n"))
            }
            _ => chain(self),
        }
    }

    /// Whether nobody reads any more: no error to tell anyone.
    pub fn is_broken_pipe(&self) -> bool {
        match self {
            Self::Output(e) | Self::Write { source: e, .. } => e.kind() == io::ErrorKind::BrokenPipe,
            _ => false,
        }
    }
}

/// The error and its causes in one line; a cause that its parent has quoted is not said twice.
pub fn chain(error: &dyn Error) -> String {
    let mut line = error.to_string();
    let mut cause = error.source();
    while let Some(e) = cause {
        let text = e.to_string();
        if !line.contains(&text) {
            let _ = write!(line, ": {text}");
        }
        cause = e.source();
    }
    printable(&line.replace('\n', "; "))
}

/// Foreign text as a terminal may have it: without what could control it.
pub fn printable(text: &str) -> String {
    text.chars().map(config::printable).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chain_is_one_line_and_says_nothing_twice() {
        let source = io::Error::new(io::ErrorKind::NotFound, "no such name");
        let line = chain(&CtlError::Output(source));
        assert_eq!(line, "writing to standard output failed: no such name");
        let source = ReadError::Open { file: "a.csv".into(), source: io::Error::other("gone") };
        assert_eq!(chain(&CtlError::Read(source)).matches("gone").count(), 1);
        assert_eq!(CtlError::Config("a:2: no\u{1b}\n  2 | x".into()).text().lines().count(), 3);
        assert!(!CtlError::Config("a:2: no\u{1b}\n  2 | x".into()).text().contains('\u{1b}'));
        let plain = CtlError::Config("a: no sensor".into());
        assert_eq!(plain.text(), chain(&plain));
    }
}
