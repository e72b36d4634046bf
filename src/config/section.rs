//! Reads typed values out of a table and notes everything that is wrong with it.

use super::findings::{Findings, Unknown};
use super::nearest::nearest;
use super::raw::{Node, Table, Value};
use super::source::{Place, quoted};
use std::path::PathBuf;

/// A table that is being read. Every key must be asked for; [`Section::finish`] reports the others.
///
/// A value that is wrong is noted and replaced by its default, so that reading goes on and finds
/// everything; the settings are thrown away in the end.
pub struct Section<'a> {
    findings: &'a Findings<'a>,
    table: Option<&'a Table>,
    place: Place,
    /// The header that a key of this section belongs under, for advice.
    home: String,
    /// What is written before a key of this section.
    prefix: String,
    asked: Vec<&'static str>,
}

impl<'a> Section<'a> {
    /// Reads `table`, whose header is at `place`.
    pub fn new(findings: &'a Findings<'a>, table: &'a Table, place: Place, home: &str, prefix: String) -> Self {
        Self { findings, table: Some(table), place, home: home.into(), prefix, asked: Vec::new() }
    }

    /// The place of `key`'s value, or of the section's header.
    pub fn place(&self, key: &str) -> Place {
        self.get(key).map_or(self.place, |n| n.place)
    }

    /// Whether there is a table to read at all.
    pub fn is_table(&self) -> bool {
        self.table.is_some()
    }

    /// Whether `key` is there.
    pub fn has(&self, key: &str) -> bool {
        self.get(key).is_some()
    }

    /// Whether `key` holds a table.
    pub fn holds_table(&self, key: &str) -> bool {
        self.get(key).is_some_and(|n| matches!(n.value, Value::Table(_)))
    }

    /// Leaves `keys` unread without complaint.
    pub fn skip(&mut self, keys: &[&'static str]) {
        self.asked.extend(keys);
    }

    /// Notes that `key` is wrong: its path, its value as written, `problem`.
    pub fn wrong(&self, key: &str, problem: &str) {
        let Some(node) = self.get(key) else {
            self.findings.add(self.place, format!("{}{key} {problem}", self.prefix));
            return;
        };
        let written = match (&node.value, self.findings.source(node.place)) {
            (Value::Table(_) | Value::Array(_), _) | (_, None) => String::new(),
            (_, Some(source)) => format!(" = {}", quoted(source.at(node.place))),
        };
        self.findings.add(node.place, format!("{}{key}{written} {problem}", self.prefix));
    }

    fn get(&self, key: &str) -> Option<&'a Node> {
        self.table?.get(key).map(|e| &e.node)
    }

    fn ask(&mut self, key: &'static str) -> Option<&'a Node> {
        self.asked.push(key);
        self.get(key)
    }

    fn wrong_kind(&self, key: &str, node: &Node, expected: &str) {
        let hint = match &node.value {
            Value::String(s) if looks_bare(s) && !expected.contains("string") => ": leave the quotes out",
            _ => "",
        };
        self.wrong(key, &format!("is {}, expected {expected}{hint}", node.value.what()));
    }

    /// Notes that `key` is missing; `expected` says what it would hold.
    pub fn missing(&self, key: &str, expected: &str) {
        self.wrong(key, &format!("is missing: {expected}"));
    }

    /// A number for which `fits` holds; `expected` says which those are.
    pub fn number(&mut self, key: &'static str, expected: &str, fits: impl Fn(f64) -> bool) -> Option<f64> {
        let node = self.ask(key)?;
        let number = match node.value {
            Value::Integer(i) => i.map(|i| i as f64),
            Value::Float(f) => Some(f),
            _ => {
                self.wrong_kind(key, node, &format!("a number ({expected})"));
                return None;
            }
        };
        match number {
            Some(n) if !n.is_finite() => self.wrong(key, &format!("is not a finite number: {expected}")),
            Some(n) if fits(n) => return Some(n),
            _ => self.wrong(key, &format!("is out of range: {expected}")),
        }
        None
    }

    /// A number from `low` to `high`; `unit` as it follows a number, with its space.
    pub fn range(&mut self, key: &'static str, low: f64, high: f64, unit: &str) -> Option<f64> {
        self.number(key, &format!("{low} to {high}{unit}"), |n| (low..=high).contains(&n))
    }

    /// A whole number from `low` to `high`; `expected` says so.
    pub fn integer(&mut self, key: &'static str, low: i64, high: i64, expected: &str) -> Option<i64> {
        let node = self.ask(key)?;
        match node.value {
            Value::Integer(Some(i)) if (low..=high).contains(&i) => return Some(i),
            Value::Integer(_) => self.wrong(key, &format!("is out of range: {expected}")),
            _ => self.wrong_kind(key, node, &format!("a whole number ({expected})")),
        }
        None
    }

    /// A whole number from `low` to `high`, or `"auto"`, which is `None`; `expected` says the range.
    pub fn integer_or_auto(&mut self, key: &'static str, low: i64, high: i64, expected: &str) -> Option<i64> {
        let expected = format!("{expected}, or \"auto\"");
        if self.get(key).is_some_and(|n| matches!(&n.value, Value::String(s) if s == "auto")) {
            self.asked.push(key);
            return None;
        }
        self.integer(key, low, high, &expected)
    }

    /// A file's absolute path; `expected` says what the file holds.
    pub fn path(&mut self, key: &'static str, expected: &str) -> Option<PathBuf> {
        let path = PathBuf::from(self.string(key, expected)?);
        if path.is_absolute() {
            return Some(path);
        }
        self.wrong(key, &format!("is not an absolute path: {expected}"));
        None
    }

    /// `true` or `false`.
    pub fn boolean(&mut self, key: &'static str) -> Option<bool> {
        let node = self.ask(key)?;
        match node.value {
            Value::Boolean(b) => return Some(b),
            _ => self.wrong_kind(key, node, "true or false"),
        }
        None
    }

    /// A string that is not empty; `expected` says what it holds.
    pub fn string(&mut self, key: &'static str, expected: &str) -> Option<&'a str> {
        let node = self.ask(key)?;
        match &node.value {
            Value::String(s) if s.is_empty() => self.wrong(key, &format!("is empty: {expected}")),
            Value::String(s) if s.chars().any(char::is_control) => {
                self.wrong(key, &format!("has a control character in it: {expected}"));
            }
            Value::String(s) => return Some(s),
            _ => self.wrong_kind(key, node, &format!("a string ({expected})")),
        }
        None
    }

    /// Strings with their places, none when the key is not there; `expected` says what they are.
    pub fn strings(&mut self, key: &'static str, expected: &str) -> Vec<(Place, &'a str)> {
        let Some(node) = self.ask(key) else { return Vec::new() };
        let Value::Array(nodes) = &node.value else {
            self.wrong_kind(key, node, &format!("an array of strings ({expected})"));
            return Vec::new();
        };
        let string = |n: &'a Node| match &n.value {
            Value::String(s) => Some((n.place, s.as_str())),
            other => {
                let what = other.what();
                self.findings.add(n.place, format!("{}{key} holds {what}, expected strings: {expected}", self.prefix));
                None
            }
        };
        nodes.iter().filter_map(string).collect()
    }

    /// One of `choices` by its name. A name among `later` is a good one of which this version knows
    /// nothing.
    pub fn choice<T: Copy>(&mut self, key: &'static str, choices: &[(&str, T)]) -> Option<T> {
        let names: Vec<String> = choices.iter().map(|(n, _)| format!("\"{n}\"")).collect();
        let there_is = match names.as_slice() {
            [only] => only.clone(),
            [first @ .., last] => format!("{} or {last}", first.join(", ")),
            [] => String::new(),
        };
        let word = self.string(key, &there_is)?;
        if let Some((_, value)) = choices.iter().find(|(n, _)| *n == word) {
            return Some(*value);
        }
        if let (true, Some(near)) = (choices.len() > 2, nearest(word, choices.iter().map(|(n, _)| *n))) {
            self.wrong(key, &format!("is not known; did you mean \"{near}\"? ({there_is})"));
        } else {
            self.wrong(key, &format!("is not known: {there_is}"));
        }
        None
    }

    /// The table under `key`, empty when it is not there. `home` is its header.
    pub fn section(&mut self, key: &'static str, home: &str, prefix: &str) -> Section<'a> {
        let mut section = Section {
            findings: self.findings,
            table: None,
            place: self.place(key),
            home: home.into(),
            prefix: format!("{}{prefix}", self.prefix),
            asked: Vec::new(),
        };
        match self.ask(key).map(|n| (n, &n.value)) {
            None => {}
            Some((_, Value::Table(table))) => section.table = Some(table),
            Some((_, Value::Array(_))) if home.starts_with('[') => {
                self.wrong(key, &format!("needs single brackets: {home}, for there is only one"));
            }
            Some((node, _)) => self.wrong_kind(key, node, &format!("a table: {home}")),
        }
        section
    }

    /// The tables under `key`, with their places. `home` is their header.
    pub fn list(&mut self, key: &'static str, home: &str) -> Vec<(Place, &'a Table)> {
        match self.ask(key).map(|n| (n, &n.value)) {
            None => {}
            Some((_, Value::Array(nodes))) => {
                let tables = nodes.iter().filter_map(|n| match &n.value {
                    Value::Table(table) => Some((n.place, table)),
                    _ => {
                        let what = n.value.what();
                        self.findings.add(n.place, format!("{}{key} holds {what}, expected {home}", self.prefix));
                        None
                    }
                });
                return tables.collect();
            }
            Some((_, Value::Table(_))) => {
                self.wrong(key, &format!("needs double brackets: {home}, and one for each"));
            }
            Some((node, _)) => self.wrong_kind(key, node, &format!("tables: a {home} for each")),
        }
        Vec::new()
    }

    /// Reports those of `keys` that are there, though they belong elsewhere: `why`.
    pub fn foreign(&mut self, keys: &[&'static str], why: &str) {
        for key in keys.iter().filter(|k| self.has(k)).copied().collect::<Vec<_>>() {
            self.asked.push(key);
            self.wrong(key, why);
        }
    }

    /// Reports every key that was not asked for.
    pub fn finish(self) {
        self.findings.belong(&self.home, &self.asked);
        let Some(table) = self.table else { return };
        for (key, entry) in table.iter().filter(|(k, _)| !self.asked.contains(&k.as_str())) {
            let is_section = self.home.is_empty() && matches!(entry.node.value, Value::Table(_) | Value::Array(_));
            self.findings.add_unknown(Unknown {
                place: entry.key,
                what: if is_section { "section" } else { "key" },
                prefix: self.prefix.clone(),
                key: key.clone(),
                known: self.asked.clone(),
            });
        }
    }
}

/// Whether the string holds what TOML would read as a number or a truth value without its quotes.
fn looks_bare(s: &str) -> bool {
    let hex = s.strip_prefix("0x").is_some_and(|h| u32::from_str_radix(h, 16).is_ok());
    hex || s.parse::<f64>().is_ok() || s == "true" || s == "false"
}
