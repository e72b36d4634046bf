//! As much Markdown as docs/configuration.md has, as roff.

use super::escaped;
use std::fmt::Write as _;

/// The text of `markdown` below its title.
pub fn roff(markdown: &str) -> String {
    let mut page = String::new();
    let mut lines = markdown.lines().skip_while(|l| l.starts_with("# ")).peekable();
    while let Some(line) = lines.next() {
        if line.starts_with("```") {
            page += ".PP\n.RS 4\n.nf\n";
            for code in lines.by_ref().take_while(|l| !l.starts_with("```")) {
                let _ = writeln!(page, "{}", escaped(code));
            }
            page += ".fi\n.RE\n";
        } else if let Some(heading) = line.strip_prefix("### ") {
            let _ = writeln!(page, ".SS \"{}\"", plain(heading));
        } else if let Some(heading) = line.strip_prefix("## ") {
            let _ = writeln!(page, ".SH \"{}\"", title(heading));
        } else if line.starts_with('|') {
            let mut rows = vec![cells(line)];
            while let Some(row) = lines.next_if(|l| l.starts_with('|')) {
                rows.push(cells(row));
            }
            table(&rows, &mut page);
        } else if line.is_empty() {
            page += ".PP\n";
        } else if let Some(item) = line.strip_prefix("- ") {
            let _ = writeln!(page, ".IP \\(bu 2\n{}", inline(item));
        } else {
            let _ = writeln!(page, "{}", inline(line.trim_start()));
        }
    }
    page.replace(".PP\n.PP\n", ".PP\n").replace(".PP\n.SH", ".SH").replace(".PP\n.SS", ".SS").replace(".PP\n.IP", ".IP")
}

fn cells(row: &str) -> Vec<&str> {
    row.trim_matches('|').split('|').map(str::trim).collect()
}

/// A table of keys, or of two columns, becomes a list; any other stays a table. The second row is the rule under the titles.
fn table(rows: &[Vec<&str>], page: &mut String) {
    let titles = &rows[0];
    if titles[..] == ["key", "default", "range", "what"] {
        for row in &rows[2..] {
            let [key, default, range, what] = row[..] else { panic!("{row:?}") };
            let range = if range.is_empty() { String::new() } else { format!("; {}", inline(range)) };
            let default =
                if default == "required" { "required".into() } else { format!("default {}", inline(default)) };
            let _ = writeln!(page, ".TP\n{}\n{}.\n({default}{range})", inline(key), inline(what));
        }
        return;
    }
    if titles.len() == 2 {
        for row in &rows[2..] {
            let [thing, what] = row[..] else { panic!("{row:?}") };
            let _ = writeln!(page, ".TP\n{}\n{}.", inline(thing), inline(what));
        }
        return;
    }
    let _ = writeln!(page, ".TS\n{}.", vec!["l"; titles.len()].join(" "));
    for row in std::iter::once(titles).chain(&rows[2..]) {
        let cells: Vec<String> = row.iter().map(|c| inline(c)).collect();
        let _ = writeln!(page, "{}", cells.join("\t"));
    }
    page.push_str(".TE\n");
}

/// Code and what is strong in bold, links as their text.
fn inline(text: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some(at) = rest.find(['`', '*', '[']) {
        out += &escaped_within(&rest[..at]);
        let tail = &rest[at..];
        let (mark, end, shown) = if let Some(code) = tail.strip_prefix('`') {
            (1, "`", code.split('`').next())
        } else if let Some(strong) = tail.strip_prefix("**") {
            (2, "**", strong.split("**").next())
        } else if let Some((link, target)) = tail.strip_prefix('[').and_then(|t| t.split_once("](")) {
            out += &inline(link);
            rest = target.split_once(')').map_or("", |(_, rest)| rest);
            continue;
        } else {
            out += &tail[..1];
            rest = &tail[1..];
            continue;
        };
        let shown = shown.unwrap_or_default();
        let _ = write!(out, "\\fB{}\\fR", escaped_within(shown));
        rest = tail.get(mark + shown.len() + end.len()..).unwrap_or_default();
    }
    let text = out + &escaped_within(rest);
    if text.starts_with(['.', '\'']) { format!("\\&{text}") } else { text }
}

fn escaped_within(text: &str) -> String {
    text.replace('\\', "\\e").replace('-', "\\-")
}

/// A heading without marks.
fn plain(text: &str) -> String {
    text.replace(['`', '"'], "")
}

/// A heading of the first order: in capitals, but a section of the configuration as it is spelt.
fn title(text: &str) -> String {
    let title = plain(text);
    if title.starts_with('[') { title } else { title.to_uppercase() }
}
