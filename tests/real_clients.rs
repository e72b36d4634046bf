//! Programs of others that listen to the daemon, on its simulated source: pymavlink, MAVSDK, MAVProxy,
//! node-mavlink, and Wireshark's tshark. Each must show every attitude that was sent, at the right
//! angles, stamps and rate. What `tests/setup` installs is needed; nothing is skipped without it.

mod dbus_bus;
mod process;

use dbus_bus::Bus;
use process::{ATTITUDE, CTL, Daemon, Folder, Receiver};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::{BufRead, BufReader};
use std::net::UdpSocket;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};

/// The system id of the daemon in these tests: none that a client takes for its own.
const SYSTEM: u8 = 42;

fn clients() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/clients")
}

/// What `tests/clients/setup` has made, for Python or for Node.js.
fn made(kind: &str) -> String {
    let setup = Command::new(clients().join("setup")).arg(kind).output().expect("tests/clients/setup runs");
    assert!(setup.status.success(), "no clients, no test: {}", String::from_utf8_lossy(&setup.stderr));
    String::from_utf8(setup.stdout).unwrap().trim().to_owned()
}

fn python(script: &str) -> Command {
    let mut command = Command::new(made("python"));
    command.arg(clients().join(script));
    command
}

/// A client that listens at `port`.
fn spawn(mut command: Command, port: u16, seconds: u32) -> Child {
    let mut child = command
        .args(["--listen", &format!("127.0.0.1:{port}"), "--seconds", &seconds.to_string()])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap_or_else(|e| panic!("{:?}: {e}", command.get_program()));
    let mut said = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    while !line.contains("listening") {
        assert_ne!(said.read_line(&mut line).unwrap(), 0, "the client ended: {line}");
    }
    // What else it says goes nowhere, but must not block it.
    std::thread::spawn(move || std::io::copy(&mut said, &mut std::io::sink()));
    child
}

/// Roll and pitch, °, and body rates, °/s, where they are shown beside them, by their stamp, ms.
type Angles = BTreeMap<u64, Vec<f64>>;

/// Scans of the simulation, and attitudes where no other rate is set, a second.
const SCANS_HZ: u32 = 50;

const NO_BUS: &str = "[dbus]\nbus = \"none\"\n";

/// The daemon's configuration: `more`, and endpoints to these ports with so many attitudes a second.
fn config(more: &str, endpoints: &[(u16, u32)]) -> String {
    let mut text = format!("{more}[simulation]\nenabled = true\n[mavlink]\nsystem-id = {SYSTEM}\n");
    for (port, hz) in endpoints {
        text += &format!("[[mavlink.endpoint]]\naddress = \"udpout:127.0.0.1:{port}\"\n");
        if *hz != SCANS_HZ {
            text += &format!("attitude-hz = {hz}\n");
        }
    }
    text
}

/// ATTITUDE as it went over the wire, until `done`.
fn overhear(receiver: &Receiver, done: &AtomicBool) -> Angles {
    let mut angles = Angles::new();
    while !done.load(Ordering::Relaxed) {
        let (id, mut payload) = receiver.next().expect("a message within 10 s");
        if id == ATTITUDE {
            payload.resize(28, 0);
            let word = |at: usize| <[u8; 4]>::try_from(&payload[at..at + 4]).unwrap();
            let degrees = |at: usize| f64::from(f32::from_le_bytes(word(at))).to_degrees();
            angles.insert(u64::from(u32::from_le_bytes(word(0))), [4, 8, 16, 20, 24].map(degrees).to_vec());
        }
    }
    angles
}

/// Lets the client listen for 4 s to `hz` attitudes a second. What it reports, after a comparison of
/// what it shows with what was sent: each within `tolerance` degrees.
fn compare(command: Command, hz: u32, tolerance: f64) -> Value {
    let (folder, receiver) = (Folder::new(), Receiver::new());
    let port = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let client = spawn(command, port, 4);
    let _daemon = Daemon::start(&folder, &config(NO_BUS, &[(port, hz), (receiver.port(), SCANS_HZ)]));
    let done = AtomicBool::new(false);
    let (output, sent) = std::thread::scope(|scope| {
        let sent = scope.spawn(|| overhear(&receiver, &done));
        let output = client.wait_with_output();
        done.store(true, Ordering::Relaxed);
        (output.unwrap(), sent.join().unwrap())
    });
    assert!(output.status.success(), "{output:?}");
    let text = String::from_utf8(output.stdout).unwrap();
    // A native library may have put its log before the report.
    let report: Value = serde_json::from_str(text.lines().last().unwrap()).unwrap();
    let shown = angles(&report);
    let (Some(first), Some(last)) = (shown.keys().next(), shown.keys().next_back()) else { panic!("{report}") };
    let missed: Vec<_> = sent.range(first..=last).filter(|(stamp, _)| !shown.contains_key(stamp)).collect();
    assert!(hz != SCANS_HZ || missed.is_empty(), "of {} attitudes it did not show {missed:?}", sent.len());
    for (stamp, values) in &shown {
        let off = values.iter().zip(&sent[stamp]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off <= tolerance, "at {stamp} ms {values:?}, sent as {:?}", sent[stamp]);
    }
    // Rates that have no stamp there: those that were sent, in their order.
    let (mut all, mut found) = (sent.values(), 0);
    for rates in report["rates"].as_array().into_iter().flatten() {
        let rates: Vec<f64> = rates.as_array().unwrap().iter().map(|r| r.as_f64().unwrap()).collect();
        let is = |sent: &&Vec<f64>| rates.iter().zip(&sent[2..]).all(|(a, b)| (a - b).abs() <= tolerance);
        assert!(all.find(is).is_some(), "{rates:?} after {found} others was not sent");
        found += 1;
    }
    assert!(found > 0 || shown.values().all(|values| values.len() == 5), "no rates");
    // By their stamps: how fast the client was does not count. A busy machine leaves out scans, and so does the client
    // then that shows every one; a slower stream is kept at its rate.
    let rate = (shown.len() - 1) as f64 / ((last - first) as f64 / 1000.0);
    let least = if hz == SCANS_HZ { 0.5 } else { 0.9 };
    assert!((least..1.1).contains(&(rate / f64::from(hz))), "{rate} a second");
    assert!(shown.len() as f64 > 1.5 * f64::from(hz), "{} attitudes", shown.len());
    let moved = |k: usize| {
        let all = sent.range(first..=last).map(|(_, values)| values[k]);
        all.clone().fold(f64::MIN, f64::max) - all.fold(f64::MAX, f64::min)
    };
    assert!(moved(0) > 0.5 || moved(1) > 0.5, "it stood still");
    assert!((2..5).all(|k| moved(k) > 0.1), "it did not turn");
    report
}

fn angles(report: &Value) -> Angles {
    let numbers = |row: &[Value]| row[1..].iter().map(|v| v.as_f64().unwrap()).collect();
    let rows = report["attitude"].as_array().unwrap().iter().map(|row| row.as_array().unwrap());
    rows.map(|row| (row[0].as_u64().unwrap(), numbers(row))).collect()
}

#[test]
fn mavsdk_shows_attitude() {
    // It computes degrees in 32 bits.
    let report = compare(python("mavsdk_attitude.py"), 50, 1e-4);
    assert_eq!((&report["system"], &report["components"]), (&json!(SYSTEM), &json!([191])));
    assert_eq!(report["autopilot"], json!(false));
}

#[test]
fn mavproxy_shows_attitude() {
    let mut command = python("mavproxy_attitude.py");
    command.args(["--system", &SYSTEM.to_string()]);
    let report = compare(command, 50, 1e-6);
    assert_eq!(report["errors"], json!([]), "{report}");
}

#[test]
fn node_mavlink_shows_attitude() {
    let mut command = Command::new("node");
    command.arg(clients().join("attitude.mjs")).arg(made("node")).args(["--system", &SYSTEM.to_string()]);
    let report = compare(command, 10, 1e-6);
    assert_eq!(report["damaged"], json!(0), "{report}");
    let heartbeats = report["counts"]["HEARTBEAT"].as_u64().unwrap();
    assert!((3..=6).contains(&heartbeats), "{report}");
}

#[test]
fn tshark_shows_attitude() {
    // It prints six digits of a radian.
    let report = compare(python("dissect.py"), 50, 1e-3);
    assert_eq!(report["errors"], json!([]), "{report}");
}

#[test]
fn tshark_knows_every_message_that_is_sent() {
    let folder = Folder::new();
    let port = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let mut command = python("dissect.py");
    command.args(["--ask", "--system", &SYSTEM.to_string()]);
    let client = spawn(command, port, 12);
    let mut text =
        config(NO_BUS, &[(port, 5)]).replace("[simulation]\n", "[simulation]\nfaults = [\"off:nose@1..4\"]\n");
    text = text.replace("[mavlink]\n", "[mavlink]\nsys-status = true\n");
    let _daemon = Daemon::start(&folder, &text);
    let output = client.wait_with_output().unwrap();
    assert!(output.status.success(), "{output:?}");
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["errors"], json!([]), "{report}");
    println!("{}", report["counts"]);
    // Left out: COMPONENT_INFORMATION_BASIC (396), which pymavlink's common dialect does not have.
    for (id, name) in [
        ("0", "HEARTBEAT"),
        ("1", "SYS_STATUS"),
        ("22", "PARAM_VALUE"),
        ("30", "ATTITUDE"),
        ("31", "ATTITUDE_QUATERNION"),
        ("61", "ATTITUDE_QUATERNION_COV"),
        ("76", "COMMAND_LONG"),
        ("77", "COMMAND_ACK"),
        ("111", "TIMESYNC"),
        ("148", "AUTOPILOT_VERSION"),
        ("244", "MESSAGE_INTERVAL"),
        ("345", "PARAM_ERROR"),
        ("251", "NAMED_VALUE_FLOAT"),
        ("253", "STATUSTEXT"),
    ] {
        assert!(report["counts"][id].as_u64().is_some_and(|n| n > 0), "no {name}: {}", report["counts"]);
    }
}

#[test]
fn mavlink_and_d_bus_show_the_same() {
    let (folder, receiver, bus) = (Folder::new(), Receiver::new(), Bus::new());
    let more = format!("[dbus]\nbus = \"{}\"\n", bus.address());
    let _daemon = Daemon::start(&folder, &config(&more, &[(receiver.port(), SCANS_HZ)]));
    bus.status(std::time::Duration::from_secs(10)).unwrap();
    let mut watch =
        Command::new(CTL).args(["--bus", &bus.address(), "watch", "--json"]).stdout(Stdio::piped()).spawn().unwrap();
    let lines = BufReader::new(watch.stdout.take().unwrap()).lines();
    let done = AtomicBool::new(false);
    let (shown, sent) = std::thread::scope(|scope| {
        let sent = scope.spawn(|| overhear(&receiver, &done));
        let shown: Vec<Value> = lines.take(30).map(|l| serde_json::from_str(&l.unwrap()).unwrap()).collect();
        std::thread::sleep(std::time::Duration::from_millis(100));
        done.store(true, Ordering::Relaxed);
        (shown, sent.join().unwrap())
    });
    watch.kill().unwrap();
    watch.wait().unwrap();
    let mut same = 0;
    for status in &shown {
        let Some(stamp) = status["sample_time_usec"].as_u64() else { panic!("{status}") };
        if let Some([roll, pitch, ..]) = sent.get(&(stamp / 1000 % (1 << 32))).map(Vec::as_slice) {
            let off = |name: &str, angle: f64| (status[name].as_f64().unwrap() - angle).abs();
            assert!(off("roll_deg", *roll) < 1e-4 && off("pitch_deg", *pitch) < 1e-4, "{status} {roll} {pitch}");
            same += 1;
        }
    }
    assert!(same >= 20, "{same}: {shown:?}");
}
