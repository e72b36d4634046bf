//! Which messages are due when: the state of one endpoint's outgoing stream. Pure; time comes in
//! as an argument.
//!
//! Nothing goes out on the strength of this thread being alive. What is told depends on the age of
//! the newest frame: from 1 s on the heartbeat is critical and says so in words, from 3 s on there
//! is silence, and every ground station shows the component as lost.

use super::decimator::Decimator;
use super::messages::{self, Message};
use crate::attitude::{Attitude, Mode};
use crate::fault::{ActiveFault, Evidence, FaultKind, FaultName};
use crate::state::Snapshot;
use crate::time::Time;
use ::mavlink::dialects::common::MavState;
use std::time::Duration;

/// The age of the newest frame at which sampling counts as dead, s.
const DEAD_AFTER_S: f64 = 1.0;

/// The age of the newest frame from which on nothing is sent, s.
const SILENT_AFTER_S: f64 = 3.0;

/// The period of HEARTBEAT and NAMED_VALUE_FLOAT.
const SECOND: Duration = Duration::from_secs(1);

/// STATUSTEXT messages in a second at most. Faults that come and go faster are told less often,
/// and the last word is always the true one.
const TEXTS_PER_S: u32 = 8;

/// What is told, copied out of the shared state: a few words and the list of faults.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Seen {
    /// Counts frames; 0 before the first.
    pub sequence: u64,
    /// When the newest frame was written.
    pub written: Time,
    /// The newest conversion in the estimate.
    pub time: Time,
    /// Roll and pitch, or nothing while they are withheld.
    pub attitude: Option<Attitude>,
    /// Their standard deviations, rad.
    pub sigma: Attitude,
    /// The contrast, K.
    pub contrast_k: Option<f64>,
    /// How far to trust it.
    pub mode: Mode,
    /// What speaks against it.
    pub faults: Vec<ActiveFault>,
}

impl Seen {
    /// Takes in a snapshot; allocates only when there are more faults than ever before.
    pub fn copy(&mut self, snapshot: &Snapshot) {
        let estimate = &snapshot.estimate;
        self.sequence = snapshot.sequence;
        self.written = snapshot.written;
        self.time = estimate.time;
        self.attitude = estimate.attitude;
        self.sigma = estimate.sigma;
        self.contrast_k = estimate.contrast_k;
        self.mode = estimate.mode;
        self.faults.clone_from(&estimate.faults);
    }
}

/// The state of one endpoint's stream.
#[derive(Clone, Debug)]
pub struct Session {
    started: Time,
    decimator: Option<Decimator>,
    sequence: u64,
    attitude_time: Option<Time>,
    contrast_time: Option<Time>,
    next_second: Time,
    told: Vec<FaultKind>,
    texts: u32,
    texts_since: Time,
}

impl Session {
    /// A stream that begins at `now`, after frame `sequence`, with ATTITUDE for every frame or
    /// `attitude_hz` times a second.
    pub fn new(now: Time, sequence: u64, attitude_hz: Option<f64>) -> Self {
        Self {
            started: now,
            decimator: attitude_hz.and_then(Decimator::new),
            sequence,
            attitude_time: None,
            contrast_time: None,
            next_second: now,
            told: Vec::with_capacity(16),
            texts: 0,
            texts_since: now,
        }
    }

    /// Gives `send` what is due at `now`. While nobody is `listening` no fault is told; all that
    /// are there are told as soon as somebody does.
    pub fn step(
        &mut self,
        now: Time,
        seen: &Seen,
        names: &dyn FaultName,
        listening: bool,
        mut send: impl FnMut(&Message),
    ) {
        let newest = if seen.sequence == 0 { self.started } else { seen.written };
        let age_s = now.since(newest);
        if age_s >= SILENT_AFTER_S {
            return;
        }
        let dead = age_s >= DEAD_AFTER_S;
        if seen.sequence != self.sequence {
            self.sequence = seen.sequence;
            if !dead && let Some(message) = self.attitude(seen) {
                send(&message);
            }
        }
        if listening {
            self.tell(now, seen, dead.then_some(age_s), names, &mut send);
        } else {
            self.told.clear();
        }
        if now >= self.next_second {
            self.next_second = after(self.next_second, SECOND, now);
            send(&messages::heartbeat(match (dead, seen.sequence) {
                (true, _) => MavState::MAV_STATE_CRITICAL,
                (false, 0) => MavState::MAV_STATE_BOOT,
                (false, _) => messages::state(seen.mode),
            }));
            send(&messages::quality_value(now, if dead { 0.0 } else { messages::quality(seen) }));
            let contrast = seen.contrast_k.filter(|k| k.is_finite() && self.contrast_time != Some(seen.time));
            if let Some(contrast_k) = contrast {
                self.contrast_time = Some(seen.time);
                send(&messages::contrast(seen.time, contrast_k));
            }
        }
    }

    /// ATTITUDE, if it holds a measurement not sent before and the decimator lets it pass.
    fn attitude(&mut self, seen: &Seen) -> Option<Message> {
        let message = messages::attitude(seen.time, seen.attitude?)?;
        if self.attitude_time == Some(seen.time) || !self.decimator.as_mut().is_none_or(|d| d.passes(seen.time)) {
            return None;
        }
        self.attitude_time = Some(seen.time);
        Some(message)
    }

    /// STATUSTEXT for each fault that has come or gone. Dead sampling can not say so itself: it
    /// shows as `stale` of the age `dead_s`.
    fn tell(
        &mut self,
        now: Time,
        seen: &Seen,
        dead_s: Option<f64>,
        names: &dyn FaultName,
        send: &mut impl FnMut(&Message),
    ) {
        if now.since(self.texts_since) >= 1.0 {
            self.texts_since = now;
            self.texts = 0;
        }
        let dead = dead_s.map(|value| (FaultKind::Stale, Evidence::Limit { value, limit: DEAD_AFTER_S, unit: "s" }));
        let active = || seen.faults.iter().map(|f| (f.kind, f.evidence)).chain(dead);
        let Self { told, texts, .. } = self;
        told.retain(|kind| {
            let keep = *texts >= TEXTS_PER_S || active().any(|(k, _)| k == *kind);
            if !keep {
                *texts += 1;
                send(&messages::fault_went(*kind, names));
            }
            keep
        });
        let withheld = seen.attitude.is_none() || dead.is_some();
        for (kind, evidence) in active() {
            if *texts < TEXTS_PER_S && !told.contains(&kind) {
                told.push(kind);
                *texts += 1;
                send(&messages::fault_came(kind, evidence, withheld, names));
            }
        }
    }

    /// The last message of all: a heartbeat that says the component is going down.
    pub fn farewell() -> Message {
        messages::heartbeat(MavState::MAV_STATE_POWEROFF)
    }
}

/// The next due time on a schedule of `period` that is not left for a late step, only for one that
/// is late by more than a period.
fn after(due: Time, period: Duration, now: Time) -> Time {
    if due + period > now { due + period } else { now + period }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Missing;
    use crate::head::Head;
    use ::mavlink::dialects::common::MavSeverity;
    use proptest::prelude::*;

    fn at(secs: f64) -> Time {
        Time::from_secs_f64(1000.0 + secs)
    }

    /// A frame that is fresh at `secs`.
    fn frame(sequence: u64, secs: f64) -> Seen {
        Seen {
            sequence,
            written: at(secs),
            time: at(secs - 0.002),
            attitude: Some(Attitude::from_degrees(10.0, 5.0)),
            sigma: Attitude::from_degrees(1.0, 1.0),
            contrast_k: Some(20.0),
            mode: Mode::Nominal,
            faults: Vec::new(),
        }
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
        let mut session = Session::new(at(0.0), 0, None);
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
        let sent = step(&mut Session::new(at(0.0), 0, None), 0.0, &frame(1, 0.0));
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
            let seen = Seen { mode, ..frame(1, 0.0) };
            assert_eq!(states(&step(&mut Session::new(at(0.0), 0, None), 0.0, &seen)), [state]);
        }
    }

    #[test]
    fn no_attitude_while_it_is_withheld_and_never_the_last_one() {
        let mut session = Session::new(at(0.0), 0, None);
        assert_eq!(attitudes(&step(&mut session, 0.0, &frame(1, 0.0))), 1);
        for i in 1..100_u32 {
            let secs = f64::from(i) * 0.02;
            let seen = Seen { attitude: None, mode: Mode::Faulted, ..frame(u64::from(i) + 1, secs) };
            let sent = step(&mut session, secs, &seen);
            assert_eq!(attitudes(&sent), 0);
            assert!(values(&sent, "ir_qual").iter().all(|q| *q == 0.0));
        }
        assert_eq!(attitudes(&step(&mut session, 2.0, &frame(101, 2.0))), 1);
        // A frame without a new measurement.
        assert_eq!(attitudes(&step(&mut session, 2.02, &Seen { time: at(1.998), ..frame(102, 2.02) })), 0);
        // The frame that was there when the stream began.
        assert_eq!(attitudes(&step(&mut Session::new(at(2.03), 102, None), 2.03, &frame(102, 2.02))), 0);
    }

    #[test]
    fn dead_sampling_is_critical_after_one_second_and_silent_after_three() {
        let mut session = Session::new(at(0.0), 0, None);
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
    fn before_the_first_frame_it_boots_but_not_for_ever() {
        let mut session = Session::new(at(0.0), 0, None);
        let seen = Seen::default();
        let sent: Vec<_> = (0..100_u32).flat_map(|i| step(&mut session, f64::from(i) * 0.1, &seen)).collect();
        use MavState::{MAV_STATE_BOOT as BOOT, MAV_STATE_CRITICAL as CRITICAL};
        assert_eq!(states(&sent), [BOOT, CRITICAL, CRITICAL]);
    }

    #[test]
    fn a_fault_is_told_when_it_comes_and_when_it_goes() {
        use MavSeverity::{MAV_SEVERITY_CRITICAL as CRITICAL, MAV_SEVERITY_ERROR as ERROR};
        let mut session = Session::new(at(0.0), 0, None);
        assert!(texts(&step(&mut session, 0.0, &frame(1, 0.0))).is_empty());
        let one = Seen { faults: vec![lost(0)], mode: Mode::Degraded, ..frame(2, 0.02) };
        assert_eq!(texts(&step(&mut session, 0.02, &one)), [(ERROR, "irhorizon: sensor-lost:nose (no answer)".into())]);
        let two = Seen { faults: vec![lost(0), lost(1)], attitude: None, mode: Mode::Faulted, ..frame(3, 0.04) };
        assert_eq!(
            texts(&step(&mut session, 0.04, &two)),
            [(CRITICAL, "irhorizon: sensor-lost:tail (no answer)".into())]
        );
        assert!(texts(&step(&mut session, 0.06, &Seen { sequence: 4, ..two })).is_empty());
        let gone: Vec<String> = texts(&step(&mut session, 0.08, &frame(5, 0.08))).into_iter().map(|t| t.1).collect();
        assert_eq!(gone, ["irhorizon: sensor-lost:nose cleared", "irhorizon: sensor-lost:tail cleared"]);
    }

    #[test]
    fn whoever_begins_to_listen_is_told_what_is_wrong() {
        let mut session = Session::new(at(0.0), 0, None);
        let faulty = Seen { faults: vec![lost(0)], ..frame(1, 0.0) };
        let mut tell = |secs, listening| {
            let mut sent = Vec::new();
            session.step(at(secs), &faulty, &Head::six(), listening, |m| sent.push(m.clone()));
            texts(&sent).len()
        };
        assert_eq!(
            [tell(0.0, true), tell(0.1, true), tell(0.2, false), tell(0.3, true), tell(0.4, true)],
            [1, 0, 0, 1, 0]
        );
    }

    #[test]
    fn a_storm_of_faults_is_told_slowly_and_ends_with_the_truth() {
        let mut session = Session::new(at(0.0), 0, None);
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
            let mut session = Session::new(at(0.0), 0, None);
            let (mut now, mut seen, mut stamps) = (0.0, Seen::default(), Vec::new());
            for (pause, scanned, measured, withheld) in steps {
                now += pause;
                if scanned {
                    let time = if measured { at(now) } else { seen.time };
                    seen = Seen { time, ..frame(seen.sequence + 1, now) };
                    if withheld || time == Time::default() {
                        seen.attitude = None;
                    }
                }
                for message in step(&mut session, now, &seen) {
                    if let Message::Attitude(a) = message {
                        prop_assert!(scanned && seen.attitude.is_some());
                        stamps.push(a.time_boot_ms);
                    }
                }
            }
            prop_assert!(stamps.is_sorted());
        }
    }
}
