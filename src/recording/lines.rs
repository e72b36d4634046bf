//! Lines of bounded length: a file without line ends cannot fill the memory.

use std::io::{BufRead, Read, Result};

/// The longest line that is read, bytes without its end.
pub const MAX_LINE: usize = 64 * 1024;

/// How a line ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Line {
    /// With a line end.
    Whole,
    /// With the end of the file.
    Cut,
    /// Past [`MAX_LINE`]; the rest of it has been skipped.
    TooLong,
    /// There is no further line.
    End,
}

/// A file line by line into one buffer.
#[derive(Debug)]
pub(super) struct Lines<R> {
    input: R,
    buffer: Vec<u8>,
    /// The number of the line read last, from 1.
    pub number: u64,
}

impl<R: BufRead> Lines<R> {
    pub fn new(input: R) -> Self {
        Self { input, buffer: Vec::with_capacity(1024), number: 0 }
    }

    /// Reads the next line; [`Self::line`] is it.
    pub fn advance(&mut self) -> Result<Line> {
        self.buffer.clear();
        // Two more bytes: the line end.
        let n = (&mut self.input).take(MAX_LINE as u64 + 2).read_until(b'\n', &mut self.buffer)?;
        if n == 0 {
            return Ok(Line::End);
        }
        self.number += 1;
        let mut ended = if self.buffer.ends_with(b"\n") { Line::Whole } else { Line::Cut };
        if ended == Line::Cut && n == MAX_LINE + 2 {
            self.skip()?;
            ended = Line::TooLong;
        }
        while matches!(self.buffer.last(), Some(b'\n' | b'\r')) {
            self.buffer.pop();
        }
        if self.buffer.len() > MAX_LINE {
            ended = Line::TooLong;
        }
        Ok(ended)
    }

    /// The line read last, without its end.
    pub fn line(&self) -> &[u8] {
        &self.buffer
    }

    /// It as text, without a mark before it and blanks around it; `None` where it is none.
    pub fn text(&self) -> Option<&str> {
        let text = std::str::from_utf8(self.line()).ok().filter(|t| !t.contains('\0'))?;
        Some(text.trim_start_matches('\u{feff}').trim())
    }

    /// Skips the rest of an over-long line.
    fn skip(&mut self) -> Result<()> {
        self.buffer.clear();
        while (&mut self.input).take(MAX_LINE as u64).read_until(b'\n', &mut self.buffer)? > 0 {
            if self.buffer.ends_with(b"\n") {
                break;
            }
            self.buffer.clear();
        }
        Ok(())
    }
}

/// A line's cells, without the blanks and quotes around them. A quoted cell may hold commas; a
/// quote that is never closed ends with the line.
pub(super) fn cells(line: &[u8]) -> Cells<'_> {
    Cells { rest: Some(line) }
}

/// See [`cells`].
pub(super) struct Cells<'a> {
    rest: Option<&'a [u8]>,
}

impl<'a> Iterator for Cells<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        let rest = self.rest?;
        let mut quoted = false;
        let comma = rest.iter().position(|&b| {
            quoted ^= b == b'"';
            b == b',' && !quoted
        });
        let (cell, rest) = match comma {
            Some(i) => (&rest[..i], Some(&rest[i + 1..])),
            None => (rest, None),
        };
        self.rest = rest;
        let cell = cell.trim_ascii();
        Some(cell.strip_prefix(b"\"").and_then(|c| c.strip_suffix(b"\"")).unwrap_or(cell).trim_ascii())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_as_they_do_everywhere() {
        let mut lines = Lines::new(&b"a\r\nb\n\nc"[..]);
        for (ended, text) in [(Line::Whole, "a"), (Line::Whole, "b"), (Line::Whole, ""), (Line::Cut, "c")] {
            assert_eq!(lines.advance().unwrap(), ended);
            assert_eq!(lines.line(), text.as_bytes());
        }
        assert_eq!(lines.advance().unwrap(), Line::End);
        assert_eq!(lines.number, 4);
    }

    #[test]
    fn a_line_without_end_takes_no_memory_and_the_next_is_read() {
        let mut long = vec![b'x'; 10 * MAX_LINE];
        long.extend_from_slice(b"\nnext\n");
        let mut lines = Lines::new(&long[..]);
        assert_eq!(lines.advance().unwrap(), Line::TooLong);
        assert_eq!(lines.advance().unwrap(), Line::Whole);
        assert_eq!(lines.line(), b"next");
        assert!(lines.buffer.capacity() <= 4 * MAX_LINE);
        let mut exact = vec![b'x'; MAX_LINE];
        exact.push(b'\n');
        assert_eq!(Lines::new(&exact[..]).advance().unwrap(), Line::Whole);
        assert_eq!(Lines::new(&[b'x'; MAX_LINE + 1][..]).advance().unwrap(), Line::TooLong);
    }

    #[test]
    fn cells_lose_blanks_and_quotes() {
        let got: Vec<_> = cells(b" 1 ,\"2\",\"a, b\",,\"open, 3").collect();
        assert_eq!(got, [&b"1"[..], b"2", b"a, b", b"", b"\"open, 3"]);
        assert_eq!(cells(b"").count(), 1);
    }
}
