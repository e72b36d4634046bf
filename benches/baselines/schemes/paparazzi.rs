//! Paparazzi, 2007 on: `atan2(y, z)`, `atan2(x, z)`.

use super::Baseline;

/// Pitch beyond ±90° is turned round by half a turn. Neutral angles and the four correction factors
/// are the airframe's: none and 1 here. Its health check, a sum of signals below 50 counts of its own
/// converter, has no meaning in kelvin and is left out.
#[derive(Debug)]
pub struct Paparazzi;

impl Baseline for Paparazzi {
    fn update(&mut self, _: f64, [x, y, z]: [f64; 3]) -> Option<(f64, f64)> {
        if [x, y, z] == [0.0; 3] {
            return None;
        }
        let pitch = x.atan2(z).to_degrees();
        let folded = if pitch > 90.0 {
            pitch - 180.0
        } else if pitch < -90.0 {
            pitch + 180.0
        } else {
            pitch
        };
        Some((y.atan2(z).to_degrees(), folded))
    }
}
