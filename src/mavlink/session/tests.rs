use super::*;
use crate::attitude::Attitude;
use crate::fault::ActiveFault;
use crate::frame::Missing;
use crate::head::Head;
use crate::state::{Moment, Snapshot};
use ::mavlink::dialects::common::MavSeverity;
use proptest::prelude::*;

fn at(secs: f64) -> Time {
    Time::from_secs_f64(1000.0 + secs)
}

/// A frame that is fresh at `secs`.
fn frame(sequence: u64, secs: f64) -> Seen {
    let moment = Moment {
        sequence,
        written: at(secs),
        time: at(secs - 0.002),
        valid_at: at(secs - 0.002),
        attitude: Some(Attitude::from_degrees(10.0, 5.0)),
        measured: true,
        sigma: Attitude::from_degrees(1.0, 1.0),
        mode: Mode::Nominal,
        ..Moment::default()
    };
    Seen { moment, contrast_k: Some(20.0), ..Seen::default() }
}

/// A frame with these faults, its attitude changed.
fn but(seen: Seen, faults: &[ActiveFault], change: impl FnOnce(&mut Moment)) -> Seen {
    let mut seen = Seen { faults: faults.to_vec(), ..seen };
    change(&mut seen.moment);
    seen
}

fn lost(sensor: usize) -> ActiveFault {
    let evidence = Evidence::Missing { reason: Missing::NoAnswer, failures: 9 };
    ActiveFault { kind: FaultKind::SensorLost(sensor), since: at(0.0), evidence }
}

fn step(session: &mut Session, secs: f64, seen: &Seen) -> Vec<Message> {
    let mut sent = Vec::new();
    session.step(at(secs), seen, &Head::six(), true, |m| sent.push(m.clone()));
    sent
}

fn states(sent: &[Message]) -> Vec<MavState> {
    sent.iter().filter_map(|m| if let Message::Heartbeat(h) = m { Some(h.system_status) } else { None }).collect()
}

fn attitudes(sent: &[Message]) -> usize {
    sent.iter().filter(|m| matches!(m, Message::Attitude(_))).count()
}

fn texts(sent: &[Message]) -> Vec<(MavSeverity, String)> {
    let text = |m: &Message| match m {
        Message::Text(t) => Some((t.severity, t.text.to_str().unwrap().to_owned())),
        _ => None,
    };
    sent.iter().filter_map(text).collect()
}

fn values(sent: &[Message], name: &str) -> Vec<f32> {
    let value = |m: &Message| match m {
        Message::Value(v) if v.name.to_str() == Ok(name) => Some(v.value),
        _ => None,
    };
    sent.iter().filter_map(value).collect()
}

#[test]
fn one_attitude_for_each_frame_and_the_rest_each_second() {
    let mut session = Session::new(at(0.0), 0, &Streams::default());
    let mut sent = Vec::new();
    for i in 0..500_u32 {
        let secs = f64::from(i) / 50.0;
        sent.extend(step(&mut session, secs, &frame(u64::from(i) + 1, secs)));
        // Awake without a new frame: nothing more to say.
        assert!(step(&mut session, secs + 0.001, &frame(u64::from(i) + 1, secs)).is_empty());
    }
    assert_eq!(attitudes(&sent), 500);
    assert_eq!(states(&sent), [MavState::MAV_STATE_ACTIVE; 10]);
    assert_eq!(values(&sent, "ir_contr"), [20.0; 10]);
    assert_eq!(values(&sent, "ir_qual").len(), 10);
    assert!(texts(&sent).is_empty());
}

#[test]
fn attitude_comes_first() {
    let sent = step(&mut Session::new(at(0.0), 0, &Streams::default()), 0.0, &frame(1, 0.0));
    assert!(matches!(sent[0], Message::Attitude(_)), "{sent:?}");
}

#[test]
fn the_state_tells_the_mode() {
    let table = [
        (Mode::Starting, MavState::MAV_STATE_CALIBRATING),
        (Mode::Nominal, MavState::MAV_STATE_ACTIVE),
        (Mode::Degraded, MavState::MAV_STATE_ACTIVE),
        (Mode::Faulted, MavState::MAV_STATE_CRITICAL),
    ];
    for (mode, state) in table {
        let seen = but(frame(1, 0.0), &[], |m| m.mode = mode);
        assert_eq!(states(&step(&mut Session::new(at(0.0), 0, &Streams::default()), 0.0, &seen)), [state]);
    }
}

#[test]
fn another_state_is_told_at_once_and_each_second_from_then_on() {
    use MavState::{MAV_STATE_ACTIVE as ACTIVE, MAV_STATE_CRITICAL as CRITICAL};
    let mut session = Session::new(at(0.0), 0, &Streams::default());
    let mut told = Vec::new();
    for i in 0..200_u32 {
        let secs = f64::from(i) * 0.02;
        // Withheld from 0.3 to 2 s; from 3 s on it changes with each frame.
        let withheld = (15..100).contains(&i) || i > 150 && i % 2 == 0;
        let mode = if withheld { Mode::Faulted } else { Mode::Nominal };
        let sent = step(&mut session, secs, &but(frame(u64::from(i) + 1, secs), &[], |m| m.mode = mode));
        told.extend(states(&sent).into_iter().map(|state| (i, state)));
    }
    assert_eq!(told[..5], [(0, ACTIVE), (15, CRITICAL), (65, CRITICAL), (100, ACTIVE), (150, ACTIVE)]);
    assert!((5..=10).contains(&told[5..].len()), "{told:?}");
    assert!(told.windows(2).all(|t| t[1].0 - t[0].0 >= 5 && t[1].0 - t[0].0 <= 50), "{told:?}");
}

#[test]
fn no_attitude_while_it_is_withheld_and_never_the_last_one() {
    let mut session = Session::new(at(0.0), 0, &Streams::default());
    assert_eq!(attitudes(&step(&mut session, 0.0, &frame(1, 0.0))), 1);
    for i in 1..100_u32 {
        let secs = f64::from(i) * 0.02;
        let seen = but(frame(u64::from(i) + 1, secs), &[], |m| (m.attitude, m.mode) = (None, Mode::Faulted));
        let sent = step(&mut session, secs, &seen);
        assert_eq!(attitudes(&sent), 0);
        assert!(values(&sent, "ir_qual").iter().all(|q| *q == 0.0));
    }
    assert_eq!(attitudes(&step(&mut session, 2.0, &frame(101, 2.0))), 1);
    // A frame without a new measurement.
    assert_eq!(attitudes(&step(&mut session, 2.02, &but(frame(102, 2.02), &[], |m| m.valid_at = at(1.998)))), 0);
    // The frame that was there when the stream began.
    assert_eq!(attitudes(&step(&mut Session::new(at(2.03), 102, &Streams::default()), 2.03, &frame(102, 2.02))), 0);
}

#[test]
fn frames_that_were_passed_over_are_told_once_in_their_order_and_not_when_old() {
    let mut session = Session::new(at(0.0), 0, &Streams::default());
    let mut stamps = Vec::new();
    let mut passed_over = |session: &mut Session, now, seen: &Seen| {
        session.passed_over(at(now), seen, |m| {
            let Message::Attitude(a) = m else { panic!("{m:?}") };
            stamps.push(a.time_boot_ms);
        });
    };
    assert_eq!(attitudes(&step(&mut session, 0.0, &frame(1, 0.0))), 1);
    for (sequence, secs) in [(1, 0.0), (2, 0.02), (3, 0.04), (2, 0.02)] {
        passed_over(&mut session, 0.07, &frame(sequence, secs));
    }
    passed_over(&mut session, 2.0, &frame(4, 0.06));
    assert_eq!(attitudes(&step(&mut session, 2.0, &frame(5, 2.0))), 1);
    passed_over(&mut session, 2.0, &frame(4, 2.0));
    // Stamped 2 ms before each was written.
    assert_eq!(stamps, [1_000_018, 1_000_038]);
}

#[test]
fn dead_sampling_is_critical_after_one_second_and_silent_after_three() {
    let mut session = Session::new(at(0.0), 0, &Streams::default());
    let seen = frame(1, 0.0);
    assert_eq!(states(&step(&mut session, 0.0, &seen)), [MavState::MAV_STATE_ACTIVE]);
    let mut sent = Vec::new();
    for i in 1..200_u32 {
        let secs = f64::from(i) * 0.05;
        let now = step(&mut session, secs, &seen);
        assert!(secs < 3.0 || now.is_empty(), "{now:?} at {secs} s");
        sent.extend(now);
    }
    assert_eq!(attitudes(&sent), 0);
    assert_eq!(states(&sent), [MavState::MAV_STATE_CRITICAL; 2]);
    assert_eq!(values(&sent, "ir_qual"), [0.0; 2]);
    assert!(values(&sent, "ir_contr").is_empty(), "the contrast of an old sample was sent again");
    let critical = MavSeverity::MAV_SEVERITY_CRITICAL;
    assert_eq!(texts(&sent), [(critical, "irhorizon: stale (1.00 s, limit 1.00 s)".into())]);
    let sent = step(&mut session, 20.0, &frame(2, 20.0));
    assert_eq!(states(&sent), [MavState::MAV_STATE_ACTIVE]);
    assert_eq!(attitudes(&sent), 1);
    assert_eq!(texts(&sent), [(MavSeverity::MAV_SEVERITY_NOTICE, "irhorizon: stale cleared".into())]);
}

#[test]
fn where_there_is_silence_nothing_is_sent_to_who_asks_either() {
    let mut session = Session::new(at(0.0), 0, &Streams::default());
    let mut asked = |id, secs| {
        let mut sent = 0;
        (session.request(id, at(secs), &frame(1, 0.0), |_| sent += 1), sent > 0)
    };
    // HEARTBEAT, SYS_STATUS, NAMED_VALUE_FLOAT; of STATUSTEXT the next step would tell.
    for id in [0, 1, 251] {
        assert_eq!([asked(id, 2.9), asked(id, 3.0)], [(Asked::Sent, true), (Asked::NotNow, false)], "{id}");
    }
    assert_eq!([asked(253, 2.9), asked(253, 3.0)], [(Asked::Sent, false), (Asked::NotNow, false)]);
    assert_eq!(asked(30, 3.0), (Asked::NotNow, false));
    assert_eq!(asked(33, 3.0), (Asked::Unknown, false));
}

#[test]
fn slow_frames_are_not_dead() {
    for (hz, dead_s) in [(1.0, 2.5), (2.0, 1.25), (50.0, 1.0)] {
        let mut session = Session::new(at(0.0), 0, &Streams::default()).with_frame_rate(hz);
        let mut state = |secs| {
            let mut sent = Vec::new();
            session.request(0, at(secs), &frame(1, 0.0), |m| sent.push(m.clone()));
            states(&sent)
        };
        let (active, critical) = ([MavState::MAV_STATE_ACTIVE], [MavState::MAV_STATE_CRITICAL]);
        assert_eq!((state(dead_s - 0.01), state(dead_s + 0.01)), (active.into(), critical.into()), "{hz} Hz");
    }
}

#[test]
fn before_the_first_frame_it_boots_but_not_for_ever() {
    let mut session = Session::new(at(0.0), 0, &Streams::default());
    let seen = Seen::default();
    let sent: Vec<_> = (0..100_u32).flat_map(|i| step(&mut session, f64::from(i) * 0.1, &seen)).collect();
    use MavState::{MAV_STATE_BOOT as BOOT, MAV_STATE_CRITICAL as CRITICAL};
    assert_eq!(states(&sent), [BOOT, CRITICAL, CRITICAL]);
}

#[test]
fn a_fault_is_told_when_it_comes_and_when_it_goes() {
    use MavSeverity::{MAV_SEVERITY_CRITICAL as CRITICAL, MAV_SEVERITY_ERROR as ERROR};
    let mut session = Session::new(at(0.0), 0, &Streams::default());
    assert!(texts(&step(&mut session, 0.0, &frame(1, 0.0))).is_empty());
    let one = but(frame(2, 0.02), &[lost(0)], |m| m.mode = Mode::Degraded);
    assert_eq!(texts(&step(&mut session, 0.02, &one)), [(ERROR, "irhorizon: sensor-lost:nose (no answer)".into())]);
    let two = but(frame(3, 0.04), &[lost(0), lost(1)], |m| (m.attitude, m.mode) = (None, Mode::Faulted));
    assert_eq!(texts(&step(&mut session, 0.04, &two)), [(CRITICAL, "irhorizon: sensor-lost:tail (no answer)".into())]);
    assert!(texts(&step(&mut session, 0.06, &but(two, &[lost(0), lost(1)], |m| m.sequence = 4))).is_empty());
    let gone: Vec<String> = texts(&step(&mut session, 0.08, &frame(5, 0.08))).into_iter().map(|t| t.1).collect();
    assert_eq!(gone, ["irhorizon: sensor-lost:nose cleared", "irhorizon: sensor-lost:tail cleared"]);
}

#[test]
fn a_fault_whose_attitude_is_held_is_told_again_when_that_is_lost() {
    use MavSeverity::{MAV_SEVERITY_CRITICAL as CRITICAL, MAV_SEVERITY_ERROR as ERROR};
    let mut session = Session::new(at(0.0), 0, &Streams::default());
    let mut said = |sequence, secs, mode| {
        let attitude = (mode == Mode::Degraded).then(Attitude::default);
        let seen = but(frame(sequence, secs), &[lost(0)], |m| (m.attitude, m.mode) = (attitude, mode));
        texts(&step(&mut session, secs, &seen)).into_iter().map(|t| t.0).collect::<Vec<_>>()
    };
    assert_eq!(said(1, 0.0, Mode::Degraded), [ERROR]);
    assert_eq!(said(2, 0.02, Mode::Degraded), []);
    assert_eq!(said(3, 0.04, Mode::Faulted), [CRITICAL]);
    assert_eq!(said(4, 0.06, Mode::Faulted), []);
}

#[test]
fn what_has_been_told_to_withhold_is_not_told_to_again_within_five_seconds() {
    use MavSeverity::{MAV_SEVERITY_CRITICAL as CRITICAL, MAV_SEVERITY_ERROR as ERROR};
    let mut session = Session::new(at(0.0), 0, &Streams::default());
    let mut said = Vec::new();
    // The attitude comes and goes, the fault stays; after 12 s another comes that is not withheld at first.
    for i in 0..1000_u32 {
        let secs = f64::from(i) * 0.02;
        let faults = if i < 600 { vec![lost(0)] } else { vec![lost(0), lost(1)] };
        let given = i % 10 < 5;
        let seen = but(frame(u64::from(i) + 1, secs), &faults, |m| {
            (m.attitude, m.mode) = (m.attitude.filter(|_| given), if given { Mode::Degraded } else { Mode::Faulted });
        });
        let texts = texts(&step(&mut session, secs, &seen));
        said.extend(texts.into_iter().map(|(severity, text)| (i, severity, text.contains("tail"))));
    }
    let expected = [
        (0, ERROR, false),
        (5, CRITICAL, false),
        (255, CRITICAL, false),
        (505, CRITICAL, false),
        (600, ERROR, true),
        (605, CRITICAL, true),
        (755, CRITICAL, false),
        (855, CRITICAL, true),
    ];
    assert_eq!(said, expected);
}

#[test]
fn what_is_shown_in_place_of_an_attitude_goes_out_with_a_critical_heartbeat_and_no_quality() {
    let mut session = Session::new(at(0.0), 0, &Streams::default());
    let seen = but(frame(1, 0.0), &[lost(0)], |m| (m.measured, m.mode) = (false, Mode::Faulted));
    let sent = step(&mut session, 0.0, &seen);
    assert_eq!((attitudes(&sent), states(&sent)), (1, vec![MavState::MAV_STATE_CRITICAL]));
    assert_eq!((values(&sent, "ir_qual"), texts(&sent)[0].0), (vec![0.0], MavSeverity::MAV_SEVERITY_CRITICAL));
    // Not measured anew, and of a later moment.
    let later = but(seen, &[lost(0)], |m| (m.sequence, m.valid_at) = (2, at(0.02)));
    assert_eq!(attitudes(&step(&mut session, 0.02, &later)), 1);
}

#[test]
fn an_attitude_that_is_held_is_critical_and_not_healthy() {
    let mut session = Session::new(at(0.0), 0, &Streams::default()).with_sys_status(true);
    let held = but(frame(1, 0.0), &[lost(0)], |m| (m.measured, m.mode) = (false, Mode::Degraded));
    let sent = step(&mut session, 0.0, &held);
    assert_eq!((attitudes(&sent), states(&sent)), (1, vec![MavState::MAV_STATE_CRITICAL]));
    assert!(sent.contains(&messages::sys_status(false)), "{sent:?}");
    // Not a failure yet, but it will be one.
    assert_eq!(texts(&sent)[0].0, MavSeverity::MAV_SEVERITY_ERROR);
}

#[test]
fn sys_status_is_sent_if_wanted_each_second_and_at_once_when_health_changes() {
    let health = |sent: &[Message]| {
        let one = |m: &Message| match m {
            Message::Status(s) => Some((s.onboard_control_sensors_health.bits(), s.voltage_battery)),
            _ => None,
        };
        sent.iter().filter_map(one).collect::<Vec<_>>()
    };
    let mut plain = Session::new(at(0.0), 0, &Streams::default());
    assert_eq!(health(&step(&mut plain, 0.0, &frame(1, 0.0))), []);
    let mut session = Session::new(at(0.0), 0, &Streams::default()).with_sys_status(true);
    let mut said =
        |sequence, secs, mode| health(&step(&mut session, secs, &but(frame(sequence, secs), &[], |m| m.mode = mode)));
    // Bit 21 of MAV_SYS_STATUS_SENSOR; no battery is 65535 mV.
    let (well, ill) = ((1 << 21, 65535), (0, 65535));
    assert_eq!(said(1, 0.0, Mode::Starting), [ill]);
    assert_eq!(said(2, 0.1, Mode::Nominal), [well]);
    assert_eq!(said(3, 0.2, Mode::Degraded), []);
    assert_eq!(said(4, 0.3, Mode::Faulted), [ill]);
    assert_eq!(said(5, 0.9, Mode::Faulted), []);
    assert_eq!(said(6, 1.0, Mode::Faulted), [ill]);
}

#[test]
fn what_goes_out_with_each_frame_does_so_once_and_goes_on_slowly_without() {
    let mut session = Session::new(at(0.0), 0, &Streams::default());
    // The second is as good as each frame once frames come more slowly.
    for (id, interval_us) in [(1, 5_000.0), (251, 25_000.0)] {
        session.set_interval(id, interval_us).unwrap();
    }
    session.configure(at(0.0), &Streams::default(), false, 25.0);
    // Awake six times a frame, and of the last second nothing is new.
    let sent = (0..300_u32).flat_map(|i| {
        let newest = (i / 6).min(25);
        step(&mut session, f64::from(i) / 150.0, &frame(u64::from(newest) + 1, f64::from(newest) / 25.0))
    });
    let sent: Vec<_> = sent.collect();
    let statuses = sent.iter().filter(|m| matches!(m, Message::Status(_))).count();
    assert_eq!((statuses, values(&sent, "ir_qual").len()), (26, 26));
    assert_eq!(values(&step(&mut session, 2.0, &frame(26, 1.0)), "ir_qual"), [0.0]);
}

#[test]
fn whoever_begins_to_listen_is_told_what_is_wrong() {
    let mut session = Session::new(at(0.0), 0, &Streams::default());
    let faulty = Seen { faults: vec![lost(0)], ..frame(1, 0.0) };
    let mut tell = |secs, listening| {
        let mut sent = Vec::new();
        session.step(at(secs), &faulty, &Head::six(), listening, |m| sent.push(m.clone()));
        texts(&sent).len()
    };
    assert_eq!([tell(0.0, true), tell(0.1, true), tell(0.2, false), tell(0.3, true), tell(0.4, true)], [1, 0, 0, 1, 0]);
}

#[test]
fn faults_of_another_head_are_told_by_its_names() {
    let mut session = Session::new(at(0.0), 0, &Streams::default());
    let (old, mut new) = (Head::six(), Head::six());
    new.sensors.reverse();
    let lost = Seen { faults: vec![lost(0)], ..frame(1, 0.0) };
    let mut sent = Vec::new();
    session.step(at(0.0), &lost, &old, true, |m| sent.push(m.clone()));
    session.forget(&old, |m| sent.push(m.clone()));
    session.step(at(0.1), &lost, &new, true, |m| sent.push(m.clone()));
    let said: Vec<String> = texts(&sent).into_iter().map(|(_, text)| text).collect();
    let [first, last] = [&old, &new].map(|head| head.sensors[0].name.as_str());
    assert!(said.len() == 3 && first != last, "{said:?}");
    assert!(
        said[0].contains(first) && said[1].contains(&format!("{first} cleared")) && said[2].contains(last),
        "{said:?}"
    );
}

#[test]
fn a_storm_of_faults_is_told_slowly_and_ends_with_the_truth() {
    let mut session = Session::new(at(0.0), 0, &Streams::default());
    let mut sent = Vec::new();
    for i in 0..501_u32 {
        let secs = f64::from(i) * 0.02;
        let faults = if i % 2 == 0 { vec![lost(2)] } else { vec![lost(0), lost(1)] };
        sent.extend(texts(&step(&mut session, secs, &Seen { faults, ..frame(u64::from(i) + 1, secs) })));
    }
    assert!((60..=88).contains(&sent.len()), "{} texts in 10 s", sent.len());
    for i in 0..100_u32 {
        let secs = 10.02 + f64::from(i) * 0.02;
        let seen = Seen { faults: vec![lost(2)], ..frame(u64::from(i) + 600, secs) };
        sent.extend(texts(&step(&mut session, secs, &seen)));
    }
    let last = |name: &str| sent.iter().rev().find(|t| t.1.contains(name)).unwrap().1.ends_with("cleared");
    assert_eq!([last("nose"), last("tail"), last("left")], [true, true, false]);
}

#[test]
fn copying_a_snapshot_keeps_the_room_for_faults() {
    let mut snapshot = Snapshot::default();
    snapshot.estimate.faults = vec![lost(0), lost(1)];
    let mut seen = Seen::default();
    seen.copy(&snapshot);
    let room = seen.faults.as_ptr();
    snapshot.estimate.faults.pop();
    seen.copy(&snapshot);
    assert_eq!(seen.faults, [lost(0)]);
    assert_eq!(seen.faults.as_ptr(), room);
}

proptest! {
    #[test]
    fn whatever_happens_no_attitude_is_sent_twice_or_while_withheld(
        steps in prop::collection::vec((0.0_f64..2.0, any::<bool>(), any::<bool>(), any::<bool>()), 1..200),
    ) {
        let mut session = Session::new(at(0.0), 0, &Streams::default());
        let (mut now, mut seen, mut stamps) = (0.0, Seen::default(), Vec::new());
        for (pause, scanned, measured, withheld) in steps {
            now += pause;
            if scanned {
                let time = if measured { at(now) } else { seen.moment.time };
                seen = but(frame(seen.moment.sequence + 1, now), &[], |m| (m.time, m.valid_at) = (time, time));
                if withheld || time == Time::default() {
                    seen.moment.attitude = None;
                }
            }
            for message in step(&mut session, now, &seen) {
                if let Message::Attitude(a) = message {
                    prop_assert!(scanned && seen.moment.attitude.is_some());
                    stamps.push(a.time_boot_ms);
                }
            }
        }
        prop_assert!(stamps.is_sorted());
    }
}
