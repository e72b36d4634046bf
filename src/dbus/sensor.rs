//! `org.irhorizon1.Sensor`: one sensor.

use super::horizon::{SharedLive, lock};
use super::info::SensorInfo;
use crate::frame::{Reading, Value};
use crate::source::SensorHealth;
use zbus::interface;

/// The interface's object.
pub(super) struct Sensor {
    pub live: SharedLive,
    pub index: usize,
}

impl Sensor {
    fn info<T: Default>(&self, pick: impl FnOnce(&SensorInfo) -> T) -> T {
        lock(&self.live).info.sensors.get(self.index).map(pick).unwrap_or_default()
    }

    fn health<T: Default>(&self, pick: impl FnOnce(&SensorHealth) -> T) -> T {
        let live = lock(&self.live);
        live.of_sensor(&live.snapshot.health, self.index).map(pick).unwrap_or_default()
    }

    fn reading(&self) -> Result<Reading, &'static str> {
        let live = lock(&self.live);
        if live.overdue {
            return Err("stale");
        }
        live.of_sensor(&live.snapshot.frame.readings, self.index).copied().ok_or("not read yet")
    }

    fn value(&self, pick: impl FnOnce(Value) -> Option<f64>) -> f64 {
        self.reading().ok().and_then(Result::ok).and_then(|s| pick(s.value)).unwrap_or(f64::NAN)
    }
}

/// The properties are read-only; their changes are not signalled. Numbers that are not known are
/// NaN.
#[interface(name = "org.irhorizon1.Sensor")]
impl Sensor {
    /// Its place in the configuration, from 0.
    #[zbus(property(emits_changed_signal = "const"))]
    fn index(&self) -> u32 {
        u32::try_from(self.index).unwrap_or(u32::MAX)
    }

    /// Its name.
    #[zbus(property(emits_changed_signal = "const"))]
    fn name(&self) -> String {
        self.info(|i| i.name.clone())
    }

    /// `mlx90614`, `ads1115` or `simulated`.
    #[zbus(property(emits_changed_signal = "const"))]
    fn kind(&self) -> &'static str {
        self.info(|i| i.kind)
    }

    /// The bus it is read from, empty when simulated.
    #[zbus(property(emits_changed_signal = "const"))]
    fn bus(&self) -> String {
        self.info(|i| i.bus.clone())
    }

    /// Its address there, 0 when simulated.
    #[zbus(property(emits_changed_signal = "const"))]
    fn address(&self) -> u8 {
        self.info(|i| i.address)
    }

    /// Where it looks.
    #[zbus(property(emits_changed_signal = "const"))]
    fn direction(&self) -> String {
        self.info(|i| i.direction.clone())
    }

    /// `ok`, or why there is no measurement in the newest frame.
    #[zbus(property(emits_changed_signal = "false"))]
    fn state(&self) -> &'static str {
        match self.reading() {
            Ok(Ok(_)) => "ok",
            Ok(Err(missing)) => missing.as_str(),
            Err(why) => why,
        }
    }

    /// What it looks at, degrees Celsius.
    #[zbus(property(emits_changed_signal = "false"))]
    fn object_c(&self) -> f64 {
        self.value(|v| match v {
            Value::Absolute { object_c, .. } => Some(object_c),
            Value::Volts(_) => None,
        })
    }

    /// Its own die, degrees Celsius.
    #[zbus(property(emits_changed_signal = "false"))]
    fn ambient_c(&self) -> f64 {
        self.value(|v| match v {
            Value::Absolute { ambient_c, .. } => ambient_c,
            Value::Volts(_) => None,
        })
    }

    /// The pair's voltage.
    #[zbus(property(emits_changed_signal = "false"))]
    fn volts(&self) -> f64 {
        self.value(|v| match v {
            Value::Absolute { .. } => None,
            Value::Volts(volts) => Some(volts),
        })
    }

    /// What it shows beyond what attitude and sky explain, kelvin.
    #[zbus(property(emits_changed_signal = "false"))]
    fn residual_c(&self) -> f64 {
        let live = lock(&self.live);
        live.of_sensor(&live.snapshot.estimate.residuals_k, self.index).copied().flatten().unwrap_or(f64::NAN)
    }

    /// When it was measured, microseconds of CLOCK_BOOTTIME; 0 without a measurement.
    #[zbus(property(emits_changed_signal = "false"))]
    fn sample_time_usec(&self) -> u64 {
        self.reading().ok().and_then(Result::ok).map_or(0, |s| s.time.as_micros())
    }

    /// How its words are checked.
    #[zbus(property(emits_changed_signal = "false"))]
    fn integrity(&self) -> &'static str {
        self.health(|h| h.integrity).as_str()
    }

    /// Its settling time, seconds; 0 when unknown.
    #[zbus(property(emits_changed_signal = "false"))]
    fn settling_s(&self) -> f64 {
        self.health(|h| h.settling_s)
    }

    /// The emissivity set in it, 0 to 1.
    #[zbus(property(emits_changed_signal = "false"))]
    fn emissivity(&self) -> f64 {
        self.health(|h| h.emissivity).unwrap_or(f64::NAN)
    }

    /// Its identity, hexadecimal, empty when unknown.
    #[zbus(property(emits_changed_signal = "false"))]
    fn identity(&self) -> String {
        self.health(|h| h.identity).map_or(String::new(), |id| format!("{id:016x}"))
    }

    /// Named counts since start.
    #[zbus(property(emits_changed_signal = "false"))]
    fn counters(&self) -> Vec<(String, u64)> {
        self.health(|h| h.counters).named().map(|(name, count)| (name.to_owned(), count)).into()
    }
}
