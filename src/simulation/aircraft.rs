//! An aircraft that is flown: attitude, heading, speed and path against time.

use super::feature::wrapped;
use super::manoeuvre::{Motion, Pilot, Style};
use super::noise::Noise;
use super::turbulence::{Gusts, Wander};
use crate::attitude::Attitude;

/// Standard gravity, m/s².
const G_M_S2: f64 = 9.806_65;
/// Between two states kept, s.
const STEP_S: f64 = 0.005;
/// The flight path follows the nose behind by this, s.
const PATH_LAG_S: f64 = 0.4;
/// The nose of an uncoordinated aircraft follows its turn behind by this, s.
const NOSE_LAG_S: f64 = 0.5;
/// The steepest bank whose turn is a level flight's: cos² of it.
const STEEPEST_COS2: f64 = 0.25;

/// How an aircraft flies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aircraft {
    /// Mean airspeed, m/s.
    pub airspeed_m_s: f64,
    /// Variation of the airspeed, m/s rms.
    pub airspeed_rms_m_s: f64,
    /// Angle of attack in level flight, °.
    pub attack_deg: f64,
    /// What the angle of attack grows by at twice the weight, °.
    pub attack_per_g_deg: f64,
    /// The wind's motion to north and to east, m/s.
    pub wind_m_s: [f64; 2],
    /// The air's own rising and sinking, m/s rms.
    pub updraught_m_s: f64,
    /// Whether the heading lags the turn by half a second and yaws about it.
    pub uncoordinated: bool,
}

impl Default for Aircraft {
    /// A small drone at 18 m/s in still air that rises and sinks a little.
    fn default() -> Self {
        Self {
            airspeed_m_s: 18.0,
            airspeed_rms_m_s: 1.0,
            attack_deg: 2.5,
            attack_per_g_deg: 5.0,
            wind_m_s: [0.0; 2],
            updraught_m_s: 0.4,
            uncoordinated: false,
        }
    }
}

impl Aircraft {
    /// The angle of attack's part of pitch, `α cos φ`, and its derivative by roll, rad, where α grows
    /// with the load `1/cos φ`.
    fn lift(&self, roll: f64) -> [f64; 2] {
        let (sin, cos) = roll.sin_cos();
        let [level, per_g] = [self.attack_deg, self.attack_per_g_deg].map(f64::to_radians);
        [per_g + (level - per_g) * cos, (per_g - level) * sin]
    }

    /// The rate of turn, rad/s: `g tan φ / V`, fading beyond 60°, where no level flight could hold it.
    fn turn_rate(&self, roll: f64, airspeed_m_s: f64) -> f64 {
        let (sin, cos) = roll.sin_cos();
        G_M_S2 / airspeed_m_s.max(1.0) * sin * cos / (cos * cos).max(STEEPEST_COS2)
    }
}

/// The state of an aircraft at an instant. Angles in rad, rates of the angles in rad/s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// Roll, pitch, yaw; roll and yaw go on beyond a full turn.
    pub angles: [f64; 3],
    /// Their derivatives.
    pub rates: [f64; 3],
    /// Airspeed, m/s.
    pub airspeed_m_s: f64,
    /// Motion over ground to north, to east, and up, m/s.
    pub velocity_m_s: [f64; 3],
    /// Height above the start, m.
    pub altitude_m: f64,
}

impl State {
    /// Roll and pitch in their ranges.
    pub fn attitude(&self) -> Attitude {
        let [roll, pitch, _] = self.angles;
        Attitude { roll: wrapped(roll), pitch }
    }

    /// Body rates about nose, right and down, °/s, by Euler's kinematics.
    pub fn body_rates_deg_s(&self) -> [f64; 3] {
        let ([roll, pitch, _], [roll_rate, pitch_rate, yaw_rate]) = (self.angles, self.rates);
        let ((sr, cr), (sp, cp)) = (roll.sin_cos(), pitch.sin_cos());
        [roll_rate - yaw_rate * sp, pitch_rate * cr + yaw_rate * sr * cp, yaw_rate * cr * cp - pitch_rate * sr]
            .map(f64::to_degrees)
    }

    /// Between this state and `next`, `STEP_S` later: angles by their values and rates.
    fn toward(&self, next: &Self, x: f64) -> Self {
        let line = |a: f64, b: f64| a + x * (b - a);
        let angle = |i: usize| {
            let [a, b] = [self, next].map(|s| (s.angles[i], s.rates[i] * STEP_S));
            let rise = b.0 - a.0;
            a.0 + x * (a.1 + x * (3.0 * rise - 2.0 * a.1 - b.1 + x * (a.1 + b.1 - 2.0 * rise)))
        };
        Self {
            angles: std::array::from_fn(angle),
            rates: std::array::from_fn(|i| line(self.rates[i], next.rates[i])),
            airspeed_m_s: line(self.airspeed_m_s, next.airspeed_m_s),
            velocity_m_s: std::array::from_fn(|i| line(self.velocity_m_s[i], next.velocity_m_s[i])),
            altitude_m: line(self.altitude_m, next.altitude_m),
        }
    }
}

/// A flight that was flown: its states, 200 a second.
#[derive(Clone, Debug, PartialEq)]
pub struct Trajectory {
    states: Vec<State>,
}

impl Trajectory {
    /// Flies `seconds` (at most a day) in a style; `seed` chooses what is left to chance.
    pub fn fly(aircraft: &Aircraft, style: &Style, seconds: f64, seed: u64) -> Self {
        let mut noise = Noise::new(seed);
        let mut pilot = Pilot::new(style, noise.bits());
        let mut speed = Wander::new(aircraft.airspeed_rms_m_s, 8.0, &mut noise);
        let mut updraught = Wander::new(aircraft.updraught_m_s, 5.0, &mut noise);
        let mut yawing = Gusts::new(3.0_f64.to_radians(), 1.5, 0.5, noise.bits());
        // The direction of flight through the air, how fast it turns, and where the nose is.
        let mut course = std::f64::consts::TAU * noise.uniform();
        let (mut turn, mut nose, mut nose_turn) = (0.0, course, 0.0);
        let mut altitude_m = 100.0;
        let mut path = None;
        let count = (seconds.clamp(0.0, 86_400.0) / STEP_S).ceil() as usize + 1;
        let states = (0..count)
            .map(|i| {
                let time_s = i as f64 * STEP_S;
                let m: Motion = pilot.step(time_s, STEP_S, |roll| aircraft.lift(roll));
                let airspeed_m_s = aircraft.airspeed_m_s + speed.step(STEP_S, &mut noise);
                let before = turn;
                turn = aircraft.turn_rate(m.roll, airspeed_m_s);
                course += 0.5 * (before + turn) * STEP_S;
                let (yaw, yaw_rate) = if aircraft.uncoordinated {
                    let [shake, shake_rate] = yawing.step(STEP_S);
                    let before = nose_turn;
                    nose_turn = (course - nose) / NOSE_LAG_S;
                    nose += 0.5 * (before + nose_turn) * STEP_S;
                    (nose + shake, nose_turn + shake_rate)
                } else {
                    (course, turn)
                };
                let climb = m.pitch - aircraft.lift(m.roll)[0];
                let path = path.get_or_insert(climb);
                *path += (climb - *path) * STEP_S / PATH_LAG_S;
                let (sin, cos) = path.sin_cos();
                let up = airspeed_m_s * sin + updraught.step(STEP_S, &mut noise);
                altitude_m += up * STEP_S;
                let [wind_north, wind_east] = aircraft.wind_m_s;
                State {
                    angles: [m.roll, m.pitch, yaw],
                    rates: [m.roll_rate, m.pitch_rate, yaw_rate],
                    airspeed_m_s,
                    velocity_m_s: [
                        airspeed_m_s * cos * course.cos() + wind_north,
                        airspeed_m_s * cos * course.sin() + wind_east,
                        up,
                    ],
                    altitude_m,
                }
            })
            .collect();
        Self { states }
    }

    /// The state `time_s` seconds after the flight began: the first before, the last, at rest, after.
    pub fn at(&self, time_s: f64) -> State {
        let x = (time_s / STEP_S).max(0.0);
        let i = x as usize;
        match (self.states.get(i), self.states.get(i.saturating_add(1))) {
            (Some(a), Some(b)) => a.toward(b, x.fract()),
            _ => State { rates: [0.0; 3], ..self.states.last().copied().unwrap_or_default() },
        }
    }
}
