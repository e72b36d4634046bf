//! Bad input to the two commands: the whole of standard error, compared with
//! `tests/golden/errors/NAME.txt`. `UPDATE_GOLDEN=1 cargo test --test errors` writes them anew.
//!
//! Folders read as DIR, process numbers as PID, ports of this run as PORT.

mod dbus_bus;
mod golden_file;
mod process;

use dbus_bus::Bus;
use irhorizon::bus::explain::buses_under;
use process::{CTL, DAEMON, Daemon, Folder, Receiver, without_rights};
use rustix::process::Signal;
use std::fmt::Write as _;
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

const QUIET: &str = "[dbus]\nbus = \"none\"\n[[mavlink.endpoint]]\naddress = \"udpout:127.0.0.1:9\"\n";
const SIX: &str = "[simulation]\nenabled = true\n";

/// Compares what was said with the file; `names` are what changes from run to run.
fn golden(name: &str, said: &str, names: &[(&str, &str)]) {
    let mut said = said.to_owned();
    for (found, written) in names {
        said = said.replace(found, written);
    }
    // How many reads it took, and to the hundredth of a second, is a busy machine's affair.
    let said = said.replace(" s, limit 0.50 s", " SECONDS, limit 0.50 s");
    let said: String = said.split_inclusive(' ').zip(said.split_inclusive(' ').skip(1).chain([""])).fold(
        String::new(),
        |text, (word, next)| match next {
            "reads " | "SECONDS, " => text + "N ",
            _ => text + word,
        },
    );
    assert_eq!(golden_file::difference(format!("tests/golden/errors/{name}.txt"), &said), None);
}

fn dir(folder: &Folder) -> String {
    folder.0.display().to_string()
}

/// A daemon that does not start: its exit status is `code`, and what it says is in the file.
fn refused(name: &str, folder: &Folder, mut command: Command, code: i32) {
    let output = command.output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(code), "{said}");
    assert!(output.stdout.is_empty());
    golden(name, &said, &[(&dir(folder), "DIR")]);
}

fn daemon(config: &Path) -> Command {
    let mut command = Command::new(DAEMON);
    command.arg("--config").arg(config);
    command
}

fn sensor(name: &str, bus: &str, address: u8) -> String {
    format!("[[sensor]]\nname = \"{name}\"\nkind = \"mlx90614\"\nbus = \"{bus}\"\naddress = {address:#04x}\n")
}

/// Six sensors on `bus`.
fn six(bus: &str) -> String {
    let names = ["nose", "tail", "left", "right", "up", "down"];
    names.iter().zip(0x5b..).map(|(name, address)| sensor(name, bus, address)).collect()
}

#[test]
fn a_configuration_that_is_wrong() {
    let folder = Folder::new();
    refused("no-config", &folder, daemon(&folder.path("irhorizon.toml")), 78);
    let bus = "/dev/i2c-1";
    let cases = [
        ("unknown-key", format!("[daemon]\nrate = 50\n{QUIET}{}", six(bus))),
        ("one-address", format!("{QUIET}{}", six(bus).replace("0x5c", "0x5b"))),
        (
            "missing-vertical-pair",
            format!(
                "{QUIET}[estimator]\nmethod = \"inverse-sine\"\n{}",
                six(bus).split("[[sensor]]").take(5).collect::<Vec<_>>().join("[[sensor]]")
            ),
        ),
        ("address-out-of-range", format!("{QUIET}{}", six(bus).replace("0x60", "0x80"))),
        ("too-fast", format!("[daemon]\nrate-hz = 200\nquiet-ms = 5.0\n{QUIET}{}", six(bus))),
        ("not-text", format!("{QUIET}\u{0}")),
    ];
    for (name, text) in cases {
        let config = folder.write("irhorizon.toml", text);
        refused(name, &folder, daemon(&config), 78);
    }
    let config = folder.path("is-a-directory");
    fs::create_dir(&config).unwrap();
    refused("is-a-directory", &folder, daemon(&config), 78);
}

#[test]
fn a_command_line_that_is_wrong() {
    let folder = Folder::new();
    let mut command = Command::new(DAEMON);
    command.args(["--konfig", "x"]);
    refused("unknown-option", &folder, command, 64);
    for (name, args, code) in [
        ("ctl-unknown-command", &["statsu"][..], 64),
        ("ctl-no-command", &[][..], 64),
        ("ctl-bad-bus", &["--bus", "sytem", "status"][..], 64),
        ("ctl-validate-absent", &["validate", "DIR/none.toml"][..], 1),
    ] {
        let mut command = Command::new(CTL);
        command.args(args.iter().map(|a| a.replace("DIR", &dir(&folder))));
        refused(name, &folder, command, code);
    }
}

#[test]
fn a_configuration_that_may_not_be_read() {
    let folder = Folder::new();
    let config = folder.write("irhorizon.toml", SIX);
    fs::set_permissions(&config, fs::Permissions::from_mode(0o000)).unwrap();
    let mut command = without_rights(DAEMON, &folder);
    command.arg("--config").arg(&config);
    refused("config-denied", &folder, command, 78);
}

/// The daemon goes on without its bus, says so, and ends when told.
#[test]
fn a_bus_that_does_not_exist() {
    let folder = Folder::new();
    let receiver = Receiver::new();
    let endpoint = format!("[[mavlink.endpoint]]\naddress = \"udpout:127.0.0.1:{}\"\n", receiver.port());
    let dbus = Bus::new();
    let text = format!("{endpoint}[dbus]\nbus = \"{}\"\n{}", dbus.address(), six("/dev/i2c-none"));
    let mut daemon = Daemon::start(&folder, &text);
    daemon.says("stale");
    daemon.says("bus-down");
    let status = dbus.status(Duration::from_secs(5)).unwrap();
    assert_eq!(status.mode, "faulted");
    assert!(status.faults.iter().any(|f| f.name == "bus-down:/dev/i2c-none"), "{:?}", status.faults);
    assert_eq!((status.roll_deg, status.pitch_deg), (None, None));
    assert!(receiver.next().is_some(), "MAVLink is heard from nevertheless");
    assert!(daemon.is_running());
    daemon.signal(Signal::TERM);
    assert!(daemon.ended().success());
    // This machine may have buses.
    let buses = format!("there are: {}", buses_under(Path::new("/")).join(", "));
    golden("bus-absent", &daemon.said(), &[(&dir(&folder), "DIR"), (&buses, "there is no I2C bus at all")]);
}

/// A device file that is there and may not be opened. It is a plain file: opening is as far as it
/// gets. The guest has the real one.
#[test]
fn a_bus_that_may_not_be_opened() {
    let folder = Folder::new();
    let bus = folder.write("i2c-1", "");
    fs::set_permissions(&bus, fs::Permissions::from_mode(0o000)).unwrap();
    let receiver = Receiver::new();
    let endpoint = QUIET.replace(":9\"", &format!(":{}\"", receiver.port()));
    let config = folder.write("irhorizon.toml", format!("{endpoint}{}", six(&bus.display().to_string())));
    let mut command = without_rights(DAEMON, &folder);
    command.arg("--config").arg(&config);
    let mut daemon = Daemon::spawn(command, folder.path("log"));
    daemon.says("stale");
    daemon.says("bus-down");
    daemon.signal(Signal::TERM);
    assert!(daemon.ended().success());
    let user =
        if rustix::process::geteuid().is_root() { "nobody".into() } else { std::env::var("USER").unwrap_or_default() };
    golden("bus-denied", &daemon.said(), &[(&dir(&folder), "DIR"), (&user, "USER")]);
}

#[test]
fn a_second_daemon_on_the_same_bus() {
    let (folder, bus) = (Folder::new(), Bus::new());
    let text = format!("{SIX}[dbus]\nbus = \"{}\"\n", bus.address());
    let mut first = Daemon::start(&folder, &text);
    let before = bus.status(Duration::from_secs(10)).unwrap();
    let output = daemon(&folder.path("irhorizon.toml")).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    let names = [(first.pid().to_string(), "PID"), (bus.address(), "ADDRESS")];
    let said = String::from_utf8(output.stderr).unwrap();
    golden("name-owned", &said, &names.each_ref().map(|(found, written)| (found.as_str(), *written)));
    std::thread::sleep(Duration::from_millis(300));
    let after = bus.status(Duration::from_secs(1)).unwrap();
    assert!(after.sample_time_usec > before.sample_time_usec && first.is_running(), "the first goes on");
}

#[test]
fn a_mavlink_port_in_use() {
    let folder = Folder::new();
    let taken = Receiver::new();
    let port = taken.port().to_string();
    let text = format!("{SIX}[dbus]\nbus = \"none\"\n[[mavlink.endpoint]]\naddress = \"udpin:127.0.0.1:{port}\"\n");
    let mut daemon = Daemon::start(&folder, &text);
    daemon.says("in use");
    daemon.signal(Signal::TERM);
    assert!(daemon.ended().success());
    golden("port-in-use", &daemon.said(), &[(&port, "PORT")]);
}

#[test]
fn no_daemon_to_ask() {
    let (folder, bus) = (Folder::new(), Bus::new());
    for (place, address) in [("name", bus.address()), ("bus", format!("unix:path={}/none", dir(&folder)))] {
        for command in ["status", "sensors"] {
            let output = Command::new(CTL).args(["--bus", &address, command]).output().unwrap();
            assert_eq!(output.status.code(), Some(3));
            let said = String::from_utf8(output.stderr).unwrap();
            golden(&format!("ctl-no-{place}"), &said, &[(&address, "ADDRESS"), (&dir(&folder), "DIR")]);
        }
    }
}

const COLUMNS: &str = "time_s,nose_obj_c,tail_obj_c,left_obj_c,right_obj_c,up_obj_c,down_obj_c\n";

fn row(i: u32) -> String {
    format!("{:.2},3.0,3.0,3.0,3.0,-20.0,20.0\n", f64::from(i) * 0.02)
}

#[test]
fn recordings_that_are_no_good() {
    let folder = Folder::new();
    let good: String = (0..100).map(row).collect();
    let nan: String = (0..100).map(|i| row(i).replace("3.0", "NaN").replace("20.0", "inf")).collect();
    let mut cut = format!("{COLUMNS}{good}");
    cut.truncate(cut.len() - 9);
    let cases: [(&str, Vec<u8>, bool); 10] = [
        ("empty", Vec::new(), false),
        ("header-alone", COLUMNS.into(), false),
        ("truncated", cut.into(), true),
        ("nan", format!("{COLUMNS}{nan}").into(), true),
        ("malformed", format!("{COLUMNS}{}", good.replace(",-20.0", ";-20,0")).into(), true),
        ("binary", (0..=255).cycle().take(100_000).collect(), false),
        ("no-time", good.clone().into(), false),
        ("time-backwards", format!("{COLUMNS}{}{}{}", row(50), row(51), row(0)).into(), true),
        ("time-ahead", format!("{COLUMNS}{}{}", row(50), row(0)).into(), true),
        ("no-sensors", b"time_s,altitude_m\n0.0,1.0\n".to_vec(), false),
    ];
    for (name, bytes, read) in cases {
        let file = folder.write("flight.csv", bytes);
        let output = Command::new(CTL).arg("replay").arg(&file).output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(i32::from(!read)), "{name}: {said}");
        golden(&format!("replay-{name}"), &said, &[(&dir(&folder), "DIR")]);
        let rows = String::from_utf8(output.stdout).unwrap();
        assert!(!rows.contains("NaN") && !rows.contains("inf"), "{name}: {rows}");
    }
    refused("replay-absent", &folder, replay(&folder.path("none.csv")), 1);
    refused("replay-directory", &folder, replay(&folder.0), 1);
}

fn replay(file: &Path) -> Command {
    let mut command = Command::new(CTL);
    command.arg("replay").arg(file);
    command
}

/// What `command` says, after how long, and the most memory that it had, kB.
fn measured(mut command: Command, folder: &Folder) -> (String, i32, Duration, u64) {
    let start = Instant::now();
    let (out, err) = (fs::File::create("/dev/null").unwrap(), folder.path("err"));
    let mut child = command.stdout(out).stderr(fs::File::create(&err).unwrap()).spawn().unwrap();
    let mut most = 0;
    let status = loop {
        let status = fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
        let peak = status.lines().find_map(|l| l.strip_prefix("VmHWM:")?.trim().strip_suffix(" kB")?.parse().ok());
        most = most.max(peak.unwrap_or(0));
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        assert!(start.elapsed() < Duration::from_secs(120), "it goes on");
        std::thread::sleep(Duration::from_millis(5));
    };
    (fs::read_to_string(err).unwrap(), status.code().unwrap(), start.elapsed(), most)
}

/// A hundred megabytes, as one line, as zeros, and as rows: the memory does not grow with them.
#[test]
fn recordings_that_are_huge() {
    const SIZE: usize = 100 << 20;
    let folder = Folder::new();
    let zeros = folder.path("zeros.csv");
    fs::File::create(&zeros).unwrap().set_len(SIZE as u64).unwrap();
    let line = folder.write("line.csv", [COLUMNS.as_bytes(), &vec![b'1'; SIZE]].concat());
    let mut rows = String::with_capacity(SIZE + 64);
    rows.push_str(COLUMNS);
    for i in 0.. {
        if rows.len() >= SIZE {
            break;
        }
        let _ = writeln!(rows, "{}.{:02},3.0,3.0,3.0,3.0,-20.0,20.0", i / 50, i % 50 * 2);
    }
    let rows = folder.write("rows.csv", rows);
    // The quickest method: it is the reader that is tried.
    let quick = folder.write("quick.toml", "[estimator]\nmethod = \"inverse-sine\"\n");
    for (name, file, code) in [("zeros", zeros, 1), ("line", line, 1), ("rows", rows, 0)] {
        let mut command = replay(&file);
        command.arg("--config").arg(&quick);
        let (said, status, took, kilobytes) = measured(command, &folder);
        println!("{name}: {took:?}, {kilobytes} kB");
        assert_eq!(status, code, "{said}");
        assert!(kilobytes < 32 * 1024, "{name}: {kilobytes} kB");
        assert!(took < Duration::from_secs(60), "{name}: {took:?}");
        golden(&format!("replay-huge-{name}"), &said, &[(&dir(&folder), "DIR")]);
    }
}
