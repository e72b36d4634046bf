//! How an aircraft flies, and its state at an instant.

use super::feature::wrapped;
use crate::attitude::Attitude;
use std::f64::consts::{FRAC_PI_2, PI};

/// Standard gravity, m/s².
const G_M_S2: f64 = 9.806_65;
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
    /// The angle of attack's part of a pitch that may have gone over the top, rad.
    pub(super) fn lift_at(&self, roll: f64, pitch: f64) -> f64 {
        if is_over(pitch) { -self.lift(roll + PI)[0] } else { self.lift(roll)[0] }
    }

    /// The angle of attack's part of pitch, `α cos φ`, and its derivative by roll, rad, where α grows
    /// with the load `1/cos φ`.
    pub(super) fn lift(&self, roll: f64) -> [f64; 2] {
        let (sin, cos) = roll.sin_cos();
        let [level, per_g] = [self.attack_deg, self.attack_per_g_deg].map(f64::to_radians);
        [per_g + (level - per_g) * cos, (per_g - level) * sin]
    }

    /// The rate of turn, rad/s: `g tan φ / V`, fading beyond 60°, where no level flight could hold it.
    pub(super) fn turn_rate(&self, roll: f64, airspeed_m_s: f64) -> f64 {
        let (sin, cos) = roll.sin_cos();
        G_M_S2 / airspeed_m_s.max(1.0) * sin * cos / (cos * cos).max(STEEPEST_COS2)
    }
}

/// The state of an aircraft at an instant. Angles in rad, rates of the angles in rad/s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// Roll, pitch, yaw; all go on beyond a full turn, pitch over the top, where roll and yaw stay as they
    /// were.
    pub angles: [f64; 3],
    /// Their derivatives.
    pub rates: [f64; 3],
    /// Airspeed, m/s.
    pub airspeed_m_s: f64,
    /// Motion over ground to north, to east, and up, m/s.
    pub velocity_m_s: [f64; 3],
    /// Where it is: m to north and to east of the start, and above the ground.
    pub place_m: [f64; 3],
}

/// Whether an aircraft of this pitch went over the top: what its roll calls upright is inverted.
pub(super) fn is_over(pitch: f64) -> bool {
    pitch.abs() > FRAC_PI_2 && wrapped(pitch).abs() > FRAC_PI_2
}

impl State {
    /// Roll and pitch in their ranges.
    pub fn attitude(&self) -> Attitude {
        let [roll, pitch, _] = self.angles;
        let turned = if pitch.abs() > PI { wrapped(pitch) } else { pitch };
        if is_over(pitch) {
            Attitude { roll: wrapped(roll + PI), pitch: PI.copysign(turned) - turned }
        } else {
            Attitude { roll: wrapped(roll), pitch: turned }
        }
    }

    /// Where the nose points, rad clockwise from north, going on beyond a full turn.
    pub fn yaw(&self) -> f64 {
        self.angles[2] + if is_over(self.angles[1]) { PI } else { 0.0 }
    }

    /// Body rates about nose, right and down, °/s, by Euler's kinematics.
    pub fn body_rates_deg_s(&self) -> [f64; 3] {
        let ([roll, pitch, _], [roll_rate, pitch_rate, yaw_rate]) = (self.angles, self.rates);
        let ((sr, cr), (sp, cp)) = (roll.sin_cos(), pitch.sin_cos());
        [roll_rate - yaw_rate * sp, pitch_rate * cr + yaw_rate * sr * cp, yaw_rate * cr * cp - pitch_rate * sr]
            .map(f64::to_degrees)
    }

    /// The share `x` (0..1) of the way to `next`, `step_s` later: angles by their values and rates.
    pub(super) fn toward(&self, next: &Self, step_s: f64, x: f64) -> Self {
        let line = |a: f64, b: f64| a + x * (b - a);
        let angle = |i: usize| {
            let [a, b] = [self, next].map(|s| (s.angles[i], s.rates[i] * step_s));
            let rise = b.0 - a.0;
            a.0 + x * (a.1 + x * (3.0 * rise - 2.0 * a.1 - b.1 + x * (a.1 + b.1 - 2.0 * rise)))
        };
        Self {
            angles: std::array::from_fn(angle),
            rates: std::array::from_fn(|i| line(self.rates[i], next.rates[i])),
            airspeed_m_s: line(self.airspeed_m_s, next.airspeed_m_s),
            velocity_m_s: std::array::from_fn(|i| line(self.velocity_m_s[i], next.velocity_m_s[i])),
            place_m: std::array::from_fn(|i| line(self.place_m[i], next.place_m[i])),
        }
    }
}
