//! The sky's shape, learnt in flight: a contrast that grows and falls with the bank is one reckoned with a wrong shape.

use crate::estimator::range::share;
use crate::time::Time;

/// The share of the humid sky, before anything is learnt: its mean, the report's sky, in which nothing is then
/// underestimated, and its standard deviation.
const FIRST: (f64, f64) = (0.0, 0.7);
/// The shares that are possible: from a sky of one temperature down to a few degrees above the horizon, seen by sensors
/// that see less wide than they are said to, to an overcast.
pub const POSSIBLE: (f64, f64) = (-0.6, 1.8);
/// What a share has gone in a second by chance.
const WALK: f64 = 0.01;
/// Contrasts are compared over this time, s: over longer ones the weather changes them.
const COMPARED_S: f64 = 20.0;
/// What a contrast changes by itself in that time at the least, as a share of it, and how long such a change lasts, s.
const CHANGES: (f64, f64) = (0.015, 2.0);
/// How fast it is learnt that it changes more, and less, s.
const LEARNT_S: (f64, f64) = (2.0, 20.0);
/// After so long without a contrast comparing begins anew, s.
const GAP_S: f64 = 2.0;

/// How far the sky's shape is from one curve toward another.
#[derive(Clone, Copy, Debug)]
pub struct ShapeLearner {
    possible: (f64, f64),
    share: f64,
    variance: f64,
    /// The mean logarithm of the contrast that the one curve gives, of what the other gives over it, and when.
    means: Option<([f64; 2], Time)>,
    /// The variance of what the contrast's logarithm has lately changed by.
    changes: f64,
}

impl ShapeLearner {
    /// For shares from one below 0 to one above 1, as far as the curves have inverses between them.
    pub fn new((least, most): (f64, f64)) -> Self {
        let (share, sigma) = FIRST;
        let possible = (least.max(POSSIBLE.0), most.min(POSSIBLE.1));
        Self { possible, share, variance: sigma * sigma, means: None, changes: CHANGES.0 * CHANGES.0 }
    }

    /// The share of the other curve.
    pub fn share(&self) -> f64 {
        self.share
    }

    /// Its standard deviation.
    pub fn sigma(&self) -> f64 {
        self.variance.sqrt()
    }

    /// Takes in the contrast found at `time` with that share, K, and by how much its logarithm goes with the share.
    pub fn update(&mut self, contrast_k: f64, by_share: f64, time: Time) {
        let one = contrast_k.ln() - self.share * by_share;
        if !(one.is_finite() && by_share.is_finite()) {
            return;
        }
        let last = self.means.filter(|(_, last)| (0.0..GAP_S).contains(&time.since(*last)));
        let Some((mut means, last)) = last else {
            self.means = Some(([one, by_share], time));
            return;
        };
        let dt_s = time.since(last);
        let now = [one, by_share];
        for (mean, now) in means.iter_mut().zip(now) {
            *mean += share(dt_s, COMPARED_S) * (now - *mean);
        }
        self.means = Some((means, time));
        let [one, by_share] = [now[0] - means[0], now[1] - means[1]];
        self.variance = (self.variance + WALK * WALK * dt_s).min(FIRST.1 * FIRST.1);
        // By the right shape it does not change; what it does change by at once weighs little.
        let changed = one + self.share * by_share;
        let square = changed * changed;
        let noise = (CHANGES.0 * CHANGES.0 + self.changes + square) * CHANGES.1 / dt_s.max(1e-9);
        let gain = self.variance * by_share / (by_share * by_share * self.variance + noise);
        self.share = (self.share - gain * changed).clamp(self.possible.0, self.possible.1);
        self.variance *= 1.0 - gain * by_share;
        let learnt_s = if square > self.changes { LEARNT_S.0 } else { LEARNT_S.1 };
        self.changes += share(dt_s, learnt_s) * (square - self.changes);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A minute of banking under a sky of this share, in which the contrast goes as `contrast_k` says.
    fn flown(share: f64, contrast_k: impl Fn(f64) -> f64) -> ShapeLearner {
        let mut learner = ShapeLearner::new(POSSIBLE);
        for i in 0..3000 {
            let s = f64::from(i) * 0.02;
            // A wrong shape shows a contrast that is too large in a bank.
            let by_share = -0.08 * (0.5 * s).sin().powi(2);
            let found_k = contrast_k(s) * ((learner.share() - share) * by_share).exp();
            learner.update(found_k, by_share, Time::from_secs_f64(100.0 + s));
        }
        learner
    }

    #[test]
    fn the_shape_is_the_one_under_which_the_contrast_stays_what_it_is() {
        for share in [0.0, 0.4, 1.0, 1.6] {
            let learnt = flown(share, |_| 30.0);
            assert!(
                (learnt.share() - share).abs() < 0.05 + learnt.sigma() && learnt.sigma() < 0.3,
                "{share}: {learnt:?}"
            );
        }
    }

    /// A cloud on the way, and a slow change of the weather.
    #[test]
    fn a_contrast_that_changes_by_itself_teaches_nothing() {
        let clouds: [fn(f64) -> f64; 3] = [
            |s| if (20.0..30.0).contains(&s) { 9.0 } else { 30.0 },
            |s| 30.0 - 18.0 * ((s - 20.0) / 1.5).clamp(0.0, 1.0),
            |s| 30.0 * (-s / 120.0).exp(),
        ];
        for (n, cloud) in clouds.into_iter().enumerate() {
            let learnt = flown(1.0, cloud);
            assert!((learnt.share() - 1.0).abs() < 3.0 * learnt.sigma().max(0.1), "{n}: {learnt:?}");
        }
    }

    #[test]
    fn straight_ahead_nothing_is_learnt() {
        let mut learner = ShapeLearner::new(POSSIBLE);
        for i in 0..3000 {
            learner.update(30.0, -0.01, Time::from_secs_f64(f64::from(i) * 0.02));
        }
        assert!((learner.share() - FIRST.0).abs() < 1e-9 && (learner.sigma() - FIRST.1).abs() < 1e-9);
    }

    #[test]
    fn whatever_comes_the_share_stays_possible() {
        let mut learner = ShapeLearner::new(POSSIBLE);
        let hostile = [(f64::NAN, 0.1), (30.0, f64::INFINITY), (0.0, 0.1), (-3.0, 0.1), (1e300, -0.2), (1e-300, 0.3)];
        for i in 0..600 {
            let (contrast_k, by_share) = hostile[i % 6];
            let s = if i % 7 == 0 { 0.0 } else { 0.02 * i as f64 };
            learner.update(contrast_k, by_share, Time::from_secs_f64(s));
            assert!((POSSIBLE.0..=POSSIBLE.1).contains(&learner.share()) && learner.sigma() <= FIRST.1);
        }
    }
}
