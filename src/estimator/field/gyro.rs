//! Body rates, and when to believe them.

use crate::attitude::Attitude;
use crate::estimator::vector::{Vector, add_scaled, dot, length, product, rotation};
use crate::frame::Aiding;
use crate::time::Time;

/// A sample older than this is none, and frames farther apart cannot use one, s.
const AGE_S: f64 = 0.25;
/// Samples that come more slowly than the first, on the average, tell less than the thermopiles alone; of those in use the
/// second, s.
const SLOW_S: (f64, f64) = (0.15, 0.19);
/// A share of each interval, in that average.
const INTERVALS: f64 = 0.1;
/// Faster than this nothing that flies can turn, °/s.
const FASTEST_DEG_S: f64 = 2000.0;
/// A gyro that was wrong is believed again after this, s; twice as long each time.
const DISTRUST_S: (f64, f64) = (20.0, 640.0);
/// A gyro that flies is never still to the last digit: one that says the same for so long, s, and in so many samples, says
/// nothing. Sooner where it would have turned by so much meanwhile, rad (6°): what a slow link repeats is over by then.
const STUCK_S: (f64, f64) = (2.0, 0.4);
const STUCK: u32 = 8;
const STUCK_RAD: f64 = 0.1;
/// How far rates bend between samples is averaged over so long, s.
const BENT_S: f64 = 4.0;
/// The variance of the mean rate between two samples, of the square by which a sample is off the line through the two
/// before: of rates that wander as by chance, the line from one to the next is off by a 24th.
const WANDERS: f64 = 1.0 / 24.0;
/// The same, where frames in between go by the sample before.
const HELD: f64 = 1.0 / 6.0;
/// Within this time an aircraft's inertia keeps its rates near a line, s.
const SMOOTH_S: f64 = 0.04;

/// Rates as sensors with a time constant of `lag_s` show them, `dt_s` after those `before`.
pub fn shown(before: Vector, rates: Vector, dt_s: f64, lag_s: f64) -> Vector {
    let share = -(-dt_s / lag_s.max(1e-3)).exp_m1();
    add_scaled(before, share, add_scaled(rates, -1.0, before))
}

/// The gyro of an autopilot.
#[derive(Clone, Debug, Default)]
pub struct Gyro {
    last: Option<(Vector, Time)>,
    /// What it says now, believed or not.
    heard: Option<Vector>,
    /// What it last said of the airframe, since when, and in how many samples.
    same: Option<(Vector, Time, u32)>,
    rates: Option<Vector>,
    now: Time,
    /// How far samples are apart, on the average, s.
    interval_s: Option<f64>,
    /// By how much the last sample differed from the one before.
    change: Option<Vector>,
    /// The variance of what it turns more or less than its samples say, rad²/s about nose, left, up, and how long that has
    /// been learnt, s.
    walk: Vector,
    learnt_s: f64,
    /// From the airframe's axes to the head's; `None` where they are the same.
    to_head: Option<[Vector; 3]>,
    wrong_since: Option<Time>,
    distrust_s: f64,
}

impl Gyro {
    /// Takes in what came with a frame, `dt_s` after the last, and whether the thermopiles have seen other turns; whether the
    /// gyro has come or gone.
    pub fn update(&mut self, aiding: &Aiding, now: Time, dt_s: f64, contradicted: bool) -> bool {
        self.now = now;
        let before = self.rates.is_some();
        self.heard = self.current(aiding, now, dt_s);
        self.rates = self.heard;
        let slow_s = if before { SLOW_S.1 } else { SLOW_S.0 };
        if self.interval_s.is_some_and(|s| s > slow_s) {
            self.rates = None;
        }
        if contradicted || self.is_doubted() {
            self.rates = None;
        }
        before != self.rates.is_some()
    }

    fn current(&mut self, aiding: &Aiding, now: Time, dt_s: f64) -> Option<Vector> {
        let age = |at: Time| (0.0..AGE_S).contains(&now.since(at));
        if let [Some(p), Some(q), Some(r)] = aiding.gyro_deg_s
            && [p, q, r].iter().all(|v| v.abs() <= FASTEST_DEG_S)
        {
            // Front, right, down to nose, left, up.
            let rates = [p, -q, -r].map(f64::to_radians);
            let (_, since, samples) = self.same.filter(|(said, ..)| *said == rates).unwrap_or((rates, now, 0));
            self.same = Some((rates, since, samples.saturating_add(1)));
            let rates = self.to_head.map_or(rates, |m| product(&m, rates));
            let before = self.last.replace((rates, now));
            before.inspect(|(_, at)| self.pace(now.since(*at)));
            let (last, at) = before.filter(|(_, at)| age(*at)).unwrap_or((rates, now));
            // All frames since then went by the last sample alone: half of what it has changed by since then is made up for.
            let frames = if dt_s > 0.0 { (now.since(at) / dt_s).max(1.0) } else { 1.0 };
            let change = add_scaled(rates, -1.0, last);
            self.bend(change, now.since(at), if frames > 1.5 { HELD } else { WANDERS });
            return (dt_s < AGE_S).then(|| add_scaled(last, 0.5 * frames, change));
        }
        self.last.filter(|(_, at)| age(*at) && dt_s < AGE_S).map(|(rates, _)| rates)
    }

    /// Learns how often samples come, but for gaps.
    fn pace(&mut self, interval_s: f64) {
        if (0.0..1.0).contains(&interval_s) {
            let average_s = self.interval_s.get_or_insert(interval_s);
            *average_s += INTERVALS * (interval_s - *average_s);
        }
    }

    /// Learns from a sample that differs by `change` from the one `interval_s` before how far rates bend between samples.
    fn bend(&mut self, change: Vector, interval_s: f64, share: f64) {
        if interval_s <= 0.0 {
            self.change = None;
            return;
        }
        let Some(before) = self.change.replace(change) else { return };
        self.learnt_s = (self.learnt_s + interval_s).min(BENT_S);
        let share = share * (interval_s / SMOOTH_S).min(1.0).powi(2);
        for (walk, (now, before)) in self.walk.iter_mut().zip(change.iter().zip(before)) {
            *walk += interval_s / self.learnt_s * (share * (now - before).powi(2) * interval_s - *walk);
        }
    }

    /// The variance of what it turns more or less than its samples say, rad²/s about nose, left, up.
    pub fn walk(&self) -> Vector {
        self.walk
    }

    /// The head shows this roll and pitch in level flight. What the rates are turned back by now, rad: from the axes by the
    /// trim before; a small angle.
    pub fn set_trim(&mut self, trim: Attitude) -> Vector {
        // The other way round than from the head to the airframe.
        let [pitch, roll] = [[0.0, trim.pitch, 0.0], [-trim.roll, 0.0, 0.0]].map(rotation);
        let columns: [Vector; 3] = std::array::from_fn(|k| product(&roll, std::array::from_fn(|i| pitch[i][k])));
        let to_head = std::array::from_fn(|r| std::array::from_fn(|k| columns[k][r]));
        let turned = trim != Attitude::default();
        let before = std::mem::replace(&mut self.to_head, turned.then_some(to_head)).unwrap_or(rotation([0.0; 3]));
        // Of the matrix from the new axes to those before.
        let element = |r: usize, c: usize| dot(before[r], to_head[c]);
        std::array::from_fn(|i| {
            let (next, last) = ((i + 1) % 3, (i + 2) % 3);
            0.5 * (element(last, next) - element(next, last))
        })
    }

    /// The rates to be used, rad/s on nose, left, up: the mean over the time since the last frame.
    pub fn rates(&self) -> Option<Vector> {
        self.rates
    }

    /// The same, whether it is believed or not.
    pub fn heard(&self) -> Option<Vector> {
        self.heard
    }

    /// The newest rates, rad/s on nose, left, up, while it is believed: also in frames that nothing begins with.
    pub fn newest(&self) -> Option<Vector> {
        self.said().filter(|_| !self.is_distrusted())
    }

    /// The same, whether it is believed or not.
    pub fn said(&self) -> Option<Vector> {
        let slow = self.interval_s.is_some_and(|s| s > SLOW_S.1);
        let fresh = |at: Time| (0.0..AGE_S).contains(&self.now.since(at));
        self.last.filter(|(_, at)| fresh(*at) && !slow && !self.is_stuck()).map(|(rates, _)| rates)
    }

    /// Whether there are rates.
    pub fn in_use(&self) -> bool {
        self.rates.is_some()
    }

    fn is_doubted(&self) -> bool {
        self.is_distrusted() || self.is_stuck()
    }

    fn is_stuck(&self) -> bool {
        self.same.is_some_and(|(rates, since, samples)| {
            let same_s = self.now.since(since);
            let turned = same_s > STUCK_S.1 && length(rates) * same_s > STUCK_RAD;
            samples > STUCK && (same_s > STUCK_S.0 || turned)
        })
    }

    fn is_distrusted(&self) -> bool {
        self.wrong_since.is_some_and(|at| (0.0..self.distrust_s).contains(&self.now.since(at)))
    }

    /// The thermopiles speak against it: it is not believed for a while.
    pub fn distrust(&mut self) {
        if self.rates.take().is_some() {
            self.wrong_since = Some(self.now);
            self.distrust_s = (2.0 * self.distrust_s).clamp(DISTRUST_S.0, DISTRUST_S.1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is shown by one trim is what is shown by the next and turned back.
    #[test]
    fn a_trim_that_moves_turns_the_axes() {
        let mut gyro = Gyro::default();
        let mut shown = |degrees: [f64; 2]| {
            let [roll, pitch] = degrees.map(f64::to_radians);
            let turned = gyro.set_trim(Attitude { roll, pitch });
            (gyro.to_head.map_or([1.0, -2.0, 0.5], |m| product(&m, [1.0, -2.0, 0.5])), turned)
        };
        let mut before = shown([0.0, 0.0]).0;
        for trim in [[1.0, 0.0], [1.0, -0.5], [3.0, 4.0], [3.5, 4.5], [0.0, 4.0], [0.0, 3.0], [0.0, 0.0]] {
            let (now, turned) = shown(trim);
            let back = product(&rotation(turned), now);
            assert!((0..3).all(|i| (back[i] - before[i]).abs() < 2e-3), "{trim:?}: {back:?} {before:?}");
            before = now;
        }
    }

    /// About the nose, at 0 and at 0.1 s; the frames between them have none.
    #[test]
    fn samples_between_frames_turn_as_far_as_their_mean() {
        let mut gyro = Gyro::default();
        let mut turned_deg = 0.0;
        for (i, rate) in [Some(0.0), None, None, None, None, Some(10.0)].into_iter().enumerate() {
            let aiding = Aiding { gyro_deg_s: [rate, rate, rate], ..Aiding::default() };
            gyro.update(&aiding, Time::from_secs_f64(5.0 + 0.02 * i as f64), 0.02, false);
            turned_deg += gyro.rates().map_or(0.0, |r| r[0].to_degrees() * 0.02);
        }
        assert!((turned_deg - 0.5).abs() < 1e-6, "{turned_deg}°");
    }

    /// Rates of `rate_deg_s` (by the sample's number) with every `every`-th of 500 frames, 50 a second.
    fn heard(every: usize, rate_deg_s: impl Fn(usize) -> f64) -> Gyro {
        let mut gyro = Gyro::default();
        for i in 0..500 {
            let rate = (i % every == 0).then(|| rate_deg_s(i / every));
            let aiding = Aiding { gyro_deg_s: [rate; 3], ..Aiding::default() };
            gyro.update(&aiding, Time::from_secs_f64(5.0 + 0.02 * i as f64), 0.02, false);
        }
        gyro
    }

    #[test]
    fn rates_that_come_too_seldom_are_not_used() {
        for (every, used) in [(1, true), (5, true), (7, true), (10, false), (12, false), (25, false)] {
            assert_eq!(heard(every, |i| 3.0 + 0.01 * (i % 2) as f64).in_use(), used, "every {every}. frame");
        }
    }

    #[test]
    fn one_that_says_the_same_for_long_is_not_used_until_it_says_something_else() {
        for every in [1, 5] {
            let stuck_from = |i: usize| heard(every, move |n| 0.001 * (n * every).min(i) as f64).in_use();
            assert!(!stuck_from(0) && !stuck_from(390) && stuck_from(410) && stuck_from(500), "every {every}. frame");
        }
        // At 35 deg/s 0.4 s are enough.
        let fast_from = |i: usize| heard(1, move |n| 20.0 + 0.001 * n.min(i) as f64).in_use();
        assert!(!fast_from(390) && !fast_from(475) && fast_from(485));
        let again = |i: usize| if i < 499 { 3.0 } else { 3.01 };
        assert!(heard(1, again).in_use() && heard(1, again).newest().is_some());
        assert!(heard(1, |_| 3.0).newest().is_none());
    }

    #[test]
    fn what_bends_between_samples_is_doubted_and_a_line_is_not() {
        assert!(heard(5, |i| i as f64).walk().iter().all(|w| *w < 1e-20));
        // Up and down by 6 deg/s: off the line by 12 each time.
        for (every, share) in [(1, 0.25 * WANDERS), (5, HELD)] {
            let expected = share * 12_f64.to_radians().powi(2) * 0.02 * every as f64;
            let walk = heard(every, |i| if i % 2 == 0 { 6.0 } else { 0.0 }).walk();
            assert!(walk.iter().all(|w| (w / expected - 1.0).abs() < 0.05), "{walk:?}, {expected}");
        }
    }
}
