//! What the state says of the attitude: angles, standard deviations, and the guard.

use super::state::{State, TURN};
use crate::attitude::Attitude;
use crate::estimator::vector::cross;

/// Below this standard deviation there is nothing to guard against, rad: a quarter of a degree.
const SURE: f64 = 0.004_4;
/// The share of the doubt beyond it by which an angle is shown larger.
const GUARD: f64 = 0.5;
/// Angles from which, and beyond which wholly, that is done, rad: 10° and 30°.
const GUARDED: (f64, f64) = (0.175, 0.524);
/// The largest angle added, rad: 5°.
const LARGEST: f64 = 0.087;

/// Roll and pitch with their standard deviations. Near the vertical, where roll has no meaning, its
/// standard deviation grows.
pub fn attitude(state: &State) -> (Attitude, Attitude) {
    let up = state.vertical();
    let attitude = Attitude { roll: up[1].atan2(up[2]), pitch: up[0].clamp(-1.0, 1.0).asin() };
    let flat = (up[1] * up[1] + up[2] * up[2]).max(1e-4);
    let mut roll = [(0, 0.0); 3];
    let mut pitch = [(0, 0.0); 3];
    for k in 0..3 {
        let moved = cross(up, std::array::from_fn(|i| f64::from(u8::from(i == k))));
        roll[k] = (TURN + k, (up[2] * moved[1] - up[1] * moved[2]) / flat);
        pitch[k] = (TURN + k, moved[0] / flat.sqrt());
    }
    let sigma = |h| state.variance_of(h).max(0.0).sqrt();
    (attitude, Attitude { roll: sigma(&roll), pitch: sigma(&pitch) })
}

/// Where the model is in doubt the error goes to the safe side: an angle beyond 10° is shown larger by
/// a share of the doubt. Roll beyond 90° goes toward the back.
pub fn guard(angle: f64, sigma: f64, limit: f64) -> f64 {
    let x = ((angle.abs() - GUARDED.0) / (GUARDED.1 - GUARDED.0)).clamp(0.0, 1.0);
    let added = (GUARD * (sigma - SURE).max(0.0)).min(LARGEST) * x;
    (angle.abs() + added).min(limit.max(angle.abs())).copysign(angle)
}
