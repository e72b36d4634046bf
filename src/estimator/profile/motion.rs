//! How the vertical moves: what noise there is averaged out of it, and the sensors' lag made up for.

use crate::estimator::vector::{Vector, add_scaled, dot, length, unit};
use crate::estimator::whiteness::Whiteness;
use crate::time::Time;

/// What the rate of the vertical has gone in a second, rad/s (8.5°/s), until it is learnt.
const WALK: f64 = 0.15;
/// The rate is not known better than this at first, rad/s (20°/s).
const FIRST_RATE: f64 = 0.35;
/// Readings farther apart than this tell nothing of what went on between them, s.
const APART_S: f64 = 0.2;
/// So many standard deviations from where it was expected, and so far, rad (3°), the vertical has not moved: it is another.
const JUMP: (f64, f64) = (8.0, 0.05);
/// The share by which the time constant of the sensors may be another.
const LAG_DOUBT: f64 = 0.3;

/// A Kalman filter on the vertical and its rate, each component by itself, looking ahead by the sensors' lag.
#[derive(Clone, Debug)]
pub struct Motion {
    lag_s: f64,
    state: Option<Moving>,
    walk: Whiteness,
}

/// Where the vertical is, and how fast it goes.
#[derive(Clone, Copy, Debug)]
struct Moving {
    time: Time,
    up: Vector,
    /// rad/s.
    rate: Vector,
    /// The variances of a component and its rate, and their covariance.
    p: [f64; 3],
}

/// The vertical as it is now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moved {
    /// Of length 1.
    pub up: Vector,
    /// The standard deviation of each component by noise and motion, over that of the noise alone.
    pub spread: f64,
    /// What it may be off by where the sensors' lag is another.
    pub late: Vector,
}

impl Motion {
    /// For sensors with a first-order time constant of `lag_s` ≥ 0.
    pub fn new(lag_s: f64) -> Self {
        Self { lag_s, state: None, walk: Whiteness::new(0.1, (0.5, 0.5), (0.3, 8.0)) }
    }

    /// The time constant from now on, s.
    pub fn set_lag_s(&mut self, lag_s: f64) {
        self.lag_s = lag_s;
    }

    /// Takes in the vertical seen at `time`, of length 1, with a standard deviation of `noise` (rad) in each component.
    /// One of the same time as the last changes nothing; an earlier one begins anew, as one does that has jumped.
    pub fn update(&mut self, up: Vector, noise: f64, time: Time) -> Moved {
        let variance = noise * noise;
        let first = Moving { time, up, rate: [0.0; 3], p: [variance, 0.0, FIRST_RATE * FIRST_RATE] };
        let known = self.state.filter(|s| s.time == time);
        let moving = known.or_else(|| self.follow(self.state?, up, variance, time)).unwrap_or(first);
        self.state = Some(moving);
        let Moving { rate, p, .. } = moving;
        let ahead = p[0] + self.lag_s * (2.0 * p[1] + self.lag_s * p[2]);
        Moved {
            up: unit(add_scaled(moving.up, self.lag_s, rate)).unwrap_or(up),
            spread: if noise > 0.0 { ahead.max(0.0).sqrt() / noise } else { 1.0 },
            late: rate.map(|r| LAG_DOUBT * self.lag_s * r),
        }
    }

    fn follow(&mut self, s: Moving, seen: Vector, variance: f64, time: Time) -> Option<Moving> {
        let dt_s = time.since(s.time);
        if !(dt_s > 0.0 && dt_s <= APART_S) {
            return None;
        }
        let walk = WALK * self.walk.factor();
        let q = walk * walk * dt_s;
        let [p, c, r] = s.p;
        let p = p + dt_s * (2.0 * c + dt_s * r) + q * dt_s * dt_s / 3.0;
        let c = c + dt_s * r + q * dt_s / 2.0;
        let r = r + q;
        let expected = add_scaled(s.up, dt_s, s.rate);
        let innovation = add_scaled(seen, -1.0, expected);
        let total = p + variance;
        let far = length(innovation);
        if far > JUMP.0 * total.sqrt() && far > JUMP.1 {
            return None;
        }
        // What turns it about the nose, where an aircraft moves most.
        let across = unit([0.0, seen[2], -seen[1]]).unwrap_or([0.0; 3]);
        self.walk.update(dot(innovation, across), dt_s);
        let (by, rate_by) = (p / total, c / total);
        Some(Moving {
            time,
            up: add_scaled(expected, by, innovation),
            rate: add_scaled(s.rate, rate_by, innovation),
            p: [(1.0 - by) * p, (1.0 - by) * c, r - rate_by * c],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::attitude::Attitude;
    use crate::simulation::noise::Noise;

    const NOISE: f64 = 0.005;

    fn at(i: u32) -> Time {
        Time::from_secs_f64(100.0 + 0.02 * f64::from(i))
    }

    fn up(roll_deg: f64) -> Vector {
        Attitude::from_degrees(roll_deg, 0.0).vertical()
    }

    fn roll_deg(up: Vector) -> f64 {
        up[1].atan2(up[2]).to_degrees()
    }

    /// Rolling to and fro by 30°, seen by sensors that lag by 0.1 s, with noise: the errors without and with what is said
    /// of the motion, and the share of them within twice their standard deviation.
    fn flown(lag_s: f64) -> [f64; 3] {
        let (mut motion, mut noise) = (Motion::new(lag_s), Noise::new(3));
        let true_deg = |s: f64| 30.0 * (0.8 * s).sin();
        let (mut lagged, mut errors, mut inside) = (0.0, [0.0; 2], 0.0);
        for i in 0..5000 {
            let s = 0.02 * f64::from(i);
            lagged += -(-0.2_f64).exp_m1() * (true_deg(s) - lagged);
            let seen = up(lagged + (NOISE * noise.normal()).to_degrees());
            let moved = motion.update(seen, NOISE, at(i));
            let off = roll_deg(moved.up) - true_deg(s);
            let late = moved.late[1].hypot(moved.late[2]);
            let sigma_deg = (moved.spread * NOISE).hypot(late).to_degrees();
            inside += f64::from(u8::from(off.abs() < 2.0 * sigma_deg)) / 5000.0;
            for (sum, e) in errors.iter_mut().zip([roll_deg(seen) - true_deg(s), off]) {
                *sum += e * e / 5000.0;
            }
        }
        [errors[0].sqrt(), errors[1].sqrt(), inside]
    }

    #[test]
    fn lag_is_made_up_for_and_noise_averaged_out() {
        let [seen, said, inside] = flown(0.1);
        assert!(seen > 1.5 && said < 0.4 && inside > 0.9, "{seen} {said} {inside}");
        let [_, blurred, _] = flown(0.0);
        assert!(blurred > 1.5, "what is not known of is not made up for: {blurred}");
    }

    #[test]
    fn at_rest_it_stays_where_it_is_and_becomes_surer() {
        let mut motion = Motion::new(0.1);
        let first = motion.update(up(20.0), NOISE, at(0));
        let last = (1..500).map(|i| motion.update(up(20.0), NOISE, at(i))).last().unwrap();
        assert!((roll_deg(last.up) - 20.0).abs() < 1e-9 && (roll_deg(first.up) - 20.0).abs() < 1e-9);
        assert!(first.spread > 1.0 && last.spread < 0.8 * first.spread, "{} {}", first.spread, last.spread);
    }

    #[test]
    fn a_jump_a_gap_and_a_clock_set_back_begin_anew() {
        for (again, deg) in [(at(101), 80.0), (at(140), 5.0), (at(20), 5.0)] {
            let mut motion = Motion::new(0.1);
            for i in 0..=100 {
                motion.update(up(0.2 * f64::from(i)), NOISE, at(i));
            }
            let moved = motion.update(up(deg), NOISE, again);
            assert!((roll_deg(moved.up) - deg).abs() < 1e-9 && moved.late == [0.0; 3], "{again:?} {moved:?}");
            assert_eq!(motion.update(up(40.0), NOISE, again), moved, "said twice");
        }
    }
}
