//! What faults do to a sensor: first to what it sees, then to what it says.

use super::{Fault, Kind};
use crate::frame::{Missing, Value};
use crate::simulation::head::{Lag, as_read, quantised};
use crate::simulation::noise::Noise;
use crate::simulation::turbulence::Wander;
use std::collections::VecDeque;

/// In which order they come in: whatever follows sees what is before it.
const ORDER: [Kind; 9] = [
    Kind::Wet,
    Kind::Rain,
    Kind::Slow,
    Kind::Wrong,
    Kind::Delayed,
    Kind::Garbage,
    Kind::Stuck,
    Kind::Intermittent,
    Kind::Off,
];
/// Drops on a sensor, K rms, and how long they stay, s.
const DROPS_K: f64 = 0.5;
const DROPS_S: f64 = 1.0;
/// Scans a second, at most, for which memory is set aside.
const SCANS_HZ: f64 = 200.0;
/// A hair early counts: the scans' own times are rounded, s.
const HAIR_S: f64 = 1e-6;
/// What a sensor's datasheet lets it say: MLX90614, °C, a step within; ADS1115 at ±2.048 V, V.
const OBJECT_C: [f64; 2] = [-69.98, 379.98];
const FULL_SCALE_V: f64 = 2.048;

/// What a fault remembers of a sensor.
#[derive(Clone, Debug)]
enum Memory {
    Nothing,
    Drops(Wander),
    Lag(Lag),
    /// What it said, with when, s: from the newest that is old enough on.
    Past(VecDeque<(f64, Value)>),
    Held(Option<Value>),
}

#[derive(Clone, Debug)]
struct Effect {
    fault: Fault,
    noise: Noise,
    memory: Memory,
}

/// The faults of one sensor.
#[derive(Clone, Debug, Default)]
pub struct Effects(Vec<Effect>);

impl Effects {
    /// Those of `faults` that befall the sensor called `name`, the head's sensor number `index`. Each
    /// has its own chance by `seed`, so that one changes no other.
    pub fn new(faults: &[Fault], name: &str, index: usize, seed: u64) -> Self {
        let of_kind = |kind| faults.iter().filter(move |f| f.kind == kind && f.befalls(name));
        let effect = |fault: &Fault| {
            let mut seeds = Noise::new(seed ^ fault.from_s.to_bits());
            let mut noise = Noise::new(seeds.bits() ^ ((fault.kind as u64) << 32) ^ index as u64);
            let memory = match fault.kind {
                Kind::Rain => Memory::Drops(Wander::new(DROPS_K, DROPS_S, &mut noise)),
                Kind::Slow => Memory::Lag(Lag::new(fault.strength)),
                // Memory is set aside now, for nothing is allocated later.
                Kind::Delayed => Memory::Past(VecDeque::with_capacity((fault.strength * SCANS_HZ) as usize + 8)),
                Kind::Stuck => Memory::Held(None),
                _ => Memory::Nothing,
            };
            Effect { fault: fault.clone(), noise, memory }
        };
        Self(ORDER.into_iter().flat_map(of_kind).map(effect).collect())
    }

    /// What it sees, °C or K, where without faults it would see `seen` and through water `film`.
    pub fn seen(&mut self, mut seen: f64, film: f64, time_s: f64, dt_s: f64) -> f64 {
        for Effect { fault, noise, memory } in &mut self.0 {
            let share = fault.share(time_s);
            match (fault.kind, memory) {
                (Kind::Wet, _) => seen += share * fault.strength / 100.0 * (film - seen),
                (Kind::Rain, Memory::Drops(drops)) => seen += share * drops.step(dt_s, noise),
                (Kind::Slow, Memory::Lag(lag)) if share > 0.0 => seen = lag.update(seen, dt_s),
                (Kind::Slow, Memory::Lag(lag)) => *lag = Lag::new(fault.strength),
                _ => {}
            }
        }
        seen
    }

    /// What is added to what it says, K.
    pub fn offset_k(&self, time_s: f64) -> f64 {
        let wrong = self.0.iter().map(|e| &e.fault).filter(|f| f.kind == Kind::Wrong);
        wrong.map(|f| f.share(time_s) * f.strength).sum()
    }

    /// What it says where it would say `value`, whose smallest step is `volts_step` if it is in volts.
    pub fn said(&mut self, mut value: Value, time_s: f64, volts_step: f64) -> Result<Value, Missing> {
        for Effect { fault, noise, memory } in &mut self.0 {
            let on = fault.share(time_s) > 0.0;
            match (fault.kind, memory) {
                (Kind::Delayed, Memory::Past(past)) => {
                    past.push_back((time_s, value));
                    while past.get(1).is_some_and(|(then_s, _)| *then_s <= time_s - fault.strength + HAIR_S) {
                        past.pop_front();
                    }
                    if on && let Some((_, old)) = past.front() {
                        value = *old;
                    }
                }
                (Kind::Garbage, _) if on => value = anything(value, noise.uniform(), volts_step),
                (Kind::Stuck, Memory::Held(held)) if on => value = *held.get_or_insert(value),
                (Kind::Stuck, Memory::Held(held)) => *held = None,
                (Kind::Intermittent, _) if on && noise.uniform() <= fault.strength / 100.0 => {
                    return Err(Missing::NoAnswer);
                }
                (Kind::Off, _) if on => return Err(Missing::NoAnswer),
                _ => {}
            }
        }
        Ok(value)
    }
}

/// What lies `x` (0..1) of the way through a sensor's range, in its steps.
fn anything(value: Value, x: f64, volts_step: f64) -> Value {
    match value {
        Value::Absolute { ambient_c, .. } => {
            let [least, most] = OBJECT_C;
            Value::Absolute { object_c: as_read(least + x * (most - least)), ambient_c }
        }
        Value::Volts(_) => {
            // The last step before the end: the end itself is a saturated converter's.
            let most = FULL_SCALE_V - volts_step;
            Value::Volts(quantised(most * (2.0 * x - 1.0), volts_step))
        }
    }
}
