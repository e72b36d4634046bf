//! Estimates as `replay` writes them, read again: those of another program to be scored beside.

use super::error::ReadError;
use super::format::TIME;
use super::lines::{Line, Lines, cells};
use super::number::{parse, parse_nanos};
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

/// The columns that are read, in the order of [`EstimateRow`].
const COLUMNS: [&str; 5] = [TIME, "roll_deg", "pitch_deg", "roll_sigma_deg", "pitch_sigma_deg"];

/// What a row says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EstimateRow {
    /// The row's time, ns.
    pub nanos: u64,
    /// Roll, pitch and their standard deviations, °; `None` for an empty cell, or one that holds no
    /// finite number.
    pub values_deg: [Option<f64>; 4],
}

/// A file of estimates, row by row in rising time. Rows that cannot be used are passed over.
#[derive(Debug)]
pub struct Estimates<R> {
    lines: Lines<R>,
    file: String,
    /// Which of [`COLUMNS`] each column is.
    columns: Vec<Option<usize>>,
    last: Option<u64>,
}

impl Estimates<BufReader<File>> {
    /// Opens the file at `path`.
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        let file = path.display().to_string();
        match File::open(path) {
            Ok(f) => Self::new(BufReader::with_capacity(64 * 1024, f), file),
            Err(source) => Err(ReadError::Open { file, source }),
        }
    }
}

impl<R: BufRead> Estimates<R> {
    /// Reads the header of `input`; errors call it `file`.
    pub fn new(input: R, file: String) -> Result<Self, ReadError> {
        let mut lines = Lines::new(input);
        let text = loop {
            let ended =
                lines.advance().map_err(|source| ReadError::Io { file: file.clone(), line: lines.number, source })?;
            match (ended, lines.text()) {
                (Line::End, _) => return Err(ReadError::Empty { file }),
                (Line::TooLong, _) | (_, None) => return Err(ReadError::NotText { file, line: lines.number }),
                (_, Some(text)) if text.is_empty() || text.starts_with('#') => {}
                (_, Some(text)) => break text,
            }
        };
        let place = |cell: &[u8]| COLUMNS.iter().position(|c| c.as_bytes() == cell);
        let columns: Vec<Option<usize>> = cells(text.as_bytes()).map(place).collect();
        let line = lines.number;
        if !columns.contains(&Some(0)) {
            return Err(ReadError::no_time(file, line, text.to_owned()));
        }
        if let Some(column) = [1, 2].into_iter().find(|c| !columns.contains(&Some(*c))) {
            return Err(ReadError::NoEstimates { file, line, column: COLUMNS[column] });
        }
        Ok(Self { lines, file, columns, last: None })
    }

    /// The next row that can be used; `None` at the end.
    pub fn next_row(&mut self) -> Result<Option<EstimateRow>, ReadError> {
        loop {
            let ended = match self.lines.advance() {
                Ok(Line::End) => return Ok(None),
                Ok(ended) => ended,
                Err(source) => {
                    return Err(ReadError::Io { file: self.file.clone(), line: self.lines.number, source });
                }
            };
            if let Some(row) = self.row().filter(|r| ended != Line::TooLong && self.last.is_none_or(|t| r.nanos > t)) {
                self.last = Some(row.nanos);
                return Ok(Some(row));
            }
        }
    }

    fn row(&self) -> Option<EstimateRow> {
        let mut nanos = None;
        let mut values_deg = [None; 4];
        for (cell, column) in cells(self.lines.line()).zip(&self.columns) {
            match column {
                Some(0) => nanos = parse_nanos(cell),
                Some(i) => values_deg[i - 1] = parse(cell).filter(|v| v.is_finite()),
                None => {}
            }
        }
        Some(EstimateRow { nanos: nanos?, values_deg })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn open(text: &str) -> Result<Estimates<&[u8]>, ReadError> {
        Estimates::new(text.as_bytes(), "out.csv".into())
    }

    #[test]
    fn columns_are_found_by_name_and_bad_rows_passed_over() {
        let text = "\u{feff}mode,pitch_deg,time_s,roll_deg,roll_sigma_deg\n\
                    nominal,1,0.5,2,nan\n\nfaulted,,0.4,9,1\nx,y,z\nfaulted,,0.6,,\nnominal,3,inf,4,5\nnominal,7,0.7\n";
        let mut rows = open(text).unwrap();
        let mut all = Vec::new();
        while let Some(row) = rows.next_row().unwrap() {
            all.push((row.nanos, row.values_deg));
        }
        assert_eq!(
            all,
            [
                (500_000_000, [Some(2.0), Some(1.0), None, None]),
                (600_000_000, [None; 4]),
                (700_000_000, [None, Some(7.0), None, None])
            ]
        );
    }

    #[test]
    fn a_file_of_something_else_is_refused() {
        assert!(matches!(open(""), Err(ReadError::Empty { .. })));
        assert!(matches!(open("roll_deg,pitch_deg\n"), Err(ReadError::NoTime { .. })));
        assert!(matches!(open("time_s,roll_deg\n"), Err(ReadError::NoEstimates { column: "pitch_deg", .. })));
        let bytes = Estimates::new(&b"\x9f\x1b[2J\n1\n"[..], "out.csv".into());
        assert!(matches!(bytes, Err(ReadError::NotText { line: 1, .. })));
        assert!(matches!(open(&"x".repeat(1 << 20)), Err(ReadError::NotText { .. })));
    }
}
