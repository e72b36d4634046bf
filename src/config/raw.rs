//! A file's TOML as it was parsed, every key and value with its place.

use super::source::{Place, Source, quoted};
use std::collections::BTreeMap;
use toml::de::{DeTable, DeValue, Error};

/// Keys with their values.
pub type Table = BTreeMap<String, Entry>;

/// A key's place and its value.
#[derive(Clone, Debug)]
pub struct Entry {
    /// Where the key stands.
    pub key: Place,
    /// What it is set to.
    pub node: Node,
}

/// A value and its place; a table's place is its header.
#[derive(Clone, Debug)]
pub struct Node {
    /// Where it stands.
    pub place: Place,
    /// What it is.
    pub value: Value,
}

/// A TOML value.
#[derive(Clone, Debug)]
pub enum Value {
    /// A string.
    String(String),
    /// An integer; `None` beyond 64 bits.
    Integer(Option<i64>),
    /// A number with a point or an exponent, `nan` or `inf`.
    Float(f64),
    /// `true` or `false`.
    Boolean(bool),
    /// A date or a time, for which there is no use here.
    Date,
    /// `[…]`, or the tables under a `[[header]]`.
    Array(Vec<Node>),
    /// `{…}`, or the keys under a `[header]`.
    Table(Table),
}

impl Value {
    /// What it is, in words, with its article.
    pub const fn what(&self) -> &'static str {
        match self {
            Self::String(_) => "a string",
            Self::Integer(_) => "an integer",
            Self::Float(_) => "a number with a point",
            Self::Boolean(_) => "true or false",
            Self::Date => "a date",
            Self::Array(_) => "an array",
            Self::Table(_) => "a table",
        }
    }
}

/// The place of the value at the end of `path`.
pub fn place(table: &Table, path: &[&str]) -> Option<Place> {
    let (key, rest) = path.split_first()?;
    let node = &table.get(*key)?.node;
    match &node.value {
        Value::Table(table) if !rest.is_empty() => place(table, rest),
        _ => rest.is_empty().then_some(node.place),
    }
}

/// Parses source number `file`; syntax errors go to `found`, the first of each line.
pub fn parse(source: &Source, file: usize, found: &mut Vec<(Place, String)>) -> Table {
    if let Some(start) = source.text.find('\0') {
        found.push((Place { file, start, end: start + 1 }, "this is not a text file: it holds a NUL byte".into()));
        return Table::new();
    }
    let (table, errors) = DeTable::parse_recoverable(&source.text);
    if errors.is_empty() {
        return convert_table(table.get_ref(), file);
    }
    let mut errors: Vec<(Place, String)> = errors.iter().map(|e| translate(source, file, e)).collect();
    errors.sort_by_key(|(place, _)| *place);
    let mut end_of_line = None;
    for (place, message) in errors {
        if end_of_line.is_none_or(|end| place.start > end) {
            let rest = source.text.get(place.start..).unwrap_or_default();
            end_of_line = Some(rest.find('\n').map_or(source.text.len(), |i| place.start + i));
            found.push((place, message));
        }
    }
    Table::new()
}

fn translate(source: &Source, file: usize, error: &Error) -> (Place, String) {
    let span = error.span().unwrap_or_default();
    let place = Place { file, start: span.start, end: span.end };
    let text = source.at(place);
    let message = error.message();
    let message = if message.starts_with("string values must be quoted") && text.is_empty() {
        "a value is missing after the =".into()
    } else if message.starts_with("cannot recurse") {
        "tables or arrays are nested too deep".into()
    } else if message == "duplicate key" {
        format!("{} is set twice in this file", quoted(text))
    } else if message.starts_with("invalid basic string") || message.starts_with("invalid literal string") {
        "the string's closing quote is missing".into()
    } else if message.starts_with("unexpected key or value") {
        "only a comment may follow here".into()
    } else if message.starts_with("string values must be quoted") && text.starts_with(|c: char| c.is_ascii_digit()) {
        format!("{} is not a value: a number stands alone, a string in quotes", quoted(text))
    } else if is_bare_value(text) {
        format!("{0} is not a value: a string needs quotes (\"{0}\")", quoted(text))
    } else {
        format!("not valid TOML: {message}")
    };
    (place, message)
}

/// Whether `text` looks like a string that lacks its quotes, rather than a number gone wrong.
fn is_bare_value(text: &str) -> bool {
    text.starts_with(|c: char| c.is_alphabetic() || c == '/') && !text.contains(['"', '\'', '\n', '='])
}

fn convert_table(table: &DeTable<'_>, file: usize) -> Table {
    table
        .iter()
        .map(|(key, value)| {
            let span = key.span();
            let place = Place { file, start: span.start, end: span.end };
            let node = convert(value.get_ref(), value.span(), file);
            (key.get_ref().to_string(), Entry { key: place, node })
        })
        .collect()
}

fn convert(value: &DeValue<'_>, span: std::ops::Range<usize>, file: usize) -> Node {
    let value = match value {
        DeValue::String(s) => Value::String(s.to_string()),
        DeValue::Integer(i) => Value::Integer(i64::from_str_radix(i.as_str(), i.radix()).ok()),
        DeValue::Float(f) => Value::Float(f.as_str().parse().unwrap_or(f64::NAN)),
        DeValue::Boolean(b) => Value::Boolean(*b),
        DeValue::Datetime(_) => Value::Date,
        DeValue::Array(a) => Value::Array(a.iter().map(|v| convert(v.get_ref(), v.span(), file)).collect()),
        DeValue::Table(t) => Value::Table(convert_table(t, file)),
    };
    Node { place: Place { file, start: span.start, end: span.end }, value }
}
