//! What could not be used of a recording, counted, with the line where each was first met.

use std::fmt;

/// Why a row could not be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RowFault {
    /// Its time is absent or no number of seconds.
    NoTime,
    /// Its time is before 0.
    Negative,
    /// Its time is not after the row's before.
    Backwards,
    /// Its time lies ahead, and the next row's does not bear it out.
    Ahead,
    /// It has more or fewer cells than the header.
    Ragged,
    /// The file ends within it.
    Truncated,
    /// It is longer than any row can be.
    TooLong,
}

impl RowFault {
    const ALL: [(Self, &'static str); 7] = [
        (Self::NoTime, "without time"),
        (Self::Negative, "with a time below 0"),
        (Self::Backwards, "not after the row before"),
        (Self::Ahead, "alone in the future"),
        (Self::Ragged, "with too many or too few cells"),
        (Self::Truncated, "truncated"),
        (Self::TooLong, "too long"),
    ];
}

/// How many rows there were, and how many of them gave no frame.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Rows met, blank lines and comments not among them.
    pub rows: u64,
    /// Cells of known columns that held no usable number.
    pub cells: u64,
    /// Rows that gave a frame more than 10 s after the one before.
    pub wide: u64,
    /// Rows whose temperatures are all above 150 °C.
    pub hot: u64,
    /// How often the clock was set back, and the line from which that was first believed.
    set_back: (u64, u64),
    faults: [(u64, u64); RowFault::ALL.len()],
}

impl Tally {
    /// How many rows had `fault`.
    pub fn count(&self, fault: RowFault) -> u64 {
        self.faults[fault as usize].0
    }

    /// How many rows gave no frame.
    pub fn unusable(&self) -> u64 {
        self.faults.iter().map(|(n, _)| n).sum()
    }

    /// Whether everything could be used.
    pub fn is_clean(&self) -> bool {
        self.cells == 0 && self.unusable() == 0
    }

    /// Whether most rows are as those of a time in another unit: milliseconds step too wide, microseconds lie in the
    /// future, and such a time of day is beyond any number of seconds.
    pub fn is_other_unit(&self) -> bool {
        let odd = self.wide + self.count(RowFault::Ahead) + self.count(RowFault::NoTime);
        2 * odd > self.rows
    }

    /// Whether in most rows nothing is seen but what is hotter than any sky and ground: kelvin are.
    pub fn is_in_kelvin(&self) -> bool {
        2 * self.hot > self.rows
    }

    pub(super) fn set_back(&mut self, line: u64) {
        let (count, first) = &mut self.set_back;
        if *count == 0 {
            *first = line;
        }
        *count += 1;
    }

    pub(super) fn add(&mut self, fault: RowFault, line: u64) {
        let (count, first) = &mut self.faults[fault as usize];
        if *count == 0 {
            *first = line;
        }
        *count += 1;
    }
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let unusable = self.unusable();
        match unusable {
            0 => write!(f, "all {} rows were usable", self.rows)?,
            1 => write!(f, "1 of {} rows was unusable: ", self.rows)?,
            n => write!(f, "{n} of {} rows were unusable: ", self.rows)?,
        }
        let met = RowFault::ALL.iter().filter(|(fault, _)| self.count(*fault) > 0);
        for (i, (fault, words)) in met.enumerate() {
            let (count, first) = self.faults[*fault as usize];
            write!(f, "{}{count} {words} (", if i > 0 { ", " } else { "" })?;
            write!(f, "{}line {first})", if count > 1 { "first at " } else { "" })?;
        }
        match self.cells {
            0 => {}
            1 => write!(f, "; 1 cell held no usable number")?,
            n => write!(f, "; {n} cells held no usable number")?,
        }
        let begins = "the attitude begins anew there, with times that go on rising";
        match self.set_back {
            (0, _) => Ok(()),
            (1, line) => write!(f, "; the clock was set back (line {line}): {begins}"),
            (n, line) => write!(f, "; the clock was set back {n} times (first at line {line}): {begins}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_words_stand_where_their_faults_do() {
        for (i, (fault, _)) in RowFault::ALL.iter().enumerate() {
            assert_eq!(*fault as usize, i);
        }
    }

    #[test]
    fn it_says_how_many_of_how_many_and_where() {
        let mut t = Tally { rows: 180_000, ..Tally::default() };
        assert_eq!(t.to_string(), "all 180000 rows were usable");
        t.add(RowFault::NoTime, 7);
        t.add(RowFault::NoTime, 9);
        t.add(RowFault::Truncated, 180_001);
        t.cells = 1;
        assert_eq!(
            t.to_string(),
            "3 of 180000 rows were unusable: 2 without time (first at line 7), 1 truncated (line 180001); \
             1 cell held no usable number"
        );
    }
}
