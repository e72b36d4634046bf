//! Findings as people and programs read them.

use super::finding::{Finding, Verdict};
use crate::ctl::error::CtlError;
use crate::ctl::run;
use serde::Serialize;
use std::fmt::Write as _;

/// The width that evidence is broken at.
const WIDTH: usize = 100;
/// Where they begin.
const INDENT: usize = 6;

/// A paragraph for each finding, and the sum of them.
pub fn plain(found: &[Finding]) -> String {
    let mut text = String::new();
    let mut found_left = found;
    while let Some((f, rest)) = found_left.split_first() {
        // What was left out for one reason is said once.
        let alike = |o: &&Finding| f.verdict == Verdict::Skipped && o.on.is_empty() && o.evidence == f.evidence;
        let more = if f.on.is_empty() { rest.iter().take_while(alike).count() } else { 0 };
        let (also, rest) = rest.split_at(more);
        found_left = rest;
        let checks: Vec<&str> = std::iter::once(f).chain(also).map(|f| f.check.as_str()).collect();
        let on = if f.on.is_empty() { String::new() } else { format!(" {}", f.on) };
        let line = format!("{}{on}: {}", checks.join(", "), f.evidence);
        wrap(&mut text, &format!("{:<INDENT$}", word(f.verdict)), &line);
        if let Some(next) = &f.next {
            // Never broken: it may be a command to be copied.
            let _ = writeln!(text, "{:INDENT$}→ {next}", "");
        }
    }
    let [ok, warnings, failures, skipped] = counts(found);
    let plural = |n: usize, one: &str| if n == 1 { format!("1 {one}") } else { format!("{n} {one}s") };
    let _ = writeln!(
        text,
        "\n{}, {}, {ok} ok, {skipped} skipped",
        plural(failures, "failure"),
        plural(warnings, "warning")
    );
    text
}

fn word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Ok => "ok",
        Verdict::Warn => "warn",
        Verdict::Fail => "FAIL",
        Verdict::Skipped => "-",
    }
}

/// How many of each verdict.
fn counts(found: &[Finding]) -> [usize; 4] {
    [Verdict::Ok, Verdict::Warn, Verdict::Fail, Verdict::Skipped]
        .map(|v| found.iter().filter(|f| f.verdict == v).count())
}

/// Writes `line` after `start`, broken between words, all further lines as far in as the first one's text.
fn wrap(text: &mut String, start: &str, line: &str) {
    let indent = start.chars().count();
    text.push_str(start);
    let mut column = indent;
    for (i, word) in line.split(' ').enumerate() {
        let length = word.chars().count();
        if i > 0 && column + 1 + length > WIDTH {
            let _ = write!(text, "\n{:indent$}", "");
            column = indent;
        } else if i > 0 {
            text.push(' ');
            column += 1;
        }
        text.push_str(word);
        column += length;
    }
    text.push('\n');
}

#[derive(Serialize)]
struct Report<'a> {
    failures: usize,
    warnings: usize,
    ok: usize,
    skipped: usize,
    findings: &'a [Finding],
}

/// One JSON object.
pub fn json(found: &[Finding]) -> Result<String, CtlError> {
    let [ok, warnings, failures, skipped] = counts(found);
    run::json(&Report { failures, warnings, ok, skipped, findings: found })
}
