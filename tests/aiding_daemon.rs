//! The daemon as a process, and an autopilot at the far end of a slow link that loses messages.
//!
//! The flight is the simulated source's own, which has no heading, so GPS and airspeed would tell of another one: the
//! autopilot sends its rates alone. What is measured goes by stamps, not by when a busy machine gets round to it.

#[path = "dbus_bus/mod.rs"]
mod dbus_bus;
mod far_autopilot;
mod process;

use dbus_bus::Bus;
use far_autopilot::{FarAutopilot, Told, body_rates};
use irhorizon::attitude::{Attitude, Estimate};
use irhorizon::config::Settings;
use irhorizon::config::settings::SimulationSettings;
use irhorizon::frame::Frame;
use irhorizon::head::Head;
use irhorizon::horizon::Horizon;
use irhorizon::simulation::{Flight, SimulatedSource};
use irhorizon::sky::FieldOfView;
use irhorizon::source::FrameSource;
use irhorizon::time::Time;
use process::{CTL, Daemon, Folder};
use std::process::Command;
use std::time::Duration;

const SEED: u64 = 11;
/// The flight's time that is measured: after the settling, through both turns and into the climb.
const FROM_S: f64 = 12.0;
const TO_S: f64 = 42.0;
const PERIOD: Duration = Duration::from_millis(20);

/// Roll and pitch, °.
type Degrees = [f64; 2];

fn rms(errors: &[Degrees]) -> Degrees {
    [0, 1].map(|i| (errors.iter().map(|e| e[i].powi(2)).sum::<f64>() / errors.len() as f64).sqrt())
}

fn error(said: Attitude, truth: Attitude) -> Degrees {
    [said.roll - truth.roll, said.pitch - truth.pitch].map(f64::to_degrees)
}

/// The errors where the same frames are a recording, from the scan at `first` on: with exact rates in it, or none.
fn recorded(origin: Time, first: Time, with_rates: bool) -> Vec<Degrees> {
    let (settings, simulation) = (Settings::default(), SimulationSettings { seed: SEED, ..Default::default() });
    let field = FieldOfView::Gaussian { fwhm_deg: settings.head.field_of_view_deg };
    let mut source = SimulatedSource::new(&simulation, &Head::six(), field).with_origin(origin);
    let flight = Flight::demo(SEED);
    let mut horizon = Horizon::new(&settings, Head::six());
    horizon.set_lag_s(simulation.lag_s);
    let (mut frame, mut estimate, mut errors) = (Frame::new(6), Estimate::default(), Vec::new());
    let mut tick = first;
    while tick.since(origin) < TO_S {
        source.scan(tick, &mut frame);
        if with_rates {
            frame.aiding.gyro_deg_s = body_rates(&flight, tick.since(origin)).map(Some);
        }
        horizon.update(&frame, &[], &mut estimate);
        if tick.since(origin) >= FROM_S {
            errors.push(error(estimate.attitude.unwrap(), flight.attitude(tick.since(origin))));
        }
        tick = tick + PERIOD;
    }
    errors
}

/// When the simulated flight of a daemon began, as it says.
fn origin(daemon: &Daemon) -> Time {
    daemon.says(" µs of CLOCK_BOOTTIME");
    let said = daemon.said();
    let usec = said.split("begins at ").nth(1).and_then(|s| s.split(' ').next()).unwrap();
    Time::from_nanos(usec.parse::<u64>().unwrap() * 1000)
}

/// A flight's ATTITUDE, checked for holes.
fn whole<'a>(told: &'a [Told], pilot: &FarAutopilot, (from_s, to_s): (f64, f64)) -> Vec<&'a Told> {
    let begun = pilot.origin();
    let within: Vec<_> = told.iter().filter(|t| (from_s..to_s).contains(&t.time.since(begun))).collect();
    let gap_s = within.windows(2).map(|w| w[1].time.since(w[0].time)).fold(0.0, f64::max);
    println!("{from_s:.0} to {to_s:.0} s: {} ATTITUDE, the longest gap {gap_s:.3} s", within.len());
    assert!(gap_s < 0.3 && within.len() as f64 > 40.0 * (to_s - from_s), "{} with a gap of {gap_s} s", within.len());
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
    let daemon = Daemon::spawn(command, folder.path("log"));
    let origin = origin(&daemon);
    pilot.took_off(origin);
    pilot.run(origin + Duration::from_secs_f64(TO_S));

    let shown = bus.client().status().unwrap().autopilot.expect("an autopilot");
    let status = Command::new(CTL).args(["status", "--format", "json", "--bus", &bus.address()]).output().unwrap();
    let json: serde_json::Value = serde_json::from_slice(&status.stdout).unwrap();
    println!("{}", json["autopilot"]);
    assert_eq!(json["autopilot"]["system_id"], 7);
    assert!(shown.used && shown.synced, "{shown:?}");
    assert!((30.0..50.0).contains(&shown.rates_hz) && (0.035..0.08).contains(&shown.late_s.unwrap()), "{shown:?}");
    let differs = [shown.roll_difference_deg.unwrap() - 5.0, shown.pitch_difference_deg.unwrap() + 5.0];
    assert!(differs.iter().all(|d| d.abs() < 1.0), "{shown:?}");

    // Asked once each, and again where the answer was lost; what comes unasked never.
    println!("asked for {:?}, answers lost {:?}", pilot.asked, pilot.unanswered);
    let count = |ids: &[u32], id| ids.iter().filter(|i| **i == id).count();
    assert!(!pilot.asked.contains(&u32::from(process::ATTITUDE)));
    for id in &pilot.asked {
        assert!(count(&pilot.asked, *id) <= 1 + count(&pilot.unanswered, *id), "{:?}", pilot.asked);
    }

    let told = pilot.told.clone();
    let measured = whole(&told, &pilot, (FROM_S, TO_S - 0.5));
    assert!(measured.iter().all(|t| (t.system, t.component) == (7, 191)), "of the autopilot's system");
    assert!(measured.iter().all(|t| t.yaw == 1.25), "the autopilot's yaw");
    let aided: Vec<_> = measured.iter().map(|t| error(t.attitude, pilot.truth(t.time))).collect();
    // The scans' phase is that of the stamps: these are of the same moments, to the millisecond.
    let phase_ns = (measured[0].time.as_nanos() - origin.as_nanos()) % PERIOD.as_nanos() as u64;
    let first = origin + Duration::from_nanos(phase_ns);
    let [exact, bare] = [true, false].map(|with| rms(&recorded(origin, first, with)));
    let aided = rms(&aided);
    let ratio = [0, 1].map(|i| aided[i] / exact[i]);
    println!("rms error: aided {aided:.3?}°, recorded {exact:.3?}°, without {bare:.3?}°; {ratio:.2?} of that recorded");
}
