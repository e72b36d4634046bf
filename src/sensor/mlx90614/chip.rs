//! An MLX90614 as the hardware source walks over it.

use super::driver::{Mlx90614, Object};
use super::registers::Configuration;
use crate::bus::explain::Place;
use crate::bus::linux::LinuxBus;
use crate::bus::{BusError, PecBus};
use crate::clock;
use crate::config::settings::{Mlx90614Settings, PecPolicy};
use crate::frame::{AMBIENT_LASTS_S, Missing, Reading, Sample, Value};
use crate::sensor::Chip;
use crate::source::{Integrity, SensorHealth};
use crate::time::Time;

/// Opens the chip's end of its bus.
pub type OpenBus = Box<dyn FnMut() -> Result<Box<dyn PecBus>, BusError> + Send>;

/// How often a word is asked for before the chip is not opened for it.
const TRIES: usize = 3;

/// One MLX90614 with one or both of its objects.
pub struct Mlx90614Chip {
    place: Place,
    policy: PecPolicy,
    objects: Vec<Object>,
    open_bus: OpenBus,
    chip: Option<Mlx90614<Box<dyn PecBus>>>,
    ambient: Option<(f64, Time)>,
    health: Vec<SensorHealth>,
    said: String,
}

impl Mlx90614Chip {
    /// The chip that the sensors called `name` share, in the order of its slots; they all name the
    /// same bus and address. Of several PEC policies the strictest holds. Nothing is opened yet.
    pub fn from_settings(name: &str, sensors: &[&Mlx90614Settings]) -> Option<Self> {
        let first = *sensors.first()?;
        let place = Place { name: name.to_owned(), chip: "MLX90614", bus: first.bus.clone(), address: first.address };
        let policy = [PecPolicy::Required, PecPolicy::Auto]
            .into_iter()
            .find(|p| sensors.iter().any(|s| s.pec == *p))
            .unwrap_or(PecPolicy::Off);
        let objects = sensors.iter().map(|s| Object::from_number(s.object)).collect::<Option<_>>()?;
        let (bus, address) = (first.bus.clone(), first.address);
        let open_bus: OpenBus = Box::new(move || LinuxBus::open(&bus, address).map(|b| Box::new(b) as Box<dyn PecBus>));
        Some(Self::new(place, policy, objects, open_bus))
    }

    /// A chip on any bus.
    pub fn new(place: Place, policy: PecPolicy, objects: Vec<Object>, open_bus: OpenBus) -> Self {
        let health = vec![SensorHealth::default(); objects.len()];
        Self { place, policy, objects, open_bus, chip: None, ambient: None, health, said: String::new() }
    }

    /// Logs `text` unless it was the last thing said.
    fn say(&mut self, level: log::Level, text: String) {
        if text != self.said {
            log::log!(level, "{}: {text}", self.place);
            self.said = text;
        }
    }

    fn prepare(&mut self) -> Result<Mlx90614<Box<dyn PecBus>>, BusError> {
        let mut chip = Mlx90614::new((self.open_bus)()?);
        let (integrity, configuration) = self.check_pec(&mut chip)?;
        let emissivity = persistently(|| chip.emissivity())?;
        let identity = persistently(|| chip.identity())?;
        let settling_s = configuration.settling_s();
        for health in &mut self.health {
            health.integrity = integrity;
            health.settling_s = settling_s;
            health.lag_s = configuration.lag_s();
            health.emissivity = Some(emissivity);
            health.identity = Some(identity);
        }
        self.ambient = chip.ambient_c().ok().map(|t| (t, clock::now()));
        let text = format!(
            "identity {identity:016x}, settling {settling_s:.2} s (IIR {} %, FIR {}{}), emissivity {emissivity:.3}, {}",
            configuration.iir_percent(),
            configuration.fir_length(),
            if configuration.dual() { ", two channels" } else { "" },
            integrity.as_str()
        );
        self.say(log::Level::Info, text);
        Ok(chip)
    }

    /// Decides how words are checked, and reads the configuration on the way.
    fn check_pec(&mut self, chip: &mut Mlx90614<Box<dyn PecBus>>) -> Result<(Integrity, Configuration), BusError> {
        let unchecked = match (self.policy, chip.bus().pec()) {
            (PecPolicy::Off, _) => Some(Integrity::SwitchedOff),
            (PecPolicy::Auto, None) => Some(Integrity::AdapterWithout),
            (PecPolicy::Required, None) => {
                let bus = self.place.bus.display();
                let text = format!(
                    "not used: pec = \"required\", and the adapter of {bus} has no PEC; use another adapter, or set \
                     pec = \"auto\" to read it unchecked"
                );
                self.say(log::Level::Warn, text);
                return Err(BusError::Pec);
            }
            (_, Some(integrity)) => {
                chip.bus().set_pec(true)?;
                match persistently(|| chip.configuration()) {
                    Ok(configuration) => return Ok((integrity, configuration)),
                    Err(BusError::Pec) => {
                        self.blame_pec(chip);
                        return Err(BusError::Pec);
                    }
                    Err(other) => return Err(other),
                }
            }
        };
        chip.bus().set_pec(false)?;
        let configuration = persistently(|| chip.configuration())?;
        Ok((unchecked.unwrap_or_default(), configuration))
    }

    /// The PEC never matched: says whether it is the words that are damaged or the code alone.
    fn blame_pec(&mut self, chip: &mut Mlx90614<Box<dyn PecBus>>) {
        let words = chip.bus().set_pec(false).map(|()| [(); TRIES].map(|()| chip.configuration()));
        let steady = words.is_ok_and(|w| w[0].is_ok() && w.iter().all(|word| *word == w[0]));
        let text = if steady {
            "not used: its PEC never matches, though its words are steady without; this part or adapter sends a wrong \
             PEC: set pec = \"off\" for this sensor to read it unchecked"
        } else {
            "not used: its words arrive damaged (PEC mismatch); check the wiring, the pull-ups and that the bus runs at \
             100 kHz or less"
        };
        self.say(log::Level::Warn, text.to_owned());
    }

    /// The last die temperature, unless it is too old.
    fn ambient_at(&self, now: Time) -> Option<f64> {
        self.ambient.filter(|(_, at)| now.since(*at) <= AMBIENT_LASTS_S).map(|(t, _)| t)
    }
}

/// Asks again after a failure that may pass, a few times.
fn persistently<T>(mut ask: impl FnMut() -> Result<T, BusError>) -> Result<T, BusError> {
    let mut answer = ask();
    for _ in 1..TRIES {
        match answer {
            Err(BusError::Pec | BusError::Other(_)) => answer = ask(),
            _ => break,
        }
    }
    answer
}

impl Chip for Mlx90614Chip {
    fn open(&mut self) -> Result<(), BusError> {
        self.close();
        let prepared = self.prepare();
        if let Err(e) = prepared {
            self.health.iter_mut().for_each(|h| h.counters.failed(e.missing()));
        }
        self.chip = Some(prepared?);
        Ok(())
    }

    fn close(&mut self) {
        self.chip = None;
        self.ambient = None;
    }

    fn read(&mut self, slot: usize) -> Reading {
        let (Some(chip), Some(object)) = (&mut self.chip, self.objects.get(slot)) else {
            return Err(Missing::NotYet);
        };
        let object_c = chip.object_c(*object);
        let time = clock::now();
        let counters = &mut self.health[slot].counters;
        match object_c {
            Ok(_) => counters.reads += 1,
            Err(why) => counters.failed(why),
        }
        let object_c = object_c?;
        Ok(Sample { value: Value::Absolute { object_c, ambient_c: self.ambient_at(time) }, time })
    }

    fn housekeep(&mut self) {
        // A failure leaves the last one to grow old; the objects' reads say what is wrong.
        if let Some(Ok(ambient_c)) = self.chip.as_mut().map(Mlx90614::ambient_c) {
            self.ambient = Some((ambient_c, clock::now()));
        }
    }

    fn health(&self, slot: usize) -> SensorHealth {
        self.health.get(slot).copied().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests;
