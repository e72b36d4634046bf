//! The autopilot's attitude beside ours at the same moments, for show alone. Pure.

use crate::attitude::Attitude;
use crate::estimator::flying::wrapped;
use crate::time::Time;
use std::collections::VecDeque;

/// Our attitudes that are kept: for over half a second at 200 Hz.
const OURS: usize = 128;
/// Its attitudes that wait for ours.
const THEIRS: usize = 32;
/// Ours farther apart than this say nothing of what is between them, s.
const GAP_S: f64 = 0.25;
/// The time over which the difference is averaged, s.
const LATELY_S: f64 = 1.0;
/// After so long without a new one there is no difference, s.
const STALE_S: f64 = 2.5;
/// Nearer to straight up or down than this roll is no measure, rad.
const STEEP: f64 = 75.0 / 180.0 * std::f64::consts::PI;

/// The difference, as it goes.
#[derive(Clone, Debug)]
pub struct Comparison {
    ours: VecDeque<(Time, Attitude)>,
    theirs: VecDeque<(Time, Attitude)>,
    mean: Option<(Attitude, Time)>,
}

impl Default for Comparison {
    fn default() -> Self {
        Self { ours: VecDeque::with_capacity(OURS), theirs: VecDeque::with_capacity(THEIRS), mean: None }
    }
}

impl Comparison {
    /// The autopilot's attitude at `time`.
    pub fn theirs(&mut self, time: Time, attitude: Attitude) {
        if self.theirs.len() >= THEIRS {
            self.theirs.pop_front();
        }
        self.theirs.push_back((time, attitude));
    }

    /// Our attitude at `time`: all of theirs up to then are compared.
    pub fn ours(&mut self, time: Time, attitude: Attitude) {
        match self.ours.back() {
            Some((last, _)) if *last == time => return,
            // A clock that has been set back begins anew.
            Some((last, _)) if *last > time => self.ours.clear(),
            _ => {}
        }
        if self.ours.len() >= OURS {
            self.ours.pop_front();
        }
        self.ours.push_back((time, attitude));
        while let Some((at, theirs)) = self.theirs.front().copied().filter(|(at, _)| *at <= time) {
            self.theirs.pop_front();
            if let Some(ours) = self.at(at) {
                self.learn(at, theirs, ours);
            }
        }
    }

    fn at(&self, time: Time) -> Option<Attitude> {
        let place = self.ours.partition_point(|(t, _)| *t < time);
        let (after, next) = self.ours.get(place).copied()?;
        if after == time {
            return Some(next);
        }
        let (before, last) = self.ours.get(place.checked_sub(1)?).copied()?;
        let (a, b) = (last.vertical(), next.vertical());
        let x = time.since(before) / after.since(before);
        let between = Attitude::from_vertical(std::array::from_fn(|i| a[i] + x * (b[i] - a[i])));
        (after.since(before) <= GAP_S).then_some(between)
    }

    fn learn(&mut self, at: Time, theirs: Attitude, ours: Attitude) {
        let difference = Attitude { roll: wrapped(theirs.roll - ours.roll), pitch: theirs.pitch - ours.pitch };
        if ours.pitch.abs().max(theirs.pitch.abs()) > STEEP || !difference.roll.is_finite() {
            return;
        }
        let mean = match self.mean.filter(|(_, last)| (0.0..STALE_S).contains(&at.since(*last))) {
            Some((mean, last)) => {
                let new = 1.0 - (-at.since(last) / LATELY_S).exp();
                Attitude {
                    roll: wrapped(mean.roll + new * wrapped(difference.roll - mean.roll)),
                    pitch: mean.pitch + new * (difference.pitch - mean.pitch),
                }
            }
            None => difference,
        };
        self.mean = Some((mean, at));
    }

    /// Their roll and pitch less ours, over the last second or so, rad.
    pub fn difference(&self, now: Time) -> Option<Attitude> {
        self.mean.filter(|(_, at)| now.since(*at) < STALE_S).map(|(mean, _)| mean)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(ms: u32) -> Time {
        Time::from_secs_f64(5.0 + f64::from(ms) / 1000.0)
    }

    /// Both roll at 100 °/s; theirs is 2° more and 1° less, and comes `late` frames late.
    fn compare(late: u32) -> Option<Attitude> {
        let mut c = Comparison::default();
        for i in 0_u32..200 {
            let roll = |i: u32| 2.0 * f64::from(i) - 180.0;
            if let Some(then) = i.checked_sub(late) {
                // Between two of ours.
                c.theirs(at(20 * then + 10), Attitude::from_degrees(wrapped_deg(roll(then) + 1.0 + 2.0), -1.0));
            }
            c.ours(at(20 * i), Attitude::from_degrees(wrapped_deg(roll(i)), 0.0));
        }
        c.difference(at(4000))
    }

    fn wrapped_deg(deg: f64) -> f64 {
        wrapped(deg.to_radians()).to_degrees()
    }

    #[test]
    fn the_same_moments_are_compared_however_late_they_come() {
        for late in [0, 3, 30] {
            let d = compare(late).unwrap();
            let (roll, pitch) = (d.roll.to_degrees(), d.pitch.to_degrees());
            assert!((roll - 2.0).abs() < 0.01 && (pitch + 1.0).abs() < 0.01, "late by {late}: {roll} {pitch}");
        }
        assert_eq!(compare(150), None, "ours of that time are gone");
    }

    #[test]
    fn it_fades_and_a_clock_set_back_does_no_harm() {
        let mut c = Comparison::default();
        let level = Attitude::default();
        c.ours(at(0), level);
        c.theirs(at(10), Attitude::from_degrees(1.0, 1.0));
        c.theirs(at(15), Attitude { roll: f64::NAN, pitch: 0.0 });
        c.ours(at(20), level);
        assert!(c.difference(at(20)).is_some_and(|d| d.roll.is_finite()));
        assert_eq!(c.difference(at(3000)), None);
        c.ours(Time::default(), level);
        c.theirs(at(1), level);
        c.ours(at(40), level);
    }
}
