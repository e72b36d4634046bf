//! Which side is up: an aircraft that turns over does it by degrees, ground and sky that change places do it through
//! a contrast of zero (report section V.3: hail on the ground).

use super::noise::PAIR_NOISE_K;
use super::vector::{Vector, dot, length, product, rotation};
use crate::direction::Direction;
use crate::time::Time;

/// Seconds for which a vertical tells which side is up: by itself, and carried by a gyro; after that, upright is assumed.
const REMEMBERED_S: f64 = 1.0;
const CARRIED_S: f64 = 60.0;
/// A contrast below this share of what it was within some time, s, is on its way through nothing: what is left of it may turn
/// round by itself, toward a warm side, and tells nothing.
const LITTLE: f64 = 0.4;
const USUAL_S: f64 = 30.0;
/// The contrast below which a vertical is too noisy to tell which side is up, K.
pub const TELLING_K: f64 = 10.0 * PAIR_NOISE_K;
/// Past this `u_up`, a sky warmer than the ground seen from an aircraft on its back is believed to be neither, if it is warmer
/// than any hail makes it, or has been so for longer than anybody flies on the back over hail.
const ON_ITS_BACK: f64 = -0.5;
/// No hail makes the sky warmer than the ground by more than this, K.
pub const HAIL_K: f64 = 10.0;
/// Nobody flies on the back over hail for longer than this, s.
pub const BACK_S: f64 = 10.0;

/// The side up, from frame to frame.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sides {
    /// The last vertical that told it, and when.
    last: Option<(Vector, Time)>,
    /// A gyro is heard; has been since.
    gyro: bool,
    carried: bool,
    /// When it was looked for last, and the contrast that there usually is, K.
    seen: Option<Time>,
    usual_k: f64,
    /// Since when ground and sky look exchanged to an aircraft on its back.
    back_since: Option<Time>,
}

impl Sides {
    /// As though `up`, a unit vector on (nose, left, up), had been seen to be up.
    pub fn knowing(up: Vector, time: Time) -> Self {
        Self { last: Some((up, time)), ..Self::default() }
    }

    /// Whether ground and sky look exchanged in `seen`, the contrast vector on (nose, left, up), K: −1, else 1. The
    /// side up is the one nearer to the last one seen; upright where there is none.
    pub fn sign(&mut self, seen: Vector, time: Time) -> f64 {
        let contrast_k = length(seen);
        let exchanged = dot(seen, self.up(time)) < 0.0;
        // Exchanged and on its back: neither, rather than both.
        let back = exchanged && -seen[2] < ON_ITS_BACK * contrast_k;
        self.back_since = back.then(|| self.back_since.unwrap_or(time));
        let neither =
            self.back_since.is_some_and(|since| contrast_k > HAIL_K || !(0.0..BACK_S).contains(&time.since(since)));
        let sign = if exchanged && !neither { -1.0 } else { 1.0 };
        let since_s = self.seen.replace(time).map_or(0.0, |seen| time.since(seen).max(0.0));
        self.usual_k = contrast_k.max(self.usual_k * (-since_s / USUAL_S).exp());
        let little = contrast_k < HAIL_K.min(LITTLE * self.usual_k);
        if contrast_k > TELLING_K && (neither || !little) {
            (self.last, self.carried) = (Some((seen.map(|c| sign * c / contrast_k), time)), self.gyro);
        }
        sign
    }

    /// The last vertical that told which side is up, on (nose, left, up).
    pub fn up(&self, time: Time) -> Vector {
        let for_s = if self.carried { CARRIED_S } else { REMEMBERED_S };
        let remembered = self.last.filter(|(_, at)| time.since(*at).abs() < for_s);
        remembered.map_or(Direction::UP.components(), |(vertical, _)| vertical)
    }

    /// The body turns by `turn`, rad about (nose, left, up), as a gyro tells, or nobody tells.
    pub fn carry(&mut self, turn: Option<Vector>) {
        self.gyro = turn.is_some();
        self.carried &= self.gyro;
        if let (Some((up, _)), Some(turn)) = (&mut self.last, turn) {
            *up = product(&rotation(turn.map(|c| -c)), *up);
        }
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

    #[test]
    fn a_gyro_carries_it_through_what_tells_nothing() {
        let at = Time::from_secs_f64;
        for (gyro, up) in [(true, Direction::DOWN), (false, Direction::UP)] {
            let mut sides = Sides::default();
            sides.carry(gyro.then_some([0.0; 3]));
            assert_eq!(sides.sign(flown(20.0, 0.0), at(10.0)), 1.0);
            // Half a roll in fog.
            for i in 1..=100 {
                sides.carry(gyro.then_some([std::f64::consts::PI / 100.0, 0.0, 0.0]));
                assert_eq!(sides.sign([0.0; 3], at(10.0 + 0.1 * f64::from(i))), 1.0);
            }
            let seen = sides.up(at(20.0));
            assert!(dot(seen, up.components()) > 0.99, "{gyro}: {seen:?}");
        }
    }

    #[test]
    fn on_its_back_over_hail_all_looks_upright_and_is_not() {
        let at = |i: u32| Time::from_secs_f64(10.0 + 0.02 * f64::from(i));
        // A roll of 180° over hail of −4 K, and so for 20 s.
        let over = |i: u32| flown(-4.0, 1.8 * f64::from(i.min(100)));
        let mut sides = Sides::knowing(Direction::UP.components(), at(0));
        let upright: Vec<u32> = (0..1000).filter(|i| sides.sign(over(*i), at(*i)) > 0.0).collect();
        // It must have been a mistake: nobody flies so for so long.
        let since = upright.first().copied().unwrap_or(0);
        assert!((560..600).contains(&since) && upright.len() as u32 == 1000 - since, "{upright:?}");
        // No hail is that cold.
        let mut sides = Sides::knowing(Direction::DOWN.components(), at(0));
        assert_eq!([3.0, 12.0].map(|k| sides.sign(flown(k, 0.0), at(1))), [-1.0, 1.0]);
    }
}
