//! What is said of a vertical: roll and pitch, with their standard deviations.

use super::motion::Moved;
use super::solve::{Scaled, Solved, Solver};
use crate::attitude::Attitude;
use crate::estimator::guard::guard;
use crate::estimator::noise::PAIR_NOISE_K;
use crate::estimator::vector::{Vector, dot};
use std::f64::consts::{FRAC_PI_2, PI};

/// The cosine of pitch below which the standard deviation of roll grows no more.
const LEAST_ACROSS: f64 = 0.05;

/// The upward vertical on (nose, left, up), and what else it may be off by.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// The vertical, with the doubts of noise, motion and lag.
    pub moved: Moved,
    /// By the sky's shape.
    pub by_shape: Vector,
    /// By a warm side.
    pub unseen: Attitude,
    /// What one sensor may be off by, K.
    pub off_k: f64,
}

impl Seen {
    /// As one frame alone shows it under a sky that is known.
    pub fn alone(up: Vector) -> Self {
        let moved = Moved { up, spread: 1.0, late: [0.0; 3] };
        Self { moved, by_shape: [0.0; 3], unseen: Attitude::default(), off_k: 0.0 }
    }
}

/// The attitude, and its standard deviation, of what is `seen` after `solved` was found of `signals`; with a doubted
/// contrast, of what is `ranged` on a smaller one if that is larger.
pub fn attitude(
    solver: &Solver,
    signals: &[Option<f64>],
    solved: &Solved,
    seen: &Seen,
    ranged: Option<&Scaled>,
) -> (Attitude, Attitude) {
    let Moved { up: exact, spread, late } = seen.moved;
    let mut larger = exact;
    if let Some(ranged) = ranged {
        for ((component, r), now) in larger.iter_mut().zip(ranged.vertical).zip(solved.vertical) {
            let more = ((r * ranged.length).abs() - now.abs()).max(0.0);
            *component += more.copysign(*component);
        }
    }
    let across = exact[1].hypot(exact[2]);
    let angles = |u: Vector| Attitude { roll: u[1].atan2(exact[2]), pitch: u[0].atan2(across) };
    let (given, plain) = (angles(larger), angles(exact));

    // The ways that the vertical goes when roll or pitch grows, over how far it goes.
    let (sin_roll, cos_roll) = plain.roll.sin_cos();
    let roll = [0.0, cos_roll, -sin_roll].map(|c| c / across.max(LEAST_ACROSS));
    let pitch = [across, -exact[0] * sin_roll, -exact[0] * cos_roll];
    // Noise grows less by what was seen before, a sensor that is off does not.
    let noise = (spread * PAIR_NOISE_K.hypot(solved.residual_k)).hypot(seen.off_k);
    let [roll_noise, pitch_noise] = solver.spread(signals, solved, [roll, pitch], noise).unwrap_or([PI; 2]);
    // What cannot be explained at all.
    let unexplained = (1.0 - solved.length).max(0.0);
    // Where the model is in doubt the angle is shown larger; what the range has added is doubted as well.
    let said = |way: Vector, noise: f64, unseen: f64, (given, plain): (f64, f64), limit: f64| {
        let model = dot(way, seen.by_shape).hypot(unexplained);
        let sigma = model.hypot(noise).hypot(dot(way, late)).hypot(given - plain).hypot(unseen);
        (guard(given, model, limit), sigma)
    };
    let (roll, roll_sigma) = said(roll, roll_noise, seen.unseen.roll, (given.roll, plain.roll), PI);
    let (pitch, pitch_sigma) = said(pitch, pitch_noise, seen.unseen.pitch, (given.pitch, plain.pitch), FRAC_PI_2);
    (Attitude { roll, pitch }, Attitude { roll: roll_sigma, pitch: pitch_sigma })
}
