//! Attitudes flown through, what the daemon says of them, and the truth for those who listen.

use crate::rig::Daemon;
use crate::sky::Scheme;
use crate::stalls::Watch;
use irhorizon::clock;
use serde_json::Value;
use std::fs::File;
use std::io::Write;
use std::path::PathBuf;
use std::time::Duration;

/// Sensors that the test can show a sky to.
pub trait Sensors {
    /// What the raw values are called.
    fn columns(&self) -> &'static [&'static str];
    /// Shows the sky at this attitude; gives the raw values that they show now.
    fn show(&mut self, roll_deg: f64, pitch_deg: f64) -> Vec<f64>;
    /// The pairs' signals (x, y, z in K) that these raw values mean.
    fn pairs_k(&self, raw: &[f64]) -> [f64; 3];
}

/// Name, roll and pitch in degrees.
const POSES: [(&str, f64, f64); 9] = [
    ("level", 0.0, 0.0),
    ("30 right", 30.0, 0.0),
    ("30 left", -30.0, 0.0),
    ("45 right", 45.0, 0.0),
    ("45 left", -45.0, 0.0),
    ("level again", 0.0, 0.0),
    ("15 up", 0.0, 15.0),
    ("15 down", 0.0, -15.0),
    ("level at last", 0.0, 0.0),
];

/// From pose to pose this fast, in steps of this length.
const MOVE_DEG_S: f64 = 25.0;
const STEP: Duration = Duration::from_millis(40);

/// A pose counts from this long after it was taken up, and is held at least so long.
pub const SETTLE: Duration = Duration::from_millis(400);
const HOLD: Duration = Duration::from_millis(1600);

/// The largest error of an angle, °.
pub const TOLERANCE_DEG: f64 = 0.5;

/// The tests' folder that the host sees.
pub fn share() -> PathBuf {
    PathBuf::from(std::env::var("IRHORIZON_SHARE").expect("IRHORIZON_SHARE"))
}

/// Where the host listens to the set-up called `name`.
pub fn listener(name: &str) -> String {
    let variable = format!("IRHORIZON_LISTENER_{}", name.to_uppercase());
    let port = std::env::var(&variable).unwrap_or_else(|_| panic!("{variable}: run this by tests/kernel/run"));
    format!("udpout:{}:{port}", std::env::var("IRHORIZON_HOST").unwrap())
}

/// Where the machine stood still for longer at a time, or for more of it in all, the truth itself was late.
const CALM: (Duration, f64) = (Duration::from_millis(250), 0.03);
/// A flight over the sensors of one set-up.
pub struct Flight<'a, S> {
    sensors: &'a mut S,
    scheme: Scheme,
    truth: File,
    steps: Vec<(f64, [f64; 3])>,
}

/// The largest errors seen, °.
#[derive(Default, Debug)]
pub struct Worst {
    pub dbus_deg: f64,
    pub status_deg: f64,
}

/// An error unless this holds.
fn require(holds: bool, what: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(what()) }
}

impl<'a, S: Sensors> Flight<'a, S> {
    /// Takes the truth down in `<name>.truth.csv`, its first line for who reads it.
    pub fn begin(name: &str, sensors: &'a mut S, scheme: Scheme) -> Self {
        let mut truth = File::create(share().join(format!("{name}.truth.csv"))).unwrap();
        let Scheme { rate_hz, time_constant_s, roll_limit_deg } = scheme;
        writeln!(truth, "# rate_hz={rate_hz} time_constant_s={time_constant_s} roll_limit_deg={roll_limit_deg}")
            .unwrap();
        writeln!(truth, "boot_ms,pose,{},expected_roll_deg,expected_pitch_deg", sensors.columns().join(",")).unwrap();
        let mut flight = Self { sensors, scheme, truth, steps: Vec::new() };
        flight.step("", 0.0, 0.0);
        flight
    }

    fn step(&mut self, pose: &str, roll_deg: f64, pitch_deg: f64) {
        let time_s = clock::now().as_secs_f64();
        let raw = self.sensors.show(roll_deg, pitch_deg);
        self.steps.push((time_s, self.sensors.pairs_k(&raw)));
        let (roll, pitch) = self.scheme.expect(&self.steps, time_s);
        let raw: Vec<String> = raw.iter().map(f64::to_string).collect();
        writeln!(self.truth, "{:.3},{pose},{},{roll:.4},{pitch:.4}", time_s * 1e3, raw.join(",")).unwrap();
    }

    /// Flies through all poses; what was found, and whether the machine did not stand still meanwhile.
    pub fn fly(mut self, daemon: &Daemon) -> (Result<Worst, String>, bool) {
        let watch = Watch::start();
        let worst = self.poses(daemon);
        let (longest, span) = (watch.stalls().into_iter().map(|(from, to)| to - from).max(), watch.stop());
        let longest = longest.unwrap_or_default();
        println!("flown in {span}, {longest:.3?} at a time at most");
        (worst, longest <= CALM.0 && span.lost() <= CALM.1)
    }

    /// In each of the poses D-Bus and `status` must agree with the expectation.
    fn poses(&mut self, daemon: &Daemon) -> Result<Worst, String> {
        let (mut roll, mut pitch) = (0.0, 0.0);
        let mut worst = Worst::default();
        for (name, to_roll, to_pitch) in POSES {
            let angle = f64::max(f64::abs(to_roll - roll), f64::abs(to_pitch - pitch));
            let steps = (angle / MOVE_DEG_S / STEP.as_secs_f64()).ceil();
            let begun = clock::now();
            for i in 1..=steps as u32 {
                clock::sleep_until(begun + STEP * i);
                // Gently: the rate is none at either end.
                let part = (1.0 - (std::f64::consts::PI * f64::from(i) / steps).cos()) / 2.0;
                self.step("", roll + (to_roll - roll) * part, pitch + (to_pitch - pitch) * part);
            }
            (roll, pitch) = (to_roll, to_pitch);
            let begun = clock::now();
            self.step(name, roll, pitch);
            clock::sleep_until(begun + SETTLE);
            self.check(name, daemon, &mut worst)?;
            clock::sleep_until(begun + HOLD);
        }
        // Ends the last pose, which is level: as a user asks.
        let told = ["Mode", "Faults"].map(|name| daemon.property(name));
        require(told == ["s \"nominal\"", "as 0"], || format!("{told:?}"))?;
        for name in ["RollDeg", "PitchDeg"] {
            let angle = daemon.property(name);
            let degrees: f64 = angle.strip_prefix("d ").and_then(|d| d.parse().ok()).ok_or_else(|| angle.clone())?;
            require(degrees.abs() <= TOLERANCE_DEG, || format!("{name} {angle}"))?;
        }
        self.step("", roll, pitch);
        Ok(worst)
    }

    fn check(&self, pose: &str, daemon: &Daemon, worst: &mut Worst) -> Result<(), String> {
        let none = Value::Array(vec![]);
        let p = daemon.properties();
        require(p["Mode"] == "nominal" && p["Faults"] == none, || format!("{pose}: {p}"))?;
        let error = self.error_deg(pose, &p["SampleTimeUsec"], &p["RollDeg"], &p["PitchDeg"])?;
        worst.dbus_deg = worst.dbus_deg.max(error);
        let s = daemon.status();
        require(s["mode"] == "nominal" && s["faults"] == none, || format!("{pose}: {s}"))?;
        let error = self.error_deg(pose, &s["sample_time_usec"], &s["roll_deg"], &s["pitch_deg"])?;
        worst.status_deg = worst.status_deg.max(error);
        Ok(())
    }

    fn error_deg(&self, pose: &str, usec: &Value, roll: &Value, pitch: &Value) -> Result<f64, String> {
        let at_s = usec.as_u64().ok_or("no time")? as f64 * 1e-6;
        let taken_up_s = self.steps.last().unwrap().0;
        let now_s = clock::now().as_secs_f64();
        require(at_s > taken_up_s && at_s < now_s, || format!("{pose}: {at_s} is no time of this pose"))?;
        let expected = self.scheme.expect(&self.steps, at_s);
        let (roll, pitch) = (roll.as_f64().ok_or("no roll")?, pitch.as_f64().ok_or("no pitch")?);
        let error = (roll - expected.0).abs().max((pitch - expected.1).abs());
        require(error <= TOLERANCE_DEG, || format!("{pose}: roll {roll}, pitch {pitch}, expected {expected:?}"))?;
        Ok(error)
    }
}
