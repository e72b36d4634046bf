//! Configurations that were not written with good will, or not written at all: nothing panics, blocks
//! or takes long, and whatever is accepted says the same when it is read again.

use irhorizon::config::settings::{EstimatorSettings, HeadSettings, Method};
use irhorizon::config::{ConfigErrors, Loaded, Settings, load, load_for_replay, parse};
use proptest::prelude::*;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

const EXAMPLE: &str = include_str!("../packaging/irhorizon.toml");

fn parse_one(text: &str) -> Result<Loaded, ConfigErrors> {
    parse(&[("a.toml".into(), text.into())])
}

/// What is accepted reads back as the same; what is not is told in few and printable lines.
fn survives(text: &str) {
    match parse_one(text) {
        Ok(first) => {
            let again = parse_one(&first.text).unwrap_or_else(|e| panic!("{text}\nshown as\n{}\n{e}", first.text));
            assert_eq!(again.text, first.text);
            for (a, b) in first.settings.sensors.iter().zip(&again.settings.sensors) {
                assert!(a.direction.dot(b.direction.components()) > 1.0 - 1e-12);
                assert_eq!((&a.name, &a.device, &a.power), (&b.name, &b.device, &b.power));
            }
            let without_sensors = |s: Settings| Settings { sensors: Vec::new(), ..s };
            assert_eq!(without_sensors(again.settings), without_sensors(first.settings));
        }
        Err(errors) => {
            let told = errors.to_string();
            assert!(!errors.errors.is_empty() && errors.errors.len() <= 100 && told.len() < 100_000);
            assert!(!told.chars().any(|c| c.is_control() && c != '\n'), "{told:?}");
            let lines: Vec<_> = errors.errors.iter().map(|e| (&e.file, e.line().unwrap_or(usize::MAX))).collect();
            assert!(lines.is_sorted(), "{told}");
            for e in &errors.errors {
                assert!(e.line().is_none_or(|l| (1..=text.split('\n').count()).contains(&l)), "{told}");
                assert!(e.message.chars().count() < 700, "{told}");
            }
        }
    }
}

fn every_valid_text() -> Vec<String> {
    let mut texts = vec![EXAMPLE.to_owned(), uncommented()];
    for name in ["analogue-head", "six-sensors", "simulation", "chips", "endpoint", "wrong-type", "syntax"] {
        texts.push(std::fs::read_to_string(format!("tests/golden/config/{name}.toml")).expect(name));
    }
    texts
}

/// The shipped file with every commented setting in force.
fn uncommented() -> String {
    let setting = |l: &str| {
        l.strip_prefix('#').filter(|l| l.starts_with(|c: char| c == '[' || c.is_lowercase())).map(str::to_owned)
    };
    EXAMPLE.lines().map(|l| setting(l).unwrap_or_else(|| l.to_owned()) + "\n").collect()
}

#[test]
fn the_shipped_file_is_right_and_its_comments_show_the_defaults() {
    let shipped = parse_one(EXAMPLE).unwrap();
    assert_eq!(shipped.warnings, Vec::<String>::new());
    assert_eq!(shipped.settings.sensors.len(), 6);
    assert_eq!(shipped.settings.simulation, None);
    let defaults = Settings::default();
    let all = parse_one(&uncommented()).unwrap().settings;
    assert_eq!(all.sensors.len(), 7, "the commented ADC channel comes in");
    assert!(all.faults.lamp.is_some());
    assert_eq!((all.rate_hz, all.quiet), (defaults.rate_hz, defaults.quiet));
    assert_eq!((all.head.lag_s, all.estimator.roll_limit_deg), (Some(0.1), Some(0.0)));
    assert_eq!(all.estimator.method, Some(shipped.settings.method()), "for the six sensors without the channel");
    let unsaid = EstimatorSettings { method: None, roll_limit_deg: None, ..all.estimator };
    assert_eq!((HeadSettings { lag_s: None, ..all.head }, unsaid), (defaults.head, defaults.estimator));
    assert_eq!(irhorizon::config::settings::FaultSettings { lamp: None, ..all.faults }, defaults.faults);
    assert_eq!((all.dbus, all.simulation), (defaults.dbus, None));
    assert_eq!((all.mavlink.system_id, all.mavlink.component_id), (None, 191));
}

#[test]
fn defaults_are_those_of_the_manual() {
    let s = parse_one("simulation.enabled = true").unwrap().settings;
    assert_eq!((s.rate_hz, s.quiet), (50.0, Duration::from_millis(1)));
    assert_eq!((s.head.roll_trim_deg, s.head.pitch_trim_deg, s.head.field_of_view_deg), (0.0, 0.0, 90.0));
    assert_eq!((s.method().as_str(), s.estimator.range_time_constant_s), ("field", 3.0));
    let limits_deg = Method::NAMED.map(|(_, m)| s.estimator.roll_limit_deg_for(m));
    assert_eq!((limits_deg, s.head.lag_s), ([45.0, 0.0, 0.0], None));
    assert_eq!((s.faults.low_contrast_c, s.faults.lost_after_s), (2.0, 0.1));
    assert_eq!((s.faults.back_after_s, s.faults.stale_after_s), (0.1, 0.5));
    assert_eq!(s.dbus.update_hz, 10.0);
    let sim = s.simulation.clone().unwrap();
    assert_eq!((sim.noise_c, sim.lag_s, sim.seed), (0.08, 0.1, 1));
    let head = s.head();
    let names: Vec<&str> = head.sensors.iter().map(|s| s.name.as_str()).collect();
    assert_eq!(names, ["nose", "tail", "left", "right", "up", "down"]);
}

#[test]
fn each_number_holds_at_its_limits_and_not_beyond() {
    let table: [(&str, &str, &[&str], &[&str]); 17] = [
        ("daemon", "rate-hz", &["1", "200", "33.3"], &["0.9", "200.1", "0", "-50"]),
        ("daemon", "quiet-ms", &["0", "20"], &["-0.1", "20.1"]),
        ("head", "roll-trim-deg", &["-45", "45"], &["-45.1", "45.1"]),
        ("head", "pitch-trim-deg", &["-45", "45"], &["-45.1", "45.1"]),
        ("head", "field-of-view-deg", &["5", "150"], &["4.9", "150.1"]),
        ("head", "lag-s", &["0", "0.03", "5"], &["-0.1", "5.1"]),
        ("estimator", "range-time-constant-s", &["0.1", "60"], &["0.09", "61"]),
        ("estimator", "roll-limit-deg", &["0", "10", "180"], &["-1", "9.9", "180.1"]),
        ("faults", "low-contrast-c", &["0.2", "20"], &["0.1", "21"]),
        ("faults", "lost-after-s", &["0.02", "5"], &["0.01", "5.1"]),
        ("faults", "back-after-s", &["0.02", "5"], &["0.01", "5.1"]),
        ("faults", "stale-after-s", &["0.05", "10"], &["0.04", "10.1"]),
        ("mavlink", "system-id", &["1", "255"], &["0", "256", "1.5"]),
        ("mavlink", "component-id", &["1", "255"], &["0", "256", "-1"]),
        ("dbus", "update-hz", &["0.1", "50"], &["0.09", "50.1"]),
        ("simulation", "noise-c", &["0", "5"], &["-0.1", "5.1"]),
        ("simulation", "lag-s", &["0", "5"], &["-0.1", "5.1"]),
    ];
    for (section, key, good, bad) in table {
        let text = |value: &str| format!("simulation.enabled = true\n{section}.{key} = {value}\n");
        for value in good {
            assert!(parse_one(&text(value)).is_ok(), "{section}.{key} = {value}");
        }
        for value in bad.iter().chain(&["nan", "inf", "-inf", "1e400", "99999999999999999999", "\"1\"", "true", "[]"]) {
            let errors = parse_one(&text(value)).unwrap_err();
            let told = errors.to_string();
            assert_eq!(errors.errors.len(), 1, "{told}");
            assert!(
                told.starts_with(&format!("a.toml:2:{}: {section}.{key} ", section.len() + key.len() + 5)),
                "{told}"
            );
        }
    }
}

#[test]
fn mutated_configurations_are_survived() {
    let texts = every_valid_text();
    let pieces = [
        "\n",
        "\"",
        "[",
        "]",
        "[[sensor]]\n",
        "=",
        "{",
        "}",
        ".",
        "#",
        ",",
        "nan",
        "inf",
        "-",
        "0x",
        "9999999999",
        "é",
        "\u{1b}[2J",
        "\0",
        "\r",
        "'''",
        "\"\"\"",
        "\\u0000",
        "name = \"nose\"\n",
        "true",
        "1979-05-27",
        "_",
        "\u{202e}",
        " ",
        "e9",
    ];
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    let mut random = |below: usize| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        usize::try_from(state % below as u64).unwrap()
    };
    let mut accepted = 0;
    for round in 0..2_000 {
        let mut text: Vec<char> = texts[round % texts.len()].chars().collect();
        for _ in 0..1 + random(6) {
            let at = random(text.len());
            let end = (at + random(8)).min(text.len());
            match random(4) {
                0 => drop(text.drain(at..end)),
                1 => drop(text.splice(at..at, pieces[random(pieces.len())].chars()).collect::<Vec<_>>()),
                2 => drop(text.splice(at..end, pieces[random(pieces.len())].chars()).collect::<Vec<_>>()),
                _ => {
                    let from = random(text.len());
                    let piece: Vec<char> = text[from..(from + random(60)).min(text.len())].to_vec();
                    text.splice(at..at, piece);
                }
            }
            if text.is_empty() {
                break;
            }
        }
        let text: String = text.into_iter().collect();
        accepted += usize::from(parse_one(&text).is_ok());
        survives(&text);
    }
    assert!(accepted > 100, "only {accepted} of the mutations were harmless: this tests the parser alone");
}

proptest! {
    #[test]
    fn any_text_is_survived(text in any::<String>()) {
        survives(&text);
    }

    #[test]
    fn any_bytes_are_survived(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        let folder = Folder::new();
        let path = folder.write("a.toml", &bytes);
        let _ = load(&path).map_err(|e| e.to_string());
    }

    #[test]
    fn a_drop_in_has_the_last_word(rate in 1_u32..=200, address in 0x10_u8..0x50, first in any::<bool>()) {
        let rate = f64::from(rate);
        let drop_in = format!("[daemon]\nrate-hz = {rate}\n[[sensor]]\nname = \"left\"\naddress = {address}\n");
        let other = "[daemon]\nrate-hz = 7\nquiet-ms = 3\n".to_owned();
        let (early, late) = if first { (drop_in.clone(), other) } else { (other, drop_in) };
        let files: Vec<(PathBuf, String)> =
            [("main", EXAMPLE.to_owned()), ("early", early), ("late", late)].map(|(n, t)| (n.into(), t)).into();
        let settings = parse(&files).unwrap().settings;
        prop_assert_eq!(settings.rate_hz, if first { 7.0 } else { rate });
        prop_assert_eq!(settings.quiet, Duration::from_millis(3));
        prop_assert_eq!(settings.sensors.len(), 6);
        prop_assert_eq!(settings.sensors[2].device.address(), address);
    }
}

#[test]
fn large_and_deep_texts_are_refused_soon() {
    let size = 256 * 1024;
    let texts = [
        "[[sensor]]\n".repeat(size / 11),
        "[[mavlink.endpoint]]\n".repeat(size / 21),
        (0..15_000).map(|i| format!("[[sensor]]\nname=\"s{i}\"\n")).collect(),
        format!("daemon = {{{}}}", (0..25_000).map(|i| format!("k{i}=1")).collect::<Vec<_>>().join(",")),
        (0..15_000).map(|i| format!("key{i} = {i}\n")).collect(),
        format!("k={}", "[".repeat(size - 2)),
        format!("k={}{}", "[".repeat(size / 2), "]".repeat(size / 2 - 2)),
        format!("a{}=1", ".a".repeat(size / 2 - 2)),
        format!("[a{}]", ".a".repeat(size / 2 - 2)),
        "a={".repeat(size / 3),
        format!("dbus.bus = \"{}\"", "x".repeat(size)),
        format!("{} = 1", "x".repeat(size)),
        "=\n".repeat(size / 2),
        "\r".repeat(size),
        "\u{feff}".repeat(size / 3),
    ];
    for text in texts {
        let start = Instant::now();
        survives(&text);
        let took = start.elapsed();
        assert!(took < Duration::from_secs(20), "{took:?} for {}", &text[..30]);
    }
}

#[test]
fn crlf_and_a_byte_order_mark_change_nothing() {
    let plain = parse_one(EXAMPLE).unwrap();
    assert_eq!(parse_one(&format!("\u{feff}{}", EXAMPLE.replace('\n', "\r\n"))).unwrap(), plain);
}

#[test]
fn a_file_that_cannot_be_a_configuration_is_not_read() {
    let folder = Folder::new();
    let told = |path: &Path| load(path).unwrap_err().to_string();

    let large = folder.write("large.toml", b"");
    std::fs::File::options().write(true).open(&large).unwrap().set_len(100 << 20).unwrap();
    assert!(told(&large).contains("larger than 1 MiB"));
    let mut full = EXAMPLE.as_bytes().to_vec();
    full.resize(1 << 20, b'\n');
    assert!(load(&folder.write("full.toml", &full)).is_ok(), "1 MiB itself is allowed");

    let pipe = folder.0.join("pipe.toml");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    assert!(told(&pipe).contains("not a regular file"));
    assert!(told(&folder.0).contains("is a directory"));
    let dangling = folder.0.join("dangling.toml");
    std::os::unix::fs::symlink("/nowhere", &dangling).unwrap();
    assert!(told(&dangling).contains("no such file"));
    assert!(told(Path::new("")).contains("no such file"));
    assert!(told(&large.join("a.toml")).contains("Not a directory"));

    let secret = folder.write("secret.toml", EXAMPLE.as_bytes());
    std::fs::set_permissions(&secret, std::os::unix::fs::PermissionsExt::from_mode(0o000)).unwrap();
    if std::fs::File::open(&secret).is_err() {
        assert!(told(&secret).contains("may not be read"), "{}", told(&secret));
    }
}

#[test]
fn drop_ins_are_the_visible_toml_files_in_the_order_of_their_names() {
    let folder = Folder::new();
    let main = folder.write("a.toml", EXAMPLE.as_bytes());
    let drop_ins = folder.0.join("a.toml.d");
    std::fs::create_dir(&drop_ins).unwrap();
    for (name, rate) in [("20.toml", "20"), ("10.toml", "10"), (".30.toml", "30"), ("40.toml~", "40"), ("50.txt", "50")]
    {
        std::fs::write(drop_ins.join(name), format!("daemon.rate-hz = {rate}")).unwrap();
    }
    let loaded = load(&main).unwrap();
    assert_eq!(loaded.settings.rate_hz, 20.0);
    assert_eq!(loaded.files, [main.clone(), drop_ins.join("10.toml"), drop_ins.join("20.toml")]);

    std::fs::create_dir(drop_ins.join("60.toml")).unwrap();
    std::fs::write(drop_ins.join("70.toml"), b"\xff").unwrap();
    let errors = load(&main).unwrap_err();
    assert_eq!(errors.errors.len(), 2, "{errors}");
}

#[test]
fn a_replay_needs_no_sensors_and_a_daemon_does() {
    let folder = Folder::new();
    let path = folder.write("a.toml", b"[head]\nroll-trim-deg = 2\n");
    assert!(load(&path).unwrap_err().to_string().contains("no sensor is configured"));
    let replayed = load_for_replay(&path).unwrap();
    assert_eq!(replayed.settings.head().pairs.len(), 3);
}

/// A folder that goes away with its last user.
struct Folder(PathBuf);

impl Folder {
    fn new() -> Self {
        static COUNT: std::sync::atomic::AtomicU32 = std::sync::atomic::AtomicU32::new(0);
        let n = COUNT.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("irhorizon-config-{}-{n}", std::process::id()));
        std::fs::create_dir(&path).expect("a new folder");
        Self(path)
    }

    fn write(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.0.join(name);
        std::fs::write(&path, bytes).expect("a new file");
        path
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
