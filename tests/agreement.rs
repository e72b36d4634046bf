//! Whoever tells of the attitude tells the same: MAVLink, D-Bus, replay and lamp at every frame of a flight through
//! fog and a bus that goes silent, whatever is wanted meanwhile.

mod dbus_bus;

use dbus_bus::{Bus, Daemon};
use irhorizon::attitude::{Attitude, Estimate, Mode};
use irhorizon::config::Settings;
use irhorizon::config::settings::Streams;
use irhorizon::config::settings::{Method, OnFault};
use irhorizon::ctl::replay::replay;
use irhorizon::direction::Direction;
use irhorizon::gpio::lamp::lit;
use irhorizon::head::Head;
use irhorizon::horizon::Horizon;
use irhorizon::mavlink::encode::Encoder;
use irhorizon::mavlink::session::{Seen, Session};
use irhorizon::recording::Recording;
use irhorizon::state::Snapshot;
use irhorizon::time::Time;
use mavlink::MavlinkVersion;
use mavlink::dialects::common::MavMessage;
use std::path::PathBuf;

/// Scans a second.
const RATE_HZ: f64 = 10.0;

/// A recording of a banked flight: clear, fog, clear, a silent bus, clear.
fn flight() -> String {
    let names = Direction::NAMED.map(|(name, _)| format!("{name}_obj_c"));
    let mut text = format!("time_s,{}\n", names.join(","));
    let mut scan = 0.0;
    for (seconds, contrast_k, silent) in
        [(2.0, 30.0, false), (3.0, 0.3, false), (8.0, 30.0, false), (2.0, 30.0, true), (2.0, 30.0, false)]
    {
        for _ in 0..(seconds * RATE_HZ) as u32 {
            scan += 1.0;
            let vertical = Attitude::from_degrees(15.0 * (scan * 0.05_f64).sin(), 4.0).vertical();
            let object_c = |d: &Direction| 16.0 - contrast_k / 2.0 * (1.0 + d.dot(vertical));
            let cells =
                Direction::NAMED.map(|(_, d)| if silent { String::new() } else { format!("{:.3}", object_c(&d)) });
            text += &format!("{:.2},{}\n", 100.0 + scan / RATE_HZ, cells.join(","));
        }
    }
    text
}

/// What the pipeline says of each frame with its time, and the rows that `replay` writes of it.
fn replayed(on_fault: OnFault) -> (Vec<(Time, Estimate)>, Vec<String>) {
    let mut settings = Settings::default();
    settings.estimator.method = Some(Method::InverseSine);
    (settings.faults.on_fault, settings.faults.hold_s) = (on_fault, 1.0);
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("agreement-{}.csv", on_fault.as_str()));
    std::fs::write(&path, flight()).unwrap();
    let mut reader = Recording::open(&path).unwrap().frames(None).unwrap();
    let (mut horizon, mut said, mut out) = (Horizon::new(&settings, Head::six()), Vec::new(), Vec::new());
    let mut update = |frame: &_, estimate: &mut _| {
        horizon.update(frame, &[], estimate);
        said.push((frame.time, estimate.clone()));
    };
    replay(&mut reader, false, &mut update, &mut out).unwrap_or_else(|e| panic!("{e:?}"));
    let rows = String::from_utf8(out).unwrap().lines().skip(1).map(str::to_owned).collect();
    (said, rows)
}

/// What a session sends, read from its bytes: the state of the heartbeat if there is one, roll and pitch in degrees.
fn sent(session: &mut Session, now: Time, seen: &Seen) -> (Option<u8>, Option<[f64; 2]>) {
    let (mut encoder, mut state, mut angles) = (Encoder::new(1, 191), None, None);
    session.step(now, seen, &Head::six(), true, |message| {
        let bytes = encoder.encode(message).to_vec();
        match mavlink::MavlinkReader::new(&bytes[..]).read_message(MavlinkVersion::V2).unwrap().1 {
            MavMessage::HEARTBEAT(h) => state = Some(h.system_status as u8),
            MavMessage::ATTITUDE(a) => angles = Some([a.roll, a.pitch].map(|v| f64::from(v).to_degrees())),
            _ => {}
        }
    });
    (state, angles)
}

/// Flies once, compares everybody at each frame; the modes in their order, without repetition.
fn agree(on_fault: OnFault) -> Vec<(Mode, bool)> {
    let (said, rows) = replayed(on_fault);
    let bus = Bus::new();
    let daemon = Daemon::start(&bus);
    let mut client = bus.client();
    let mut stream = Session::new(said[0].0, 0, &Streams::default());
    let (mut seen, mut modes) = (Seen::default(), Vec::new());
    for (i, ((now, estimate), row)) in said.iter().zip(&rows).enumerate() {
        let sequence = i as u64 + 1;
        seen.copy(&Snapshot { sequence, written: *now, estimate: estimate.clone(), ..Snapshot::default() });
        let (_, new) = sent(&mut stream, *now, &seen);
        let (heartbeat, told) = sent(&mut Session::new(*now, 0, &Streams::default()), *now, &seen);
        daemon.frame(|s| s.estimate.clone_from(estimate));
        let status = client.status().unwrap();
        let cells: Vec<&str> = row.split(',').collect();
        let context = format!("frame {i} at {now:?}: {estimate:?}\n{row}\n{status:?}");

        // MAV_STATE: 2 CALIBRATING, 4 ACTIVE, 5 CRITICAL.
        let (state, dark_allowed, lit_allowed) = match status.mode.as_str() {
            "starting" => (2, false, true),
            "nominal" => (4, true, false),
            // What is held is not measured.
            "degraded" => (if estimate.measured { 4 } else { 5 }, true, true),
            "faulted" => (5, false, true),
            other => panic!("{other}"),
        };
        assert_eq!(heartbeat, Some(state), "{context}");
        let lamp = lit(estimate.mode, *now);
        assert!(if lamp { lit_allowed } else { dark_allowed }, "lamp lit: {lamp}, {context}");
        assert_eq!(cells[6], status.mode, "{context}");
        assert_eq!((cells[7].is_empty(), status.faults.len()), (estimate.faults.is_empty(), estimate.faults.len()));

        let on_bus = status.roll_deg.zip(status.pitch_deg).map(|(r, p)| [r, p]);
        assert_eq!((on_bus.is_some(), status.roll_sigma_deg.is_some()), (told.is_some(), told.is_some()), "{context}");
        let in_row = (!cells[1].is_empty()).then(|| [1, 2].map(|c| cells[c].parse::<f64>().unwrap()));
        assert_eq!(in_row.is_some(), new.is_some(), "{context}");
        for angles in [new, told, in_row].into_iter().flatten() {
            let shown = on_bus.unwrap_or_else(|| panic!("{context}"));
            assert!(angles.iter().zip(shown).all(|(a, b)| (a - b).abs() < 6e-4), "{angles:?} {context}");
        }
        let now = (estimate.mode, estimate.attitude.is_some());
        if modes.last() != Some(&now) {
            modes.push(now);
        }
    }
    assert_eq!(said.len(), rows.len());
    modes
}

const NOMINAL: (Mode, bool) = (Mode::Nominal, true);
const WITHHELD: (Mode, bool) = (Mode::Faulted, false);
/// Held. While sensors are not yet believed to be back nothing is given.
const DEGRADED: (Mode, bool) = (Mode::Degraded, true);

#[test]
fn while_it_is_withheld() {
    assert_eq!(agree(OnFault::Withhold), [NOMINAL, WITHHELD, NOMINAL, WITHHELD, NOMINAL]);
}

#[test]
fn while_it_is_held() {
    let expected = [NOMINAL, DEGRADED, WITHHELD, NOMINAL, DEGRADED, WITHHELD, NOMINAL];
    assert_eq!(agree(OnFault::Hold), expected);
}

#[test]
fn while_level_is_shown() {
    let level = (Mode::Faulted, true);
    assert_eq!(agree(OnFault::Level), [NOMINAL, level, NOMINAL, level, NOMINAL]);
}
