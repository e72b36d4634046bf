use super::request::{Command, ParamId};
use super::*;
use crate::attitude::{Attitude, Mode};
use crate::config::settings::{EndpointAddress, EndpointSettings, Streams};
use crate::state::Moment;
use ::mavlink::dialects::common::{MavParamError, MavResult};
use proptest::prelude::*;

use MavResult::{
    MAV_RESULT_ACCEPTED as ACCEPTED, MAV_RESULT_CANCELLED as CANCELLED, MAV_RESULT_DENIED as DENIED,
    MAV_RESULT_FAILED as FAILED, MAV_RESULT_IN_PROGRESS as IN_PROGRESS, MAV_RESULT_TEMPORARILY_REJECTED as REJECTED,
    MAV_RESULT_UNSUPPORTED as UNSUPPORTED,
};

const US: Ids = Ids { system: 1, component: 191 };
const GCS: Ids = Ids { system: 255, component: 190 };

fn at(secs: f64) -> Time {
    Time::from_secs_f64(1000.0 + secs)
}

/// A service with its session, at some time, in some settings.
struct Bench {
    service: Service,
    session: Session,
    settings: Settings,
    seen: Seen,
    flying: bool,
}

impl Bench {
    fn new() -> Self {
        let mut settings = Settings::default();
        let address = EndpointAddress::UdpOut(([127, 0, 0, 1], 14550).into());
        settings.mavlink.endpoints = vec![EndpointSettings { address, streams: Streams::default(), tlog: None }];
        let session = Session::new(at(0.0), 0, &Streams::default()).with_frame_rate(50.0);
        let mut bench = Self { service: Service::default(), session, settings, seen: Seen::default(), flying: false };
        bench.look(0.0);
        bench
    }

    /// A good attitude of 4° and -2°.
    fn look(&mut self, secs: f64) {
        let moment = Moment {
            sequence: self.seen.moment.sequence + 1,
            written: at(secs),
            time: at(secs),
            valid_at: at(secs),
            attitude: Some(Attitude::from_degrees(4.0, -2.0)),
            measured: true,
            sigma: Attitude::from_degrees(1.0, 1.0),
            mode: Mode::Nominal,
            ..Moment::default()
        };
        self.seen = Seen { moment, contrast_k: Some(20.0), ..Seen::default() };
    }

    fn ask(&mut self, secs: f64, from: Ids, target: Ids, what: What) -> Replies {
        let mut replies = Replies::default();
        let Self { settings, seen, flying, .. } = self;
        let at = Situation { now: at(secs), us: US, settings, wanted: settings, seen, flying: *flying };
        self.service.heed(from, &Request { target, what }, &at, &mut self.session, &mut replies);
        replies
    }

    fn command(&mut self, number: u16, params: [f32; 7]) -> Replies {
        self.ask(0.0, GCS, US, What::Command(Command { number, params, confirmation: 0 }))
    }

    fn step(&mut self, secs: f64) -> Replies {
        let mut replies = Replies::default();
        let Self { settings, seen, flying, .. } = self;
        let at = Situation { now: at(secs), us: US, settings, wanted: settings, seen, flying: *flying };
        self.service.step(&at, &mut replies);
        replies
    }

    fn set(&mut self, secs: f64, name: &str, value: f32) -> Replies {
        self.ask(secs, GCS, US, What::ParamSet { name: id(name), value })
    }
}

fn id(name: &str) -> ParamId {
    std::array::from_fn(|i| name.as_bytes().get(i).copied().unwrap_or(0))
}

fn params<const N: usize>(first: [f32; N]) -> [f32; 7] {
    std::array::from_fn(|i| first.get(i).copied().unwrap_or(0.0))
}

fn level(confirmation: u8) -> What {
    What::Command(Command { number: 241, params: [0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0], confirmation })
}

fn acks(replies: &Replies) -> Vec<(u16, MavResult)> {
    let ack = |m: &Message| if let Message::Ack(a) = m { Some((a.command, a.result)) } else { None };
    replies.messages.iter().filter_map(ack).collect()
}

fn ids(replies: &Replies) -> Vec<u32> {
    replies.messages.iter().map(Message::id).collect()
}

fn values(replies: &Replies) -> Vec<(u16, f32)> {
    let value = |m: &Message| if let Message::Param(p) = m { Some((p.param_index, p.param_value)) } else { None };
    replies.messages.iter().filter_map(value).collect()
}

fn text(replies: &Replies) -> String {
    let text = |m: &Message| if let Message::Text(t) = m { t.text.to_str().ok().map(str::to_owned) } else { None };
    replies.messages.iter().filter_map(text).collect::<Vec<_>>().join(" | ")
}

#[test]
fn a_command_that_nobody_knows_is_answered_to_its_sender() {
    let mut bench = Bench::new();
    for number in [0, 400, 1234, 65_535] {
        let replies = bench.command(number, params([1.0]));
        let [Message::Ack(ack)] = replies.messages.as_slice() else { panic!("{replies:?}") };
        assert_eq!((ack.command, ack.result, ack.target_system, ack.target_component), (number, UNSUPPORTED, 255, 190));
    }
}

#[test]
fn what_is_for_others_is_left_to_them() {
    let mut bench = Bench::new();
    let command = |number| What::Command(Command { number, params: params([148.0]), confirmation: 0 });
    for target in [(2, 191), (1, 1), (2, 0), (0, 1)] {
        let target = Ids { system: target.0, component: target.1 };
        assert_eq!(bench.ask(0.0, GCS, target, command(512)), Replies::default());
        assert_eq!(bench.ask(0.0, GCS, target, What::ParamList), Replies::default());
    }
    // Its own words, come back.
    assert_eq!(bench.ask(0.0, US, US, command(512)), Replies::default());
    assert_eq!(bench.step(1.0), Replies::default());
    // Everybody: what is done here is done, of the rest nothing is said.
    for target in [(1, 0), (0, 0), (0, 191)] {
        let target = Ids { system: target.0, component: target.1 };
        assert_eq!(ids(&bench.ask(0.0, GCS, target, command(512))), [77, 148]);
        assert_eq!(bench.ask(0.0, GCS, target, command(400)), Replies::default());
        let unknown = What::ParamRead { index: -1, name: id("SYSID_THISMAV") };
        assert_eq!(bench.ask(0.0, GCS, target, unknown), Replies::default());
    }
}

#[test]
fn every_message_that_is_sent_can_be_asked_for() {
    let mut bench = Bench::new();
    for (asked, expected) in [
        (0.0, vec![77, 0]),
        (1.0, vec![77, 1]),
        (30.0, vec![77, 30]),
        (31.0, vec![77, 31]),
        (61.0, vec![77, 61]),
        (148.0, vec![77, 148]),
        (244.0, vec![77, 244]),
        (251.0, vec![77, 251, 251, 251]),
        (253.0, vec![77, 253]),
        (396.0, vec![77, 396]),
    ] {
        let replies = bench.command(512, params([asked, 30.0]));
        assert_eq!((ids(&replies), acks(&replies)), (expected, vec![(512, ACCEPTED)]), "message {asked}");
    }
    for bad in [33.0, 0.5, -1.0, f32::NAN, f32::INFINITY, 1e9] {
        assert_eq!(acks(&bench.command(512, params([bad]))), [(512, DENIED)], "message {bad}");
    }
    bench.seen.moment.attitude = None;
    for attitude in [30.0, 31.0, 61.0] {
        let replies = bench.command(512, params([attitude]));
        assert_eq!((replies.messages.len(), acks(&replies)), (1, vec![(512, REJECTED)]));
    }
    assert_eq!(ids(&bench.command(520, params([1.0]))), [77, 148]);
}

#[test]
fn intervals_are_set_and_told() {
    let mut bench = Bench::new();
    let interval = |replies: &Replies| match replies.messages.as_slice() {
        [_, Message::Interval(i)] => (i.message_id, i.interval_us),
        other => panic!("{other:?}"),
    };
    assert_eq!(interval(&bench.command(510, params([31.0]))), (31, -1));
    for _ in 0..2 {
        assert_eq!(acks(&bench.command(511, params([31.0, 100_000.0]))), [(511, ACCEPTED)]);
        assert_eq!(interval(&bench.command(510, params([31.0]))), (31, 100_000));
    }
    assert_eq!(acks(&bench.command(511, params([33.0, 1e6]))), [(511, DENIED)]);
    assert_eq!(interval(&bench.command(510, params([33.0]))), (33, 0));
    let refused = bench.command(511, params([0.0, -1.0]));
    assert_eq!((acks(&refused), text(&refused)), (vec![(511, DENIED)], "irhorizon: HEARTBEAT stays at 1 Hz".into()));
    assert_eq!(acks(&bench.command(510, params([70_000.0]))), [(510, DENIED)]);
    let step = |bench: &mut Bench, secs: f64| {
        bench.look(secs);
        let mut quaternions = 0;
        let head = crate::head::Head::six();
        bench.session.step(at(secs), &bench.seen, &head, true, |m| quaternions += usize::from(m.id() == 31));
        quaternions
    };
    let sent: usize = (0..500).map(|i| step(&mut bench, f64::from(i) * 0.02)).sum();
    assert!((98..=102).contains(&sent), "{sent} in 10 s");
}

#[test]
fn the_list_is_whole_and_never_faster_than_twenty_a_second() {
    let mut bench = Bench::new();
    let count = parameters::count(&bench.settings);
    assert_eq!(bench.ask(0.0, GCS, US, What::ParamList), Replies::default());
    let mut told = Vec::new();
    let mut list = |bench: &mut Bench, from: u32, to: u32| {
        for i in from..to {
            let secs = f64::from(i) / 100.0;
            let replies = bench.step(secs);
            assert!(replies.messages.len() <= 1 && replies.orders.is_empty());
            told.extend(values(&replies).into_iter().map(|v| (secs, v)));
        }
    };
    list(&mut bench, 0, 50);
    // Asked for again on the way, it begins anew.
    bench.ask(0.5, GCS, Ids { system: 1, component: 0 }, What::ParamList);
    list(&mut bench, 50, 1000);
    let first = told.iter().rposition(|(_, (i, _))| *i == 0).unwrap();
    assert_eq!(
        told[first..].iter().map(|(_, (i, _))| usize::from(*i)).collect::<Vec<_>>(),
        (0..count).collect::<Vec<_>>()
    );
    for (i, (_, (index, value))) in told.iter().enumerate().skip(1) {
        assert!(told[i].0 - told[i - 1].0 >= 0.049);
        assert_eq!(Some(*value), parameters::value(&bench.settings, usize::from(*index)));
    }
}

#[test]
fn parameters_are_read_by_name_and_by_index() {
    let mut bench = Bench::new();
    let mut read = |index, name: &str| bench.ask(0.0, GCS, US, What::ParamRead { index, name: id(name) });
    assert_eq!(values(&read(-1, "IRH_HOLD_S")), [(7, 3.0)]);
    assert_eq!(values(&read(7, "ignored")), [(7, 3.0)]);
    for (index, name) in [(-1, "IRH_NONE"), (26, ""), (i16::MAX, ""), (i16::MIN, "")] {
        let replies = read(index, name);
        let [Message::ParamError(e)] = replies.messages.as_slice() else { panic!("{replies:?}") };
        assert_eq!((e.error, e.param_index), (MavParamError::MAV_PARAM_ERROR_DOES_NOT_EXIST, index));
    }
}

#[test]
fn a_good_value_is_ordered_and_a_bad_one_answered_with_the_old() {
    let mut bench = Bench::new();
    let good = bench.set(0.0, "IRH_ROLL_TRIM", -2.5);
    let change = Change { section: Section::Table("head"), key: "roll-trim-deg", value: "-2.5".into() };
    assert_eq!(good.orders, [Order::Set(vec![change.clone()])]);
    assert_eq!(values(&good), [(0, -2.5)]);
    assert_eq!(text(&good), "irhorizon: IRH_ROLL_TRIM set");
    bench.settings = apply(&bench.settings, &[change]).unwrap();
    // Sent once more: nothing to do.
    let again = bench.set(0.0, "IRH_ROLL_TRIM", -2.5);
    assert_eq!((values(&again), again.messages.len(), again.orders.len()), (vec![(0, -2.5)], 1, 0));
    for (name, value, stays, why) in [
        ("IRH_ROLL_TRIM", 46.0, -2.5, "irhorizon: IRH_ROLL_TRIM needs -45 to 45°"),
        ("IRH_ROLL_TRIM", f32::NAN, -2.5, "irhorizon: IRH_ROLL_TRIM needs a finite number"),
        ("IRH_AIDING", 0.5, 1.0, "irhorizon: IRH_AIDING needs 0 or 1"),
        ("IRH_ON_FAULT", 3.0, 0.0, "irhorizon: IRH_ON_FAULT needs 0 (withhold), 1 (h.."),
        ("IRH_E1_ATT_HZ", 60.0, 50.0, "irhorizon: IRH_E1_ATT_HZ needs 0 (none) or 0.1 t.."),
    ] {
        let bad = bench.set(0.0, name, value);
        assert_eq!((values(&bad)[0].1, bad.orders.len(), text(&bad)), (stays, 0, why.to_owned()));
    }
    assert_eq!(text(&bench.set(0.0, "IRH_YAW", 1.0)), "irhorizon: IRH_YAW set");
    assert_eq!(ids(&bench.set(0.0, "IRH_NONE", 1.0)), [345]);
}

#[test]
fn a_flood_of_values_is_taken_slowly() {
    let mut bench = Bench::new();
    let mut taken = 0;
    for i in 0..1000_u16 {
        taken += bench.set(f64::from(i) / 500.0, "IRH_YAW", 0.0).messages.len();
    }
    assert_eq!(taken, 40);
}

#[test]
fn whoever_listens_is_told_what_others_have_changed() {
    let mut bench = Bench::new();
    let old = bench.settings.clone();
    bench.settings.head.pitch_trim_deg = 1.0;
    bench.settings.mavlink.endpoints[0].streams.texts = false;
    bench.service.announce(at(0.0), &old, &bench.settings);
    let told: Vec<(u16, f32)> = (0..50).flat_map(|i| values(&bench.step(f64::from(i) * 0.05))).collect();
    assert_eq!(told, [(1, 1.0), (25, 0.0)]);
}

#[test]
fn level_ground_gives_the_trim() {
    let mut bench = Bench::new();
    bench.settings.head.learn_trim = true;
    bench.seen.trim = Attitude::from_degrees(0.0, 1.0);
    let begun = bench.ask(0.0, GCS, US, level(0));
    assert_eq!(acks(&begun), [(241, IN_PROGRESS)]);
    let (mut said, mut orders) = (Vec::new(), Vec::new());
    for i in 1..=300_u32 {
        let secs = f64::from(i) / 50.0;
        bench.look(secs);
        bench.seen.trim = Attitude::from_degrees(0.0, 1.0);
        let mut replies = bench.step(secs);
        if i == 100 {
            // Sent once more, and by somebody else.
            assert_eq!(acks(&bench.ask(secs, GCS, US, level(1))), [(241, IN_PROGRESS)]);
            assert_eq!(acks(&bench.ask(secs, Ids { system: 254, component: 1 }, US, level(0))), [(241, REJECTED)]);
        }
        said.extend(acks(&replies).into_iter().map(|(_, result)| result));
        orders.append(&mut replies.orders);
    }
    assert_eq!(said, [IN_PROGRESS, IN_PROGRESS, IN_PROGRESS, IN_PROGRESS, ACCEPTED]);
    let [Order::Set(changes)] = orders.as_slice() else { panic!("{orders:?}") };
    let new = apply(&bench.settings, changes).unwrap();
    // 4° of roll and -2 + 1° of pitch, turned one after the other.
    assert!((new.head.roll_trim_deg - 4.0).abs() < 0.01 && (new.head.pitch_trim_deg + 1.0).abs() < 0.01, "{new:?}");
    // The last answer was lost: it is given once more, and nothing begins.
    assert_eq!(acks(&bench.ask(6.1, GCS, US, level(2))), [(241, ACCEPTED)]);
    assert_eq!(bench.step(6.2), Replies::default());
    assert_eq!(acks(&bench.ask(6.3, GCS, US, level(0))), [(241, IN_PROGRESS)]);
}

#[test]
fn a_trim_that_is_set_meanwhile_fails_a_calibration() {
    let mut bench = Bench::new();
    assert_eq!(acks(&bench.ask(0.0, GCS, US, level(0))), [(241, IN_PROGRESS)]);
    assert_eq!(bench.step(0.1), Replies::default());
    bench.settings.head.pitch_trim_deg = 3.0;
    let failed = bench.step(0.2);
    assert_eq!(
        (acks(&failed), text(&failed)),
        (vec![(241, FAILED)], "irhorizon: level calibration failed: trim changed".into())
    );
}

#[test]
fn no_calibration_in_flight_nor_of_what_is_not_here() {
    let mut bench = Bench::new();
    bench.flying = true;
    let refused = bench.ask(0.0, GCS, US, level(0));
    assert_eq!(
        (acks(&refused), text(&refused)),
        (vec![(241, REJECTED)], "irhorizon: no level calibration in flight".into())
    );
    bench.flying = false;
    for (params, result) in [
        (params([1.0]), UNSUPPORTED),
        (params([0.0, 0.0, 0.0, 0.0, 3.0]), DENIED),
        (params([0.0, 0.0, 0.0, 0.0, f32::NAN]), DENIED),
        (params([]), ACCEPTED),
    ] {
        assert_eq!(acks(&bench.command(241, params)), [(241, result)]);
    }
    assert_eq!(acks(&bench.ask(0.0, GCS, US, level(0))), [(241, IN_PROGRESS)]);
    let stopped = bench.command(241, params([]));
    assert_eq!(acks(&stopped), [(241, ACCEPTED), (241, CANCELLED)]);
    assert_eq!(bench.step(0.1), Replies::default());
    // A take-off ends it.
    assert_eq!(acks(&bench.ask(0.2, GCS, US, level(0))), [(241, IN_PROGRESS)]);
    bench.flying = true;
    let failed = bench.step(0.3);
    assert_eq!((acks(&failed), failed.orders.len()), (vec![(241, FAILED)], 0));
}

proptest! {
    #[test]
    fn each_command_for_us_gets_one_ack_and_few_words(
        commands in prop::collection::vec(
            (prop_oneof![Just(241_u16), 510_u16..513, Just(520_u16), any::<u16>()], prop::array::uniform7(
                prop_oneof![Just(0.0_f32), Just(2.0), Just(30.0), Just(251.0), any::<f32>()]), any::<u8>()),
            1..40,
        ),
    ) {
        let mut bench = Bench::new();
        for (i, (number, params, confirmation)) in commands.into_iter().enumerate() {
            let what = What::Command(Command { number, params, confirmation });
            let replies = bench.ask(i as f64 * 0.1, GCS, US, what);
            let own: Vec<u16> = acks(&replies).iter().map(|a| a.0).collect();
            let cancelled = own.len() == 2 && acks(&replies)[1].1 == CANCELLED;
            prop_assert!(own == [number] || cancelled, "{:?}", replies);
            prop_assert!(replies.messages.len() <= 4 && replies.orders.is_empty());
            prop_assert!(matches!(replies.messages[0], Message::Ack(_)));
        }
    }
}
