//! Thermopiles here, rates and GPS in an autopilot behind a link that is 40 ms late, loses one message in five and has
//! a clock of its own: the attitude must be nearly as good as that of a recording in which each frame has its rates.

mod autopilot;

use autopilot::Autopilot;
use irhorizon::aiding::Inbox;
use irhorizon::attitude::{Attitude, Estimate};
use irhorizon::config::Settings;
use irhorizon::config::settings::{EndpointAddress, Method};
use irhorizon::daemon::sampling::Sampling;
use irhorizon::frame::{Aiding, Frame, Missing};
use irhorizon::head::Head;
use irhorizon::horizon::Horizon;
use irhorizon::mavlink::aiding::Listener;
use irhorizon::recording::{Recording, Taps, Writer};
use irhorizon::simulation::{Scenario, SimulatedSource};
use irhorizon::source::{FrameSource, SensorHealth};
use irhorizon::state::Shared;
use irhorizon::time::Time;
use rustix::net::{RecvFlags, recv};
use std::os::fd::AsFd;
use std::sync::Arc;

/// Frames of a flight: 100 s at 50 Hz; the first 20 s are left out.
const FRAMES: u64 = 5000;
const LEFT_OUT: u64 = 1000;
/// What the errors may be, of those with a recording.
const MOST: f64 = 1.3;
/// And of an autopilot that goes on at 50 Hz, as published in a clear sky, where a recording's are of four hundredths of
/// a degree, °: so much may be added, as independent errors are, by what the aircraft has begun to do in the 50 to 110 ms
/// of which no rates are there yet.
const UNKNOWN_DEG: f64 = 0.04;

fn tick(i: u64) -> Time {
    Time::from_nanos(2_000_000_000_000 + i * 20_000_000)
}

/// A flight whose instruments are elsewhere.
struct Bare(SimulatedSource);

impl FrameSource for Bare {
    fn scan(&mut self, tick: Time, frame: &mut Frame) {
        self.0.scan(tick, frame);
        frame.aiding = Aiding::default();
    }

    fn health(&self) -> &[SensorHealth] {
        self.0.health()
    }

    fn buses_down(&self) -> &[Option<Missing>] {
        self.0.buses_down()
    }
}

/// Squares of the errors of roll and pitch, °², how many, and how many are within 2 σ.
#[derive(Clone, Copy, Debug, Default)]
struct Errors {
    squares: [f64; 2],
    count: f64,
    within: f64,
}

impl Errors {
    fn add(&mut self, truth: Attitude, said: Attitude, sigma: Attitude) {
        let errors = [said.roll - truth.roll, said.pitch - truth.pitch];
        errors.iter().zip(&mut self.squares).for_each(|(e, sum)| *sum += e.to_degrees().powi(2));
        self.count += 1.0;
        self.within += f64::from(u8::from(errors[0].abs() <= 2.0 * sigma.roll && errors[1].abs() <= 2.0 * sigma.pitch));
    }

    fn rms(&self) -> [f64; 2] {
        self.squares.map(|s| (s / self.count).sqrt())
    }

    fn pooled<const N: usize>(all: [Self; N]) -> Self {
        all.into_iter().fold(Self::default(), |a, b| Self {
            squares: [a.squares[0] + b.squares[0], a.squares[1] + b.squares[1]],
            count: a.count + b.count,
            within: a.within + b.within,
        })
    }
}

/// The errors of a recording's replay.
fn replay(recording: &str, truth: impl Fn(Time) -> Attitude) -> Errors {
    let mut reader = Recording::new(recording.as_bytes(), "test".into()).unwrap().frames(Some(Head::six())).unwrap();
    let mut horizon = Horizon::new(&Settings::default(), Head::six());
    horizon.set_lag_s(0.1);
    let (mut frame, mut estimate, mut errors) = (Frame::new(6), Estimate::default(), Errors::default());
    while reader.next_frame(&mut frame).unwrap() {
        horizon.update(&frame, &[], &mut estimate);
        if frame.time >= tick(LEFT_OUT) {
            errors.add(truth(frame.time), estimate.attitude.unwrap(), estimate.sigma);
        }
    }
    errors
}

/// What was flown live.
struct Live {
    recording: String,
    published: Errors,
    /// Everything that was published.
    said: Vec<(Time, Attitude)>,
    shown: irhorizon::aiding::Autopilot,
}

/// Flies by `field` with the rates and speeds of an autopilot elsewhere, on which `has` is done first.
fn live(scenario: &Scenario, seed: u64, frames: u64, has: impl FnOnce(&mut Autopilot)) -> Live {
    live_by(Method::Field, scenario, seed, frames, has)
}

/// The same by a method.
fn live_by(method: Method, scenario: &Scenario, seed: u64, frames: u64, has: impl FnOnce(&mut Autopilot)) -> Live {
    let source = scenario.source(seed).with_origin(tick(0));
    let flight = source.clone();
    let mut pilot = Autopilot::new(scenario, seed, tick(0));
    has(&mut pilot);
    let (inbox, shared, taps) = (Arc::new(Inbox::default()), Arc::new(Shared::default()), Arc::new(Taps::default()));
    let mut settings = Settings::default();
    settings.estimator.method = Some(method);
    settings.mavlink.aiding = true;
    settings.mavlink.endpoints = vec![EndpointAddress::UdpOut("127.0.0.1:14550".parse().unwrap()).into()];
    let mut listener = Listener::new(&settings.mavlink, 50.0, Arc::clone(&inbox));
    let horizon = Horizon::new(&settings, Head::six());
    let mut sampling =
        Sampling::new(Head::six(), Box::new(Bare(source)), horizon, Arc::clone(&shared), Arc::clone(&taps), None)
            .with_inbox(inbox);
    let mut recording = Writer::new(&Head::six(), "").header().to_owned();
    let tap = taps.subscribe().unwrap();
    let mut packet = [0; 4096];
    let (mut published, mut said) = (Errors::default(), Vec::new());
    for i in 0..frames {
        pilot.talk(tick(i), &mut listener);
        sampling.step(tick(i));
        pilot.step(tick(i));
        while let Ok((length, _)) = recv(tap.as_fd(), &mut packet[..], RecvFlags::DONTWAIT) {
            recording.push_str(std::str::from_utf8(&packet[..length]).unwrap());
        }
        let snapshot = shared.lock();
        let estimate = &snapshot.estimate;
        let attitude = estimate.attitude.unwrap_or(Attitude { roll: f64::NAN, pitch: f64::NAN });
        said.push((estimate.valid_at, attitude));
        if i >= LEFT_OUT {
            let late_s = tick(i).since(estimate.valid_at);
            assert!((0.0..1e-9).contains(&late_s), "published without delay");
            published.add(flight.truth_at(estimate.valid_at), attitude, estimate.sigma);
        }
    }
    let shown = shared.lock().autopilot;
    Live { recording, published, said, shown }
}

/// The errors with a recording that has the rates in it, then live: of what the estimator made, and as published. The
/// autopilot sends its rates 50 times a second, and twice as often where it `obliges`.
fn fly(scenario: &Scenario, seed: u64, obliges: bool) -> [Errors; 3] {
    let mut source = scenario.source(seed).with_origin(tick(0));
    let writer = Writer::new(&Head::six(), "");
    let (mut recording, mut frame) = (writer.header().to_owned(), Frame::new(6));
    for i in 0..FRAMES {
        source.scan(tick(i), &mut frame);
        writer.row(&frame, &mut recording);
    }
    let flown = live(scenario, seed, FRAMES, |pilot| pilot.obliges = obliges);
    let shown = flown.shown;
    assert!(shown.used && shown.link.synced && shown.link.system == Some(7), "{shown:?}");
    assert!((0.03..0.05).contains(&shown.late_s.unwrap()), "{shown:?}");
    let rates_hz = if obliges { 66.0..94.0 } else { 33.0..47.0 };
    assert!(rates_hz.contains(&shown.link.rates_hz) && (2.5..5.5).contains(&shown.link.gps_hz), "{shown:?}");
    let truth = |time| source.truth_at(time);
    [replay(&recording, truth), replay(&flown.recording, truth), flown.published]
}

fn compare(name: &str, obliges: bool, unknown_deg: f64) {
    let scenario = Scenario::named(name).unwrap().lasting(FRAMES as f64 / 50.0);
    let flights = [31, 32, 33].map(|seed| fly(&scenario, seed, obliges));
    let [recorded, made, published] = std::array::from_fn(|i| Errors::pooled(flights.map(|f| f[i])));
    let mut missed = Vec::new();
    for (what, errors, unknown_deg) in
        [("recorded", recorded, 0.0), ("at its moment", made, 0.0), ("as published", published, unknown_deg)]
    {
        let ratio: [f64; 2] = std::array::from_fn(|k| errors.rms()[k] / recorded.rms()[k]);
        let within = 100.0 * errors.within / errors.count;
        println!(
            "{name}, {what}: rms {:.3?}°, {ratio:.2?} of that recorded; both in 2 sigma {within:.1} %",
            errors.rms()
        );
        if !(0..2).all(|k| errors.rms()[k] <= (MOST * recorded.rms()[k]).hypot(unknown_deg)) {
            missed.push(format!("{what}: {ratio:.2?}"));
        }
    }
    assert!(missed.is_empty(), "{name}: too far beyond the errors of a recording: {missed:?}");
}

#[test]
fn clear_and_dry() {
    compare("clear-dry", true, 0.0);
}

#[test]
fn overcast() {
    compare("overcast", true, 0.0);
}

#[test]
fn clear_and_dry_at_50_hz() {
    compare("clear-dry", false, UNKNOWN_DEG);
}

/// An autopilot that says its rates, climb and stamps otherwise than the messages want them is understood.
#[test]
fn clear_and_dry_with_inav() {
    let scenario = Scenario::named("clear-dry").unwrap().lasting(FRAMES as f64 / 50.0);
    let flown = |inav| {
        let flights = [31, 32, 33].map(|seed| live(&scenario, seed, FRAMES, |pilot| pilot.inav = inav));
        assert!(flights.iter().all(|f| f.shown.used && f.shown.link.rates_hz > 50.0 && f.shown.link.gps_hz > 2.5));
        Errors::pooled(flights.map(|f| f.published))
    };
    let (plain, inav) = (flown(false), flown(true));
    println!("{:.3?}° as the messages want it, {:.3?}° as iNav says it", plain.rms(), inav.rms());
    assert!((0..2).all(|k| inav.rms()[k] < MOST * plain.rms()[k]));
}

/// Its rates are right for it, and wrong for the head: neither estimated with nor carried on by.
#[test]
fn a_head_that_sits_backwards_goes_on_by_itself() {
    let scenario = Scenario::named("clear-dry").unwrap().lasting(FRAMES as f64 / 50.0);
    let flights = [31, 32, 33].map(|seed| {
        let flown = live(&scenario, seed, FRAMES, |pilot| pilot.backwards = true);
        assert!(!flown.shown.used && flown.shown.link.rates_hz > 50.0, "{:?}", flown.shown);
        flown.published
    });
    let errors = Errors::pooled(flights);
    println!("{:.3?}°, both in 2 sigma {:.1} %", errors.rms(), 100.0 * errors.within / errors.count);
    assert!(errors.rms().iter().all(|rms| *rms < 1.0));
}

/// What the autopilot thinks its attitude is changes nothing but what is shown beside ours.
#[test]
fn its_attitude_is_compared_and_never_used() {
    let scenario = Scenario::named("clear-dry").unwrap().lasting(20.0);
    let right = live(&scenario, 34, 900, |_| ());
    let wrong = live(&scenario, 34, 900, |pilot| pilot.wrong = Attitude::from_degrees(5.0, -3.0));
    // By its bits: what is withheld is no number.
    let bits =
        |live: &Live| live.said.iter().map(|(t, a)| (*t, a.roll.to_bits(), a.pitch.to_bits())).collect::<Vec<_>>();
    assert_eq!(bits(&right), bits(&wrong));
    let differs = wrong.shown.differs.unwrap();
    let (roll, pitch) = (differs.roll.to_degrees(), differs.pitch.to_degrees());
    assert!((roll - 5.0).abs() < 0.5 && (pitch + 3.0).abs() < 0.5, "{roll} {pitch}");
}

/// Methods that do not tell a gyro that is wrong from one that is right show nothing of it.
#[test]
fn a_method_that_cannot_judge_rates_is_not_moved_by_them() {
    let scenario = Scenario::named("clear-dry").unwrap();
    for method in [Method::Profile, Method::InverseSine] {
        let right = live_by(method, &scenario, 3, 1500, |_| ());
        let wrong = live_by(method, &scenario, 3, 1500, |pilot| pilot.backwards = true);
        assert!(right.said == wrong.said && !right.shown.used, "{method:?}: {:?}", right.shown);
    }
}
