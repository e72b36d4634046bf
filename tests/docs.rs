//! The documentation is true: its keys and defaults are the parser's, its examples are accepted, its
//! `console` blocks give what they show (`…` stands for anything, alone on a line for any lines).

mod dbus_bus;

use dbus_bus::Bus;
use irhorizon::config::{Loaded, parse};
use std::collections::{BTreeMap, HashSet};
use std::fs;
use std::net::UdpSocket;
use std::path::{Path, PathBuf};
use std::process::{Child, Command};
use std::time::{Duration, Instant};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn page(name: &str) -> String {
    fs::read_to_string(root().join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// Every page, by its name.
fn pages() -> Vec<(String, String)> {
    let mut names: Vec<String> = fs::read_dir(root().join("docs"))
        .unwrap()
        .map(|e| format!("docs/{}", e.unwrap().file_name().into_string().unwrap()))
        .filter(|n| n.ends_with(".md"))
        .collect();
    names.sort();
    names.push("README.md".into());
    names.into_iter().map(|n| (n.clone(), page(&n))).collect()
}

/// The fenced blocks of `language`.
fn blocks(text: &str, language: &str) -> Vec<String> {
    let mut blocks = Vec::new();
    let mut open: Option<(bool, String)> = None;
    for line in text.lines() {
        match (&mut open, line.strip_prefix("```")) {
            (None, Some(info)) => open = Some((info == language, String::new())),
            (Some(_), Some(_)) => blocks.extend(open.take().filter(|b| b.0).map(|b| b.1)),
            (Some((_, text)), None) => *text += &format!("{line}\n"),
            (None, None) => {}
        }
    }
    blocks
}

fn loaded(texts: &[&str]) -> Loaded {
    let files: Vec<(PathBuf, String)> = texts.iter().map(|t| ("doc.toml".into(), (*t).to_owned())).collect();
    parse(&files).unwrap_or_else(|e| panic!("{e}\nin\n{}", texts.join("---\n")))
}

/// Section and key of everything in a configuration written out, with its last value.
fn keys(text: &str) -> BTreeMap<(String, String), String> {
    let mut keys = BTreeMap::new();
    let mut section = String::new();
    for line in text.lines() {
        if line.starts_with('[') {
            section = line.trim_matches(['[', ']']).to_owned();
        } else if let Some((key, value)) = line.split_once(" = ") {
            keys.insert((section.clone(), key.to_owned()), value.to_owned());
            for part in value.trim_matches(['{', '}', ' ']).split(", ").filter(|_| value.starts_with('{')) {
                let (key, value) = part.split_once(" = ").unwrap();
                keys.insert((section.clone(), key.to_owned()), value.to_owned());
            }
        }
    }
    keys
}

/// The rows of the tables of keys: section, key, default, range.
fn rows() -> Vec<(String, String, String, String)> {
    let mut section = String::new();
    let mut rows = Vec::new();
    for line in page("docs/configuration.md").lines() {
        if let Some(header) = line.strip_prefix("## `").or_else(|| line.strip_prefix('`')) {
            section = header.split('`').next().unwrap().trim_matches(['[', ']']).to_owned();
        }
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        if let ["", key, default, range, _, ""] = cells[..]
            && key.starts_with('`')
        {
            let bare = |s: &str| s.trim_matches('`').to_owned();
            // A GPIO line is a value of other keys; it is told where it is met first.
            let section = if section.starts_with('{') { "sensor" } else { &section };
            rows.push((section.to_owned(), bare(key), bare(default), range.to_owned()));
        }
    }
    rows
}

const MLX: &str = "[[sensor]]\nname = \"NAME\"\nkind = \"mlx90614\"\nbus = \"/dev/i2c-1\"\naddress = 0x5ADDRESS\n";

fn six() -> String {
    let names = ["nose", "tail", "left", "right", "up", "down"];
    names.iter().zip(1..).map(|(n, i)| MLX.replace("NAME", n).replace("ADDRESS", &i.to_string())).collect()
}

/// Every key at its default, as far as it has one.
fn plain() -> String {
    let pair = "[[sensor]]\nname = \"long\"\nkind = \"ads1115\"\nbus = \"/dev/i2c-1\"\naddress = 0x48\n\
                input = \"ain0\"\nkelvin-per-v = 40.0\ndirection = \"nose\"\ndata-ready = { chip = \"a\", line = 1 }\n";
    let endpoint = "[[mavlink.endpoint]]\naddress = \"udpout:127.0.0.1:14550\"\n";
    format!("{}{pair}{endpoint}[simulation]\nenabled = true\n", six())
}

/// Every key that has none besides.
const REST: &str = "[[sensor]]\nname = \"long\"\ndirection = { azimuth-deg = 45.0, elevation-deg = 1.0 }\n\
                    power = { chip = \"a\", line = 2 }\n[faults]\nlamp = { chip = \"a\", line = 3 }\n\
                    [head]\nlag-s = 0.2\n[estimator]\nmethod = \"profile\"\nroll-limit-deg = 60\n\
                    [[mavlink.endpoint]]\naddress = \"udpout:127.0.0.1:14550\"\nattitude-hz = 5\n\
                    tlog = \"/t\"\n[mavlink]\nsigning-key = \"/k\"\n";

#[test]
fn every_key_is_in_the_page_and_no_other() {
    let plain = plain();
    let mut known: Vec<_> = keys(&loaded(&[&plain, REST]).text).into_keys().collect();
    // Those of a GPIO line and of a direction stand for all their uses.
    known.retain(|(section, key)| section != "faults" || !["chip", "line", "active-low"].contains(&key.as_str()));
    let mut told: Vec<_> = rows().into_iter().map(|(section, key, ..)| (section, key)).collect();
    told.sort();
    assert_eq!(told, known);
}

#[test]
fn defaults_are_those_of_the_parser() {
    let values = keys(&loaded(&[&plain()]).text);
    let off = keys(&loaded(&[&six()]).text);
    for (section, key, default, _) in rows() {
        if ["required", "none", "by its name", "by the sensors", "by the head", "by the method", "every scan"]
            .contains(&default.as_str())
        {
            continue;
        }
        let from = if key == "enabled" { &off } else { &values };
        assert_eq!(from.get(&(section.clone(), key.clone())), Some(&default), "[{section}] {key}");
    }
}

#[test]
fn ranges_are_those_of_the_parser() {
    let mut checked = 0;
    for (section, key, _, range) in rows() {
        let number = |s: &str| s.trim_matches(',').parse::<f64>().is_ok();
        let words: Vec<&str> = range.split(' ').collect();
        let to = words.windows(3).find(|w| w[1] == "to" && number(w[0]) && number(w[2])).map(|w| w.join(" "));
        let sign = range.strip_prefix('±').map(|r| r.split(' ').next().unwrap()).map(|n| format!("-{n} to {n}"));
        let Some(expected) = to.or(sign) else { continue };
        let (six, pair) = (six(), plain());
        let text = match (section.as_str(), key.as_str()) {
            ("sensor", "azimuth-deg" | "elevation-deg") => {
                let other = if key == "azimuth-deg" { "elevation-deg" } else { "azimuth-deg" };
                let direction = format!("direction = {{ {key} = 1e9, {other} = 0 }}");
                format!("[[sensor]]\nname = \"long\"\n{direction}\n")
            }
            ("sensor", "line") => "[[sensor]]\nname = \"long\"\ndata-ready = { chip = \"a\", line = 99999 }\n".into(),
            ("sensor", "offset-c") => "[[sensor]]\nname = \"nose\"\noffset-c = 9\n".into(),
            ("sensor", _) => format!("[[sensor]]\nname = \"long\"\n{key} = 99999999\n"),
            _ => format!("[{section}]\n{key} = 99999999\n"),
        };
        let base = if section == "sensor" { pair } else { six };
        let files = [("a.toml".into(), base), ("b.toml".into(), text.clone())];
        let errors = parse(&files).expect_err(&text).to_string();
        assert!(errors.contains(&expected), "[{section}] {key}: {expected:?} is not in\n{errors}");
        checked += 1;
    }
    assert!(checked >= 18, "{checked}");
}

#[test]
fn every_fault_has_its_paragraph() {
    let source = page("src/fault/vocabulary.rs");
    let named = source.lines().filter(|l| l.trim_start().starts_with("FaultKind::") && l.contains(" => "));
    let faults = page("docs/faults.md");
    let mut count = 0;
    for name in named.filter_map(|l| l.split('"').nth(1)) {
        let name = name.trim_end_matches(":{}");
        let paragraph = faults.lines().any(|l| l.starts_with(&format!("**`{name}")));
        assert!(paragraph, "docs/faults.md has no paragraph **`{name}…`**");
        count += 1;
    }
    assert!(count >= 6, "{count}");
}

#[test]
fn examples_are_accepted() {
    for (name, text) in pages() {
        for example in blocks(&text, "toml") {
            // What has neither sensors of its own nor a simulation is a drop-in.
            let whole = example.contains("kind =") || example.contains("enabled = true");
            let loaded = if whole { loaded(&[&example]) } else { loaded(&[&six(), &example]) };
            assert_eq!(loaded.warnings, [""; 0], "{name}");
        }
    }
}

/// The daemon on its simulated source, killed at the end.
struct Daemon(Child);

impl Drop for Daemon {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A folder with what the examples work on, and a bus and a daemon that answer.
struct Stage {
    bus: Bus,
    _receiver: UdpSocket,
    _daemon: Daemon,
}

impl Stage {
    fn new() -> Self {
        let bus = Bus::new();
        let receiver = UdpSocket::bind("127.0.0.1:0").unwrap();
        let dir = &bus.dir;
        let example = page("packaging/irhorizon.toml");
        fs::write(dir.join("irhorizon.toml"), &example).unwrap();
        fs::write(dir.join("fast.toml"), example.replace("#rate-hz = 50 ", "rate-hz = 100")).unwrap();
        fs::write(dir.join("strict.toml"), "[faults]\nlow-contrast-c = 5.0\n[simulation]\nenabled = true\n").unwrap();
        fs::write(dir.join("profile.toml"), "[estimator]\nmethod = \"profile\"\n").unwrap();
        fs::write(dir.join("flight.csv"), blocks(&page("docs/recording.md"), "csv").concat()).unwrap();
        fs::write(dir.join("turn.csv"), page("tests/golden/score/flight.csv")).unwrap();
        let to = receiver.local_addr().unwrap();
        let simulated = format!("[simulation]\nenabled = true\n[[mavlink.endpoint]]\naddress = \"udpout:{to}\"\n");
        fs::write(dir.join("simulated.toml"), simulated).unwrap();
        let daemon = Command::new(env!("CARGO_BIN_EXE_irhorizond"))
            .args(["--log-level", "error", "--config", "simulated.toml"])
            .current_dir(dir)
            .env("DBUS_SYSTEM_BUS_ADDRESS", bus.address())
            .spawn()
            .unwrap();
        let stage = Self { bus, _receiver: receiver, _daemon: Daemon(daemon) };
        let deadline = Instant::now() + Duration::from_secs(20);
        while !stage.run("irhorizonctl status; echo $?").ends_with("\n0\n") {
            assert!(Instant::now() < deadline, "the daemon did not start");
            std::thread::sleep(Duration::from_millis(50));
        }
        stage
    }

    /// What a command prints, standard error included.
    fn run(&self, command: &str) -> String {
        let bin = Path::new(env!("CARGO_BIN_EXE_irhorizonctl")).parent().unwrap();
        let output = Command::new("sh")
            .args(["-c", &format!("{{ {command}; }} 2>&1")])
            .current_dir(&self.bus.dir)
            .env("PATH", format!("{}:{}", bin.display(), std::env::var("PATH").unwrap()))
            .env("DBUS_SYSTEM_BUS_ADDRESS", self.bus.address())
            .env("DBUS_SESSION_BUS_ADDRESS", "unix:path=/nonexistent/bus")
            .output()
            .unwrap();
        String::from_utf8(output.stdout).unwrap()
    }
}

/// Whether `line` is as `shown`, where `…` stands for anything.
fn line_matches(shown: &str, line: &str) -> bool {
    let Some((start, rest)) = shown.split_once('…') else { return shown == line };
    let Some(mut left) = line.strip_prefix(start) else { return false };
    let mut parts: Vec<&str> = rest.split('…').collect();
    let end = parts.pop().unwrap_or_default();
    for part in parts {
        let Some(at) = left.find(part) else { return false };
        left = &left[at + part.len()..];
    }
    left.ends_with(end)
}

fn matches(shown: &[&str], lines: &[&str]) -> bool {
    match (shown, lines) {
        ([], []) => true,
        (["…", rest @ ..], _) => (0..=lines.len()).any(|skip| matches(rest, &lines[skip..])),
        ([s, shown @ ..], [l, lines @ ..]) => line_matches(s, l) && matches(shown, lines),
        _ => false,
    }
}

#[test]
fn commands_give_what_is_shown() {
    let stage = Stage::new();
    let mut run = 0;
    for (name, text) in pages() {
        for block in blocks(&text, "console") {
            for example in block.trim_start_matches("$ ").split("\n$ ") {
                let (command, shown) = example.split_once('\n').unwrap_or((example, ""));
                let got = stage.run(command);
                let shown: Vec<&str> = shown.lines().collect();
                let lines: Vec<&str> = got.lines().collect();
                assert!(matches(&shown, &lines), "{name}: {command}\nshows\n{}\nbut gives\n{got}", shown.join("\n"));
                run += 1;
            }
        }
    }
    assert!(run >= 10, "{run}");
}

#[test]
fn the_readme_s_first_steps_work() {
    let stage = Stage::new();
    let ctl = env!("CARGO_BIN_EXE_irhorizonctl");
    let readme = page("README.md");
    let steps: Vec<&str> = readme.lines().filter(|l| l.starts_with("cp ") || l.contains("ctl validate")).collect();
    assert_eq!(steps.len(), 2, "{steps:?}");
    fs::create_dir_all(stage.bus.dir.join("packaging")).unwrap();
    fs::copy(root().join("packaging/irhorizon.toml"), stage.bus.dir.join("packaging/irhorizon.toml")).unwrap();
    let script = steps.join("\n").replace("target/release/irhorizonctl", ctl);
    assert!(stage.run(&script).starts_with("my.toml: ok\n"), "{script}");
}

/// A row that is there twice stands in another's place.
#[test]
fn no_row_of_a_table_is_there_twice() {
    for (name, text) in pages() {
        let mut seen = HashSet::new();
        for row in text.lines().filter(|l| l.starts_with("| ") && l.contains(|c: char| c.is_ascii_digit())) {
            assert!(seen.insert(row), "{name}: {row}");
        }
    }
}

#[test]
fn links_lead_somewhere() {
    for (name, text) in pages() {
        let folder = root().join(&name).parent().unwrap().to_owned();
        for target in text.split("](").skip(1).filter_map(|t| t.split(')').next()) {
            let (file, anchor) = target.split_once('#').unwrap_or((target, ""));
            let path = if file.is_empty() { root().join(&name) } else { folder.join(file) };
            assert!(path.exists(), "{name}: {target}");
            let slug = |l: &str| l.to_lowercase().replace(['`', '[', ']', '.', ','], "").replace(' ', "-");
            let found = anchor.is_empty()
                || fs::read_to_string(&path)
                    .unwrap()
                    .lines()
                    .any(|l| l.starts_with('#') && slug(l.trim_start_matches('#').trim()) == anchor);
            assert!(found, "{name}: {target}: no such heading");
        }
    }
}
