//! What each sensor shows: the response to the sky, its lag, its noise, its smallest step.

use super::fault::Fault;
use super::fault::sensors::Effects;
use super::noise::Noise;
use super::scene::View;
use super::script::Weather;
use crate::direction::Direction;
use crate::frame::{Missing, Value};
use crate::head::{Head, SensorKind};

/// The smallest step of an MLX90614, K (datasheet 8.4.5: 0.02 K a bit, from 0 K).
const ABSOLUTE_STEP_K: f64 = 0.02;
/// The smallest step of an ADS1115 at ±2.048 V, V.
const VOLTS_STEP: f64 = 2.048 / 32_768.0;
/// The dies sit this much above the ground's temperature and follow it slowly: K, s.
const DIE_ABOVE_GROUND_K: f64 = 3.0;
const DIE_LAG_S: f64 = 60.0;

/// A first-order lag, exact for an input that changes in a straight line between samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lag {
    time_constant_s: f64,
    /// Input and output at the last sample.
    last: Option<(f64, f64)>,
}

impl Lag {
    /// At rest at its first input; 0 s is no lag.
    pub fn new(time_constant_s: f64) -> Self {
        Self { time_constant_s, last: None }
    }

    /// The output when the input has come to `input`, `dt_s` after the last sample.
    pub fn update(&mut self, input: f64, dt_s: f64) -> f64 {
        let output = match self.last {
            Some((before, output)) if self.time_constant_s > 0.0 => {
                if dt_s > 0.0 {
                    // On a slope the output follows in parallel; what was left of the start decays.
                    let behind = (input - before) / dt_s * self.time_constant_s;
                    input - behind + (output - before + behind) * (-dt_s / self.time_constant_s).exp()
                } else {
                    output
                }
            }
            _ => input,
        };
        self.last = Some((input, output));
        output
    }
}

/// A sensor of the head with its state.
#[derive(Clone, Debug)]
struct Sensor {
    name: String,
    direction: Direction,
    kind: SensorKind,
    lag: Lag,
    noise: Noise,
    effects: Effects,
}

/// A head's sensors under a sky. Nothing is allocated after it is made.
#[derive(Clone, Debug)]
pub struct SimulatedHead {
    sensors: Vec<Sensor>,
    die: Lag,
    die_c: f64,
    noise_k: f64,
    volts_step: f64,
    seed: u64,
    time_s: f64,
}

impl SimulatedHead {
    /// The sensors of `head`, each with a first-order lag of `lag_s`, noise of `noise_k` rms (a pair's
    /// on its difference) and a generator of its own, so that one sensor's outage changes no other.
    pub fn new(head: &Head, lag_s: f64, noise_k: f64, seed: u64) -> Self {
        let mut seeds = Noise::new(seed);
        let sensors = head
            .sensors
            .iter()
            .map(|s| Sensor {
                name: s.name.clone(),
                direction: s.direction,
                kind: s.kind,
                lag: Lag::new(lag_s),
                noise: Noise::new(seeds.bits()),
                effects: Effects::default(),
            })
            .collect();
        Self { sensors, die: Lag::new(DIE_LAG_S), die_c: 0.0, noise_k, volts_step: VOLTS_STEP, seed, time_s: 0.0 }
    }

    /// The smallest step of a pair's channel, V; 0 for none.
    pub fn set_volts_step(&mut self, volts_step: f64) {
        self.volts_step = volts_step;
    }

    /// What goes wrong with its sensors, in place of what did.
    pub fn set_faults(&mut self, faults: &[Fault]) {
        for (i, sensor) in self.sensors.iter_mut().enumerate() {
            sensor.effects = Effects::new(faults, &sensor.name, i, self.seed);
        }
    }

    /// Goes on by `dt_s` to `weather`: once a scan, before the sensors.
    pub fn advance(&mut self, weather: &Weather, dt_s: f64) {
        self.time_s = weather.time_s;
        self.die_c = self.die.update(weather.ground_c + DIE_ABOVE_GROUND_K, dt_s);
    }

    /// What sensor `index` shows of a view, `dt_s` after it was last asked; or why it shows nothing.
    pub fn sense(&mut self, index: usize, view: &View<'_>, dt_s: f64) -> Result<Value, Missing> {
        let Sensor { direction, kind, lag, noise, effects, .. } = &mut self.sensors[index];
        let added = self.noise_k * noise.normal() + effects.offset_k(self.time_s);
        let value = match *kind {
            SensorKind::Absolute { offset_k } => {
                let seen = effects.seen(view.sensor_c(*direction), self.die_c, self.time_s, dt_s);
                let seen = lag.update(seen, dt_s);
                Value::Absolute { object_c: as_read(seen + added + offset_k), ambient_c: Some(as_read(self.die_c)) }
            }
            SensorKind::Pair { neutral_v, kelvin_per_v } => {
                // Water on both sides of a pair leaves no difference.
                let seen = effects.seen(view.pair_k(*direction), 0.0, self.time_s, dt_s);
                let seen = lag.update(seen, dt_s);
                Value::Volts(quantised(neutral_v + (seen + added) / kelvin_per_v, self.volts_step))
            }
        };
        effects.said(value, self.time_s, self.volts_step)
    }
}

/// A temperature as an MLX90614 gives it, °C.
pub(super) fn as_read(temperature_c: f64) -> f64 {
    quantised(temperature_c + 273.15, ABSOLUTE_STEP_K) - 273.15
}

pub(super) fn quantised(value: f64, step: f64) -> f64 {
    if step > 0.0 { (value / step).round() * step } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_comes_through_as_one_less_e_to_the_t_over_tau() {
        let (tau, dt) = (0.3, 0.001);
        let mut lag = Lag::new(tau);
        lag.update(0.0, dt);
        for i in 1..2000 {
            let out = lag.update(1.0, dt);
            // The input rises over the first sample interval: its middle is when the step is.
            let t = (f64::from(i) - 0.5) * dt;
            assert!((out - (1.0 - (-t / tau).exp())).abs() < 1e-5, "{t} s: {out}");
        }
    }

    #[test]
    fn a_slope_is_followed_behind_by_the_time_constant_at_any_rate() {
        for dt in [0.005, 0.02, 0.5] {
            let mut lag = Lag::new(0.2);
            let n = (4.0 / dt) as u32;
            let out = (0..=n).map(|i| lag.update(60.0 * f64::from(i) * dt, dt)).last().unwrap();
            assert!((out - (60.0 * 4.0 - 60.0 * 0.2)).abs() < 1e-6, "{dt} s: {out}");
        }
    }

    #[test]
    fn no_lag_and_no_time_are_borne() {
        let mut none = Lag::new(0.0);
        assert_eq!([none.update(1.0, 0.02), none.update(5.0, 0.02)], [1.0, 5.0]);
        let mut lag = Lag::new(0.1);
        lag.update(1.0, 0.0);
        assert_eq!(lag.update(5.0, 0.0), 1.0);
    }
}
