//! Which side is up: an aircraft that turns over does it by degrees, ground and sky that change places do it through
//! a contrast of zero (report section V.3: hail on the ground).

use super::noise::PAIR_NOISE_K;
use super::vector::{Vector, dot, length};
use crate::direction::Direction;
use crate::time::Time;

/// Seconds for which a vertical tells which side is up; after that, upright is assumed.
const REMEMBERED_S: f64 = 1.0;
/// The contrast below which a vertical is too noisy to tell which side is up, K.
pub const TELLING_K: f64 = 10.0 * PAIR_NOISE_K;
/// Past this `u_up`, a sky warmer than the ground seen from an aircraft on its back is believed to be neither.
const ON_ITS_BACK: f64 = -0.5;

/// The side up, from frame to frame.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sides {
    /// The last vertical that told it, and when.
    last: Option<(Vector, Time)>,
}

impl Sides {
    /// As though `up`, a unit vector on (nose, left, up), had been seen to be up.
    pub fn knowing(up: Vector, time: Time) -> Self {
        Self { last: Some((up, time)) }
    }

    /// Whether ground and sky look exchanged in `seen`, the contrast vector on (nose, left, up), K: −1, else 1. The
    /// side up is the one nearer to the last one seen; upright where there is none.
    pub fn sign(&mut self, seen: Vector, time: Time) -> f64 {
        let remembered = self.last.filter(|(_, at)| time.since(*at).abs() < REMEMBERED_S);
        let before = remembered.map_or(Direction::UP.components(), |(vertical, _)| vertical);
        let contrast_k = length(seen);
        // Exchanged and on its back: neither, rather than both.
        let back = -seen[2] < ON_ITS_BACK * contrast_k;
        let sign = if dot(seen, before) >= 0.0 || back { 1.0 } else { -1.0 };
        if contrast_k > TELLING_K {
            self.last = Some((seen.map(|c| sign * c / contrast_k), time));
        }
        sign
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::attitude::Attitude;

    fn flown(contrast_k: f64, roll_deg: f64) -> Vector {
        Attitude::from_degrees(roll_deg, 5.0).vertical().map(|c| contrast_k * c)
    }

    #[test]
    fn turning_over_exchanges_nothing_and_hail_does() {
        let mut sides = Sides::default();
        let at = |i: u32| Time::from_secs_f64(10.0 + 0.02 * f64::from(i));
        // A roll through the full circle in 2 s, twice.
        for i in 0..200 {
            assert_eq!(sides.sign(flown(8.0, 3.6 * f64::from(i)), at(i)), 1.0, "{i}");
        }
        // From 8 K through nothing to −4 K in 1.2 s, wings level.
        let signs: Vec<f64> = (0..60).map(|i| sides.sign(flown(8.0 - 0.2 * f64::from(i), 0.0), at(200 + i))).collect();
        assert!(signs[..40].iter().all(|s| *s == 1.0) && signs[41..].iter().all(|s| *s == -1.0), "{signs:?}");
        // And back.
        assert_eq!(sides.sign(flown(3.0, 0.0), at(261)), 1.0);
    }
}
