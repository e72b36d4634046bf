//! Whether a gyro turns as the thermopiles see the aircraft turn.
//!
//! A filter that hears a gyro which is dead, the wrong way round or said in other units explains what does not fit by scenes,
//! and errs by tens of degrees. This asks no filter: where the sky is seen in one half of a second, turned on by the gyro, is
//! compared with where it is seen in the other half. Where it turns otherwise, it is asked how the head would have to be wired
//! for the gyro to be right.

use super::FieldEstimator;
use super::change::SceneChange;
use super::directions::Pattern;
use super::form::Form;
use super::gyro::shown;
use super::noise::NoiseLevel;
use super::state::{LAG, MAX_SENSORS, SOONEST};
use crate::estimator::Standing;
use crate::estimator::normal::Normal;
use crate::estimator::vector::{Vector, add_scaled, cross, dot, length, product, rotation, unit};
use crate::estimator::wiring::Wiring;
use crate::time::Time;

/// Half of a stretch, s.
const HALF_S: f64 = 0.5;
/// Frames farther apart show no stretch, s.
const GAP_S: f64 = 0.25;
/// Where the sky is seen is off by so much from half to half: rad, and K of a pair's signal.
const OFF: (f64, f64) = (0.017, 0.03);
/// By so many times what else changes, as clouds, drops and what is not linear in a sky do; and by so much, rad, times how
/// far from symmetric the sensors are.
const CHANGED: f64 = 1.5;
const LOPSIDED: f64 = 0.3;
/// No stretch tells more than one that turns by this, rad.
const MOST: f64 = 0.07;
/// So many stretches are remembered.
const REMEMBERED: f64 = 20.0;
/// A gyro is wrong that leaves this share of the squares of what is seen to turn, and so many times those of what may be off,
/// and in all so much, rad²; it is right that leaves the second share, and proven by the third.
const LEFT: (f64, f64, f64) = (0.7, 0.2, 0.05);
const CLEAR: f64 = 1.2;
const ENOUGH: f64 = 0.018;
/// So much must be seen to turn to say how the head is wired, rad²; a way to wire it does not explain what is noise.
const ASKED: f64 = 0.006;
/// Such a share of what is left in a stretch is taken for the gyro's bias, and more at first.
const BIAS: f64 = 0.2;
/// It is known after so many stretches, seen by sensors no farther from symmetric: others see turns where there are none.
const KNOWN: f64 = 10.0;
const SYMMETRIC: f64 = 0.05;

/// Compares stretch after stretch.
#[derive(Clone, Debug, Default)]
pub struct Turns {
    stretch: Option<Stretch>,
    /// The gyro's rates as the sensors show them, rad/s, and when.
    shown: Option<(Vector, Time)>,
    /// What the gyro says too much, rad/s, and in how many stretches that has been learnt.
    bias: Vector,
    learnt: f64,
    symmetric: bool,
    /// The sums of squares of what is seen to turn, what the gyro leaves of it, and what may be off, rad².
    told: [f64; 3],
    contradict: bool,
    proven: bool,
    /// Since it turns otherwise: the same sum of what is seen to turn, and of what is left by each way to wire the head.
    since: (f64, [f64; WAYS]),
    wired: Option<Wiring>,
}

const WAYS: usize = Wiring::ALL.len();

/// Where the sky is seen by a frame alone.
#[derive(Clone, Debug)]
pub struct Seen {
    /// Up, as long as a vertical pair's signal, K on nose, left, up.
    pub sky_k: Vector,
    /// What of each sensor's reading that does not explain, K.
    pub rest_k: Pattern,
    /// How far from symmetric the sensors are that see it, 0..1.
    pub lopsided: f64,
}

/// The sums of what has been seen in the halves of a stretch.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    since: Time,
    last: Time,
    /// Where the sky was, as it was seen, and turned on by the gyro since: as the head is wired, and as it might be.
    seen: [Vector; 2],
    turned: [Vector; 2],
    ways: [[Vector; 2]; WAYS],
    rest: [Pattern; 2],
    count: usize,
    lopsided: f64,
}

impl Stretch {
    fn new(now: Time) -> Self {
        let (seen, rest) = ([[0.0; 3]; 2], [Pattern::default(); 2]);
        let ways = [seen; WAYS];
        Self { since: now, last: now, seen, turned: seen, ways, rest, count: 0, lopsided: 0.0 }
    }

    /// Takes in where the sky is seen, after rates but for the bias, and, where that is asked, with it.
    fn take(&mut self, seen: &Seen, rates: Vector, asked: Option<Vector>, now: Time) {
        let half = usize::from(now.since(self.since) >= HALF_S);
        let add = |sums: &mut [Vector; 2]| sums[half] = add_scaled(sums[half], 1.0, seen.sky_k);
        let turn = |sums: &mut [Vector; 2], rates: Vector| {
            let on = rotation(rates.map(|r| -r * now.since(self.last)));
            *sums = sums.map(|t| product(&on, t));
            add(sums);
        };
        add(&mut self.seen);
        turn(&mut self.turned, rates);
        if let Some(rates) = asked {
            self.ways.iter_mut().zip(Wiring::ALL).for_each(|(sums, wired)| turn(sums, wired.rates(rates)));
        }
        self.rest[half].iter_mut().zip(&seen.rest_k).for_each(|(sum, rest)| *sum += rest);
        (self.last, self.count, self.lopsided) = (now, self.count + 1, self.lopsided.max(seen.lopsided));
    }

    /// The squares of what was seen to turn, what the gyro leaves of it, and what may be off, rad²; the turn that is left;
    /// and the squares of what it leaves in each way to wire the head.
    fn told(&self) -> Option<([f64; 3], Vector, [f64; WAYS])> {
        let [Some(a), Some(b)] = self.turned.map(unit) else { return None };
        let [Some(c), Some(d)] = self.seen.map(unit) else { return None };
        let half = self.count as f64 / 2.0;
        let least_k = (length(self.turned[0]).min(length(self.turned[1])) / half).max(0.1);
        let changed_k2: f64 = self.rest[0].iter().zip(&self.rest[1]).map(|(a, b)| ((a - b) / half).powi(2)).sum();
        let off_k2 = OFF.1.powi(2) + CHANGED.powi(2) * changed_k2;
        let off = OFF.0.powi(2) + (LOPSIDED * self.lopsided).powi(2) + off_k2 / least_k.powi(2);
        let angle = |a, b| dot(a, b).clamp(-1.0, 1.0).acos();
        let ways = self.ways.map(|sums| match sums.map(unit) {
            [Some(a), Some(b)] => angle(a, b).powi(2),
            _ => 0.0,
        });
        Some(([angle(c, d).powi(2), angle(a, b).powi(2), off], cross(a, b), ways))
    }
}

impl Turns {
    /// Takes in where the sky is seen, by sensors with a time constant of `lag_s`, and the gyro's mean rates since the last
    /// frame, rad/s on nose, left, up.
    pub fn update(&mut self, seen: Option<Seen>, rates: Option<Vector>, lag_s: f64, now: Time) {
        let stretch = self.stretch.take().filter(|s| (0.0..GAP_S).contains(&now.since(s.last)));
        let rates = rates.map(|rates| {
            let (before, last) = self.shown.unwrap_or((rates, now));
            shown(before, rates, now.since(last).max(0.0), lag_s)
        });
        self.shown = rates.map(|rates| (rates, now));
        let (Some(seen), Some(rates)) = (seen, rates) else { return };
        let over = |s: &Stretch| now.since(s.since) >= 2.0 * HALF_S;
        if let Some((stretch, told)) = stretch.filter(over).and_then(|s| Some((s, s.told()?))) {
            self.symmetric = stretch.lopsided < SYMMETRIC;
            self.judge(told);
        }
        let mut stretch = stretch.filter(|s| !over(s)).unwrap_or_else(|| Stretch::new(now));
        stretch.take(&seen, add_scaled(rates, -1.0, self.bias), self.contradict.then_some(rates), now);
        self.stretch = Some(stretch);
    }

    fn judge(&mut self, (told, turn, ways): ([f64; 3], Vector, [f64; WAYS])) {
        self.learnt += 1.0;
        self.bias = add_scaled(self.bias, BIAS.max(1.0 / (1.0 + self.learnt)) / HALF_S, turn);
        let weight = |turned: f64| (MOST.powi(2) / turned.max(f64::MIN_POSITIVE)).min(1.0);
        self.ask(weight(told[0]) * told[0], ways.map(|left| weight(told[0]) * left));
        let weight = weight(told[0].max(told[1]));
        for (sum, told) in self.told.iter_mut().zip(told) {
            *sum += weight * told - *sum / REMEMBERED;
        }
        let [seen, left, off] = self.told;
        if left > ENOUGH && left > LEFT.0 * seen && left > CLEAR * off {
            (self.contradict, self.proven) = (true, false);
        } else if seen > ENOUGH && left < LEFT.1 * seen && (self.wired.is_none() || left < self.least()) {
            // In a steady turn a bias explains all that is seen, too.
            self.contradict = false;
            self.proven |= left < LEFT.2 * seen;
        }
    }

    /// Asks which way to wire the head explains a stretch in which `seen` was seen to turn.
    fn ask(&mut self, seen: f64, ways: [f64; WAYS]) {
        if !self.contradict {
            (self.since, self.wired) = Default::default();
            return;
        }
        let (sum, sums) = &mut self.since;
        *sum += seen - *sum / REMEMBERED;
        sums.iter_mut().zip(ways).for_each(|(sum, left)| *sum += left - *sum / REMEMBERED);
        let [as_configured, ..] = *sums;
        let best = sums.iter().zip(Wiring::ALL).skip(1).min_by(|a, b| a.0.total_cmp(b.0));
        if let Some((left, wired)) = best.filter(|_| *sum > ASKED) {
            // What was found explains less among clouds.
            let kept = self.wired.filter(|_| *left < LEFT.0 * *sum);
            self.wired = if *left < LEFT.1 * sum.min(as_configured) { Some(wired) } else { kept };
        }
    }

    /// What is left by the way to wire the head that leaves least.
    fn least(&self) -> f64 {
        self.since.1.iter().skip(1).copied().fold(f64::INFINITY, f64::min)
    }

    /// How the head would have to be wired for a gyro to be right that turns otherwise than is seen; `None` where no way
    /// explains that.
    pub fn wired(&self) -> Option<Wiring> {
        self.wired.filter(|_| self.contradict)
    }

    /// The share of the squares of what is seen to turn that the gyro leaves.
    pub fn left(&self) -> f64 {
        self.told[1] / self.told[0].max(f64::MIN_POSITIVE)
    }

    /// What the gyro says too much, rad/s, once it is known.
    pub fn bias(&self) -> Option<Vector> {
        (self.learnt > KNOWN && self.symmetric).then_some(self.bias)
    }

    /// Whether the gyro turns otherwise than is seen.
    pub fn contradict(&self) -> bool {
        self.contradict
    }

    /// Whether it has been seen to turn rightly, and not otherwise since.
    pub fn proven(&self) -> bool {
        self.proven
    }
}

impl FieldEstimator {
    /// Compares the gyro with the thermopiles that are heard.
    pub(super) fn compare_turns(&mut self, readings: &[Option<f64>; MAX_SENSORS], now: Time) {
        let rates = self.gyro.heard();
        let seen = rates.and_then(|_| self.seen(&self.lately(readings, now)));
        if self.gyro.in_use() {
            self.lag = self.state.x[LAG];
        }
        // A time constant that is said too short would look like a gyro that is wrong, without which it cannot be found.
        self.turns.update(seen, rates, self.tuning.lag_s * self.lag.max(SOONEST).exp(), now);
    }

    /// Forgets what was made of a gyro that turns otherwise: scenes, noise, and sensors at fault.
    pub(super) fn unlearn(&mut self) {
        self.scene.forget();
        self.change = SceneChange::default();
        self.noise = NoiseLevel::new(self.tuning.noise_k);
        self.form = Form::default();
        self.witnesses.acquit();
    }

    /// What is linear in the vertical, and fits the readings best.
    fn seen(&self, readings: &[Option<f64>; MAX_SENSORS]) -> Option<Seen> {
        let heard = || {
            let heard = |i: &usize| self.witnesses.standing(*i) == Standing::Heard;
            (0..self.model.sensors()).filter(heard).filter_map(|i| Some((i, self.model.direction(i), readings[i]?)))
        };
        // Of a pair's signal the ground is no part, and a sensor shows half of it.
        let absolute = self.model.is_absolute();
        let (share, sides) = if absolute { (1.0 / heard().count().max(1) as f64, 2.0) } else { (0.0, 1.0) };
        let (mut centre, mut ground) = ([0.0; 3], 0.0);
        for (_, direction, reading) in heard() {
            (centre, ground) = (add_scaled(centre, share, direction), ground + share * reading);
        }
        let (mut normal, mut right) = (Normal::default(), [0.0; 3]);
        for (_, direction, reading) in heard() {
            let b = add_scaled(direction, -1.0, centre);
            normal.add_vector(b);
            right = add_scaled(right, reading - ground, b);
        }
        let fit = product(&normal.inverse()?, right);
        let mut rest_k = Pattern::default();
        for (i, direction, reading) in heard() {
            rest_k[i] = reading - ground - dot(add_scaled(direction, -1.0, centre), fit);
        }
        Some(Seen { sky_k: fit.map(|k| -sides * k), rest_k, lopsided: length(centre) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a gyro says of the true rates, rad/s.
    type Says = fn(Vector) -> Vector;

    /// After how many seconds of rolling to and fro by 20° it shows that `gyro` turns otherwise, under a sky of so many K; what
    /// drifts by tilts it by so many.
    fn contradicted_s(gyro: impl Fn(Vector) -> Vector, sky_k: f64, wander_k: f64) -> Option<f64> {
        let mut turns = Turns::default();
        let seconds = |i: usize| 0.02 * i as f64;
        (0..6000).map(seconds).find(|t| {
            let roll = 0.35 * (1.3 * t).sin();
            let rates = [0.35 * 1.3 * (1.3 * (t - 0.01)).cos(), 0.0, 0.0];
            let sky = [wander_k * (2.1 * t).sin(), sky_k * roll.sin(), sky_k * roll.cos()];
            let seen = Seen { sky_k: sky, rest_k: Pattern::default(), lopsided: 0.0 };
            turns.update(Some(seen), Some(gyro(rates)), 0.0, Time::from_secs_f64(9.0 + t));
            turns.contradict()
        })
    }

    #[test]
    fn a_gyro_that_turns_as_is_seen_is_believed() {
        for off in [0.0, 0.05, 0.17] {
            assert_eq!(contradicted_s(|r| add_scaled(r, off, [1.0, -1.0, 1.0]), 30.0, 0.0), None, "{off} rad/s off");
        }
        assert_eq!(contradicted_s(|r| r.map(|r| 0.8 * r), 30.0, 0.0), None);
        assert_eq!(contradicted_s(|r| r, 5.0, 0.3), None, "a little that drifts by");
    }

    #[test]
    fn one_that_does_not_is_found_out() {
        let wrong: [(&str, Says); 4] = [
            ("dead", |_| [0.0; 3]),
            ("the wrong way round", |r| r.map(|r| -r)),
            ("degrees for radians", |r| r.map(f64::to_degrees)),
            ("about another axis", |[p, q, r]| [q, p, r]),
        ];
        for (what, gyro) in wrong {
            for sky_k in [30.0, 6.0] {
                let after_s = contradicted_s(gyro, sky_k, 0.0);
                assert!(after_s.is_some_and(|s| s < 20.0), "{what}, {sky_k} K: {after_s:?}");
            }
        }
    }

    /// Rolls and pitches for a minute under a head that is wired otherwise.
    #[test]
    fn a_head_that_is_wired_otherwise_is_told_from_a_gyro_that_is_dead() {
        let after_s = |wired: Option<Wiring>| {
            let mut turns = Turns::default();
            let mut attitude = [0.0, 0.0, 30.0];
            (0..3000).map(|i| 0.02 * f64::from(i)).find(|t| {
                let rates = [0.5 * (1.3 * t).cos(), 0.3 * (0.9 * t).sin(), 0.1];
                attitude = product(&rotation(rates.map(|r| -0.02 * r)), attitude);
                let seen = Seen { sky_k: attitude, rest_k: Pattern::default(), lopsided: 0.0 };
                // To wire it so or to turn the gyro so is the same to the two.
                let says = wired.map_or([0.0; 3], |w| inverse(w).rates(rates));
                turns.update(Some(seen), Some(says), 0.0, Time::from_secs_f64(9.0 + t));
                assert!(turns.wired().is_none_or(|w| Some(w) == wired), "{wired:?}: {:?}", turns.wired());
                turns.wired().is_some()
            })
        };
        for wired in Wiring::ALL.into_iter().skip(1) {
            assert!(after_s(Some(wired)).is_some_and(|s| s < 30.0), "{wired:?}: {:?}", after_s(Some(wired)));
        }
        assert_eq!(after_s(None), None);
    }

    /// The way to wire a head that undoes `wired`.
    fn inverse(wired: Wiring) -> Wiring {
        let same = |w: &Wiring| {
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].iter().all(|v| w.rates(wired.rates(*v)) == *v)
        };
        Wiring::ALL.into_iter().find(same).unwrap()
    }

    #[test]
    fn what_was_found_out_and_turns_rightly_is_believed_again() {
        let mut turns = Turns { contradict: true, ..Turns::default() };
        for i in 0..3000 {
            let t = 0.02 * f64::from(i);
            let (roll, rate) = (0.35 * (1.3 * t).sin(), 0.35 * 1.3 * (1.3 * (t - 0.01)).cos());
            let seen =
                Seen { sky_k: [0.0, 30.0 * roll.sin(), 30.0 * roll.cos()], rest_k: Pattern::default(), lopsided: 0.0 };
            turns.update(Some(seen), Some([rate, 0.0, 0.0]), 0.0, Time::from_secs_f64(9.0 + t));
        }
        assert!(!turns.contradict());
    }
}
