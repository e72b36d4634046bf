//! What a real client hears: pymavlink, in the virtual environment that `clients/setup` makes.
//! Without Python or pymavlink these tests fail; they are never skipped.

mod stalls;

use irhorizon::attitude::{Attitude, Estimate, Mode};
use irhorizon::clock;
use irhorizon::config::Settings;
use irhorizon::config::settings::{EndpointAddress, EndpointSettings, MavlinkSettings};
use irhorizon::fault::{ActiveFault, Evidence, FaultKind};
use irhorizon::frame::Missing;
use irhorizon::mavlink::publisher::Publisher;
use irhorizon::mavlink::switchboard::Switchboard;
use irhorizon::state::Shared;
use irhorizon::time::Time;
use serde_json::{Value, json};
use stalls::{Span, Watch};
use std::io::{BufRead, BufReader};
use std::net::UdpSocket;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

fn clients() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/clients")
}

fn python() -> String {
    let setup = Command::new(clients().join("setup")).output().expect("tests/clients/setup runs");
    let told = String::from_utf8_lossy(&setup.stderr);
    assert!(setup.status.success(), "no pymavlink, no test: {told}");
    String::from_utf8(setup.stdout).unwrap().trim().to_owned()
}

/// Runs the publisher to `endpoint`, with a frame 50 times a second made by `estimate` from the
/// frame's number, while the client listens with `args`. What the client says, the frames' stamps,
/// and how the time was in which it listened.
fn hear(
    endpoint: EndpointSettings,
    args: &[&str],
    estimate: impl Fn(u64, &mut Estimate) + Sync,
) -> (Value, Vec<Time>, Span) {
    let mut client = Command::new(python())
        .arg(clients().join("attitude.py"))
        .args(args)
        .args(["--json", "--wait", "20"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    let mut said = BufReader::new(client.stderr.take().unwrap());
    while !line.contains("listening on") {
        assert_ne!(said.read_line(&mut line).unwrap(), 0, "the client ended: {line}");
    }
    let watch = Watch::start();
    let shared = Shared::default();
    let mavlink = MavlinkSettings { system_id: Some(3), endpoints: vec![endpoint], ..Settings::default().mavlink };
    let switchboard = Switchboard::sending(Settings { mavlink, ..Settings::default() });
    let publisher = Publisher::new(&switchboard);
    let head = Arc::new(Settings::default().head());
    let done = AtomicBool::new(false);
    let (output, stamps, span) = std::thread::scope(|scope| {
        scope.spawn(|| publisher.run(&shared, &switchboard));
        let fed = scope.spawn(|| {
            let (mut stamps, mut tick) = (Vec::new(), clock::now());
            for i in 1.. {
                // A tick that was missed on a busy machine is not made up for.
                tick = (tick + Duration::from_millis(20)).max(clock::now());
                clock::sleep_until(tick);
                if done.load(Ordering::Relaxed) {
                    break;
                }
                let now = clock::now();
                shared.update(|s| {
                    s.sequence = i;
                    s.written = now;
                    s.head = Arc::clone(&head);
                    s.estimate.time = tick;
                    s.estimate.valid_at = s.estimate.time;
                    estimate(i, &mut s.estimate);
                });
                stamps.push(tick);
            }
            shared.update(|s| s.stopping = true);
            stamps
        });
        let output = client.wait_with_output();
        let span = watch.stop();
        done.store(true, Ordering::Relaxed);
        (output.unwrap(), fed.join().unwrap(), span)
    });
    assert!(output.status.success(), "{output:?}");
    (serde_json::from_slice(&output.stdout).unwrap(), stamps, span)
}

fn free_port() -> std::net::SocketAddr {
    UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap()
}

fn near(value: &Value, expected: f64, tolerance: f64) -> bool {
    value.as_f64().is_some_and(|v| (v - expected).abs() <= tolerance)
}

#[test]
fn pymavlink_hears_attitude_and_heartbeat() {
    let to = free_port();
    let csv = std::env::temp_dir().join(format!("irhorizon-attitude-{}.csv", std::process::id()));
    let endpoint = EndpointSettings::from(EndpointAddress::UdpOut(to));
    let args = ["--listen", &to.to_string(), "--seconds", "4", "--csv", csv.to_str().unwrap()];
    let begun = clock::now();
    let (heard, stamps, span) = hear(endpoint, &args, |i, estimate| {
        estimate.attitude = Some(Attitude::from_degrees(30.0 * (i as f64 * 0.1).sin(), -12.5));
        estimate.sigma = Attitude::from_degrees(1.0, 2.5);
        estimate.rates = Some([20.0, -3.5, 7.25].map(f64::to_radians));
        estimate.contrast_k = Some(21.25);
        estimate.measured = true;
        estimate.mode = Mode::Nominal;
    });
    let ended = clock::now();
    let table = std::fs::read_to_string(&csv).unwrap();
    std::fs::remove_file(&csv).unwrap();

    assert_eq!((&heard["bad_data"], &heard["lost"]), (&json!(0), &json!(0)), "{heard}");
    assert_eq!((&heard["magic"], &heard["senders"]), (&json!([0xfd]), &json!([[3, 191]])), "{heard}");
    let attitude = &heard["attitude"];
    assert!(span.allows(attitude["rate_hz"].as_f64().unwrap(), 49.0..=51.0), "{span}: {heard}");
    assert!(near(&attitude["roll_deg"]["min"], -30.0, 0.1) && near(&attitude["roll_deg"]["max"], 30.0, 0.1), "{heard}");
    assert!(near(&attitude["pitch_deg"]["min"], -12.5, 1e-4) && near(&attitude["pitch_deg"]["max"], -12.5, 1e-4));
    assert_eq!((&attitude["yaw_deg"]["min"], &attitude["yaw_deg"]["max"]), (&json!(0.0), &json!(0.0)));
    for (span, rate) in attitude["rates_deg_s"].as_array().unwrap().iter().zip([20.0, -3.5, 7.25]) {
        assert!(near(&span["min"], rate, 1e-4) && near(&span["max"], rate, 1e-4), "{heard}");
    }
    assert_eq!((&attitude["time_boot_ms_monotonic"], &attitude["time_boot_ms_repeats"]), (&json!(true), &json!(0)));
    let ms = |t: Time| t.as_nanos() / 1_000_000 % (1 << 32);
    let [first, last] = ["first", "last"].map(|at| attitude["time_boot_ms"][at].as_u64().unwrap());
    assert!((ms(begun)..=ms(ended)).contains(&last), "{last} is not milliseconds since boot");
    // As many as there were frames, which on a machine that stands still are fewer than 50 a second.
    let fed = stamps.iter().filter(|t| (first..=last).contains(&ms(**t))).count();
    println!("{fed} frames, {} ATTITUDE, {} Hz", attitude["count"], attitude["rate_hz"]);
    assert!(
        near(&attitude["count"], fed as f64, 0.02 * fed as f64) && last - first > 3500,
        "{fed} frames, but {heard}"
    );

    let heartbeat = &heard["heartbeat"];
    assert!((4..=5).contains(&heartbeat["count"].as_u64().unwrap()), "{heard}");
    let fields = ["type", "autopilot", "base_mode", "mavlink_version"].map(|f| heartbeat[f].as_u64().unwrap());
    assert_eq!(fields, [18, 8, 0, 3], "{heard}");
    // Whatever was first (1: BOOT until the first frame), ACTIVE from then on.
    let states = heartbeat["system_status"].as_array().unwrap();
    assert!(states.iter().skip(1).all(|s| *s == json!(4)) && [json!(1), json!(4)].contains(&states[0]), "{heard}");
    // 1 / (1 + (2.5/5)²)
    assert!(near(&heard["values"]["ir_qual"]["last"], 0.8, 1e-6), "{heard}");
    assert!(near(&heard["values"]["ir_contr"]["last"], 21.25, 1e-6), "{heard}");
    assert_eq!(heard["statustext"], json!([]));

    let lines: Vec<&str> = table.lines().collect();
    assert_eq!(lines[0], "time_boot_ms,roll_deg,pitch_deg,receive_time");
    assert_eq!(lines.len() as u64 - 1, attitude["count"].as_u64().unwrap());
    assert!(lines[1].split(',').nth(2).unwrap().starts_with("-12.5"));
}

#[test]
fn pymavlink_as_a_peer_of_udpin_hears_faults_and_no_attitude_meanwhile() {
    let at = free_port();
    let mut endpoint = EndpointSettings::from(EndpointAddress::UdpIn(at));
    endpoint.streams.attitude_hz = Some(10.0);
    let args = ["--connect", &at.to_string(), "--seconds", "4"];
    let fault = ActiveFault {
        kind: FaultKind::SensorLost(0),
        since: Time::default(),
        evidence: Evidence::Missing { reason: Missing::NoAnswer, failures: 5 },
    };
    let (heard, stamps, span) = hear(endpoint, &args, |i, estimate| {
        // The client greets once a second: well after that, a fault for one second.
        let gone = (100..150).contains(&i);
        estimate.attitude = (!gone).then(|| Attitude::from_degrees(45.0, 0.0));
        estimate.measured = !gone;
        estimate.mode = if gone { Mode::Faulted } else { Mode::Nominal };
        estimate.faults.clear();
        if gone {
            estimate.faults.push(fault);
        }
    });
    assert_eq!((&heard["bad_data"], &heard["lost"]), (&json!(0), &json!(0)), "{heard}");
    assert_eq!(
        heard["statustext"],
        json!([
            { "severity": 2, "text": "irhorizon: sensor-lost:nose (no answer)" },
            { "severity": 5, "text": "irhorizon: sensor-lost:nose cleared" },
        ])
    );
    let attitude = &heard["attitude"];
    // 10 Hz for 4 s, less one second without; a machine that stands still makes it longer, and is late by itself.
    let (gone_s, still_s) = (stamps[149].since(stamps[98]), span.still.as_secs_f64());
    println!(
        "without for {gone_s:.2} s, {} s heard; the machine stood still for {still_s:.2} s",
        attitude["longest_gap_s"]
    );
    assert!(near(&attitude["count"], 10.0 * (4.0 - gone_s), 3.0 + 10.0 * still_s), "{heard}");
    assert!(near(&attitude["longest_gap_s"], gone_s + 0.05, 0.15 + still_s), "{heard}");
    let states = heard["heartbeat"]["system_status"].as_array().unwrap();
    assert!(states.contains(&json!(5)) && states.last() == Some(&json!(4)), "{heard}");
    assert_eq!(heard["values"]["ir_qual"]["min"], json!(0.0));
}
