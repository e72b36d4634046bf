//! Which way is up in the climb of GLOBAL_POSITION_INT: that in which its altitude goes. Pure.
//!
//! iNav up to version 8 says it upside down.

use crate::time::Time;

/// Positions farther apart tell nothing, s; so many are remembered; the squares of what they must not fit by in all, m².
const POSITIONS_S: f64 = 2.5;
const POSITIONS: f64 = 50.0;
const UNFIT_M2: f64 = 4.0;
/// The other way is right that leaves less than this share of what the one before does.
const BETTER: f64 = 0.25;

/// What has been found of an autopilot's climb.
#[derive(Clone, Copy, Debug, Default)]
pub struct Climb {
    /// When, at which altitude, m, with which climb as said, m/s.
    last: Option<(Time, f64, f64)>,
    /// The sums of squares of what the altitude rises more, as it is said and the other way round, m².
    left: [f64; 2],
    upside_down: bool,
}

impl Climb {
    /// The climb of a position of `time` at an altitude, m, which was `said`, m/s.
    pub fn hear(&mut self, time: Time, altitude_m: f64, said: f64) -> f64 {
        if let Some((last, before_m, then)) = self.last.replace((time, altitude_m, said))
            && (0.0..POSITIONS_S).contains(&time.since(last))
        {
            let (risen_m, climbed_m) = (altitude_m - before_m, 0.5 * (then + said) * time.since(last));
            for (sum, left) in self.left.iter_mut().zip([risen_m - climbed_m, risen_m + climbed_m]) {
                *sum += left * left - *sum / POSITIONS;
            }
            let other = [!self.upside_down, self.upside_down].map(usize::from);
            if self.left[other[1]] > UNFIT_M2 && self.left[other[0]] < BETTER * self.left[other[1]] {
                self.upside_down = !self.upside_down;
                let now = if self.upside_down { "upside down" } else { "upside down no more" };
                log::info!("the autopilot says its climb {now}");
            }
        }
        if self.upside_down { -said } else { said }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn climb_is_where_the_altitude_goes() {
        for (sign, altitude_there) in [(1.0, true), (-1.0, true), (1.0, false), (-1.0, false)] {
            let mut climb = Climb::default();
            let taken = (0..100).map(|i| {
                let t = 0.2 * f64::from(i);
                let altitude_m = if altitude_there { 80.0 - 5.0 * (0.4 * t).cos() } else { 0.0 };
                (
                    climb.hear(Time::from_secs_f64(7.0 + t), altitude_m, sign * 2.0 * (0.4 * t).sin()),
                    2.0 * (0.4 * t).sin(),
                )
            });
            let (last, truth) = taken.last().unwrap();
            // Where nothing tells it is as it was said.
            let sign = if altitude_there { 1.0 } else { sign };
            assert_eq!(last, sign * truth, "{sign} {altitude_there}");
        }
    }
}
