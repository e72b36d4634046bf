//! An MLX90614 as the hardware source walks over it.

use super::driver::{Mlx90614, Object};
use super::registers::Configuration;
use crate::bus::explain::Place;
use crate::bus::linux::LinuxBus;
use crate::bus::{BusError, PecBus};
use crate::clock;
use crate::config::settings::{Mlx90614Settings, PecPolicy};
use crate::frame::{Missing, Reading, Sample, Value};
use crate::sensor::Chip;
use crate::source::{Integrity, SensorHealth};
use crate::time::Time;

/// Opens the chip's end of its bus.
pub type OpenBus = Box<dyn FnMut() -> Result<Box<dyn PecBus>, BusError> + Send>;

/// A die temperature read longer ago is not given any more, s.
const AMBIENT_MAX_AGE_S: f64 = 10.0;
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
        self.ambient.filter(|(_, at)| now.since(*at) <= AMBIENT_MAX_AGE_S).map(|(t, _)| t)
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
mod tests {
    use super::*;
    use crate::bus::WordBus;
    use std::sync::{Arc, Mutex};

    /// A sensor of 256 words behind an adapter.
    #[derive(Clone, Debug)]
    struct Wire {
        words: [u16; 256],
        adapter_has_pec: bool,
        pec_on: bool,
        /// The PEC that the sensor sends is wrong.
        wrong_pec: bool,
        /// The words themselves arrive damaged, differently each time.
        noise: bool,
        reads: u16,
        dead: bool,
    }

    #[derive(Clone)]
    struct Shared(Arc<Mutex<Wire>>);

    impl WordBus for Shared {
        fn read_word(&mut self, command: u8) -> Result<u16, BusError> {
            let mut w = self.0.lock().unwrap();
            w.reads += 1;
            if w.dead {
                return Err(BusError::NoAnswer);
            }
            if w.adapter_has_pec && w.pec_on && (w.wrong_pec || w.noise) {
                return Err(BusError::Pec);
            }
            let damage = if w.noise { w.reads } else { 0 };
            Ok(w.words[usize::from(command)] ^ damage)
        }

        fn write_word(&mut self, _: u8, _: u16) -> Result<(), BusError> {
            panic!("the source never writes")
        }
    }

    impl PecBus for Shared {
        fn pec(&self) -> Option<Integrity> {
            self.0.lock().unwrap().adapter_has_pec.then_some(Integrity::Pec)
        }

        fn set_pec(&mut self, on: bool) -> Result<(), BusError> {
            self.0.lock().unwrap().pec_on = on;
            Ok(())
        }
    }

    fn sensor(policy: PecPolicy) -> (Shared, Mlx90614Chip) {
        let mut words = [0; 256];
        for (cell, word) in [(0x06, 14908), (0x07, 13658), (0x08, 12158), (0x24, 0xFFFF), (0x25, 0x9FB4), (0x3F, 7)] {
            words[cell] = word;
        }
        let (pec_on, wrong_pec, noise, reads, dead) = (false, false, false, 0, false);
        let wire = Wire { words, adapter_has_pec: true, pec_on, wrong_pec, noise, reads, dead };
        let shared = Shared(Arc::new(Mutex::new(wire)));
        let place = Place { name: "nose".into(), chip: "MLX90614", bus: "/dev/i2c-1".into(), address: 0x5a };
        let handle = shared.clone();
        let open: OpenBus = Box::new(move || Ok(Box::new(handle.clone()) as Box<dyn PecBus>));
        (shared, Mlx90614Chip::new(place, policy, vec![Object::One, Object::Two], open))
    }

    fn set(shared: &Shared, change: impl FnOnce(&mut Wire)) {
        change(&mut shared.0.lock().unwrap());
    }

    #[test]
    fn both_objects_with_the_die_temperature_of_the_opening() {
        let (_, mut chip) = sensor(PecPolicy::Auto);
        assert_eq!(chip.read(0), Err(Missing::NotYet));
        chip.open().unwrap();
        for (slot, expected_c) in [(0, 0.01), (1, -29.99)] {
            let Value::Absolute { object_c, ambient_c } = chip.read(slot).unwrap().value else { panic!() };
            assert!((object_c - expected_c).abs() < 1e-9);
            assert!((ambient_c.unwrap() - 25.01).abs() < 1e-9);
            let health = chip.health(slot);
            assert_eq!((health.integrity, health.settling_s, health.lag_s), (Integrity::Pec, 0.10, 0.10));
            assert_eq!((health.emissivity, health.identity, health.counters.reads), (Some(1.0), Some(7), 1));
        }
        chip.close();
        assert_eq!(chip.read(0), Err(Missing::NotYet));
    }

    #[test]
    fn the_die_temperature_is_refreshed_and_grows_old() {
        let (wire, mut chip) = sensor(PecPolicy::Auto);
        chip.open().unwrap();
        let opened = clock::now();
        let later = |s: u64| opened + std::time::Duration::from_secs(s);
        assert!(chip.ambient_at(later(5)).is_some());
        assert_eq!(chip.ambient_at(later(11)), None);
        set(&wire, |w| w.words[0x06] = 14958);
        chip.housekeep();
        assert!((chip.ambient_at(later(1)).unwrap() - 26.01).abs() < 1e-9);
        set(&wire, |w| w.words[0x06] |= 0x8000);
        chip.housekeep();
        assert!(chip.ambient_at(later(1)).is_some(), "a failure keeps the last one for its time");
    }

    #[test]
    fn an_adapter_without_pec_is_told_or_refused() {
        for (policy, result) in
            [(PecPolicy::Auto, Ok(())), (PecPolicy::Off, Ok(())), (PecPolicy::Required, Err(BusError::Pec))]
        {
            let (wire, mut chip) = sensor(policy);
            set(&wire, |w| w.adapter_has_pec = false);
            assert_eq!(chip.open(), result, "{policy:?}");
            if policy == PecPolicy::Auto {
                assert_eq!(chip.health(0).integrity, Integrity::AdapterWithout);
            }
        }
    }

    #[test]
    fn pec_is_never_dropped_silently() {
        for policy in [PecPolicy::Auto, PecPolicy::Required] {
            let (wire, mut chip) = sensor(policy);
            set(&wire, |w| w.wrong_pec = true);
            assert_eq!(chip.open(), Err(BusError::Pec));
            assert!(chip.said.contains("pec = \"off\""), "{}", chip.said);
            assert_eq!(chip.health(0).counters.bad_pec, 1);
            set(&wire, |w| w.wrong_pec = false);
            assert_eq!(chip.open(), Ok(()));
            assert!(wire.0.lock().unwrap().pec_on);
        }
        let (wire, mut chip) = sensor(PecPolicy::Off);
        set(&wire, |w| w.wrong_pec = true);
        assert_eq!(chip.open(), Ok(()));
        assert_eq!(chip.health(0).integrity, Integrity::SwitchedOff);
        assert!(chip.read(0).is_ok());
    }

    #[test]
    fn damaged_words_are_not_blamed_on_the_code() {
        let (wire, mut chip) = sensor(PecPolicy::Auto);
        set(&wire, |w| w.noise = true);
        assert_eq!(chip.open(), Err(BusError::Pec));
        assert!(chip.said.contains("damaged"), "{}", chip.said);
    }

    #[test]
    fn failures_are_counted_by_their_kind() {
        let (wire, mut chip) = sensor(PecPolicy::Auto);
        chip.open().unwrap();
        set(&wire, |w| w.words[0x07] = 0xFFFF);
        assert_eq!(chip.read(0), Err(Missing::ErrorFlag));
        set(&wire, |w| w.words[0x07] = 0);
        assert_eq!(chip.read(0), Err(Missing::Impossible));
        set(&wire, |w| w.wrong_pec = true);
        assert_eq!(chip.read(0), Err(Missing::BadPec));
        set(&wire, |w| w.dead = true);
        assert_eq!(chip.read(0), Err(Missing::NoAnswer));
        let c = chip.health(0).counters;
        assert_eq!((c.reads, c.error_flag, c.out_of_range, c.bad_pec, c.no_answer), (0, 1, 1, 1, 1));
        assert_eq!(chip.health(1).counters, Default::default(), "the other object is counted apart");
    }
}
