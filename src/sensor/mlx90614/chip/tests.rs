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
