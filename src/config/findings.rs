//! What is wrong with a configuration, and what was probably meant.

use super::nearest::nearest;
use super::source::{Place, Source, quoted};
use std::cell::RefCell;

/// What has been found wrong so far, and which keys exist where.
pub struct Findings<'a> {
    sources: &'a [Source],
    found: RefCell<Vec<(Place, String)>>,
    unknown: RefCell<Vec<Unknown>>,
    homes: RefCell<Vec<(String, &'static str)>>,
}

/// A key that nobody asked for.
pub struct Unknown {
    /// Where it is.
    pub place: Place,
    /// What is written before it.
    pub prefix: String,
    /// Its name.
    pub key: String,
    /// What it is: a key, or a section.
    pub what: &'static str,
    /// Those that there are.
    pub known: Vec<&'static str>,
}

impl<'a> Findings<'a> {
    /// Nothing yet.
    pub fn new(sources: &'a [Source]) -> Self {
        Self { sources, found: RefCell::default(), unknown: RefCell::default(), homes: RefCell::default() }
    }

    /// Notes that something is wrong at `place`.
    pub fn add(&self, place: Place, message: impl Into<String>) {
        self.found.borrow_mut().push((place, message.into()));
    }

    /// Notes a key that nobody asked for.
    pub fn add_unknown(&self, unknown: Unknown) {
        self.unknown.borrow_mut().push(unknown);
    }

    /// Notes which `keys` belong under the header `home`.
    pub fn belong(&self, home: &str, keys: &[&'static str]) {
        self.homes.borrow_mut().extend(keys.iter().map(|k| (home.to_owned(), *k)));
    }

    /// The file that `place` is in.
    pub fn source(&self, place: Place) -> Option<&'a Source> {
        self.sources.get(place.file)
    }

    /// How much is wrong.
    pub fn count(&self) -> usize {
        self.found.borrow().len()
    }

    /// Everything that was found, the unknown keys with where they belong.
    pub fn finish(self) -> Vec<(Place, String)> {
        let mut found = self.found.into_inner();
        let homes = self.homes.into_inner();
        for Unknown { place, prefix, key, what, known } in self.unknown.into_inner() {
            let mut belongs: Vec<&str> =
                homes.iter().filter(|(h, k)| *k == key && !h.is_empty()).map(|(h, _)| h.as_str()).collect();
            belongs.sort_unstable();
            belongs.dedup();
            let spelled = |k: &str| match (what, k) {
                ("section", "sensor") => "[[sensor]]".to_owned(),
                ("section", k) => format!("[{k}]"),
                (_, k) => k.to_owned(),
            };
            let advice = match nearest(&key, known.iter().copied()) {
                _ if !belongs.is_empty() => format!("it belongs in {}", belongs.join(" or ")),
                Some(near) => format!("did you mean {}?", spelled(near)),
                None => format!("there are {}", known.iter().map(|k| spelled(k)).collect::<Vec<_>>().join(", ")),
            };
            let key = spelled(&quoted(&key));
            found.push((place, format!("{prefix}{key} is not a known {what}; {advice}")));
        }
        found
    }

    /// `line 7`, with the file's name when it is not the one `seen_from` is in.
    pub fn line(&self, place: Place, seen_from: Place) -> String {
        let Some(source) = self.source(place) else { return "elsewhere".into() };
        let line = source.line(place.start);
        if place.file == seen_from.file { format!("line {line}") } else { format!("{}:{line}", source.name.display()) }
    }
}
