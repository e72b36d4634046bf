//! What the state says of the attitude: angles and standard deviations.

use super::state::{RATE, State, TURN};
use crate::attitude::Attitude;
use crate::estimator::vector::{Vector, cross, dot};

/// What roll and pitch change by with turns about (nose, left, up).
fn slopes(up: Vector) -> [Vector; 2] {
    let flat = (up[1] * up[1] + up[2] * up[2]).max(1e-4);
    let moved: [Vector; 3] = std::array::from_fn(|k| cross(up, std::array::from_fn(|i| f64::from(u8::from(i == k)))));
    [moved.map(|m| (up[2] * m[1] - up[1] * m[2]) / flat), moved.map(|m| m[0] / flat.sqrt())]
}

/// How fast roll and pitch change at these body rates, rad/s.
pub fn moving(state: &State, rates: Vector) -> Attitude {
    let [roll, pitch] = slopes(state.vertical()).map(|by| dot(by, rates));
    Attitude { roll, pitch }
}

/// Roll and pitch where `up` is the upward vertical on (nose, left, up), with their standard deviations; then these as they
/// would be were the body rates known. Near the vertical, where roll has no meaning, its standard deviation grows.
pub fn attitude(state: &State, up: Vector) -> (Attitude, Attitude, Attitude) {
    let attitude = Attitude { roll: up[1].atan2(up[2]), pitch: up[0].clamp(-1.0, 1.0).asin() };
    let [roll, pitch] = slopes(up).map(|by| std::array::from_fn(|k| (TURN + k, by[k])));
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
