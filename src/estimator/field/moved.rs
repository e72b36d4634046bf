//! A wall beside, by the sky's shape that it seems to change.
//!
//! Sky and sensors look alike for minutes, but for a contrast that comes and goes with clouds. A wall raises the horizon for
//! every sensor that looks along it, and most on its own side. Half of that looks like a tilt, and the rest like a sky of
//! another shape, which the filter finds within seconds: nothing is left over. So a shape that moves tells of a tilt.

use super::FieldEstimator;
use super::predict::scene;
use super::state::{DEPTH, RADIANCE, VIEW};
use crate::attitude::Attitude;

/// The shape is learnt for so long, s, before it can have moved; it is usual after so long.
const LEARNT_S: f64 = 10.0;
const USUAL_S: f64 = 60.0;
/// So much of the contrast is nothing: it is still being learnt, or there are clouds all around.
const NOTHING: f64 = 0.004;
/// The tilt that goes with more of it, rad for the whole contrast: by a wall of 25° on all of one side, σ is half of it.
const TILT: f64 = 4.5;
/// As with [scenes](super::scene), what is new counts for more where it is asked whether there is a wall.
const NEW_HIDES: f64 = 2.0;

/// How cold an even horizon looks against what is usual, as a share of the contrast.
#[derive(Clone, Copy, Debug, Default)]
pub struct Moved {
    seen_s: f64,
    usual: f64,
    now: f64,
    /// The variances with which these were known.
    known: [f64; 2],
}

impl Moved {
    /// Takes in how cold it looks, with its variance, for `dt_s`.
    pub fn update(&mut self, at_horizon: f64, variance: f64, dt_s: f64) {
        self.seen_s += dt_s;
        self.now = at_horizon;
        let share = if self.seen_s < LEARNT_S { 1.0 } else { dt_s / self.seen_s.min(USUAL_S) };
        self.usual += share * (at_horizon - self.usual);
        self.known[0] += share * (variance - self.known[0]);
        self.known[1] = variance;
    }

    /// The standard deviation of the tilt that goes with it, rad.
    pub fn sigma(&self) -> f64 {
        let [usual, now] = self.known;
        // What is known better now than it was usually has become so by moving as far, and nothing else has moved.
        let learnt = (usual - now).max(0.0).sqrt();
        TILT * ((self.now - self.usual).abs() - NOTHING - learnt).max(0.0)
    }

    /// The tilt that it may hide, rad.
    pub fn hides(&self) -> f64 {
        2.0 * NEW_HIDES * self.sigma()
    }
}

impl FieldEstimator {
    /// Watches how cold an even horizon looks, for `dt_s`.
    pub(super) fn watch_horizon(&mut self, dt_s: f64) {
        let level = self.model.at_horizon(&scene(&self.state));
        let [wider, one, other] = level.by_view;
        let by = [
            (DEPTH, level.by_ln_depth),
            (RADIANCE, level.by_radiance),
            (VIEW, wider),
            (VIEW + 1, one),
            (VIEW + 2, other),
        ];
        self.moved.update(level.value, self.state.variance_of(&by), dt_s);
    }

    /// How far `attitude` may be off by a wall that looks like another shape of the sky, or was there before it
    /// began anew.
    pub(super) fn walled(&self, attitude: Attitude) -> Attitude {
        let sigma = self.moved.sigma().hypot(self.hidden_before);
        Attitude { roll: sigma / attitude.pitch.cos().max(0.2), pitch: sigma }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// After a minute and a half of `usual`, and so long of `now`.
    fn sigma_deg(usual: f64, now: f64, seconds: f64) -> f64 {
        sigma_deg_of((usual, 0.0), (now, 0.0), seconds)
    }

    /// The same, each with its standard deviation.
    fn sigma_deg_of(usual: (f64, f64), now: (f64, f64), seconds: f64) -> f64 {
        let mut moved = Moved::default();
        let mut see = |(at_horizon, sigma): (f64, f64), seconds: f64| {
            (0..(seconds * 50.0) as u32).for_each(|_| moved.update(at_horizon, sigma * sigma, 0.02));
        };
        see((0.4, 0.0), 5.0);
        see(usual, 90.0);
        see(now, seconds);
        moved.sigma().to_degrees()
    }

    /// Straight on little is learnt of the shape, and the first bank tells the rest of it.
    #[test]
    fn what_was_not_known_has_not_moved() {
        let after = |usual, now| sigma_deg_of((0.3, usual), (0.32, now), 0.1);
        assert_eq!(after(0.02, 0.005), 0.0);
        assert!((4.0..4.2).contains(&after(0.02, 0.02)) && after(0.01, 0.005) < after(0.005, 0.005));
    }

    #[test]
    fn what_is_learnt_at_first_and_what_is_small_is_no_wall() {
        for (usual, now) in [(0.3, 0.3), (0.3, 0.303), (0.3, 0.297)] {
            assert_eq!(sigma_deg(usual, now, 1.0), 0.0, "{usual} {now}");
        }
    }

    #[test]
    fn a_shape_that_moves_either_way_hides_a_tilt_until_it_is_usual() {
        for now in [0.28, 0.32] {
            let [at_once, later, at_last] = [0.1, 30.0, 200.0].map(|seconds| sigma_deg(0.3, now, seconds));
            assert!((4.0..4.2).contains(&at_once), "{at_once}");
            assert!((1.5..3.0).contains(&later) && at_last == 0.0, "{later} {at_last}");
        }
    }
}
