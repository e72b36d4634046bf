//! A recording up to its header: what it carries, and whose frames it holds.

use super::error::ReadError;
use super::format::{self, Column};
use super::lines::{Line, Lines, cells};
use super::reader::Reader;
use crate::head::{Head, SensorKind};
use std::fs::File;
use std::io::{BufRead, BufReader, ErrorKind};
use std::path::Path;

/// As much configuration as is kept, bytes.
const MAX_CONFIG: usize = 1 << 20;

/// A recording of which the header has been read.
#[derive(Debug)]
pub struct Recording<R> {
    lines: Lines<R>,
    file: String,
    header: Vec<String>,
    config: String,
    ours: bool,
}

impl Recording<BufReader<File>> {
    /// Opens the recording at `path`.
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        let file = path.display().to_string();
        // A folder opens like a file and fails when it is read.
        let opened = File::open(path).and_then(|f| {
            let folder = f.metadata()?.is_dir();
            if folder { Err(ErrorKind::IsADirectory.into()) } else { Ok(f) }
        });
        match opened {
            Ok(f) => Self::new(BufReader::with_capacity(64 * 1024, f), file),
            Err(source) => Err(ReadError::Open { file, source }),
        }
    }
}

impl<R: BufRead> Recording<R> {
    /// Reads up to the header of `input`; errors call it `file`.
    pub fn new(input: R, file: String) -> Result<Self, ReadError> {
        let mut lines = Lines::new(input);
        let (mut config, mut ours) = (String::new(), false);
        loop {
            let ended = match lines.advance() {
                Ok(ended) => ended,
                Err(source) => return Err(ReadError::Io { file, line: lines.number, source }),
            };
            match (ended, lines.text()) {
                (Line::End, _) => return Err(ReadError::Empty { file }),
                (Line::TooLong, _) | (_, None) => return Err(ReadError::NotText { file, line: lines.number }),
                (_, Some("")) => {}
                (_, Some(text)) => match text.strip_prefix('#') {
                    Some(comment) => {
                        ours |= comment.starts_with(" irhorizon ");
                        let comment = comment.strip_prefix(' ').unwrap_or(comment);
                        // Free words may stand before the first table.
                        let begun = !config.is_empty() || comment.starts_with('[');
                        if begun && config.len() + comment.len() < MAX_CONFIG {
                            config.push_str(comment);
                            config.push('\n');
                        }
                    }
                    None => {
                        let text = text.as_bytes();
                        let header = cells(text).map(|c| String::from_utf8_lossy(c).into_owned()).collect();
                        return Ok(Self { lines, file, header, config, ours });
                    }
                },
            }
        }
    }

    /// The configuration that the recording carries, TOML.
    pub fn config(&self) -> Option<&str> {
        Some(self.config.as_str()).filter(|c| !c.is_empty())
    }

    /// Reads on as frames of `head`; without one, of the absolute head that the columns describe.
    pub fn frames(self, head: Option<Head>) -> Result<Reader<R>, ReadError> {
        let Self { lines, file, header, ours, .. } = self;
        let line = lines.number;
        if !header.iter().any(|h| h == format::TIME) {
            return Err(ReadError::no_time(file, line, header.join(",")));
        }
        let given = head.is_some();
        let Some(head) = head.or_else(|| format::head_of(header.iter().map(String::as_str))) else {
            let volts: Vec<_> = header.iter().filter(|h| h.ends_with(format::VOLTS)).map(String::as_str).collect();
            return Err(if volts.is_empty() {
                let expected = "nose_obj_c, tail_obj_c, left_obj_c, right_obj_c, up_obj_c, down_obj_c".to_owned();
                let hint = "sensors with other names need a configuration: give one with --config";
                ReadError::NoSensors { file, line, expected, hint }
            } else {
                ReadError::NeedsConfig { file, line, columns: volts.join(", ") }
            });
        };
        let columns: Vec<_> = header.iter().map(|h| Column::named(h, &head)).collect();
        for (i, c) in columns.iter().enumerate() {
            if *c != Column::Unknown && columns[..i].contains(c) {
                return Err(ReadError::Duplicate { file, line, column: header[i].clone() });
            }
        }
        let wanted = |i: usize| match head.sensors[i].kind {
            SensorKind::Absolute { .. } => (Column::Object(i), format!("{}{}", head.sensors[i].name, format::OBJECT)),
            SensorKind::Pair { .. } => (Column::Volts(i), format!("{}{}", head.sensors[i].name, format::VOLTS)),
        };
        let absent: Vec<_> = (0..head.sensors.len())
            .map(wanted)
            .filter_map(|(c, name)| if columns.contains(&c) { None } else { Some(name) })
            .collect();
        if given && absent.len() == head.sensors.len() {
            let hint = "does the configuration belong to this recording?";
            return Err(ReadError::NoSensors { file, line, expected: absent.join(", "), hint });
        }
        let mut notices = Vec::new();
        if !absent.is_empty() {
            notices.push(format!("no column {}: these sensors have no reading", absent.join(", ")));
        }
        let unknown: Vec<_> =
            header.iter().zip(&columns).filter(|(_, c)| **c == Column::Unknown).map(|(h, _)| h.as_str()).collect();
        if !unknown.is_empty() {
            let shown = unknown.iter().take(10).copied().collect::<Vec<_>>().join(", ");
            let more = if unknown.len() > 10 { ", …" } else { "" };
            let columns = if unknown.len() == 1 { "column" } else { "columns" };
            notices.push(format!("{} {columns} not known and ignored: {shown}{more}", unknown.len()));
        }
        Ok(Reader::new(lines, file, columns, head, ours, notices))
    }
}
