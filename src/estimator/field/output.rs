//! What the state says of the attitude: angles and standard deviations.

use super::state::{RATE, State, TURN};
use crate::attitude::Attitude;
use crate::estimator::vector::cross;

/// Roll and pitch with their standard deviations; then these as they would be were the body rates known. Near the
/// vertical, where roll has no meaning, its standard deviation grows.
pub fn attitude(state: &State) -> (Attitude, Attitude, Attitude) {
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
    let sigmas = |h: &[(usize, f64); 3]| {
        let by_rate = (RATE..RATE + 3).map(|r| {
            let together: f64 = h.iter().map(|(i, c)| c * state.p[*i][r]).sum();
            together * together / state.p[r][r].max(1e-12)
        });
        let all = state.variance_of(h);
        [all, all - by_rate.sum::<f64>()].map(|variance| variance.max(0.0).sqrt())
    };
    let ([roll, roll_at_rest], [pitch, pitch_at_rest]) = (sigmas(&roll), sigmas(&pitch));
    (attitude, Attitude { roll, pitch }, Attitude { roll: roll_at_rest, pitch: pitch_at_rest })
}
