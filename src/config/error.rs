//! What is wrong with a configuration, as the user reads it.

use super::source::{Excerpt, Place, Source};
use std::fmt;
use std::path::PathBuf;

/// As many errors as are listed; the rest are counted.
const LISTED: usize = 100;

/// One thing that is wrong.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ConfigError {
    /// The file it is in.
    pub file: PathBuf,
    /// Which key, what was found and what was expected.
    pub message: String,
    excerpt: Option<Excerpt>,
}

impl ConfigError {
    /// An error about a file as a whole.
    pub(super) fn whole(file: impl Into<PathBuf>, message: impl Into<String>) -> Self {
        Self { file: file.into(), message: message.into(), excerpt: None }
    }

    /// An error at a place of `source`.
    pub(super) fn at(source: &Source, place: Place, message: impl Into<String>) -> Self {
        Self { file: source.name.clone(), message: message.into(), excerpt: Some(source.excerpt(place)) }
    }

    /// The line, 1 for the first; `None` for an error about the file as a whole.
    pub fn line(&self) -> Option<usize> {
        self.excerpt.as_ref().map(|e| e.line)
    }

    /// The column, 1 for the first.
    pub fn column(&self) -> Option<usize> {
        self.excerpt.as_ref().map(|e| e.column)
    }
}

impl fmt::Display for ConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let file = self.file.display();
        let Some(e) = &self.excerpt else {
            return write!(f, "{file}: {}", self.message);
        };
        writeln!(f, "{file}:{}:{}: {}", e.line, e.column, self.message)?;
        writeln!(f, "{:>4} | {}", e.line, e.shown)?;
        let gutter = e.line.to_string().len().max(4);
        write!(f, "{:gutter$} | {:before$}{:^<marked$}", "", "", "", before = e.before, marked = e.marked)
    }
}

/// Everything that is wrong, by file and line. Displays all of it, over many lines.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ConfigErrors {
    /// The first hundred.
    pub errors: Vec<ConfigError>,
    /// How many more there are.
    pub more: usize,
}

impl fmt::Display for ConfigErrors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, error) in self.errors.iter().enumerate() {
            let separator = if i > 0 { "\n" } else { "" };
            write!(f, "{separator}{error}")?;
        }
        match self.more {
            0 => Ok(()),
            n => write!(f, "\nand {n} more"),
        }
    }
}

impl std::error::Error for ConfigErrors {}

impl From<ConfigError> for ConfigErrors {
    fn from(error: ConfigError) -> Self {
        Self { errors: vec![error], more: 0 }
    }
}

/// Sorts what was found by file and line and gives each its excerpt; `Ok` when nothing was.
pub(super) fn check(mut found: Vec<(Place, String)>, sources: &[Source]) -> Result<(), ConfigErrors> {
    if found.is_empty() {
        return Ok(());
    }
    found.sort_by_key(|(place, _)| *place);
    let more = found.len().saturating_sub(LISTED);
    let errors = found
        .into_iter()
        .take(LISTED)
        .map(|(place, message)| match sources.get(place.file) {
            Some(source) if place != Place::whole(place.file) => ConfigError::at(source, place, message),
            Some(source) => ConfigError::whole(&source.name, message),
            None => ConfigError::whole("configuration", message),
        })
        .collect();
    Err(ConfigErrors { errors, more })
}
