//! Body rates against time: in order, interpolated, and guessed for a moment. Pure.

use crate::time::Time;
use std::collections::VecDeque;

/// Rates that are kept: two thirds of a second at 100 Hz, and more than the longest wait at 400 Hz.
const KEPT: usize = 64;
/// Rates farther apart than this say nothing of what is between them, s.
const GAP_S: f64 = 0.25;
/// What follows the newest rates is guessed from them for so long, s.
pub const HELD_S: f64 = 0.2;
/// A change of rates is seen over this at least, and goes on with this time constant, s: an aircraft that begins to
/// roll goes on with that for a moment.
const CHANGE_S: f64 = 0.035;
const GOES_ON_S: f64 = 0.07;
/// Over how long it is learnt how fast rates change, s.
const LATELY_S: f64 = 2.0;

/// Rates about x (nose), y (right), z (down), °/s.
pub type Rate = [f64; 3];

/// The newest body rates.
#[derive(Clone, Debug)]
pub struct Rates {
    kept: VecDeque<(Time, Rate)>,
    /// How fast each axis wanders: the square of its change, by the time that took, (°/s)²/s.
    wander: Rate,
}

impl Default for Rates {
    fn default() -> Self {
        Self { kept: VecDeque::with_capacity(KEPT), wander: [0.0; 3] }
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
        if let Some((last, before)) = self.kept.back().copied() {
            let dt_s = time.since(last);
            if dt_s > 0.0 && dt_s < GAP_S {
                let keep = (-dt_s / LATELY_S).exp();
                let seen = |i: usize| (rate[i] - before[i]).powi(2) / dt_s;
                self.wander = std::array::from_fn(|i| keep * self.wander[i] + (1.0 - keep) * seen(i));
            }
        }
        if self.kept.len() >= KEPT {
            self.kept.pop_front();
        }
        // The oldest has made room.
        let place = self.kept.partition_point(|(t, _)| *t < time);
        self.kept.insert(place, (time, rate));
        true
    }

    /// Forgets all.
    pub fn clear(&mut self) {
        self.kept.clear();
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

    /// How fast each axis wanders: (°/s)²/s.
    pub fn wander(&self) -> Rate {
        self.wander
    }

    /// How fast the newest rates change, °/s².
    fn change(&self) -> Rate {
        let Some((newest, rate)) = self.kept.back().copied() else { return [0.0; 3] };
        let before = self.kept.iter().rev().copied().find(|(t, _)| newest.since(*t) >= CHANGE_S);
        match before.map(|(t, before)| (newest.since(t), before)) {
            Some((dt_s, before)) if dt_s < GAP_S => std::array::from_fn(|i| (rate[i] - before[i]) / dt_s),
            _ => [0.0; 3],
        }
    }

    /// The rates at `time`: between two that are near enough, or a guess from the newest.
    pub fn at(&self, time: Time) -> Option<Rate> {
        let place = self.kept.partition_point(|(t, _)| *t < time);
        let Some((after, next)) = self.kept.get(place).copied() else {
            let (newest, rate) = self.kept.back().copied()?;
            let after_s = time.since(newest);
            let gain = GOES_ON_S * (1.0 - (-after_s / GOES_ON_S).exp());
            let change = self.change();
            return (after_s <= HELD_S).then(|| std::array::from_fn(|i| rate[i] + gain * change[i]));
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
        assert!(p(80.1).is_some_and(|r| (r + 40.1).abs() < 0.01));
        assert!(p(279.0).is_some_and(|r| (-110.0..-100.0).contains(&r)) && p(281.0).is_none());
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
