//! The text of configuration files, and places in it.

use std::path::PathBuf;

/// A configuration file's name and text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    /// The file, as errors name it.
    pub name: PathBuf,
    /// All of it.
    pub text: String,
}

/// A stretch of a file: bytes `start..end` of source `file`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Place {
    /// Which of the sources.
    pub file: usize,
    /// Its first byte.
    pub start: usize,
    /// The byte after its last.
    pub end: usize,
}

impl Place {
    /// All of source `file`, when no line of it is to blame.
    pub const fn whole(file: usize) -> Self {
        Self { file, start: usize::MAX, end: usize::MAX }
    }
}

/// A line of a file with a stretch of it marked.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Excerpt {
    /// The line, 1 for the first.
    pub line: usize,
    /// The character where the stretch begins, 1 for the first.
    pub column: usize,
    /// What is shown of the line: printable characters only.
    pub shown: String,
    /// Characters shown before the stretch.
    pub before: usize,
    /// Characters of the stretch, at least 1.
    pub marked: usize,
}

/// The longest piece of a line that is shown, characters.
const WIDTH: usize = 100;

impl Source {
    /// The text at `place`, empty when it is none.
    pub fn at(&self, place: Place) -> &str {
        self.text.get(place.start..place.end).unwrap_or_default()
    }

    /// The line of the byte at `offset`, 1 for the first.
    pub fn line(&self, offset: usize) -> usize {
        self.text.as_bytes().iter().take(offset).filter(|b| **b == b'\n').count() + 1
    }

    /// The line at `place`, or the part of a long one that lies around it.
    pub fn excerpt(&self, place: Place) -> Excerpt {
        let mut start = place.start.min(self.text.len());
        while !self.text.is_char_boundary(start) {
            start -= 1;
        }
        let (head, tail) = self.text.split_at(start);
        let line_start = head.rfind('\n').map_or(0, |i| i + 1);
        let left = head[line_start..].trim_start_matches('\u{feff}');
        let right = tail.split('\n').next().unwrap_or_default();
        let column = left.chars().count() + 1;

        let cut_left = column.saturating_sub(1 + WIDTH / 2);
        let mut shown: String = if cut_left > 0 { "…".into() } else { String::new() };
        shown.extend(left.chars().skip(cut_left).map(printable));
        let before = shown.chars().count();
        let right = right.trim_end_matches('\r');
        let room = WIDTH.saturating_sub(before);
        shown.extend(right.chars().take(room).map(printable));
        if right.chars().nth(room).is_some() {
            shown.push('…');
        }
        let length = tail.get(..place.end.saturating_sub(start)).unwrap_or_default();
        let marked = length.split('\n').next().unwrap_or_default().trim_end().chars().take(room).count().max(1);
        Excerpt { line: self.line(start), column, shown, before, marked }
    }
}

/// The character, or a stand-in that cannot move the cursor or hide what follows.
pub fn printable(c: char) -> char {
    match c {
        '\t' => ' ',
        '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{2069}' | '\u{feff}' => '\u{fffd}',
        c if c.is_control() => '\u{fffd}',
        c => c,
    }
}

/// Foreign text on one line of an error: printable, and not long.
pub fn quoted(text: &str) -> String {
    let mut shown: String = text.trim().chars().take(60).map(printable).collect();
    if text.trim().chars().nth(60).is_some() {
        shown.push('…');
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(text: &str) -> Source {
        Source { name: "a.toml".into(), text: text.into() }
    }

    #[test]
    fn columns_count_characters_from_one() {
        let s = source("a = 1\n# °\nbé = \"x\"\r\nc");
        let at = s.text.find('"').unwrap();
        let e = s.excerpt(Place { file: 0, start: at, end: at + 3 });
        assert_eq!((e.line, e.column, e.before, e.marked), (3, 6, 5, 3));
        assert_eq!(e.shown, "bé = \"x\"");
    }

    #[test]
    fn a_byte_order_mark_does_not_count() {
        let s = source("\u{feff}a = 1");
        let e = s.excerpt(Place { file: 0, start: 3, end: 4 });
        assert_eq!((e.line, e.column, e.shown.as_str()), (1, 1, "a = 1"));
    }

    #[test]
    fn places_outside_the_text_are_harmless() {
        let s = source("é");
        for (start, end) in [(0, 99), (1, 1), (99, 3), (2, 2)] {
            let e = s.excerpt(Place { file: 0, start, end });
            assert_eq!((e.line, e.marked), (1, 1));
        }
    }

    #[test]
    fn long_lines_are_cut_around_the_place_and_control_characters_are_not_shown() {
        let s = source(&format!("{}\u{1b}[31mX{}", "a".repeat(5000), "b".repeat(5000)));
        let at = s.text.find('X').unwrap();
        let e = s.excerpt(Place { file: 0, start: at, end: at + 1 });
        assert_eq!(e.column, 5006);
        assert!(e.shown.chars().count() <= WIDTH + 2, "{}", e.shown);
        assert_eq!(e.shown.chars().nth(e.before), Some('X'));
        assert!(!e.shown.contains('\u{1b}'));
    }
}
