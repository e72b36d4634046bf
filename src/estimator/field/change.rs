//! A scene that changes while the aircraft looks on: a ridge comes nearer, a bank of cloud drifts by.
//!
//! What no turn, contrast or ground explains, and what lasts longer than noise does, is no gyro's error: each sensor's own
//! scene is let change as fast as that asks for, so that a gyro need not give way.

use super::directions::{Directions, Pattern, dot};
use super::scene::GLITCH_K;

/// Over this time innovations are averaged, s.
const OVER_S: f64 = 0.3;
/// What noise leaves in that average: its variance so many times.
const SAFELY: f64 = 9.0;
/// The walk's variance over what is seen, as a scene that changes is behind by what is seen.
const BEHIND: f64 = 10.0;

/// How fast the scenes change.
#[derive(Clone, Copy, Debug, Default)]
pub struct SceneChange {
    left: Pattern,
    variance_s: f64,
}

impl SceneChange {
    /// Takes in each sensor's innovation, K, `dt_s` > 0 after the last; `noise_k2` is the variance of a reading, K².
    pub fn update(&mut self, innovations: &Pattern, directions: &Directions, (noise_k2, dt_s): (f64, f64)) {
        let share = -(-dt_s / OVER_S).exp_m1();
        for (left, innovation) in self.left.iter_mut().zip(innovations) {
            *left += share * (innovation.clamp(-GLITCH_K, GLITCH_K) - *left);
        }
        let (rest, dimensions) = directions.unexplained(&self.left);
        let noise_k2 = SAFELY * dimensions as f64 * share / (2.0 - share) * noise_k2;
        self.variance_s = BEHIND / OVER_S * (dot(&rest, &rest) - noise_k2).max(0.0);
    }

    /// What the variance of each sensor's own scene grows by, K²/s.
    pub fn variance_s(&self) -> f64 {
        self.variance_s
    }
}

#[cfg(test)]
mod tests {
    use super::super::model::Seen;
    use super::super::state::MAX_SENSORS;
    use super::*;

    /// Six level sensors of which one pair is turned by a roll.
    fn directions() -> Directions {
        let seen = |i: usize| Seen {
            by_turn: [[0.0, 0.0, 20.0, -20.0][i.min(3)], [20.0, -20.0, 0.0, 0.0][i.min(3)], 0.0],
            by_ground: 1.0,
            by_contrast: -0.4,
            ..Seen::default()
        };
        let seen: [Option<Seen>; MAX_SENSORS] = std::array::from_fn(|i| (i < 4).then(|| seen(i)));
        Directions::new(&seen, Default::default())
    }

    fn after(seconds: f64, innovation: impl Fn(usize) -> Pattern) -> f64 {
        let mut change = SceneChange::default();
        for i in 0..(50.0 * seconds) as usize {
            change.update(&innovation(i), &directions(), (0.0064, 0.02));
        }
        change.variance_s()
    }

    #[test]
    fn one_side_that_grows_warmer_is_a_scene_that_changes() {
        let mut warm = Pattern::default();
        (warm[0], warm[1], warm[2], warm[3]) = (0.3, 0.3, -0.3, -0.3);
        assert!(after(1.0, |_| warm) > 5.0 && after(0.04, |_| warm) < 1.0);
    }

    #[test]
    fn a_turn_and_noise_are_none() {
        let mut turn = Pattern::default();
        (turn[0], turn[1]) = (0.3, -0.3);
        assert_eq!(after(1.0, |_| turn), 0.0);
        let noise = |i: usize| {
            let mut noise = Pattern::default();
            noise[i % 4] = if i % 8 < 4 { 0.16 } else { -0.16 };
            noise
        };
        assert_eq!(after(2.0, noise), 0.0);
    }
}
