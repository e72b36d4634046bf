//! In which units and directions an autopilot says its body rates: those in which they turn as its attitude does. Pure.
//!
//! ATTITUDE wants rad/s about nose, right and down. iNav says 0, degrees a second or radians, as its version is, and pitch
//! and yaw the other way round. Headings tell nothing here: some autopilots have none to give.

use crate::attitude::Attitude;
use crate::estimator::vector::{Vector, add_scaled, length, product, rotation};
use crate::time::Time;
use std::f64::consts::PI;

/// What is compared at a time, s; messages farther apart than the second tell nothing.
const SPAN_S: (f64, f64) = (0.2, 0.5);
/// No span tells more than one that turns by this, rad.
const MOST: f64 = 0.07;
/// So many spans are remembered.
const REMEMBERED: f64 = 50.0;
/// So much must have turned in all to tell, rad².
const ENOUGH: f64 = 0.02;
/// Another one than before is right that leaves less than this share of what turns, and of what that leaves.
const BETTER: f64 = 0.25;
/// What leaves more than such a share of what turns, and more than noise, rad², is not believed.
const WRONG: (f64, f64) = (0.6, 0.0012);

/// The ways of saying it, and by what each axis is to be multiplied.
const SENSES: [(&str, [f64; 3]); 4] = [
    ("rad/s about nose, right and down", [1.0, 1.0, 1.0]),
    ("rad/s, with pitch and yaw the other way round", [1.0, -1.0, -1.0]),
    ("degrees a second", [PI / 180.0, PI / 180.0, PI / 180.0]),
    ("degrees a second, with pitch and yaw the other way round", [PI / 180.0, -PI / 180.0, -PI / 180.0]),
];

/// What has been found of an autopilot's rates.
#[derive(Clone, Debug, Default)]
pub struct Sense {
    /// Which of the ways it is; at first the one that the message wants.
    found: usize,
    /// Whether that is believed.
    believed: bool,
    span: Option<Span>,
    /// The sums of squares of what turns, and of what each way leaves of it, rad².
    turned: f64,
    left: [f64; 4],
}

/// Since when, and where up was then on nose, right, down; the last message, and how far its rates turn since, as said.
#[derive(Clone, Copy, Debug)]
struct Span {
    since: (Time, Vector),
    last: (Time, Vector),
    said: Vector,
}

impl Sense {
    /// The rates of a message of `time`, rad/s about nose, right, down: what was `said` beside an attitude.
    pub fn hear(&mut self, time: Time, attitude: Attitude, said: Vector) -> Option<Vector> {
        let up = up(attitude);
        let span = self.span.filter(|s| (0.0..=SPAN_S.1).contains(&time.since(s.last.0))).map(|s| {
            let half_s = 0.5 * time.since(s.last.0);
            let turned = std::array::from_fn(|i| s.said[i] + half_s * (s.last.1[i] + said[i]));
            Span { last: (time, said), said: turned, ..s }
        });
        self.span = span.filter(|s| time.since(s.since.0) < SPAN_S.0).or_else(|| {
            if let Some(s) = span {
                self.judge(s.since.1, up, s.said);
            }
            Some(Span { since: (time, up), last: (time, said), said: [0.0; 3] })
        });
        let (_, factors) = SENSES[self.found];
        self.believed.then(|| std::array::from_fn(|i| factors[i] * said[i]))
    }

    fn judge(&mut self, from: Vector, to: Vector, said: Vector) {
        let square = |v: Vector| length(add_scaled(v, -1.0, to)).powi(2);
        let turned = square(from);
        let weight = (MOST.powi(2) / turned.max(f64::MIN_POSITIVE)).min(1.0);
        let keep = 1.0 - 1.0 / REMEMBERED;
        self.turned = keep * self.turned + weight * turned;
        for (sum, (_, factors)) in self.left.iter_mut().zip(SENSES) {
            // Up stays where it is while the body turns.
            let on = rotation(std::array::from_fn(|i| -factors[i] * said[i]));
            *sum = keep * *sum + weight * square(product(&on, from));
        }
        self.find();
    }

    fn find(&mut self) {
        let best = (0..SENSES.len()).min_by(|a, b| self.left[*a].total_cmp(&self.left[*b])).unwrap_or(self.found);
        let better = self.left[best] < BETTER * self.turned.min(self.left[self.found]);
        if self.turned > ENOUGH && better {
            log::info!("the autopilot says its rates in {}: taken so", SENSES[best].0);
            self.found = best;
        }
        let believed = self.left[self.found] < WRONG.1.max(WRONG.0 * self.turned);
        if self.believed && !believed {
            log::warn!("the autopilot's rates do not turn as its attitude does: they are not used until they do");
        }
        self.believed = believed;
    }
}

/// Where up is, on nose, right, down.
fn up(attitude: Attitude) -> Vector {
    let ((sin, cos), (sin_pitch, cos_pitch)) = (attitude.roll.sin_cos(), attitude.pitch.sin_cos());
    [sin_pitch, -sin * cos_pitch, -cos * cos_pitch]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Roll, pitch, yaw, rad, and their rates, rad/s, of a flight that turns to and fro.
    fn flight(t: f64) -> ([f64; 3], [f64; 3]) {
        let (a, b) = (0.7 * t, 1.1 * t);
        let angles = [0.5 * a.sin(), 0.1 * b.sin(), 6.0 + 0.9 * (0.3 * t).sin()];
        ([angles[0], angles[1], angles[2]], [0.35 * a.cos(), 0.11 * b.cos(), 0.27 * (0.3 * t).cos()])
    }

    /// The rates about the body's axes of angles that change.
    fn body([roll, pitch, _]: [f64; 3], [p, q, r]: [f64; 3]) -> [f64; 3] {
        let ((sin, cos), (sin_pitch, cos_pitch)) = (roll.sin_cos(), pitch.sin_cos());
        [p - r * sin_pitch, q * cos + r * cos_pitch * sin, r * cos_pitch * cos - q * sin]
    }

    /// What is taken, after so many seconds with so many messages a second, of rates said by `says`; attitudes in steps of
    /// `step` rad. Beside it the true ones.
    fn taken(seconds: f64, hz: f64, step: f64, says: impl Fn([f64; 3]) -> [f64; 3]) -> (Option<[f64; 3]>, [f64; 3]) {
        let mut sense = Sense::default();
        let mut last = (None, [0.0; 3]);
        for i in 0..(seconds * hz) as usize {
            let t = i as f64 / hz;
            let (angles, changes) = flight(t);
            let rates = body(angles, changes);
            let [roll, pitch, _] = angles.map(|a| if step > 0.0 { (a / step).round() * step } else { a });
            let taken = sense.hear(Time::from_secs_f64(7.0 + t), Attitude { roll, pitch }, says(rates));
            last = (taken, rates);
        }
        last
    }

    #[test]
    fn each_way_of_saying_it_is_found() {
        for (what, factors) in SENSES {
            for (hz, step) in [(50.0, 0.0), (50.0, 0.1_f64.to_radians()), (10.0, 0.0), (5.0, 0.0)] {
                let says = |rates: [f64; 3]| std::array::from_fn(|i| rates[i] / factors[i]);
                let (taken, truth) = taken(20.0, hz, step, says);
                let taken = taken.unwrap_or_else(|| panic!("{what}, {hz} Hz"));
                assert!((0..3).all(|i| (taken[i] - truth[i]).abs() < 1e-9), "{what}, {hz} Hz: {taken:?}, {truth:?}");
            }
        }
    }

    #[test]
    fn what_is_said_as_the_message_wants_it_is_taken_at_once_and_what_is_not_is_not() {
        let (taken_s, truth) = taken(0.5, 50.0, 0.0, |rates| rates);
        assert_eq!(taken_s, Some(truth));
        assert_eq!(taken(0.5, 50.0, 0.0, |rates| rates.map(f64::to_degrees)).0, None);
    }

    #[test]
    fn rates_that_turn_otherwise_are_none() {
        let others: [fn([f64; 3]) -> [f64; 3]; 3] = [|_| [0.0; 3], |r| r.map(|r| -r), |[p, q, r]| [r, p, q]];
        for (i, says) in others.into_iter().enumerate() {
            assert_eq!(taken(30.0, 50.0, 0.0, says).0, None, "{i}");
        }
    }

    proptest! {
        #[test]
        fn whatever_is_said_nothing_but_that_comes_out(
            messages in prop::collection::vec((0_u64..3_000_000_000, prop::array::uniform2(-9.0..9.0_f64), prop::array::uniform3(-2e5..2e5_f64)), 1..200),
        ) {
            let mut sense = Sense::default();
            for (nanos, [roll, pitch], said) in messages {
                let taken = sense.hear(Time::from_nanos(nanos), Attitude { roll, pitch }, said);
                let is = |factors: [f64; 3]| taken == Some(std::array::from_fn(|i| factors[i] * said[i]));
                prop_assert!(taken.is_none() || SENSES.iter().any(|(_, factors)| is(*factors)));
                prop_assert!(sense.turned.is_finite() && sense.left.iter().all(|l| l.is_finite()));
            }
        }
    }
}
