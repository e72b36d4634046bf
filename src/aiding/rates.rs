//! Body rates against time: in order, interpolated, and guessed for a moment. Pure.

use super::foresight::{AHEAD_S, Foresight, Terms};
use crate::time::Time;
use std::collections::VecDeque;
use std::time::Duration;

/// Rates that are kept: more than a second at 100 Hz, and enough to learn from at 400 Hz.
const KEPT: usize = 128;
/// Rates farther apart than this say nothing of what is between them, s.
const GAP_S: f64 = 0.25;
/// What follows the newest rates is guessed from them for so long, s.
pub const HELD_S: f64 = 0.2;
/// The slope of a rate is seen over this at least, s.
const SLOPE_S: f64 = 0.015;
/// Over so short a time a turn is a rate, s.
const SHORT_S: f64 = 0.001;

/// Rates about x (nose), y (right), z (down), °/s.
pub type Rate = [f64; 3];

/// The newest body rates.
#[derive(Clone, Debug)]
pub struct Rates {
    kept: VecDeque<(Time, Rate)>,
    foresight: Foresight,
    /// What followed the rates until here has been learnt.
    learnt: Option<Time>,
}

impl Default for Rates {
    fn default() -> Self {
        Self { kept: VecDeque::with_capacity(KEPT), foresight: Foresight::default(), learnt: None }
    }
}

/// The share `x` of the way from `a` to `b`.
fn toward(a: Rate, b: Rate, x: f64) -> Rate {
    std::array::from_fn(|i| a[i] + x * (b[i] - a[i]))
}

impl Rates {
    /// Takes in the rates of a moment, in whatever order they come; `false` for those of a moment that is known
    /// already, or older than all that is kept.
    pub fn insert(&mut self, time: Time, rate: Rate) -> bool {
        let place = self.kept.partition_point(|(t, _)| *t < time);
        let known = self.kept.get(place).is_some_and(|(t, _)| *t == time);
        if known || (place == 0 && self.kept.len() >= KEPT) {
            return false;
        }
        if self.kept.len() >= KEPT {
            self.kept.pop_front();
        }
        // The oldest has made room.
        let place = self.kept.partition_point(|(t, _)| *t < time);
        self.kept.insert(place, (time, rate));
        self.learn();
        true
    }

    /// Forgets all.
    pub fn clear(&mut self) {
        self.kept.clear();
        (self.foresight, self.learnt) = (Foresight::default(), None);
    }

    /// Learns from what followed the rates of some time ago.
    fn learn(&mut self) {
        let Some(newest) = self.newest() else { return };
        let farthest_s = AHEAD_S[AHEAD_S.len() - 1];
        let next = self.kept.partition_point(|(t, _)| self.learnt.is_some_and(|learnt| *t <= learnt));
        for place in next..self.kept.len() {
            let (from, rate) = self.kept[place];
            if newest.since(from) < farthest_s {
                return;
            }
            let dt_s = self.learnt.replace(from).map_or(0.0, |learnt| from.since(learnt)).min(GAP_S);
            let mut outcomes = [[0.0; 3]; AHEAD_S.len()];
            let all = outcomes.iter_mut().zip(AHEAD_S).all(|(outcome, ahead_s)| {
                let to = from + Duration::from_secs_f64(ahead_s);
                let mut add = |mean: Rate, dt_s: f64| (0..3).for_each(|i| outcome[i] += (mean[i] - rate[i]) * dt_s);
                self.known(from, to, &mut add).is_some()
            });
            if let Some(terms) = self.terms(place).filter(|_| all) {
                self.foresight.learn(&terms, &outcomes, dt_s);
            }
        }
    }

    /// What the rates of this place tell of what follows.
    fn terms(&self, place: usize) -> Option<Terms> {
        let (mut time, newest) = *self.kept.get(place)?;
        let (mut rate, mut slopes) = (newest, [[0.0; 3]; 2]);
        let mut before = self.kept.range(..place).rev();
        for slope in &mut slopes {
            let (t, r) = before.find(|(t, _)| time.since(*t) >= SLOPE_S)?;
            let dt_s = time.since(*t);
            if dt_s > GAP_S {
                return None;
            }
            *slope = std::array::from_fn(|i| (rate[i] - r[i]) / dt_s);
            (time, rate) = (*t, *r);
        }
        Some(std::array::from_fn(|i| [slopes[0][i], slopes[1][i], newest[i]]))
    }

    /// How far it has turned `after_s` after the newest rates, °, and the variance of that, °²: a guess.
    fn beyond(&self, after_s: f64) -> Option<[Rate; 2]> {
        let (_, rate) = self.kept.back()?;
        let held = || rate.map(|rate| [0.0, 0.0, rate]);
        let terms = self.terms(self.kept.len() - 1).unwrap_or_else(held);
        let [more, variance] = self.foresight.guess(&terms, after_s.max(0.0));
        (after_s <= HELD_S).then(|| [std::array::from_fn(|i| rate[i] * after_s + more[i]), variance])
    }

    /// The newest moment.
    pub fn newest(&self) -> Option<Time> {
        self.kept.back().map(|(t, _)| *t)
    }

    /// The time from one to the next on the average of the last few, s.
    pub fn interval_s(&self) -> Option<f64> {
        let n = self.kept.len().min(16);
        let first = self.kept.get(self.kept.len() - n)?;
        (n > 1).then(|| self.kept.back().map(|(t, _)| t.since(first.0) / (n - 1) as f64)).flatten()
    }

    /// How much of the turn until `time` is not known, °².
    pub fn unknown(&self, time: Time) -> Rate {
        let after_s = self.newest().map_or(0.0, |newest| time.since(newest));
        if after_s > 0.0 { self.beyond(after_s).map_or([0.0; 3], |[_, variance]| variance) } else { [0.0; 3] }
    }

    /// The rates at `time`: between two that are near enough, or a guess from the newest.
    pub fn at(&self, time: Time) -> Option<Rate> {
        let place = self.kept.partition_point(|(t, _)| *t < time);
        let Some((after, next)) = self.kept.get(place).copied() else {
            let after_s = time.since(self.newest()?);
            let [turned, shortly] = [after_s, after_s - SHORT_S].map(|s| self.beyond(s).map(|[turn, _]| turn));
            let (turned, before) = (turned?, shortly?);
            return Some(std::array::from_fn(|i| (turned[i] - before[i]) / SHORT_S));
        };
        if after == time {
            return Some(next);
        }
        let (before, last) = self.kept.get(place.checked_sub(1)?).copied()?;
        let gap_s = after.since(before);
        (gap_s <= GAP_S).then(|| toward(last, next, time.since(before) / gap_s))
    }

    /// Gives `step` the mean rates of every stretch from `from` to `to`, and how long it is, s. `None`: the rates
    /// of some of it are not known.
    pub fn through(&self, from: Time, to: Time, mut step: impl FnMut(Rate, f64)) -> Option<()> {
        let newest = self.newest()?;
        if from < newest {
            self.known(from, to.min(newest), &mut step)?;
        }
        if to > newest {
            let start = from.max(newest);
            let [[before, _], [after, _]] = [self.beyond(start.since(newest))?, self.beyond(to.since(newest))?];
            let dt_s = to.since(start);
            if dt_s > 0.0 {
                step(std::array::from_fn(|i| (after[i] - before[i]) / dt_s), dt_s);
            }
        }
        Some(())
    }

    /// The same for what is not after the newest rates.
    fn known(&self, from: Time, to: Time, step: &mut impl FnMut(Rate, f64)) -> Option<()> {
        let (mut at, mut rate) = (from, self.at(from)?);
        let first = self.kept.partition_point(|(t, _)| *t <= from);
        let between = self.kept.iter().skip(first).take_while(|(t, _)| *t < to).copied();
        for (time, next) in between.chain([(to, self.at(to)?)]) {
            step(toward(rate, next, 0.5), time.since(at));
            (at, rate) = (time, next);
        }
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn at(ms: f64) -> Time {
        Time::from_secs_f64(10.0 + ms / 1000.0)
    }

    fn rates(of: &[(f64, f64)]) -> Rates {
        let mut rates = Rates::default();
        of.iter().for_each(|(ms, rate)| assert!(rates.insert(at(*ms), [*rate, -rate, 0.0])));
        rates
    }

    #[test]
    fn between_two_a_straight_line_and_a_guess_for_a_moment() {
        let rates = rates(&[(0.0, 10.0), (20.0, 20.0), (80.0, -40.0)]);
        let p = |ms| rates.at(at(ms)).map(|r| (r[0] * 1e6).round() / 1e6);
        assert_eq!(
            [p(-1.0), p(0.0), p(5.0), p(50.0), p(80.0)],
            [None, Some(10.0), Some(12.5), Some(-10.0), Some(-40.0)]
        );
        // It falls by 60 °/s in 60 ms, and goes on with that for a while.
        assert!(p(80.5).is_some_and(|r| (r + 40.0).abs() < 1.0));
        assert!(p(279.0).is_some_and(|r| (-115.0..-95.0).contains(&r)) && p(281.0).is_none(), "{:?}", p(279.0));
    }

    #[test]
    fn what_has_begun_goes_on_for_a_moment() {
        let rates = rates(&[(0.0, 0.0), (20.0, 1.0), (40.0, 3.0), (60.0, 5.0)]);
        let p = |ms| rates.at(at(ms)).unwrap()[0];
        assert!((5.0..6.0).contains(&p(65.0)) && p(100.0) > p(80.0) && (6.0..13.0).contains(&p(160.0)), "{}", p(160.0));
        // The stretches are those of the guess.
        let (mut turned, mut until) = (0.0, 0.0);
        rates
            .through(at(50.0), at(160.0), |rate, dt_s| {
                turned += rate[0] * dt_s;
                until += dt_s
            })
            .unwrap();
        assert!((until - 0.11).abs() < 1e-9 && (0.6..1.1).contains(&turned), "{turned}");
    }

    #[test]
    fn out_of_order_and_twice_the_same() {
        let mut rates = rates(&[(0.0, 0.0), (40.0, 40.0)]);
        assert!(rates.insert(at(20.0), [5.0, 0.0, 0.0]));
        assert!(!rates.insert(at(20.0), [9.0, 0.0, 0.0]));
        assert_eq!(rates.at(at(20.0)).unwrap()[0], 5.0);
        for i in 0..1000 {
            rates.insert(at(60.0 + f64::from(i)), [0.0; 3]);
        }
        assert!(!rates.insert(at(10.0), [0.0; 3]), "older than all that is kept");
        assert_eq!(rates.kept.len(), KEPT);
    }

    #[test]
    fn a_hole_is_not_bridged() {
        let rates = rates(&[(0.0, 0.0), (251.0, 10.0)]);
        assert_eq!(rates.at(at(120.0)), None);
        assert_eq!(rates.through(at(0.0), at(251.0), |_, _| {}), Some(()), "both ends are known");
        assert_eq!(rates.through(at(100.0), at(251.0), |_, _| {}), None);
    }

    proptest! {
        #[test]
        fn stretches_add_up(
            of in prop::collection::vec((0_u64..600, -300.0_f64..300.0), 2..80),
            from in 0.0_f64..600.0,
            long in 0.0_f64..200.0,
        ) {
            let mut rates = Rates::default();
            for (ms, rate) in of {
                rates.insert(at(ms as f64), [rate, 0.0, 0.0]);
            }
            let (mut sum, mut least) = (0.0, f64::INFINITY);
            if rates.through(at(from), at(from + long), |_, dt_s| { sum += dt_s; least = least.min(dt_s) }).is_some() {
                prop_assert!((sum * 1e3 - long).abs() < 1e-3, "{} of {}", sum, long);
                prop_assert!(least >= 0.0);
            }
            prop_assert!(rates.kept.iter().zip(rates.kept.iter().skip(1)).all(|(a, b)| a.0 < b.0));
        }
    }
}
