//! Roll and pitch that are off by what turns with the heading: one side is warmer, and the horizon that is seen leans.
//!
//! Where north is warmer the nose is shown too low flying north, and flying west the right wing. What turns with the heading has
//! no mean over a turn, which is what single angles are judged by.

use super::LASTS_S;
use crate::attitude::Attitude;
use crate::estimator::linear::solve;
use crate::estimator::references::Angle;
use crate::fault::debounce::Debounce;
use crate::fault::wired::ASKEW;
use crate::time::Time;

/// Over this time it is found, s: clouds pass.
const FOUND_S: f64 = 60.0;
/// How large leans are, to north and to west, rad; and where there are none.
const USUAL: f64 = 0.1;
const NONE: f64 = 1e-6;
/// A lean from which it matters, and below which it does not any more, rad (4°, 2.5°).
const LEANS: (f64, f64) = (0.07, 0.044);
/// By so much the squares of the differences, in σ², must be smaller with it.
const SMALLER: f64 = 25.0;

/// Sees that the horizon leans. Straight on it says nothing.
#[derive(Clone, Debug)]
pub struct Side {
    /// The normal equations of leans up to north and to west, and of what is always too much of roll and of pitch; faded.
    normal: [[f64; 4]; 4],
    right: [f64; 4],
    heard: Option<Time>,
    lean: f64,
    there: bool,
    amiss: Debounce,
}

impl Default for Side {
    fn default() -> Self {
        Self {
            normal: [[0.0; 4]; 4],
            right: [0.0; 4],
            heard: None,
            lean: 0.0,
            there: false,
            amiss: Debounce::new(LASTS_S.0, LASTS_S.1),
        }
    }
}

impl Side {
    /// Takes in by how much roll is more than the bank that is flown at this course, rad.
    pub fn roll(&mut self, more: f64, bank: Angle, course: f64, now: Time) {
        self.take([-course.sin(), -course.cos(), 1.0, 0.0], more, bank, now);
    }

    /// The same of pitch and the climb.
    pub fn pitch(&mut self, more: f64, climb: Angle, course: f64, now: Time) {
        self.take([-course.cos(), course.sin(), 0.0, 1.0], more, climb, now);
    }

    fn take(&mut self, by: [f64; 4], more: f64, reference: Angle, now: Time) {
        let since_s = self.heard.replace(now).map_or(0.0, |heard| now.since(heard).max(0.0));
        let (keep, weight) = ((-since_s / FOUND_S).exp(), reference.weight_of_same());
        for i in 0..4 {
            self.right[i] = keep * self.right[i] + weight * by[i] * more;
            for j in 0..4 {
                self.normal[i][j] = keep * self.normal[i][j] + weight * by[i] * by[j];
            }
        }
        self.find();
    }

    fn find(&mut self) {
        // What is explained in σ² by all four, and without leans.
        let explained = |leans: f64| {
            let mut normal = self.normal;
            for (i, usual) in [leans, leans, ASKEW, ASKEW].into_iter().enumerate() {
                normal[i][i] += usual.powi(-2);
            }
            let x = solve(normal, self.right)?;
            Some((x, x.iter().zip(self.right).map(|(x, r)| x * r).sum::<f64>()))
        };
        let (Some(([north, west, ..], with)), Some((_, without))) = (explained(USUAL), explained(NONE)) else { return };
        self.lean = north.hypot(west);
        let least = if self.amiss.is_active() { LEANS.1 } else { LEANS.0 };
        self.there = self.lean > least && with - without > SMALLER;
    }

    /// Takes in what time it is.
    pub fn judge(&mut self, now: Time) {
        // The sky is as warm on that side while nothing is heard.
        let heard = self.heard.is_some_and(|at| (0.0..FOUND_S).contains(&now.since(at)));
        self.amiss.update(self.there && heard, now);
    }

    /// How far roll and pitch may be off for it.
    pub fn doubt(&self) -> Attitude {
        let off = if self.amiss.is_active() { self.lean } else { 0.0 };
        Attitude { roll: off, pitch: off }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulation::noise::Noise;

    /// The doubt of roll, °, after two minutes at one fix a second; the course goes on by `turns` rad a second, and roll and
    /// pitch are too much by `always`, and by a horizon that leans by so much, rad, up to north and west.
    fn doubt_deg(turns: f64, always: [f64; 2], [north, west]: [f64; 2], seed: u64) -> f64 {
        let (mut side, mut noise) = (Side::default(), Noise::new(seed));
        for s in 0..120 {
            let (now, course) = (Time::from_secs_f64(100.0 + f64::from(s)), turns * f64::from(s));
            let [nose, left] = [course, course - std::f64::consts::FRAC_PI_2].map(|a| north * a.cos() - west * a.sin());
            // As far off as they say, though for a second alone.
            let mut of = |sigma: f64| (Angle { angle: 0.0, sigma, stays: 0.0, span_s: 1.0 }, sigma * noise.normal());
            let [(bank, bank_off), (climb, climb_off)] = [of(0.14), of(0.075)];
            side.roll(always[0] - left + bank_off, bank, course, now);
            side.pitch(always[1] - nose + climb_off, climb, course, now);
            side.judge(now);
        }
        let Attitude { roll, pitch } = side.doubt();
        assert_eq!(roll, pitch);
        // Unheard it is there still, and over after a while.
        let mut silent_from = |s: f64| {
            (0..50).for_each(|i| side.judge(Time::from_secs_f64(s + 0.2 * f64::from(i))));
            side.doubt()
        };
        assert_eq!(silent_from(230.0).roll, roll);
        assert_eq!(silent_from(280.0), Attitude::default());
        roll.to_degrees()
    }

    #[test]
    fn what_turns_with_the_heading_is_a_lean() {
        for (seed, lean) in [(1, [0.2, 0.0]), (2, [0.0, -0.2]), (3, [-0.14, 0.14])] {
            for turns in [0.1, -0.5] {
                let doubt = doubt_deg(turns, [0.03, -0.05], lean, seed);
                assert!((doubt - 11.4).abs() < 3.0, "{lean:?}, {turns} rad/s: {doubt}°");
            }
        }
    }

    #[test]
    fn what_is_always_there_is_none_nor_is_noise() {
        for seed in 0..20 {
            assert_eq!(doubt_deg(0.2, [0.15, -0.15], [0.0; 2], seed), 0.0, "a head that sits askew");
            assert_eq!(doubt_deg(0.0, [0.0; 2], [0.2, 0.1], seed), 0.0, "straight on nobody knows");
        }
    }
}
