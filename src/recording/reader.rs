//! Frames out of a recording, row by row, without allocation per row. One bad row costs that row.

use super::error::ReadError;
use super::format::{self, AIDING, Column, REFERENCE};
use super::lines::{Line, Lines, cells};
use super::number::{parse, parse_nanos};
use super::order::{Order, Verdict};
use super::tally::{RowFault, Tally};
use crate::frame::{AMBIENT_LASTS_S, Frame, Missing, Sample, Value};
use crate::head::{Head, SensorKind};
use crate::time::Time;
use std::io::BufRead;
use std::ops::RangeInclusive;

/// Temperatures that a thermopile can be asked to believe, °C.
const TEMPERATURES_C: RangeInclusive<f64> = -273.15..=1000.0;
/// What neither sky nor ground is: above it kelvin are taken for degrees Celsius, °C.
const HOT_C: f64 = 150.0;
/// Voltages that an ADC can give, V.
const VOLTS: RangeInclusive<f64> = -100.0..=100.0;
/// Everything else.
const OTHERS: RangeInclusive<f64> = -1e7..=1e7;
/// A step between rows that is odd, ns.
const WIDE_NANOS: u64 = 10_000_000_000;

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

/// The frames of a recording.
#[derive(Debug)]
pub struct Reader<R> {
    lines: Lines<R>,
    file: String,
    columns: Vec<Column>,
    head: Head,
    /// Whether this program wrote it: then every row ends its line.
    ours: bool,
    notices: Vec<String>,
    objects: Vec<Result<f64, Missing>>,
    /// The die temperatures, °C, with the time of their row once that is known, ns.
    ambients: Vec<Option<(f64, Option<u64>)>>,
    aiding: [Option<f64>; AIDING.len()],
    /// The reference of the row taken apart last; of the frame given last.
    row_reference: Reference,
    reference: Reference,
    order: Order,
    /// A row that waits for the next, by which it is judged.
    held: Option<Held>,
    /// The time of the row taken apart last, where that is still to be judged, ns.
    unjudged: Option<u64>,
    /// The time given last, ns.
    last: Option<u64>,
    tally: Tally,
}

/// A row that waits.
#[derive(Debug)]
struct Held {
    frame: Frame,
    reference: Reference,
    line: u64,
}

impl<R: BufRead> Reader<R> {
    pub(super) fn new(
        lines: Lines<R>,
        file: String,
        columns: Vec<Column>,
        head: Head,
        ours: bool,
        notices: Vec<String>,
    ) -> Self {
        let sensors = head.sensors.len();
        Self {
            lines,
            file,
            columns,
            head,
            ours,
            notices,
            objects: vec![Err(Missing::Empty); sensors],
            ambients: vec![None; sensors],
            aiding: [None; AIDING.len()],
            row_reference: Reference::default(),
            reference: Reference::default(),
            order: Order::default(),
            held: None,
            unjudged: None,
            last: None,
            tally: Tally::default(),
        }
    }

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

    /// The first of the columns of roll and pitch of a reference that is not there.
    pub fn lacks_reference(&self) -> Option<&'static str> {
        (0..2).find(|i| !self.columns.contains(&Column::Reference(*i))).map(|i| REFERENCE[i])
    }

    /// Reads the next usable row into `frame`; `false` at the end of the recording.
    pub fn next_frame(&mut self, frame: &mut Frame) -> Result<bool, ReadError> {
        loop {
            let read = match self.unjudged.take() {
                None => self.read()?,
                some => some,
            };
            if let Some((verdict, held)) = self.order.settle(read).zip(self.held.take()) {
                match verdict {
                    Verdict::Take(nanos) | Verdict::Anew(nanos) => {
                        self.unjudged = read;
                        *frame = held.frame;
                        self.give(nanos, held.reference, frame);
                        return Ok(true);
                    }
                    Verdict::Wait => self.held = Some(held),
                    Verdict::Drop(fault) => self.tally.add(fault, held.line),
                }
            }
            let Some(time) = read else { return Ok(false) };
            let verdict = self.order.row(time);
            let line = self.lines.number;
            match verdict {
                Verdict::Take(nanos) | Verdict::Anew(nanos) => {
                    if matches!(verdict, Verdict::Anew(_)) {
                        self.tally.set_back(line);
                        // What waited was of the clock before.
                        self.held.take().into_iter().for_each(|held| self.tally.add(RowFault::Ahead, held.line));
                    }
                    self.fill(frame);
                    self.give(nanos, self.row_reference, frame);
                    return Ok(true);
                }
                Verdict::Wait => {
                    let mut frame = Frame::default();
                    self.fill(&mut frame);
                    self.held = Some(Held { frame, reference: self.row_reference, line });
                }
                Verdict::Drop(fault) => self.tally.add(fault, line),
            }
        }
    }

    /// Takes the next row apart that has what it needs; gives its time, `None` at the end.
    fn read(&mut self) -> Result<Option<u64>, ReadError> {
        loop {
            let ended = match self.lines.advance() {
                Ok(ended) => ended,
                Err(source) => {
                    return Err(ReadError::Io { file: self.file.clone(), line: self.lines.number, source });
                }
            };
            if ended == Line::End {
                return Ok(None);
            }
            let line = self.lines.line();
            if ended != Line::TooLong && (line.trim_ascii().is_empty() || line.starts_with(b"#")) {
                continue;
            }
            self.tally.rows += 1;
            match self.row(ended) {
                Ok(nanos) => return Ok(Some(nanos)),
                Err(fault) => self.tally.add(fault, self.lines.number),
            }
        }
    }

    /// Takes the line apart; gives its time.
    fn row(&mut self, ended: Line) -> Result<u64, RowFault> {
        if ended == Line::TooLong {
            return Err(RowFault::TooLong);
        }
        let (mut time, mut negative) = (None, false);
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
                Column::Time => {
                    time = parse_nanos(cell);
                    negative = time.is_none() && parse(cell).is_some_and(|s| s < 0.0);
                }
                Column::Object(s) => self.objects[s] = number(TEMPERATURES_C),
                Column::Volts(s) => self.objects[s] = number(VOLTS),
                Column::Ambient(s) => {
                    self.ambients[s] = number(TEMPERATURES_C).ok().map(|c| (c, None)).or(self.ambients[s]);
                }
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
        let time = time.ok_or(if negative { RowFault::Negative } else { RowFault::NoTime })?;
        for ambient in &mut self.ambients {
            let read_at = ambient.map(|(c, at)| (c, at.unwrap_or(time)));
            *ambient = read_at.filter(|(_, at)| is_recent(*at, time)).map(|(c, at)| (c, Some(at)));
        }
        self.tally.cells += bad_cells;
        let temperatures = self.objects.iter().zip(&self.head.sensors).filter(|(_, s)| s.is_absolute());
        let coldest = temperatures.filter_map(|(c, _)| c.ok()).min_by(f64::total_cmp);
        self.tally.hot += u64::from(coldest.is_some_and(|c| c > HOT_C));
        let [roll_deg, pitch_deg, yaw_deg] = reference;
        self.row_reference = Reference { roll_deg, pitch_deg, yaw_deg };
        self.aiding = aiding;
        Ok(time)
    }

    /// Copies the row taken apart last into `frame`, but for its time.
    fn fill(&self, frame: &mut Frame) {
        let time = Time::default();
        frame.aiding = format::to_aiding(self.aiding);
        frame.readings.clear();
        frame.readings.extend(self.objects.iter().zip(&self.ambients).zip(&self.head.sensors).map(
            |((value, ambient), sensor)| {
                value.map(|v| Sample {
                    value: match sensor.kind {
                        SensorKind::Absolute { .. } => {
                            Value::Absolute { object_c: v, ambient_c: ambient.map(|(c, _)| c) }
                        }
                        SensorKind::Pair { .. } => Value::Volts(v),
                    },
                    time,
                })
            },
        ));
    }

    /// Puts its time into a frame that is given.
    fn give(&mut self, nanos: u64, reference: Reference, frame: &mut Frame) {
        frame.time = Time::from_nanos(nanos);
        frame.readings.iter_mut().flatten().for_each(|sample| sample.time = frame.time);
        self.reference = reference;
        let last = self.last.replace(nanos).unwrap_or(nanos);
        self.tally.wide += u64::from(nanos - last > WIDE_NANOS);
    }
}

/// Whether what was read at `at` is still given at `time`, both ns; not where the clock was set back beyond it.
fn is_recent(at: u64, time: u64) -> bool {
    time.abs_diff(at) as f64 <= AMBIENT_LASTS_S * 1e9
}
