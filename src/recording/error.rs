//! Why a recording cannot be read: where, what was expected, the next step.

use super::format::TIME;
use thiserror::Error;

/// Why a recording cannot be read.
#[derive(Debug, Error)]
pub enum ReadError {
    /// The file cannot be opened.
    #[error("opening the recording {file}: {source}; is the name right and the file readable?")]
    Open {
        /// The recording.
        file: String,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The file cannot be read on.
    #[error("reading {file} after line {line}: {source}; what was read until there stands")]
    Io {
        /// The recording.
        file: String,
        /// The last line that was read.
        line: u64,
        /// The system's reason.
        source: std::io::Error,
    },
    /// There is no header line.
    #[error("{file}: no header line, expected one with time_s; was the recording cut off before it began?")]
    Empty {
        /// The recording.
        file: String,
    },
    /// The header line is no text, or too long.
    #[error("{file}:{line}: not text, expected a header line with time_s; is it a CSV recording, unpacked?")]
    NotText {
        /// The recording.
        file: String,
        /// The header's line.
        line: u64,
    },
    /// There is no time column.
    #[error("{file}:{line}: no time_s column among \"{found}\"; {hint}")]
    NoTime {
        /// The recording.
        file: String,
        /// The header's line.
        line: u64,
        /// The first columns.
        found: String,
        /// What to do.
        hint: &'static str,
    },
    /// A file of estimates has no angles.
    #[error("{file}:{line}: no {column} column; expected the columns that irhorizonctl replay writes")]
    NoEstimates {
        /// The file.
        file: String,
        /// The header's line.
        line: u64,
        /// The column looked for.
        column: &'static str,
    },
    /// A column is there twice.
    #[error("{file}:{line}: column {column} is there twice; remove or rename one")]
    Duplicate {
        /// The recording.
        file: String,
        /// The header's line.
        line: u64,
        /// The column.
        column: String,
    },
    /// Voltages mean nothing without a configuration.
    #[error(
        "{file}:{line}: the voltages {columns} need a configuration that says where their pairs look; \
         give one with --config"
    )]
    NeedsConfig {
        /// The recording.
        file: String,
        /// The header's line.
        line: u64,
        /// The columns.
        columns: String,
    },
    /// No column belongs to a sensor.
    #[error("{file}:{line}: no column of {expected}; {hint}")]
    NoSensors {
        /// The recording.
        file: String,
        /// The header's line.
        line: u64,
        /// The columns looked for.
        expected: String,
        /// What to do.
        hint: &'static str,
    },
}

impl ReadError {
    /// There is no time column in the line `header`.
    pub(super) fn no_time(file: String, line: u64, mut header: String) -> Self {
        let separated = header.split([';', '\t']).any(|cell| cell.trim().trim_matches('"') == TIME);
        let hint = if separated {
            "separate the columns by commas, and write 0.5 for a half"
        } else {
            "name the column of seconds time_s"
        };
        header.truncate(header.floor_char_boundary(80));
        Self::NoTime { file, line, found: header, hint }
    }
}
