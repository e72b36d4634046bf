//! A daemon that says what its bus address tells it to.

use irhorizon::ctl::kit::{Daemon, DaemonError};
use irhorizon::ctl::view::{Sensor, Status, Trim};
use irhorizon::recording::{Taps, Writer};
use std::cell::{Cell, RefCell};
use std::os::fd::OwnedFd;
use std::path::PathBuf;

thread_local! {
    pub static LOOKS: Cell<u64> = const { Cell::new(0) };
    pub static RELOADS: Cell<usize> = const { Cell::new(0) };
    /// The configuration that it runs on.
    pub static RUNS_ON: RefCell<PathBuf> = const { RefCell::new(PathBuf::new()) };
}

/// Digital sensors, with what each shows too much, K.
const DIGITAL: [(&str, f64); 3] = [("nose", 0.5), ("tail", -0.25), ("left", -0.1)];

/// A daemon whose bus address says what it answers.
pub struct Fake(pub String);

impl Daemon for Fake {
    fn status(&mut self) -> Result<Status, DaemonError> {
        let look = LOOKS.get();
        LOOKS.set(look + 1);
        // Noise that repeats after seven looks.
        let noise = [0.03, -0.05, 0.0, 0.06, -0.02, 0.01, -0.03][usize::try_from(look % 7).unwrap_or(0)];
        let mut s = Status {
            method: "field".into(),
            mode: "nominal".into(),
            roll_deg: Some(1.5 + noise),
            pitch_deg: Some(-4.0 - noise),
            roll_sigma_deg: Some(0.8),
            pitch_sigma_deg: Some(0.9),
            measured: true,
            trim: Trim { roll_deg: 0.5, ..Trim::default() },
            sample_time_usec: 1_000_000 + look,
            ..Status::default()
        };
        let pair = |name: &str, volts: f64| Sensor {
            name: name.into(),
            kind: "ads1115".into(),
            bus: "/dev/i2c-1".into(),
            state: "ok".into(),
            volts: Some(volts + noise / 100.0),
            ..Sensor::default()
        };
        s.sensors = vec![pair("long", 1.652), pair("lat", -0.004), pair("vert", 0.0)];
        // The head warms up by a kelvin in ten seconds.
        let digital = |(name, offset): (&str, f64)| Sensor {
            name: name.into(),
            kind: "mlx90614".into(),
            bus: "/dev/i2c-3".into(),
            state: "ok".into(),
            object_c: Some(21.0 + 0.01 * look as f64 + offset + noise),
            ..Sensor::default()
        };
        s.sensors.extend(DIGITAL.map(digital));
        match self.0.as_str() {
            "fake:still" => {}
            "fake:published" => s.method = "inverse-sine".into(),
            "fake:moving" => s.roll_deg = Some(1.5 + look as f64 * 0.1),
            "fake:drifting" => s.pitch_deg = Some(look as f64 * 0.018),
            "fake:faulted" => (s.mode, s.roll_deg, s.pitch_deg) = ("faulted".into(), None, None),
            "fake:degraded" => s.mode = "degraded".into(),
            "fake:unsure" => s.roll_sigma_deg = Some(9.0),
            "fake:tilted" => s.roll_deg = Some(31.0),
            "fake:silent" => (s.sensors[1].volts, s.sensors[1].state) = (None, "saturated".into()),
            "fake:warm-hand" => s.sensors[3].object_c = Some(30.0),
            "fake:swaying" => s.sensors[3].object_c = Some(21.0 + look as f64 * 0.03),
            "fake:blind" => (s.sensors[4].object_c, s.sensors[4].state) = (None, "bad-pec".into()),
            "fake:uncovered" => s.sensors[0].volts = Some(1.65 + look as f64 * 0.002),
            "fake:stuck" => s.sample_time_usec = 1,
            other => return Err(DaemonError::Absent(format!("no irhorizond on {other}").into())),
        }
        Ok(s)
    }

    fn frames(&mut self) -> Result<OwnedFd, DaemonError> {
        let loaded = RUNS_ON.with_borrow(|path| irhorizon::config::load(path)).unwrap();
        let writer = Writer::new(&loaded.settings.head(), &loaded.text);
        Taps::new(writer.header()).subscribe().map_err(|e| DaemonError::Refused(e.into()))
    }

    fn reload(&mut self) -> Result<(), DaemonError> {
        RELOADS.set(RELOADS.get() + 1);
        if self.0 == "fake:none" { Err(DaemonError::Absent("no irhorizond".into())) } else { Ok(()) }
    }
}
