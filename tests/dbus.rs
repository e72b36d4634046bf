//! The D-Bus service beside real clients on a real bus.

mod dbus_bus;
mod stalls;

use dbus_bus::{Bus, Daemon};
use irhorizon::aiding::{Autopilot, Link};
use irhorizon::attitude::{Attitude, Hint, Mode};
use irhorizon::bus::Counters;
use irhorizon::ctl::client::{Client, ClientError};
use irhorizon::ctl::view;
use irhorizon::dbus::DbusError;
use irhorizon::fault::{ActiveFault, Evidence, FaultKind};
use irhorizon::frame::{Missing, Sample, Value};
use irhorizon::source::{Integrity, SensorHealth};
use irhorizon::state::Snapshot;
use irhorizon::time::Time;
use stalls::Watch;
use std::time::{Duration, Instant};

/// The service ends within 0.2 s; a busy machine may take a little more.
fn assert_stops_soon(mut daemon: Daemon) {
    let watch = Watch::start();
    daemon.stop();
    let took = watch.stop();
    assert!(took.within(Duration::from_millis(300)), "{took:?}");
}

fn level(s: &mut Snapshot) {
    s.estimate.attitude = Some(Attitude::from_degrees(12.5, -3.0));
    s.estimate.measured = true;
    s.estimate.sigma = Attitude::from_degrees(0.5, 0.25);
    s.estimate.trim = Attitude { roll: 0.0, pitch: 6_f64.to_radians() };
    s.estimate.contrast_k = Some(31.5);
    s.estimate.hint = Some(Hint { bearing: -0.25 * std::f64::consts::PI, strength_k: 3.5 });
    s.estimate.residuals_k = vec![Some(0.5), None, Some(-2.0)];
    s.estimate.mode = Mode::Nominal;
    s.estimate.time = Time::from_nanos(5_000_000_999);
    s.estimate.faults.clear();
    s.rate_hz = 50.0;
}

fn lose_down(s: &mut Snapshot) {
    let evidence = Evidence::Missing { reason: Missing::NoAnswer, failures: 7 };
    s.estimate.faults =
        vec![ActiveFault { kind: FaultKind::SensorLost(2), since: Time::from_nanos(4_000_000_000), evidence }];
    s.estimate.mode = Mode::Degraded;
}

#[test]
fn busctl_reads_what_was_estimated() {
    let bus = Bus::new();
    let daemon = Daemon::start(&bus);
    assert_eq!(daemon.first, Some(Ok(())));
    assert_eq!((bus.property("RollDeg"), bus.property("Mode")), ("d nan".into(), "s \"starting\"".into()));
    assert_eq!(bus.property("Autopilot"), "a{sd} 0");
    assert_eq!((bus.property("HintBearingDeg"), bus.property("HintStrengthC")), ("d nan".into(), "d nan".into()));
    daemon.frame(|s| {
        level(s);
        lose_down(s);
    });
    for (name, value) in [
        ("RollDeg", "d 12.5"),
        ("PitchDeg", "d -3"),
        ("RollSigmaDeg", "d 0.5"),
        ("PitchSigmaDeg", "d 0.25"),
        ("Measured", "b true"),
        ("RollTrimDeg", "d 0.5"),
        ("PitchTrimDeg", "d 4"),
        ("PitchTrimLearntDeg", "d 6"),
        ("ContrastC", "d 31.5"),
        ("HintBearingDeg", "d -45"),
        ("HintStrengthC", "d 3.5"),
        ("Mode", "s \"degraded\""),
        ("Faults", "as 1 \"sensor-lost:down\""),
        ("FaultDetails", "a(sts) 1 \"sensor-lost:down\" 4000000 \"no answer, 7 reads in a row\""),
        ("Method", "s \"inverse-sine\""),
        ("SampleTimeUsec", "t 5000000"),
        ("RateHz", "d 50"),
        ("Version", &format!("s \"{}\"", env!("CARGO_PKG_VERSION"))),
        (
            "Endpoints",
            "a(sa(st)s) 1 \"udpout:127.0.0.1:14550\" 8 \"sent\" 42 \"failed\" 1 \"dropped\" 0 \"received\" 7 \"skipped-bytes\" 0 \"bad-crc\" 0 \"peers\" 1 \"tlog-lost\" 0 \"connection refused\"",
        ),
    ] {
        assert_eq!(bus.property(name), value, "{name}");
    }
    let set = ["set-property", "org.irhorizon1", "/org/irhorizon1", "org.irhorizon1.Horizon", "RollDeg", "d", "1"];
    assert!(bus.busctl(&set).is_err(), "read-only");
    let tree = bus.busctl(&["tree", "--list", "org.irhorizon1"]).unwrap();
    for path in ["/org/irhorizon1", "/org/irhorizon1/sensor/nose", "/org/irhorizon1/sensor/long"] {
        assert!(tree.lines().any(|l| l == path), "{tree}");
    }
}

#[test]
fn withheld_attitude_is_nan_and_never_the_last_value() {
    let bus = Bus::new();
    let daemon = Daemon::start(&bus);
    daemon.frame(level);
    assert_eq!(bus.property("RollDeg"), "d 12.5");
    daemon.frame(|s| {
        s.estimate.attitude = None;
        s.estimate.mode = Mode::Faulted;
    });
    for name in ["RollDeg", "PitchDeg", "RollSigmaDeg", "PitchSigmaDeg"] {
        assert_eq!(bus.property(name), "d nan", "{name}");
    }
    assert_eq!((bus.property("Measured"), bus.property("ContrastC")), ("b false".into(), "d 31.5".into()));
    daemon.frame(|s| (s.estimate.attitude, s.estimate.measured) = (Some(Attitude::default()), false));
    assert_eq!((bus.property("Measured"), bus.property("RollDeg")), ("b false".into(), "d 0".into()), "it stands in");
}

#[test]
fn a_sampling_loop_that_hangs_is_not_believed() {
    let bus = Bus::new();
    let daemon = Daemon::start(&bus);
    let measured = |s: &mut Snapshot| {
        level(s);
        s.frame.readings[0] =
            Ok(Sample { value: Value::Absolute { object_c: 11.5, ambient_c: None }, time: Time::default() });
    };
    daemon.frame(measured);
    let monitor = bus.monitor();
    // The limit is 1 s.
    std::thread::sleep(Duration::from_millis(1_300));
    let status = bus.client().status().unwrap();
    assert_eq!((status.mode.as_str(), status.roll_deg, status.contrast_c), ("faulted", None, None));
    assert_eq!(status.faults[0].name, "stale");
    assert_eq!((status.sensors[0].state.as_str(), status.sensors[0].object_c), ("stale", None));
    let signals = monitor.stop();
    assert_eq!(signals[0]["Mode"]["data"], "faulted");
    daemon.frame(measured);
    let status = bus.client().status().unwrap();
    assert_eq!((status.mode.as_str(), status.roll_deg, status.faults.len()), ("nominal", Some(12.5), 0));
}

#[test]
fn a_client_sees_the_whole_state_with_the_sensors_in_order() {
    let bus = Bus::new();
    let daemon = Daemon::start(&bus);
    daemon.frame(|s| {
        level(s);
        lose_down(s);
        let time = Time::from_nanos(5_000_000_000);
        s.frame.readings = vec![
            Ok(Sample { value: Value::Absolute { object_c: -7.25, ambient_c: Some(21.0) }, time }),
            Ok(Sample { value: Value::Volts(1.625), time }),
            Err(Missing::NoAnswer),
        ];
        let counters = Counters { reads: 100, bad_pec: 3, ..Counters::default() };
        s.health[0] = SensorHealth {
            lag_s: 0.1,
            integrity: Integrity::SoftwarePec,
            counters,
            settling_s: 0.31,
            emissivity: Some(1.0),
            identity: Some(0x1234_0000_0000_00ab),
        };
        s.autopilot = Autopilot {
            link: Link { system: Some(7), rates_hz: 49.0, gps_hz: 5.0, synced: true, ..Link::default() },
            late_s: Some(0.0375),
            differs: Some(Attitude::from_degrees(2.0, -1.0)),
            ..Autopilot::default()
        };
    });
    let status = bus.client().status().unwrap();
    assert_eq!((status.roll_deg, status.pitch_sigma_deg), (Some(12.5), Some(0.25)));
    assert!(status.sample_age_s > 0.0 && status.faults[0].for_s > status.sample_age_s);
    assert_eq!((status.endpoints[0].sent, status.endpoints[0].last_error.as_str()), (42, "connection refused"));
    let names: Vec<_> = status.sensors.iter().map(|s| s.name.as_str()).collect();
    assert_eq!(names, ["nose", "long", "down"]);
    let [nose, long, down] = &status.sensors[..] else { panic!("three sensors") };
    assert_eq!((nose.residual_c, long.residual_c, down.residual_c), (Some(0.5), None, Some(-2.0)));
    assert_eq!(status.hint, Some(view::Hint { bearing_deg: -45.0, strength_c: 3.5 }));
    let autopilot = status.autopilot.unwrap();
    assert_eq!((autopilot.system_id, autopilot.rates_hz, autopilot.gps_hz), (7, 49.0, 5.0));
    assert_eq!((autopilot.late_s, autopilot.used, autopilot.synced), (Some(0.0375), false, true));
    assert!((autopilot.roll_difference_deg.unwrap() - 2.0).abs() < 1e-9);
    assert_eq!(status.faults[0].advice, "irhorizonctl sensors says what to look at");
    assert_eq!((nose.kind.as_str(), nose.bus.as_str(), nose.address), ("mlx90614", "/dev/i2c-1", 0x5b));
    assert_eq!((nose.object_c, nose.ambient_c, nose.volts), (Some(-7.25), Some(21.0), None));
    assert_eq!((nose.integrity.as_str(), nose.settling_s, nose.emissivity), ("software-pec", 0.31, Some(1.0)));
    assert_eq!(nose.identity, "12340000000000ab");
    assert!(nose.counters.contains(&("bad-pec".into(), 3)) && nose.counters.contains(&("reads".into(), 100)));
    assert_eq!((long.volts, long.object_c, long.state.as_str()), (Some(1.625), None, "ok"));
    assert_eq!((down.state.as_str(), down.object_c, down.emissivity), ("no answer", None, None));
}

#[test]
fn one_signal_an_update_and_none_without_a_change() {
    let bus = Bus::new();
    let daemon = Daemon::start(&bus);
    daemon.frame(level);
    std::thread::sleep(Duration::from_millis(150));
    let monitor = bus.monitor();
    let watch = Watch::start();
    for i in 1..=50 {
        daemon.shared.update(|s| {
            s.sequence += 1;
            s.written = irhorizon::clock::now();
            s.estimate.attitude = Some(Attitude::from_degrees(20.0 + f64::from(i), -20.0 - f64::from(i)));
            s.estimate.time = Time::from_nanos(i as u64 * 20_000_000);
        });
        std::thread::sleep(Duration::from_millis(20));
    }
    // A second or so at 10 Hz.
    let (span, signals) = (watch.stop(), monitor.stop());
    assert!(span.rate(signals.len()).is(7.0..=12.0), "{}", span.rate(signals.len()));
    for s in &signals {
        let mut names: Vec<_> = s.keys().map(String::as_str).collect();
        names.sort_unstable();
        assert_eq!(names, ["PitchDeg", "RollDeg", "SampleTimeUsec"], "all that changed, nothing else");
        assert_eq!(s["RollDeg"]["data"].as_f64().unwrap().round(), -s["PitchDeg"]["data"].as_f64().unwrap().round());
    }
    let monitor = bus.monitor();
    for _ in 0..10 {
        daemon.frame(|_| ());
    }
    assert_eq!(monitor.stop().len(), 0, "nothing has changed");
}

#[test]
fn forty_signals_a_second_when_they_are_asked_for() {
    let bus = Bus::new();
    let daemon = Daemon::signalling_every(&bus, Duration::from_millis(25));
    daemon.frame(level);
    let monitor = bus.monitor();
    let watch = Watch::start();
    for i in 0..400 {
        daemon.shared.update(|s| {
            s.sequence += 1;
            s.written = irhorizon::clock::now();
            s.estimate.attitude = Some(Attitude::from_degrees(f64::from(i) * 0.1, 0.0));
        });
        std::thread::sleep(Duration::from_millis(5));
    }
    let rate = watch.stop().rate(monitor.stop().len());
    assert!(rate.is(28.0..=41.0), "{rate}");
}

#[test]
fn a_fault_is_signalled_at_once() {
    let bus = Bus::new();
    let daemon = Daemon::signalling_every(&bus, Duration::from_secs(10));
    daemon.frame(|_| ());
    daemon.frame(level);
    let monitor = bus.monitor();
    daemon.frame(lose_down);
    daemon.frame(|s| s.estimate.attitude = Some(Attitude::from_degrees(1.0, 1.0)));
    daemon.frame(level);
    let signals = monitor.stop();
    assert_eq!(signals.len(), 2, "{signals:?}");
    assert_eq!(signals[0]["Mode"]["data"], "degraded");
    assert_eq!(signals[0]["Faults"]["data"][0], "sensor-lost:down");
    assert_eq!(signals[1]["Mode"]["data"], "nominal");
}

#[test]
fn the_name_belongs_to_the_first() {
    let bus = Bus::new();
    let first = Daemon::start(&bus);
    first.frame(level);
    let second = Daemon::start(&bus);
    let Some(Err(error @ DbusError::NameOwned { .. })) = &second.first else { panic!("{:?}", second.first) };
    assert!(error.fatal());
    let text = error.to_string();
    assert!(text.starts_with("org.irhorizon1 is owned already on the bus at unix:path="), "{text}");
    assert!(text.contains(&format!("(pid {}, ", std::process::id())), "{text}");
    assert!(text.ends_with("): is another irhorizond running? systemctl status irhorizond"), "{text}");
    // REPLACE_EXISTING | DO_NOT_QUEUE: the answer 3 is EXISTS (D-Bus specification, RequestName).
    let dbus = "org.freedesktop.DBus";
    let request = ["call", dbus, "/org/freedesktop/DBus", dbus, "RequestName", "su", "org.irhorizon1", "6"];
    assert_eq!(bus.busctl(&request).unwrap(), "u 3");
    assert_eq!(bus.property("RollDeg"), "d 12.5");
}

#[test]
fn who_went_on_without_an_answer_gets_the_name_when_it_is_free() {
    let bus = Bus::new();
    let mut first = Daemon::start(&bus);
    let second = Daemon::impatient(&bus);
    assert_eq!(second.first, None);
    std::thread::sleep(Duration::from_millis(300));
    first.stop();
    assert_eq!(bus.status(Duration::from_secs(3)).unwrap().mode, "starting");
    assert_stops_soon(second);
}

#[test]
fn nobody_there_tells_how_to_start_one() {
    let bus = Bus::new();
    let error = bus.client().status().unwrap_err();
    assert!(error.no_daemon());
    assert!(error.to_string().contains("no irhorizond on the bus at unix:path="), "{error}");
    let error = ClientError::NoDaemon(irhorizon::config::settings::BusAddress::System).to_string();
    let says = "no irhorizond on the system bus: start it with `systemctl start irhorizond`, or give --bus session";
    assert_eq!(error, says);
}

#[test]
fn the_service_is_back_after_the_bus_was_restarted() {
    let mut bus = Bus::new();
    let daemon = Daemon::start(&bus);
    daemon.frame(level);
    let mut client = bus.client();
    client.status().unwrap();
    // After the second, a pause of 1.6 s and more between two attempts would have just begun.
    for away in [0.3, 3.2] {
        bus.kill();
        assert!(client.status().unwrap_err().no_daemon());
        std::thread::sleep(Duration::from_secs_f64(away));
        bus.start();
        let watch = Watch::start();
        daemon.frame(level);
        let status = bus.status(Duration::from_secs(2)).unwrap();
        let back = watch.stop();
        assert!(back.within(Duration::from_millis(1500)), "{back:?} after {away} s");
        assert_eq!((status.mode.as_str(), status.sensors.len()), ("nominal", 3));
        // The one that it came back with may be a second old.
        daemon.frame(level);
        assert_eq!(client.status().unwrap().roll_deg, Some(12.5), "the same client goes on");
    }
    assert_stops_soon(daemon);
    assert!(matches!(client.status(), Err(ClientError::NoDaemon(_))));
}

#[test]
fn a_bus_that_comes_later_is_joined() {
    let mut bus = Bus::absent();
    let daemon = Daemon::start(&bus);
    let Some(Err(error @ DbusError::Unreachable { .. })) = &daemon.first else { panic!("{:?}", daemon.first) };
    assert!(!error.fatal() && error.to_string().contains("cannot be reached"), "{error}");
    let Err(ClientError::NoBus(..)) = Client::connect(&bus.choice()) else { panic!("no bus") };
    bus.start();
    assert_eq!(bus.status(Duration::from_secs(3)).unwrap().mode, "starting");
    bus.kill();
    std::thread::sleep(Duration::from_millis(500));
    // Also while it waits for the bus.
    assert_stops_soon(daemon);
}

#[test]
fn a_bus_that_hangs_holds_up_nobody() {
    let bus = Bus::new();
    let daemon = Daemon::start(&bus);
    let mut client = bus.client();
    daemon.frame(level);
    bus.signal("STOP");
    let (mut spent, watch) = (Duration::ZERO, Watch::start());
    for i in 0..500 {
        let before = Instant::now();
        daemon.shared.update(|s| {
            s.sequence += 1;
            s.written = irhorizon::clock::now();
            s.estimate.mode = if i % 2 == 0 { Mode::Nominal } else { Mode::Degraded };
        });
        spent += before.elapsed();
        std::thread::sleep(Duration::from_millis(2));
    }
    assert!(spent < Duration::from_millis(500) + watch.stop().still, "{spent:?} for 500 frames");
    let watch = Watch::start();
    assert!(matches!(client.status(), Err(ClientError::Silent(_, how)) if how.contains("no answer within 3 s")));
    assert!(matches!(Client::connect(&bus.choice()), Err(ClientError::NoBus(..))));
    let took = watch.stop();
    assert!(took.within(Duration::from_secs(8)), "{took:?}");
    bus.signal("CONT");
    daemon.frame(level);
    assert_eq!(client.status().unwrap().mode, "nominal");
    bus.signal("STOP");
    assert_stops_soon(daemon);
    bus.signal("CONT");
}

#[test]
fn a_stream_gives_the_header_and_then_the_lines() {
    let bus = Bus::new();
    let daemon = Daemon::start(&bus);
    let mut frames = bus.client().frames().unwrap();
    let mut line = String::new();
    daemon.taps.offer(&mut line, |l| l.push_str("0.02,1.5\n"));
    assert_eq!(frames.next_line().unwrap().as_deref(), Some("time_s,nose_obj_c\n"));
    assert_eq!(frames.next_line().unwrap().as_deref(), Some("0.02,1.5\n"));
    let more: Vec<_> = (0..7).map(|_| bus.client().frames().unwrap()).collect();
    match bus.client().frames().map(drop) {
        Err(ClientError::Busy(why)) => assert!(why.contains("8 recordings"), "{why}"),
        other => panic!("{other:?}"),
    }
    drop(more);
}

#[test]
fn a_reload_tells_its_outcome_and_changes_the_sensors() {
    let bus = Bus::new();
    let daemon = Daemon::start(&bus);
    let mut client = bus.client();
    client.reload().unwrap();
    *daemon.control.reload.lock().unwrap() = Err("irhorizon.toml: line 3: rate-hz: 900 is above 200".into());
    let error = client.reload().unwrap_err();
    assert_eq!(error, ClientError::Config("irhorizon.toml: line 3: rate-hz: 900 is above 200".into()));
    let call = ["call", "org.irhorizon1", "/org/irhorizon1", "org.irhorizon1.Control", "Reload"];
    assert!(bus.busctl(&call).unwrap_err().contains("rate-hz: 900"));

    let mut fewer = dbus_bus::info();
    fewer.sensors.truncate(1);
    *daemon.control.info.lock().unwrap() = fewer.into();
    daemon.frame(|_| ());
    let names: Vec<_> = client.status().unwrap().sensors.into_iter().map(|s| s.name).collect();
    assert_eq!(names, ["nose"]);
}
