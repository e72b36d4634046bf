//! set-address on a bus of fake chips, calibrate and wait-ready with a fake daemon, record without one, completions.

#[path = "dbus_bus/mod.rs"]
mod dbus_bus;
mod process;
mod setup_kit;

use dbus_bus::Bus;
use irhorizon::head::SensorKind;
use irhorizon::recording::Writer;
use process::Folder;
use rustix::process::Signal;
use setup_kit::bus::{ADAPTER_HAS_PEC, Chip, WRITES, adc, cell, chips, mlx};
use setup_kit::daemon::{LOOKS, RELOADS, RUNS_ON};
use setup_kit::{ANSWERS, PROCESS, ctl};
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

#[test]
fn one_sensor_gets_another_address() {
    chips(&[mlx(0x5a), adc()]);
    ANSWERS.set(vec![true, true]);
    let (code, out, err) = ctl("set-address 0x5b");
    assert_eq!((code, err.as_str()), (0, ""));
    assert_eq!(
        out,
        "on /dev/i2c-1:\n  0x48  another chip\n  0x5a  MLX90614, identity 000100020003005a, sees 8.9 °C, is at 21.4 °C \
         itself\ncell 0x2e holds 0x5b now, read back. Until it is power-cycled the sensor goes on at 0x5a: take its \
         supply off and put it on again\nit answers at 0x5b: identity 000100020003005a\n"
    );
    assert_eq!(cell(0x5b), 0xBE5B);
    // Again: there is nothing to do.
    let (code, out, _) = ctl("set-address 0x5b --yes");
    assert!(code == 0 && out.ends_with("it has that address already: nothing was written\n"), "{out}");
}

#[test]
fn before_its_power_cycle_it_is_known_and_can_be_told_otherwise() {
    chips(&[mlx(0x5a)]);
    assert_eq!(ctl("set-address 0x5b --yes").0, 0);
    let (code, out, _) = ctl("set-address 0x5c --yes");
    assert!(code == 0 && out.contains("0x5b from its next power cycle on"), "{out}");
    assert_eq!(cell(0x5a), 0xBE5C);
    assert_eq!(ctl("set-address 0x5c --yes").0, 0);
    // Back to where it still is.
    assert_eq!((ctl("set-address 0x5a --yes").0, cell(0x5a)), (0, 0xBE5A));
}

#[test]
fn it_writes_nothing_unless_it_is_sure() {
    let refused = |line: &str, words: &str| {
        WRITES.set(0);
        let (code, out, err) = ctl(line);
        assert!(code == 1 && err.contains(words), "{line}: {code} {out} {err}");
        assert_eq!(WRITES.get(), 0, "{line}");
    };
    chips(&[mlx(0x5a), mlx(0x5c)]);
    refused("set-address 0x5b --yes", "2 MLX90614 answer on /dev/i2c-1 (at 0x5a, 0x5c)");
    chips(&[]);
    refused("set-address 0x5b --yes", "no MLX90614 answers");
    chips(&[adc(), Chip { claimed: true, ..mlx(0x5a) }]);
    refused("set-address 0x5b --yes", "no MLX90614 answers");
    chips(&[mlx(0x5a), adc()]);
    refused("set-address 0x48 --yes", "0x48 is taken");
    refused("set-address 0x5b --yes --i2c-bus /dev/i2c-none", "there is no /dev/i2c-none");
    ANSWERS.set(vec![false]);
    refused("set-address 0x5b", "nothing was written");
    refused("--bus fake:still set-address 0x5b --yes", "irhorizond reads long, lat, vert on /dev/i2c-1: stop it first");
    PROCESS.set(Some(812));
    refused("set-address 0x5b --yes", "pid 812");
    PROCESS.set(None);
    // Two sensors at one address answer together.
    chips(&[Chip { damaged: true, ..mlx(0x5a) }]);
    refused("set-address 0x5b --yes", "two sensors");
    for bad in ["0x02", "0x78", "5b", "-1", ""] {
        assert_eq!(ctl(&format!("set-address {bad} --yes")).0, 64, "{bad}");
    }
    let (code, _, err) = ctl("--bus /dev/i2c-1 set-address 0x5b");
    assert!(code == 64 && err.contains("--i2c-bus"), "{err}");
}

#[test]
fn a_part_with_a_wrong_pec_is_changed_when_that_is_said() {
    chips(&[Chip { damaged: true, ..mlx(0x5a) }]);
    assert_eq!((ctl("set-address 0x5b --yes --no-read-pec").0, cell(0x5a)), (0, 0xBE5B));
}

#[test]
fn an_adapter_without_pec_changes_nothing_and_says_so() {
    chips(&[mlx(0x5a)]);
    ADAPTER_HAS_PEC.set(false);
    let (code, _, err) = ctl("set-address 0x5b --yes");
    assert!(code == 1 && err.contains("writes need PEC"), "{err}");
    assert_eq!(cell(0x5a), 0xBE5A);
}

const SIMULATED: &str = "[simulation]\nenabled = true\n[head]\nroll-trim-deg = 0.5\n";

fn pairs() -> String {
    let pair = |(name, looks, input)| {
        format!(
            "[[sensor]]\nname = \"{name}\"\nkind = \"ads1115\"\nbus = \"/dev/i2c-1\"\naddress = 0x48\ninput = \
             \"{input}\"\nkelvin-per-v = -40.0\ndirection = \"{looks}\"\n"
        )
    };
    [("long", "nose", "ain0"), ("lat", "left", "ain1"), ("vert", "up", "ain2")].map(pair).concat()
}

#[test]
fn the_trim_is_measured_saved_and_brought_back() {
    let folder = Folder::new();
    let config = folder.write("irhorizon.toml", SIMULATED).display().to_string();
    RUNS_ON.set(config.clone().into());
    let saved = folder.path("irhorizon.toml.d/50-trim.toml");
    let line = format!("--bus fake:still calibrate --yes --config {config}");

    let (code, out, err) = ctl(&format!("{line} --dry-run"));
    assert_eq!(code, 0, "{err}");
    assert!(err.contains("hold or put the aircraft level"), "{err}");
    assert!(out.contains("roll   shown +1.50°, scatter ±0.0") && out.contains("trim +0.50° → +2.00°"), "{out}");
    // The daemon's own doubt stands beside the scatter, which is not the error.
    assert!(out.contains("°, σ 0.80°; trim +0.50°") && out.contains("°, σ 0.90°; trim +0.00°"), "{out}");
    assert!(!folder.path("irhorizon.toml.d").exists() && RELOADS.get() == 0);

    let (code, out, err) = ctl(&line);
    assert_eq!(code, 0, "{err}");
    assert!(out.ends_with("the daemon has taken it up\n") && RELOADS.get() == 1, "{out}");
    let head = irhorizon::config::load(Path::new(&config)).unwrap().settings.head;
    assert!((head.roll_trim_deg - 2.0).abs() < 0.02 && (head.pitch_trim_deg + 4.0).abs() < 0.02, "{head:?}");

    let first = fs::read(&saved).unwrap();
    let (_, out, _) = ctl(&line.replace("still", "published"));
    assert!(out.contains("trim +0.50° → +2.00°"), "{out}");
    let undo = format!("{line} --undo");
    assert_eq!((ctl(&undo).0, fs::read(&saved).unwrap()), (0, first));
    // One is kept.
    let (code, _, err) = ctl(&undo);
    assert!(code == 1 && err.contains("nothing is kept"), "{err}");
}

/// Before anybody takes pains to hold anything level.
#[test]
fn what_cannot_be_saved_is_not_measured() {
    let folder = Folder::new();
    let config = folder.write("irhorizon.toml", SIMULATED).display().to_string();
    RUNS_ON.set(config.clone().into());
    fs::create_dir_all(folder.path("irhorizon.toml.d/.50-trim.toml.new")).unwrap();
    let (code, out, err) = ctl(&format!("--bus fake:still calibrate --yes --config {config}"));
    assert!(code == 1 && out.is_empty() && err.contains("50-trim.toml failed"), "{out}{err}");
    assert!(!err.contains("hold or put"), "{err}");
}

#[test]
fn without_a_daemon_undoing_works_and_measuring_does_not() {
    let folder = Folder::new();
    let config = folder.write("irhorizon.toml", SIMULATED).display().to_string();
    RUNS_ON.set(config.clone().into());
    assert_eq!(ctl(&format!("--bus fake:still calibrate --yes --config {config}")).0, 0);
    assert_eq!(ctl(&format!("--bus fake:none calibrate --yes --config {config}")).0, 3);
    let (code, out, _) = ctl(&format!("--bus fake:none calibrate --undo --config {config}"));
    assert!(code == 0 && out.contains("taken away, there was none before\nno daemon runs"), "{out}");
    assert!(!folder.path("irhorizon.toml.d/50-trim.toml").exists());
}

#[test]
fn a_daemon_on_another_configuration_has_not_taken_it_up() {
    let folder = Folder::new();
    for (what, text) in [("level", SIMULATED.to_owned()), ("neutral", pairs())] {
        RUNS_ON.set(folder.write("other.toml", &text));
        let config = folder.write(&format!("{what}.toml"), &text);
        let line = format!("--bus fake:still calibrate {what} --yes --config {}", config.display());
        let refused = |line: &str| {
            let (code, out, err) = ctl(line);
            let told = err.contains(&format!("{what}.toml holds it now, but")) && err.contains("another configuration");
            assert!(code == 1 && told && !out.contains("taken it up"), "{line}: {code} {out} {err}");
        };
        refused(&line);
        refused(&line);
        refused(&format!("{line} --undo"));
    }
}

/// The same of a daemon on a real bus, which says what it runs on.
#[test]
fn undoing_asks_the_daemon_what_it_runs_on() {
    let (bus, folder, elsewhere) = (Bus::new(), Folder::new(), Folder::new());
    let address = bus.address();
    let text = format!("[simulation]\nenabled = true\n[dbus]\nbus = \"{address}\"\n");
    let saved = |folder: &Folder| {
        let drop_ins = folder.path("irhorizon.toml.d");
        fs::create_dir_all(&drop_ins).unwrap();
        fs::write(drop_ins.join("50-trim.toml"), "[head]\nroll-trim-deg = 2.0\n").unwrap();
        fs::write(drop_ins.join(".50-trim.toml.old"), "").unwrap();
    };
    saved(&folder);
    let _daemon = process::Daemon::start(&folder, &text);
    let real = |line: String| {
        let args = ["--bus", &address].into_iter().chain(line.split_whitespace());
        std::process::Command::new(process::CTL).args(args).output().unwrap()
    };
    assert!(real("wait-ready --timeout 20".to_owned()).status.success());
    saved(&elsewhere);
    let other = elsewhere.write("irhorizon.toml", &text);
    let output = real(format!("calibrate --undo --config {}", other.display()));
    let err = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.code() == Some(1) && err.contains("another configuration"), "{err}");
    let output = real(format!("calibrate --undo --config {}", folder.path("irhorizon.toml").display()));
    let out = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success() && out.ends_with("the daemon has taken it up\n"), "{out}");
}

/// A simulated flight turns and is gusty: nothing to be calibrated by.
#[test]
fn a_flight_is_not_taken_for_level() {
    let (bus, folder) = (Bus::new(), Folder::new());
    let address = bus.address();
    let text = format!("[simulation]\nenabled = true\n[dbus]\nbus = \"{address}\"\n");
    let _daemon = process::Daemon::start(&folder, &text);
    let real = |line: &str| {
        let args = ["--bus", &address].into_iter().chain(line.split_whitespace());
        std::process::Command::new(process::CTL).args(args).output().unwrap()
    };
    assert!(real("wait-ready --timeout 20").status.success());
    let config = folder.path("irhorizon.toml");
    let output = real(&format!("calibrate --yes --seconds 10 --config {}", config.display()));
    let err = String::from_utf8(output.stderr).unwrap();
    // Soon after its start the estimator is not sure enough yet, which is told first.
    let said = err.contains("keep still") || err.contains("standard deviation");
    assert!(output.status.code() == Some(1) && said, "{err}");
    assert!(!folder.path("irhorizon.toml.d").exists());
}

#[test]
fn what_is_no_measure_is_not_saved() {
    let folder = Folder::new();
    let config = folder.write("irhorizon.toml", SIMULATED).display().to_string();
    for (scene, words) in [
        ("moving", "roll changed by"),
        ("drifting", "pitch changed by"),
        ("faulted", "the daemon is faulted"),
        ("degraded", "the daemon is degraded"),
        ("unsure", "standard deviation is 9.0°"),
        ("tilted", "is the aircraft level"),
        ("stuck", "too few measurements"),
    ] {
        LOOKS.set(0);
        let (code, _, err) = ctl(&format!("--bus fake:{scene} calibrate --yes --config {config}"));
        assert!(code == 1 && err.contains(words), "{scene}: {code} {err}");
    }
    ANSWERS.set(vec![false]);
    assert_eq!(ctl(&format!("--bus fake:still calibrate --config {config}")).0, 1);
    assert!(!folder.path("irhorizon.toml.d").exists(), "nothing is left");
    let (_, _, err) = ctl(&format!("--bus fake:still calibrate neutral --yes --config {config}"));
    assert!(err.contains("no ads1115"), "{err}");
    let later = folder.path("irhorizon.toml.d");
    fs::create_dir_all(&later).unwrap();
    fs::write(later.join("trim.toml"), "[head]\nroll-trim-deg = 7.0\n").unwrap();
    let (_, _, err) = ctl(&format!("--bus fake:still calibrate --yes --config {config}"));
    assert!(err.contains("50-trim.toml sets the same"), "{err}");
    assert_eq!(fs::read_dir(later).unwrap().count(), 1);
    assert_eq!(RELOADS.get(), 0);
    assert_eq!(ctl("calibrate --undo --dry-run").0, 64);
}

#[test]
fn neutral_voltages_are_measured_of_each_pair() {
    let folder = Folder::new();
    let config = folder.write("irhorizon.toml", pairs()).display().to_string();
    RUNS_ON.set(config.clone().into());
    let line = format!("--bus fake:still calibrate neutral --yes --config {config}");
    let (code, out, err) = ctl(&line);
    assert_eq!(code, 0, "{err}");
    assert!(out.contains("long     1.6520 V ± 0.0000 V; neutral 0.0000 V before (-66.08 K off)"), "{out}");
    let text = irhorizon::config::load(Path::new(&config)).unwrap().text;
    for volts in ["neutral-v = 1.652", "neutral-v = -0.004", "neutral-v = 0"] {
        assert!(text.contains(volts), "{text}");
    }
    for (scene, words) in [("silent", "lat gives nothing (saturated)"), ("uncovered", "what long sees changed by")] {
        LOOKS.set(0);
        let (code, _, err) = ctl(&line.replace("still", scene));
        assert!(code == 1 && err.contains(words), "{scene}: {err}");
    }
}

/// Three sensors of a head; with a kelvin that all warm up meanwhile.
#[test]
fn offsets_of_digital_sensors_are_measured_against_each_other() {
    let folder = Folder::new();
    let digital = |(i, name)| {
        format!(
            "[[sensor]]\nname = \"{name}\"\nkind = \"mlx90614\"\nbus = \"/dev/i2c-3\"\naddress = 0x{}\noffset-c = {}\n",
            50 + i,
            0.1 * f64::from(i)
        )
    };
    let three: String = (0..).zip(["nose", "tail", "left"]).map(digital).collect();
    let config = folder.write("irhorizon.toml", &(pairs() + &three)).display().to_string();
    RUNS_ON.set(config.clone().into());
    let line = format!("--bus fake:still calibrate neutral --yes --config {config}");
    let (code, out, err) = ctl(&line);
    assert_eq!(code, 0, "{err}");
    // What was set before has no part in it: less the mean of 0.5, -0.25 and -0.1.
    for words in [
        "nose     +0.45 K ± 0.00 K against the others; offset +0.00 K before",
        "tail     -0.30 K ± 0.00 K against the others; offset +0.10 K before",
        "left     -0.15 K ± 0.00 K against the others; offset +0.20 K before",
    ] {
        assert!(out.contains(words), "{out}");
    }
    let settings = irhorizon::config::load(Path::new(&config)).unwrap().settings;
    let offsets: Vec<_> = settings.head().sensors.iter().map(|s| s.kind).filter(|k| k.is_absolute()).collect();
    assert_eq!(offsets, [0.45, -0.3, -0.15].map(|offset_k| SensorKind::Absolute { offset_k }));
    assert!(
        settings.head().sensors.iter().any(|s| s.kind == SensorKind::Pair { neutral_v: 1.652, kelvin_per_v: -40.0 })
    );
    for (scene, words) in [
        ("blind", "tail gives nothing (bad-pec)"),
        ("warm-hand", "nose shows +"),
        ("swaying", "how far nose is from the others is known to ±"),
    ] {
        LOOKS.set(0);
        let (code, _, err) = ctl(&line.replace("still", scene));
        assert!(code == 1 && err.contains(words), "{scene}: {err}");
    }
    // One alone cannot be compared.
    let one = folder.write("one.toml", &(pairs() + &digital((0, "nose")))).display().to_string();
    RUNS_ON.set(one.clone().into());
    let (code, out, err) = ctl(&format!("--bus fake:still calibrate neutral --yes --config {one}"));
    assert!(code == 0 && out.contains("vert") && !out.contains("nose"), "{out} {err}");
}

#[test]
fn a_recording_without_the_daemon_is_as_the_daemon_s() {
    let folder = Folder::new();
    let config = folder.write("irhorizon.toml", "[daemon]\nrate-hz = 100\n[simulation]\nenabled = true\n");
    let loaded = irhorizon::config::load(&config).unwrap();
    let header = Writer::new(&loaded.settings.head(), &loaded.text).header().to_owned();
    let whole = |file: &Path| {
        let text = fs::read_to_string(file).unwrap();
        let rows = text.strip_prefix(&header).unwrap_or_else(|| panic!("{text}"));
        assert!(
            rows.ends_with('\n') && rows.lines().all(|row| row.ends_with(",,,,,,,,")),
            "no aiding is heard: {rows}"
        );
        rows.lines().count()
    };
    let file = folder.path("flight.csv");
    let line = format!("record {} --offline --seconds 0.5 --config {}", file.display(), config.display());
    let (code, out, err) = ctl(&line);
    assert_eq!((code, out.as_str()), (0, ""), "{err}");
    let rows = whole(&file);
    assert!(
        (2..=51).contains(&rows) && err.ends_with(&format!("{rows} rows recorded to {}\n", file.display())),
        "{err}"
    );
    assert!(err.starts_with("notice: the configuration says [simulation]"), "{err}");
    assert_eq!(ctl(&format!("replay {} --output {}", file.display(), folder.path("out.csv").display())).0, 0);

    let file = folder.path("until.csv");
    let mut command = std::process::Command::new(process::CTL);
    command.args(["record", "--offline", "--config"]).args([&config, &file]);
    let mut recorder = process::Daemon::spawn(command, folder.path("recorder"));
    recorder.says("Ctrl-C ends it");
    std::thread::sleep(Duration::from_millis(200));
    recorder.signal(Signal::INT);
    assert!(recorder.ended().success(), "{}", recorder.said());
    assert!(recorder.said().contains(&format!("{} rows recorded", whole(&file))), "{}", recorder.said());
}

#[test]
fn where_the_sensors_cannot_be_read_nothing_is_recorded() {
    let folder = Folder::new();
    let config = folder.write("irhorizon.toml", pairs()).display().to_string();
    let file = folder.path("flight.csv");
    let refused = |exit: u8, line: &str, words: &str| {
        let (code, out, err) = ctl(&format!("{line} {}", file.display()));
        assert!(code == exit && out.is_empty() && err.contains(words), "{line}: {code} {out} {err}");
        assert!(!file.exists(), "{line}");
    };
    let offline = format!("record --offline --config {config}");
    refused(1, &format!("--bus fake:still {offline}"), "irhorizond reads long, lat, vert on /dev/i2c-1: stop it first");
    PROCESS.set(Some(812));
    refused(1, &offline, "pid 812");
    PROCESS.set(None);
    // Other addresses of the bus are claimed, too; one that can be read is enough.
    chips(&[Chip { claimed: true, ..adc() }]);
    refused(1, &offline, "irhorizonctl: long (ADS1115 at 0x48 on /dev/i2c-1): claimed by a kernel driver");
    chips(&[adc()]);
    folder.write("irhorizon.toml", pairs() + "[daemon]\nrate-hz = 200\n");
    refused(1, &offline, "irhorizonctl validate: a scan of 3 sensors needs");
    folder.write("irhorizon.toml", pairs().replace("/dev/i2c-1", "/dev/i2c-none"));
    refused(1, &offline, "there is no /dev/i2c-none");
    folder.write("irhorizon.toml", "[deamon]\n");
    refused(1, &offline, "the configuration is not usable; correct it and see irhorizonctl validate:\n");
    refused(64, &format!("record --config {config}"), "--offline");
}

#[test]
fn a_daemon_that_hangs_is_none_that_answers() {
    let (bus, folder) = (Bus::new(), Folder::new());
    let address = bus.address();
    let text = format!("[simulation]\nenabled = true\n[dbus]\nbus = \"{address}\"\n");
    let daemon = process::Daemon::start(&folder, &text);
    let real = |line: &str| {
        let args = ["--bus", &address].into_iter().chain(line.split_whitespace());
        std::process::Command::new(process::CTL).args(args).output().unwrap()
    };
    assert!(real("wait-ready --timeout 20").status.success());
    daemon.signal(Signal::STOP);
    let begun = Instant::now();
    assert_eq!(real("wait-ready --timeout 1").status.code(), Some(3));
    assert!(begun.elapsed() < Duration::from_secs(2), "{:?}", begun.elapsed());
    for line in ["status", "record -"] {
        let output = real(line);
        let err = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.code() == Some(3) && err.contains("no answer within 3 s"), "{line}: {err}");
    }
}

#[test]
fn ready_is_what_was_asked_for() {
    assert_eq!(ctl("--bus fake:still wait-ready --timeout 0"), (0, String::new(), String::new()));
    assert_eq!(ctl("--bus fake:degraded wait-ready --timeout 0 --mode degraded").0, 0);
    let (code, _, err) = ctl("--bus fake:degraded wait-ready --timeout 0");
    assert!(code == 1 && err.contains("not ready after 0 s: mode degraded"), "{err}");
    assert_eq!((ctl("wait-ready --timeout 0").0, ctl("wait-ready --timeout -1").0), (3, 64));
}

#[test]
fn completions_know_the_commands() {
    for shell in ["bash", "zsh", "fish"] {
        let (code, out, _) = ctl(&format!("completions {shell}"));
        assert_eq!(code, 0);
        for word in ["wait-ready", "set-address", "calibrate", "doctor", "--i2c-bus"] {
            let word = if shell == "fish" { word.trim_start_matches('-') } else { word };
            assert!(out.contains(word), "{shell}: {word}");
        }
    }
    assert_eq!(ctl("completions tcsh").0, 64);
}
