//! The daemon's answers as the view that everything prints.

use super::advice;
use super::client::ClientError;
use super::view::{Autopilot, Counters, Endpoint, Fault, Hint, Sensor, Status, Trim};
use crate::dbus::SENSOR;
use crate::time::Time;
use std::collections::HashMap;
use zbus::OwnedVariant;
use zbus::fdo::ManagedObjects;

/// An object's properties, and what was asked for them.
struct Properties(&'static str, HashMap<String, OwnedVariant>);

impl Properties {
    fn take<T>(&mut self, name: &str) -> Result<T, ClientError>
    where
        T: TryFrom<OwnedVariant, Error = zbus::Error>,
    {
        let value = self.1.remove(name).ok_or_else(|| ClientError::Answer(self.0, format!("no property {name}")))?;
        T::try_from(value).map_err(|e| ClientError::Answer(self.0, format!("property {name}: {e}")))
    }

    /// A number; NaN is none.
    fn number(&mut self, name: &str) -> Result<Option<f64>, ClientError> {
        Ok(Some(self.take(name)?).filter(|v: &f64| !v.is_nan()))
    }
}

/// The state at `now`, from the properties that came for asking `what`.
pub(super) fn status(
    what: &'static str,
    horizon: HashMap<String, OwnedVariant>,
    objects: ManagedObjects,
    now: Time,
) -> Result<Status, ClientError> {
    let mut p = Properties(what, horizon);
    let faults: Vec<(String, u64, String)> = p.take("FaultDetails")?;
    let endpoints: Vec<(String, Counters, String)> = p.take("Endpoints")?;
    let age_s = |usec: u64| now.since(Time::from_nanos(usec.saturating_mul(1_000)));
    let autopilot: HashMap<String, f64> = p.take("Autopilot")?;
    let sample_time_usec = p.take("SampleTimeUsec")?;
    let (bearing_deg, strength_c) = (p.number("HintBearingDeg")?, p.number("HintStrengthC")?);
    let mut sensors = Vec::new();
    for mut interfaces in objects.into_values() {
        if let Some(properties) = interfaces.remove(SENSOR) {
            sensors.push(sensor(Properties(what, properties))?);
        }
    }
    sensors.sort_by_key(|(index, _)| *index);
    Ok(Status {
        version: p.take("Version")?,
        method: p.take("Method")?,
        mode: p.take("Mode")?,
        roll_deg: p.number("RollDeg")?,
        pitch_deg: p.number("PitchDeg")?,
        roll_sigma_deg: p.number("RollSigmaDeg")?,
        pitch_sigma_deg: p.number("PitchSigmaDeg")?,
        measured: p.take("Measured")?,
        trim: Trim {
            roll_deg: p.take("RollTrimDeg")?,
            pitch_deg: p.take("PitchTrimDeg")?,
            roll_learnt_deg: p.take("RollTrimLearntDeg")?,
            pitch_learnt_deg: p.take("PitchTrimLearntDeg")?,
        },
        contrast_c: p.number("ContrastC")?,
        hint: bearing_deg.zip(strength_c).map(|(bearing_deg, strength_c)| Hint { bearing_deg, strength_c }),
        sample_time_usec,
        sample_age_s: if sample_time_usec == 0 { f64::NAN } else { age_s(sample_time_usec) },
        rate_hz: p.take("RateHz")?,
        faults: faults
            .into_iter()
            .map(|(name, since, evidence)| {
                let advice = advice::of(&name);
                Fault { name, for_s: age_s(since), evidence, advice }
            })
            .collect(),
        sensors: sensors.into_iter().map(|(_, sensor)| sensor).collect(),
        autopilot: self::autopilot(&autopilot),
        endpoints: endpoints
            .into_iter()
            .map(|(address, counters, error)| Endpoint::from_counters(address, &counters, error))
            .collect(),
    })
}

/// The autopilot, of which nothing is said while it is not heard.
fn autopilot(said: &HashMap<String, f64>) -> Option<Autopilot> {
    let value = |name: &str| said.get(name).copied();
    let number = |name: &str| value(name).unwrap_or(0.0);
    Some(Autopilot {
        system_id: value("SystemId")? as u8,
        rates_hz: number("RatesHz"),
        late_s: value("LateS"),
        used: number("Used") > 0.0,
        synced: number("Synced") > 0.0,
        gps_hz: number("GpsHz"),
        airspeed_hz: number("AirspeedHz"),
        roll_difference_deg: value("RollDifferenceDeg"),
        pitch_difference_deg: value("PitchDifferenceDeg"),
    })
}

/// A sensor with its place in the configuration.
fn sensor(mut p: Properties) -> Result<(u32, Sensor), ClientError> {
    let index = p.take("Index")?;
    let sensor = Sensor {
        name: p.take("Name")?,
        kind: p.take("Kind")?,
        bus: p.take("Bus")?,
        address: p.take("Address")?,
        direction: p.take("Direction")?,
        state: p.take("State")?,
        object_c: p.number("ObjectC")?,
        ambient_c: p.number("AmbientC")?,
        volts: p.number("Volts")?,
        residual_c: p.number("ResidualC")?,
        integrity: p.take("Integrity")?,
        settling_s: p.take("SettlingS")?,
        emissivity: p.number("Emissivity")?,
        identity: p.take("Identity")?,
        counters: p.take("Counters")?,
    };
    Ok((index, sensor))
}
