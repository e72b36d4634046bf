//! The daemon as a process, and an autopilot at the far end of a slow link that loses messages.
//!
//! The flight is the simulated source's own, which has no heading, so GPS and airspeed would tell of another one: the
//! autopilot sends its rates alone. What is measured goes by stamps, not by when a busy machine gets round to it; where
//! the machine stood still rates were later than the autopilot meant them to be, and nothing is measured.

#[path = "dbus_bus/mod.rs"]
mod dbus_bus;
mod far_autopilot;
mod process;

use dbus_bus::Bus;
use far_autopilot::{FarAutopilot, Told, body_rates};
use irhorizon::attitude::{Attitude, Estimate};
use irhorizon::clock;
use irhorizon::config::Settings;
use irhorizon::config::settings::SimulationSettings;
use irhorizon::frame::Frame;
use irhorizon::head::Head;
use irhorizon::horizon::Horizon;
use irhorizon::recording::Recording;
use irhorizon::simulation::{Flight, SimulatedSource};
use irhorizon::sky::FieldOfView;
use irhorizon::source::FrameSource;
use irhorizon::time::Time;
use process::stalls::Watch;
use process::{CTL, Daemon, Folder};
use rustix::process::Signal;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

const SEED: u64 = 11;
/// The flight's time that is measured: after the settling, through both turns and into the climb.
const FROM_S: f64 = 12.0;
const TO_S: f64 = 42.0;
const PERIOD: Duration = Duration::from_millis(20);

/// What the errors may be, of those of a recording with exact rates.
const MOST: f64 = 1.3;
/// And as far as stamps may be off, s: half a millisecond the autopilot's, which count milliseconds, half a millisecond
/// the daemon's, and a millisecond the answers to TIMESYNC on a machine that has other things to do.
const STAMPS_S: f64 = 0.002;
/// How long after the machine stood still there are older rates than there would have been, s.
const SHAKEN_S: f64 = 0.1;
/// Roll and pitch, °.
type Degrees = [f64; 2];

fn rms(errors: &[Degrees]) -> Degrees {
    [0, 1].map(|i| (errors.iter().map(|e| e[i].powi(2)).sum::<f64>() / errors.len() as f64).sqrt())
}

fn error(said: Attitude, truth: Attitude) -> Degrees {
    [said.roll - truth.roll, said.pitch - truth.pitch].map(f64::to_degrees)
}

/// When the machine stood still, in seconds of the flight.
struct Stalls {
    origin: Time,
    spans: Vec<(f64, f64)>,
}

impl Stalls {
    /// Those that `watch` saw, which was started at `begun`.
    fn new(origin: Time, begun: Time, watch: Watch) -> Self {
        let of_flight = |d: Duration| (begun + d).since(origin);
        Self { origin, spans: watch.stalls().iter().map(|(from, to)| (of_flight(*from), of_flight(*to))).collect() }
    }

    /// Whether `time` is one to be measured.
    fn spare(&self, time: Time) -> bool {
        let time_s = time.since(self.origin);
        (FROM_S..TO_S).contains(&time_s)
            && !self.spans.iter().any(|(from, to)| (*from..to + SHAKEN_S).contains(&time_s))
    }

    /// How long it stood still within a time of the flight, s.
    fn within(&self, from_s: f64, to_s: f64) -> f64 {
        self.spans.iter().map(|(from, to)| (to.min(to_s) - from.max(from_s)).max(0.0)).sum()
    }
}

/// The errors in the time that is measured, of `frames` that are estimated again.
fn again(stalls: &Stalls, lag_s: f64, mut frames: impl FnMut(&mut Frame) -> bool) -> Vec<Degrees> {
    let mut horizon = Horizon::new(&Settings::default(), Head::six());
    horizon.set_lag_s(lag_s);
    let flight = Flight::demo(SEED);
    let (mut frame, mut estimate, mut errors) = (Frame::new(6), Estimate::default(), Vec::new());
    while frames(&mut frame) {
        horizon.update(&frame, &[], &mut estimate);
        if stalls.spare(frame.time) {
            errors.push(error(estimate.attitude.unwrap(), flight.attitude(frame.time.since(stalls.origin))));
        }
    }
    errors
}

/// The same for a flight recorded from the scan at `first` on, with exact rates in it or with none.
fn recorded(stalls: &Stalls, first: Time, with_rates: bool) -> Vec<Degrees> {
    let origin = stalls.origin;
    let simulation = SimulationSettings { seed: SEED, ..SimulationSettings::default() };
    let field = FieldOfView::Gaussian { fwhm_deg: Settings::default().head.field_of_view_deg };
    let mut source = SimulatedSource::new(&simulation, &Head::six(), field).with_origin(origin);
    let (flight, mut tick) = (Flight::demo(SEED), first);
    again(stalls, simulation.lag_s, |frame| {
        source.scan(tick, frame);
        if with_rates {
            frame.aiding.gyro_deg_s = body_rates(&flight, tick.since(origin)).map(Some);
        }
        tick = tick + PERIOD;
        tick.since(origin) < TO_S
    })
}

/// What `irhorizonctl record` has recorded.
fn replayed(stalls: &Stalls, file: &Path) -> Vec<Degrees> {
    let recording = Recording::new(BufReader::new(File::open(file).unwrap()), "recording".into()).unwrap();
    let mut frames = recording.frames(Some(Head::six())).unwrap();
    again(stalls, SimulationSettings::default().lag_s, |frame| frames.next_frame(frame).unwrap())
}

/// When the simulated flight of a daemon began, as it says.
fn origin(daemon: &Daemon) -> Time {
    daemon.says(" µs of CLOCK_BOOTTIME");
    let said = daemon.said();
    let usec = said.split("begins at ").nth(1).and_then(|s| s.split(' ').next()).unwrap();
    Time::from_nanos(usec.parse::<u64>().unwrap() * 1000)
}

/// ATTITUDE in a time of the flight, checked for holes.
fn whole(pilot: &FarAutopilot, stalls: &Stalls, (from_s, to_s): (f64, f64)) -> Vec<Told> {
    let is_within = |t: &&Told| (from_s..to_s).contains(&t.time.since(pilot.origin()));
    let within: Vec<_> = pilot.told.iter().filter(is_within).copied().collect();
    let gap_s = within.windows(2).map(|w| w[1].time.since(w[0].time)).fold(0.0, f64::max);
    let still_s = stalls.within(from_s, to_s);
    let told =
        format!("{} ATTITUDE, the longest gap {gap_s:.3} s, the machine stood still for {still_s:.3} s", within.len());
    println!("{from_s:.1} to {to_s:.1} s: {told}");
    assert!(gap_s < 0.3 + still_s && within.len() as f64 > 40.0 * (to_s - from_s - still_s), "{told}");
    within
}

#[test]
fn an_autopilot_far_away_is_nearly_as_good_as_a_recording() {
    let (folder, bus, mut pilot) = (Folder::new(), Bus::new(), FarAutopilot::new(SEED));
    // What it thinks of its own attitude changes nothing but what is shown.
    pilot.wrong = Attitude::from_degrees(5.0, -5.0);
    let config = format!(
        "[simulation]\nenabled = true\nseed = {SEED}\n[mavlink]\nyaw = true\n[dbus]\nbus = \"{}\"\n[[mavlink.endpoint]]\n\
         address = \"udpout:127.0.0.1:{}\"\n",
        bus.address(),
        pilot.port()
    );
    let mut command = Command::new(process::DAEMON);
    command.args(["--log-level", "debug", "--config"]).arg(folder.write("irhorizon.toml", config));
    let (begun, watch) = (clock::now(), Watch::start());
    let daemon = Daemon::spawn(command, folder.path("log"));
    let origin = origin(&daemon);
    pilot.took_off(origin);
    pilot.run(clock::now() + Duration::from_secs(1));
    let (file, mut command) = (folder.path("flight.csv"), Command::new(CTL));
    command.args(["record", "--bus", &bus.address()]).arg(&file);
    let mut recorder = Daemon::spawn(command, folder.path("recorder"));
    pilot.run(origin + Duration::from_secs_f64(TO_S));

    let shown = bus.client().status().unwrap().autopilot.expect("an autopilot");
    let status = Command::new(CTL).args(["status", "--format", "json", "--bus", &bus.address()]).output().unwrap();
    let json: serde_json::Value = serde_json::from_slice(&status.stdout).unwrap();
    println!("{}", json["autopilot"]);
    assert_eq!(json["autopilot"]["system_id"], 7);
    assert!(shown.used && shown.synced, "{shown:?}");
    assert!((60.0..100.0).contains(&shown.rates_hz) && (0.035..0.1).contains(&shown.late_s.unwrap()), "{shown:?}");
    let differs = [shown.roll_difference_deg.unwrap() - 5.0, shown.pitch_difference_deg.unwrap() + 5.0];
    assert!(differs.iter().all(|d| d.abs() < 1.0), "{shown:?}");

    // Asked once each, and again where the answer was lost.
    println!("asked for {:?}, answers lost {:?}", pilot.asked, pilot.unanswered);
    let count = |ids: &[u32], id| ids.iter().filter(|i| **i == id).count();
    assert!(pilot.asked.contains(&u32::from(process::ATTITUDE)));
    for id in &pilot.asked {
        assert!(count(&pilot.asked, *id) <= 1 + count(&pilot.unanswered, *id), "{:?}", pilot.asked);
    }

    recorder.signal(Signal::INT);
    assert!(recorder.ended().success(), "{}", recorder.said());
    let stalls = || Stalls::new(origin, begun, watch);
    falls_silent(&mut pilot, &bus, stalls);

    let stalls = stalls();
    let told = whole(&pilot, &stalls, (FROM_S, TO_S));
    assert!(told.iter().all(|t| (t.system, t.component) == (7, 191)), "of the autopilot's system");
    assert!(told.iter().all(|t| t.yaw == 1.25), "the autopilot's yaw");
    let all = told.len();
    let told: Vec<Told> = told.into_iter().filter(|t| stalls.spare(t.time)).collect();
    println!("measured: {} of {all}", told.len());
    assert!(4 * told.len() > all, "this machine stands still too much for anything to be measured on it");
    // The scans' phase is that of the stamps: these are of the same moments, to the millisecond.
    let phase_ns = (told[0].time.as_nanos() - origin.as_nanos()) % PERIOD.as_nanos() as u64;
    let first = origin + Duration::from_nanos(phase_ns);
    let [exact, bare] = [true, false].map(|with| rms(&recorded(&stalls, first, with)));
    let aligned = rms(&replayed(&stalls, &file));
    let published = rms(&told.iter().map(|t| error(t.attitude, pilot.truth(t.time))).collect::<Vec<_>>());
    let rates: Vec<_> = told.iter().map(|t| pilot.rates(t.time)).collect();
    let stamps = rms(&rates).map(|rate| rate * STAMPS_S);
    println!("rms errors of roll and pitch, °: recorded with exact rates {exact:.3?}, without rates {bare:.3?}");
    println!("aligned {aligned:.3?}, published {published:.3?}; stamps {stamps:.3?}");
    let [off, are] = pilot.rates_off(&told);
    println!("body rates: {off:.2?} °/s off of {are:.2?}");
    assert!(off.iter().zip(are).all(|(off, is)| *off < 0.15 * is), "{off:?} of {are:?}");
    for i in [0, 1] {
        let most = MOST * exact[i] + stamps[i];
        let note = |what: &str, is: f64| {
            println!("axis {i}, {what}: {:.2} of that recorded, {:.2} of the most", is / exact[i], is / most)
        };
        note("aligned", aligned[i]);
        note("published", published[i]);
        assert!(aligned[i] <= most, "{} of {most}", aligned[i]);
        assert!(published[i] <= most, "{} of {most}", published[i]);
        assert!(published[i] < 0.5 * bare[i], "{} and {} without", published[i], bare[i]);
    }
}

/// The daemon goes on by itself, and soon.
fn falls_silent(pilot: &mut FarAutopilot, bus: &Bus, stalls: impl Fn() -> Stalls) {
    pilot.talks = false;
    let (silent, mut client) = (pilot.spoke, bus.client());
    let mut unaided = 0;
    while pilot.told.last().is_none_or(|t| t.time.since(silent) < 4.0) {
        pilot.run(clock::now() + Duration::from_millis(50));
        let status = client.status().unwrap();
        let since_s = Time::from_nanos(status.sample_time_usec * 1000).since(silent);
        let used = status.autopilot.is_some_and(|a| a.used);
        if !used && unaided == 0 {
            println!("unaided {since_s:.2} s after the last word");
        }
        assert!(!used || since_s < 1.0, "aided after {since_s} s");
        unaided += u32::from(!used);
    }
    assert!(unaided > 0);
    let silent_s = silent.since(pilot.origin());
    let alone = whole(pilot, &stalls(), (silent_s - 0.5, silent_s + 4.0));
    let errors: Vec<_> = alone.iter().map(|t| error(t.attitude, pilot.truth(t.time))).collect();
    let [off, are] = pilot.rates_off(&alone);
    println!("alone: rms {:.2?}°, body rates {off:.2?} °/s off of {are:.2?}", rms(&errors));
    assert!(rms(&errors).iter().all(|e| *e < 2.0), "{:?}", rms(&errors));
}
