//! The daemon on its simulated source: its end, its reloads, its log.

#[path = "dbus_bus/mod.rs"]
mod dbus_bus;
mod process;

use dbus_bus::Bus;
use irhorizon::config::Settings;
use irhorizon::ctl::client::{Client, ClientError};
use irhorizon::daemon::sampling::Sampling;
use irhorizon::frame::{Frame, Missing, Sample, Value};
use irhorizon::head::Head;
use irhorizon::horizon::Horizon;
use irhorizon::recording::Taps;
use irhorizon::source::{FrameSource, SensorHealth};
use irhorizon::state::Shared;
use irhorizon::time::Time;
use process::stalls::Watch;
use process::{ATTITUDE, Daemon, Folder, HEARTBEAT, Receiver};
use rustix::fs::{OFlags, fcntl_setfl};
use rustix::process::Signal;
use std::io::Write;
use std::process::Command;
use std::sync::{Arc, Mutex};
use std::time::Duration;

const POWEROFF: u8 = 7;

fn config(rate_hz: u32, bus: &str, receivers: &[&Receiver]) -> String {
    let endpoint = |r: &&Receiver| format!("[[mavlink.endpoint]]\naddress = \"udpout:127.0.0.1:{}\"\n", r.port());
    let endpoints: String = receivers.iter().map(endpoint).collect();
    format!("[daemon]\nrate-hz = {rate_hz}\n[simulation]\nenabled = true\n[dbus]\nbus = \"{bus}\"\n{endpoints}")
}

/// What was heard last, until nothing came for 0.2 s.
fn last(receiver: &Receiver) -> (u8, Vec<u8>) {
    receiver.0.set_read_timeout(Some(Duration::from_millis(200))).unwrap();
    std::iter::from_fn(|| receiver.next()).last().unwrap()
}

#[test]
fn it_ends_within_half_a_second_and_says_so() {
    let bus = Bus::new();
    for signal in [Signal::TERM, Signal::INT] {
        for address in ["none".to_owned(), bus.address(), "unix:path=/nonexistent".to_owned()] {
            let (folder, receiver) = (Folder::new(), Receiver::new());
            let mut daemon = Daemon::start(&folder, &config(50, &address, &[&receiver]));
            receiver.wait(ATTITUDE);
            let told = Watch::start();
            daemon.signal(signal);
            let status = daemon.ended();
            let took = told.stop();
            println!("{signal:?}, bus {address}: {took:?}");
            assert!(status.success(), "{status}: {}", daemon.said());
            assert!(took.within(Duration::from_millis(500)), "{took:?}: {}", daemon.said());
            let (id, payload) = last(&receiver);
            assert_eq!((id, payload[7]), (HEARTBEAT, POWEROFF));
            assert!(daemon.said().ends_with("stopped\n"), "{}", daemon.said());
        }
    }
}

/// A terminal held by Ctrl-S, or a journal that hangs, is a pipe that is full.
#[test]
fn a_log_that_nobody_reads_keeps_neither_the_attitude_nor_the_end_waiting() {
    let (folder, receiver) = (Folder::new(), Receiver::new());
    let (unread, mut full) = std::io::pipe().unwrap();
    fcntl_setfl(&full, OFlags::NONBLOCK).unwrap();
    while full.write(b"\n").is_ok() {}
    fcntl_setfl(&full, OFlags::empty()).unwrap();
    let mut command = Command::new(process::DAEMON);
    command.args(["--log-level", "debug", "--config"]);
    command.arg(folder.write("irhorizon.toml", config(50, "none", &[&receiver])));
    let mut daemon = Daemon::spawn_into(command, full.into(), folder.write("log", ""));
    receiver.wait(ATTITUDE);
    // Each time it has something to say.
    for _ in 0..3 {
        daemon.signal(Signal::HUP);
        receiver.forget();
        receiver.wait(ATTITUDE);
    }
    let told = Watch::start();
    daemon.signal(Signal::TERM);
    let status = daemon.ended();
    let took = told.stop();
    assert!(status.success(), "{status}");
    assert!(took.within(Duration::from_millis(600)), "{took:?}");
    drop(unread);
}

/// A signal that comes while the daemon is still starting is not lost either.
#[test]
fn it_ends_when_told_before_it_has_begun() {
    for delay in [20, 50, 100, 200] {
        let (folder, receiver) = (Folder::new(), Receiver::new());
        let mut daemon = Daemon::start(&folder, &config(50, "unix:path=/nonexistent", &[&receiver]));
        std::thread::sleep(Duration::from_millis(delay));
        daemon.signal(Signal::TERM);
        let told = Watch::start();
        let status = daemon.ended();
        let took = told.stop();
        // Before it listens for signals, the system ends it.
        assert!(status.success() || daemon.said().is_empty(), "{status}: {}", daemon.said());
        assert!(took.within(Duration::from_millis(1000)), "{took:?}: {}", daemon.said());
    }
}

#[test]
fn a_hangup_brings_the_new_configuration_in_or_leaves_the_old_one() {
    let (folder, first, second) = (Folder::new(), Receiver::new(), Receiver::new());
    let mut daemon = Daemon::start(&folder, &config(50, "none", &[&first]));
    let rate = first.attitude_rate(1.0);
    assert!(rate.is(45.0..=52.0), "{rate}");

    folder.write("irhorizon.toml", config(20, "none", &[&first, &second]));
    daemon.signal(Signal::HUP);
    daemon.says("configuration reloaded");
    for receiver in [&first, &second] {
        let rate = receiver.attitude_rate(1.0);
        assert!(rate.is(17.0..=22.0), "{rate}");
    }

    let bad = config(10, "none", &[]).replace("rate-hz", "rate");
    folder.write("irhorizon.toml", bad);
    daemon.signal(Signal::HUP);
    daemon.says("refused");
    let said = daemon.said();
    assert!(said.contains("the old one stays in force") && said.contains("did you mean rate-hz?"), "{said}");
    let rate = second.attitude_rate(1.0);
    assert!(rate.is(17.0..=22.0), "{rate}");

    std::fs::remove_file(folder.path("irhorizon.toml")).unwrap();
    daemon.signal(Signal::HUP);
    daemon.says("there is no such file");
    assert!(second.attitude_rate(1.0).is(15.0..=f64::INFINITY) && daemon.is_running());
}

#[test]
fn a_reload_over_dbus_tells_how_it_went() {
    let (folder, bus, first, second) = (Folder::new(), Bus::new(), Receiver::new(), Receiver::new());
    let _daemon = Daemon::start(&folder, &config(50, &bus.address(), &[&first]));
    first.wait(ATTITUDE);
    let mut client = Client::connect(&bus.choice()).unwrap();
    let mut frames = client.frames().unwrap();
    folder.write("irhorizon.toml", config(20, &bus.address(), &[&second]));
    client.reload().unwrap();
    let rate = second.attitude_rate(1.0);
    assert!(rate.is(17.0..=22.0), "{rate}");
    let status = client.status().unwrap();
    assert_eq!(status.endpoints.len(), 1);
    // Whoever records was told of another rate.
    while frames.next_line().unwrap().is_some() {}
    let header = client.frames().unwrap().next_line().unwrap().unwrap();
    assert!(header.contains("rate-hz = 20\n") && header.contains("\ntime_s,"), "{header}");
    assert!(status.endpoints[0].address.ends_with(&second.port().to_string()), "{:?}", status.endpoints);

    folder.write("irhorizon.toml", "[daemon]\nrate-hz = 1000\n");
    let Err(ClientError::Config(why)) = client.reload() else { panic!("a rate of 1000 Hz was taken") };
    assert!(why.contains("irhorizon.toml:2:11") && why.contains("1000"), "{why}");
    assert!(second.attitude_rate(1.0).is(15.0..=f64::INFINITY));
}

/// Neither sampling nor the estimate begins anew for a rate that the sensors cannot keep.
#[test]
fn a_rate_that_the_sensors_cannot_keep_leaves_the_estimate_alone() {
    let sensor = |(i, name): (usize, &str)| {
        format!("[[sensor]]\nname = \"{name}\"\nkind = \"mlx90614\"\nbus = \"/nonexistent\"\naddress = {}\n", 0x5b + i)
    };
    let sensors: String = ["nose", "tail", "left", "right", "up", "down"].into_iter().enumerate().map(sensor).collect();
    let config = |rate_hz: u32| format!("[daemon]\nrate-hz = {rate_hz}\n[dbus]\nbus = \"none\"\n{sensors}");
    let folder = Folder::new();
    let mut daemon = Daemon::start(&folder, &config(20));
    let begun = "a scan of 6 sensors every";
    daemon.says(begun);
    folder.write("irhorizon.toml", config(200));
    daemon.signal(Signal::HUP);
    daemon.says("refused");
    let said = daemon.said();
    assert!(said.contains("set [daemon] rate-hz to") && daemon.is_running(), "{said}");
    assert_eq!(said.matches(begun).count(), 1, "{said}");
}

/// Of a bus that is another one than that in use, and not of that one when it is back.
#[test]
fn another_bus_waits_for_a_restart_and_the_one_in_use_does_not() {
    let (folder, bus, receiver) = (Folder::new(), Bus::new(), Receiver::new());
    let daemon = Daemon::start(&folder, &config(50, &bus.address(), &[&receiver]));
    receiver.wait(ATTITUDE);
    let reload = |address: &str| {
        folder.write("irhorizon.toml", config(50, address, &[&receiver]));
        Client::connect(&bus.choice()).unwrap().reload().unwrap();
        daemon.said().matches("dbus.bus has changed").count()
    };
    assert_eq!([reload("none"), reload("none"), reload(&bus.address())], [1, 2, 2], "{}", daemon.said());
}

/// Hangups as fast as they come lose nothing and leave the last configuration in force.
#[test]
fn many_hangups_in_a_row() {
    let (folder, receiver) = (Folder::new(), Receiver::new());
    let mut daemon = Daemon::start(&folder, &config(50, "none", &[&receiver]));
    receiver.wait(ATTITUDE);
    for i in 0..50 {
        folder.write("irhorizon.toml", config(20 + i % 2 * 10, "none", &[&receiver]));
        daemon.signal(Signal::HUP);
        std::thread::sleep(Duration::from_millis(3));
    }
    std::thread::sleep(Duration::from_millis(500));
    let rate = receiver.attitude_rate(1.0);
    assert!(rate.is(27.0..=32.0), "{rate}: {}", daemon.said());
    daemon.signal(Signal::TERM);
    assert!(daemon.ended().success());
}

#[test]
fn the_log_is_plain_lines() {
    let (folder, receiver) = (Folder::new(), Receiver::new());
    let mut daemon = Daemon::start(&folder, &config(50, "none", &[&receiver]));
    receiver.wait(ATTITUDE);
    daemon.signal(Signal::TERM);
    daemon.ended();
    let said = daemon.said();
    for line in said.lines() {
        assert!(line.starts_with('[') && !line.contains('\u{1b}') && line.contains("] "), "{line:?}");
    }
    assert!((2..10).contains(&said.lines().count()), "{said}");
}

#[test]
fn a_fault_on_purpose_is_met_as_any_other() {
    let (folder, receiver) = (Folder::new(), Receiver::new());
    let faulted = "enabled = true\nfaults = [\"off:nose@0..\", \"wrong:tail@9..10\"]";
    let daemon = Daemon::start(&folder, &config(50, "none", &[&receiver]).replace("enabled = true", faulted));
    daemon.says("simulated fault: wrong=8:tail@9..10");
    daemon.says("sensor-lost:nose: no answer");
}

/// A nose that is there for 0.2 s and away for 0.2 s, on a clock of its own.
struct Fluttering {
    health: [SensorHealth; 6],
}

impl FrameSource for Fluttering {
    fn scan(&mut self, tick: Time, frame: &mut Frame) {
        frame.time = tick;
        for (i, reading) in frame.readings.iter_mut().enumerate() {
            let object_c = [3.0, 3.0, 3.0, 3.0, -20.0, 20.0][i];
            let away = i == 0 && tick.as_nanos() / 200_000_000 % 2 == 1;
            let sample = Sample { value: Value::Absolute { object_c, ambient_c: None }, time: tick };
            *reading = if away { Err(Missing::NoAnswer) } else { Ok(sample) };
        }
    }

    fn health(&self) -> &[SensorHealth] {
        &self.health
    }

    fn buses_down(&self) -> &[Option<Missing>] {
        &[]
    }
}

struct Lines(Mutex<Vec<String>>);

impl log::Log for Lines {
    fn enabled(&self, _: &log::Metadata<'_>) -> bool {
        true
    }

    fn log(&self, record: &log::Record<'_>) {
        self.0.lock().unwrap().push(record.args().to_string());
    }

    fn flush(&self) {}
}

static LINES: Lines = Lines(Mutex::new(Vec::new()));

#[test]
fn a_fault_that_flutters_is_counted_not_printed() {
    log::set_logger(&LINES).unwrap();
    log::set_max_level(log::LevelFilter::Info);
    let head = Head::six();
    let horizon = Horizon::new(&Settings::default(), head.clone());
    let source = Box::new(Fluttering { health: Default::default() });
    let mut sampling =
        Sampling::new(head, source, horizon, Arc::new(Shared::default()), Arc::new(Taps::default()), None);
    for i in 0..50 * 120 {
        sampling.step(Time::from_nanos(1_000_000_000_000 + i * 20_000_000));
    }
    let lines: Vec<String> = LINES.0.lock().unwrap().iter().filter(|l| l.contains("nose")).cloned().collect();
    println!("{}", lines.join("\n"));
    assert!((5..=20).contains(&lines.len()), "300 times in two minutes: {lines:#?}");
    assert!(lines[0].starts_with("sensor-lost:nose: no answer, "), "{lines:#?}");
    assert!(lines.iter().any(|l| l.contains("times more")), "{lines:#?}");
}
