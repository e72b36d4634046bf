//! The drop-in of the configuration in which changes are kept: its text with more changes. Pure.
//!
//! The file is the daemon's own: sections and keys, a line each. What else somebody writes into it is lost with the
//! next change.

use super::change::Change;
use std::collections::BTreeMap;

/// The first lines.
const HEAD: &str = "# Set by MAVLink parameters and kept by irhorizond, which writes this file anew: write your own\n\
                    # settings into another one. Without this file, the configuration holds as it is written.\n";

/// The keys of a section with their values, by the lines that begin it.
type Sections = BTreeMap<String, BTreeMap<String, String>>;

fn sections(text: &str) -> Sections {
    let mut sections = Sections::new();
    let mut header = String::new();
    for line in text.lines().map(str::trim).filter(|l| !l.is_empty() && !l.starts_with('#')) {
        if line.starts_with('[') {
            header = format!("{line}\n");
        } else if header == "[[mavlink.endpoint]]\n" && line.starts_with("address = ") {
            // The address belongs to the header: it tells one endpoint from another.
            header = format!("{header}{line}\n");
        } else if let Some((key, value)) = line.split_once(" = ") {
            sections.entry(header.clone()).or_default().insert(key.to_owned(), value.to_owned());
        }
    }
    sections
}

/// `text`, empty at first, with `changes`: what they set stands there once.
pub fn with(text: &str, changes: &[Change]) -> String {
    laid(text, &changes.iter().map(Change::toml).collect::<String>())
}

/// `text` with the settings of `over`, another drop-in, laid upon it.
pub fn laid(text: &str, over: &str) -> String {
    let mut out = HEAD.to_owned();
    for (header, keys) in sections(&format!("{text}\n{over}")) {
        out.push('\n');
        out.push_str(&header);
        out.extend(keys.into_iter().map(|(key, value)| format!("{key} = {value}\n")));
    }
    out
}

/// Each setting of `text` as a drop-in of its own.
pub fn single(text: &str) -> Vec<String> {
    let each = |(header, keys): (String, BTreeMap<String, String>)| {
        keys.into_iter().map(move |(key, value)| format!("{header}{key} = {value}\n"))
    };
    sections(text).into_iter().flat_map(each).collect()
}

/// `text` without the sections of endpoints for which `there` does not hold.
pub fn fitting(text: &str, there: impl Fn(&str) -> bool) -> String {
    let mut out = String::new();
    for section in text.split_inclusive("\n\n") {
        let address = section.lines().find_map(|l| l.strip_prefix("address = "));
        if address.is_none_or(|a| there(a.trim().trim_matches('"'))) {
            out.push_str(section);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mavlink::service::Section;

    fn change(section: Section, key: &'static str, value: &str) -> Change {
        Change { section, key, value: value.into() }
    }

    #[test]
    fn the_last_word_on_each_setting_is_kept() {
        let head = |key, value| change(Section::Table("head"), key, value);
        let endpoint = |port, value| change(Section::Endpoint(format!("udpout:127.0.0.1:{port}")), "values-hz", value);
        let mut text = with("", &[head("roll-trim-deg", "1.5"), head("pitch-trim-deg", "-2")]);
        for c in [
            endpoint(1, "2"),
            endpoint(2, "3"),
            endpoint(1, "5"),
            head("roll-trim-deg", "4"),
            change(Section::Table("faults"), "on-fault", "\"hold\""),
        ] {
            text = with(&text, &[c]);
        }
        let lines: Vec<&str> = text.lines().filter(|l| !l.starts_with('#') && !l.is_empty()).collect();
        assert_eq!(
            lines,
            [
                "[[mavlink.endpoint]]",
                "address = \"udpout:127.0.0.1:1\"",
                "values-hz = 5",
                "[[mavlink.endpoint]]",
                "address = \"udpout:127.0.0.1:2\"",
                "values-hz = 3",
                "[faults]",
                "on-fault = \"hold\"",
                "[head]",
                "pitch-trim-deg = -2",
                "roll-trim-deg = 4",
            ]
        );
        assert_eq!(with(&text, &[]), text);
    }

    #[test]
    fn it_is_a_drop_in_of_the_configuration() {
        let main = "[simulation]\nenabled = true\n[[mavlink.endpoint]]\naddress = \"udpout:localhost:1\"\n";
        let address = Section::Endpoint("udpout:127.0.0.1:1".into());
        let kept = with("", &[change(address, "texts", "false"), change(Section::Table("mavlink"), "yaw", "true")]);
        let files = [("a.toml".into(), main.to_owned()), ("b.toml".into(), kept)];
        let settings = crate::config::parse(&files).unwrap().settings;
        assert!(settings.mavlink.yaw && settings.mavlink.endpoints.len() == 1);
        assert!(!settings.mavlink.endpoints[0].streams.texts);
    }
}
