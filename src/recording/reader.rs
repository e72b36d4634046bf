//! Frames out of a recording, row by row, without allocation per row. One bad row costs that row.

use super::format::{self, AIDING, Column, REFERENCE};
use super::lines::{Line, Lines, cells};
use super::number::{parse, parse_nanos};
use super::tally::{RowFault, Tally};
use crate::frame::{Frame, Missing, Sample, Value};
use crate::head::{Head, SensorKind};
use crate::time::Time;
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::ops::RangeInclusive;
use std::path::Path;
use thiserror::Error;

/// Temperatures that a thermopile can be asked to believe, °C.
const TEMPERATURES_C: RangeInclusive<f64> = -273.15..=1000.0;
/// Voltages that an ADC can give, V.
const VOLTS: RangeInclusive<f64> = -100.0..=100.0;
/// Everything else.
const OTHERS: RangeInclusive<f64> = -1e7..=1e7;
/// A step forward that the next row must bear out, ns: an hour.
const LEAP_NANOS: u64 = 3_600_000_000_000;
/// As much configuration as is kept, bytes.
const MAX_CONFIG: usize = 1 << 20;

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
    #[error("{file}:{line}: no time_s column among \"{found}\"; name the column of seconds time_s")]
    NoTime {
        /// The recording.
        file: String,
        /// The header's line.
        line: u64,
        /// The first columns.
        found: String,
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

/// What an instrument of better knowledge said, °. Never part of a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reference {
    /// Roll, right wing down positive.
    pub roll_deg: Option<f64>,
    /// Pitch, nose up positive.
    pub pitch_deg: Option<f64>,
    /// Yaw, clockwise from north.
    pub yaw_deg: Option<f64>,
}

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
        match File::open(path) {
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
            let text = std::str::from_utf8(lines.line()).ok().filter(|t| !t.contains('\0'));
            let text = text.map(|t| t.trim_start_matches('\u{feff}').trim());
            match (ended, text) {
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
            let mut found = header.join(",");
            found.truncate(found.floor_char_boundary(80));
            return Err(ReadError::NoTime { file, line, found });
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
            SensorKind::Absolute => (Column::Object(i), format!("{}{}", head.sensors[i].name, format::OBJECT)),
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
            notices.push(format!("{} columns not known and ignored: {shown}{more}", unknown.len()));
        }
        let sensors = head.sensors.len();
        Ok(Reader {
            lines,
            file,
            columns,
            head,
            ours,
            notices,
            objects: vec![Err(Missing::Empty); sensors],
            ambients: vec![None; sensors],
            aiding: [None; AIDING.len()],
            reference: Reference::default(),
            last: None,
            suspect: None,
            tally: Tally::default(),
        })
    }
}

/// The frames of a recording.
#[derive(Debug)]
pub struct Reader<R> {
    lines: Lines<R>,
    file: String,
    columns: Vec<Column>,
    head: Head,
    ours: bool,
    notices: Vec<String>,
    objects: Vec<Result<f64, Missing>>,
    ambients: Vec<Option<f64>>,
    aiding: [Option<f64>; AIDING.len()],
    reference: Reference,
    last: Option<u64>,
    suspect: Option<u64>,
    tally: Tally,
}

impl<R: BufRead> Reader<R> {
    /// The sensors, in the order of each frame's readings.
    pub fn head(&self) -> &Head {
        &self.head
    }

    /// What the user should be told of the columns, a line each.
    pub fn notices(&self) -> &[String] {
        &self.notices
    }

    /// What could not be used until here.
    pub fn tally(&self) -> &Tally {
        &self.tally
    }

    /// The reference beside the frame read last.
    pub fn reference(&self) -> Reference {
        self.reference
    }

    /// Reads the next usable row into `frame`; `false` at the end of the recording.
    pub fn next_frame(&mut self, frame: &mut Frame) -> Result<bool, ReadError> {
        loop {
            let ended = match self.lines.advance() {
                Ok(ended) => ended,
                Err(source) => {
                    return Err(ReadError::Io { file: self.file.clone(), line: self.lines.number, source });
                }
            };
            if ended == Line::End {
                return Ok(false);
            }
            let line = self.lines.line();
            if ended != Line::TooLong && (line.trim_ascii().is_empty() || line.starts_with(b"#")) {
                continue;
            }
            self.tally.rows += 1;
            match self.row(ended) {
                Ok(nanos) => {
                    self.fill(nanos, frame);
                    return Ok(true);
                }
                Err(fault) => self.tally.add(fault, self.lines.number),
            }
        }
    }

    /// Takes the line apart; gives its time.
    fn row(&mut self, ended: Line) -> Result<u64, RowFault> {
        if ended == Line::TooLong {
            return Err(RowFault::TooLong);
        }
        let mut time = None;
        let mut bad_cells = 0;
        let mut reference = [None; REFERENCE.len()];
        self.objects.fill(Err(Missing::Empty));
        let mut found = 0;
        let mut aiding = [None; AIDING.len()];
        for (i, cell) in cells(self.lines.line()).enumerate() {
            let Some(column) = self.columns.get(i) else {
                // A comma at the end of each row is harmless.
                if cell.is_empty() {
                    continue;
                }
                return Err(RowFault::Ragged);
            };
            found = i + 1;
            if cell.is_empty() {
                continue;
            }
            let mut number = |range: RangeInclusive<f64>| match parse(cell) {
                Some(v) if range.contains(&v) => Ok(v),
                other => {
                    bad_cells += 1;
                    Err(if other.is_some() { Missing::Impossible } else { Missing::Empty })
                }
            };
            match *column {
                Column::Time => time = parse_nanos(cell),
                Column::Object(s) => self.objects[s] = number(TEMPERATURES_C),
                Column::Volts(s) => self.objects[s] = number(VOLTS),
                Column::Ambient(s) => self.ambients[s] = number(TEMPERATURES_C).ok().or(self.ambients[s]),
                Column::Aiding(a) => aiding[a] = number(OTHERS).ok(),
                Column::Reference(r) => reference[r] = number(OTHERS).ok(),
                Column::Unknown => {}
            }
        }
        if found < self.columns.len() {
            return Err(if ended == Line::Cut { RowFault::Truncated } else { RowFault::Ragged });
        }
        // Our own rows end their lines: without the end, the last number may be cut short.
        if ended == Line::Cut && self.ours {
            return Err(RowFault::Truncated);
        }
        let time = time.ok_or(RowFault::NoTime)?;
        self.order(time)?;
        self.tally.cells += bad_cells;
        let [roll_deg, pitch_deg, yaw_deg] = reference;
        self.reference = Reference { roll_deg, pitch_deg, yaw_deg };
        self.aiding = aiding;
        Ok(time)
    }

    /// Whether a row of this time comes after the one before.
    fn order(&mut self, time: u64) -> Result<(), RowFault> {
        if let Some(last) = self.last {
            if time <= last {
                return Err(RowFault::Backwards);
            }
            let follows = |earlier: u64| time > earlier && time - earlier <= LEAP_NANOS;
            if !follows(last) && !self.suspect.is_some_and(follows) {
                self.suspect = Some(time);
                return Err(RowFault::Ahead);
            }
        }
        self.last = Some(time);
        self.suspect = None;
        Ok(())
    }

    fn fill(&self, nanos: u64, frame: &mut Frame) {
        let time = Time::from_nanos(nanos);
        frame.time = time;
        frame.aiding = format::to_aiding(self.aiding);
        frame.readings.clear();
        frame.readings.extend(self.objects.iter().zip(&self.ambients).zip(&self.head.sensors).map(
            |((value, ambient_c), sensor)| {
                value.map(|v| Sample {
                    value: match sensor.kind {
                        SensorKind::Absolute => Value::Absolute { object_c: v, ambient_c: *ambient_c },
                        SensorKind::Pair { .. } => Value::Volts(v),
                    },
                    time,
                })
            },
        ));
    }
}
