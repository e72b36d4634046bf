//! What a gyro makes of the attitude that was given some seconds ago.
//!
//! A filter that is misled, slowly or by what it begins anew with, goes where its gyro has not turned. One of
//! the two is wrong: where they part by more than both are known to, σ holds by how much.

use super::FieldEstimator;
use super::rates::correction;
use super::state::RATE;
use crate::attitude::Attitude;
use crate::estimator::Solution;
use crate::estimator::vector::{Vector, add_scaled, dot, length, product, rotation};
use crate::time::Time;

/// How fast a gyro's bias is forgotten, rad/s for a second.
const BIAS_WALK: f64 = 1e-5;
/// The attitudes that are carried, and how far they are apart, s.
const CARRIED: usize = 4;
const APART_S: f64 = 5.0;
/// None is carried longer, s: by then it may be the gyro that was wrong.
const LONGEST_S: f64 = 30.0;
/// Frames farther apart than this are not carried across, s.
const GAP_S: f64 = 0.25;
/// So many standard deviations of both they may part.
const SIGMAS: f64 = 2.0;
/// What a gyro drifts by beside what its bias is known by, rad/s (0.1°/s), and by the share of what it turns.
const DRIFT: f64 = 0.0017;
const SCALE: f64 = 0.05;

/// An attitude that was given, turned on by the gyro since.
#[derive(Clone, Copy, Debug)]
struct Anchor {
    up: Vector,
    /// As it was given, rad.
    sigma: f64,
    /// How long that is ago, s, and what the gyro may have drifted by since, rad.
    age_s: f64,
    drifted: f64,
}

/// Carries attitudes of the last seconds by the gyro.
#[derive(Clone, Copy, Debug, Default)]
pub struct Carried {
    anchors: [Option<Anchor>; CARRIED],
    /// How long until the next is put down, s, and where.
    next_s: f64,
    at: usize,
    /// What is added to the gyro's rates, rad/s, and how well that is known.
    bias: Option<(Vector, f64)>,
    /// What is carried is carried to then.
    last: Option<Time>,
    /// The gyro that carries is not believed any more, and the filter has begun anew.
    doubted: bool,
}

impl Carried {
    /// Turns on what is carried by a gyro's `rates` with their correction and how well that is known, rad/s on (nose, left,
    /// up), to `time`.
    fn carry(&mut self, rates: Vector, now: Option<(Vector, f64)>, time: Time) {
        let dt_s = self.last.replace(time).map_or(0.0, |last| time.since(last));
        if !(0.0..GAP_S).contains(&dt_s) {
            *self = Self { bias: self.bias, last: self.last, ..Self::default() };
            return;
        }
        // Where the filter begins anew the gyro's bias does not.
        let before = self.bias.map(|(correction, known)| (correction, known + BIAS_WALK * dt_s));
        let better = now.filter(|now| before.is_none_or(|before| now.1 <= before.1));
        self.bias = better.or(before);
        let Some((correction, known)) = self.bias else { return };
        self.next_s -= dt_s;
        let rates = add_scaled(rates, 1.0, correction);
        let on = rotation(rates.map(|r| -r * dt_s));
        let drifts = SIGMAS * known + DRIFT + SCALE * length(rates);
        for anchor in self.anchors.iter_mut().flatten() {
            anchor.up = product(&on, anchor.up);
            anchor.age_s += dt_s;
            anchor.drifted += drifts * dt_s;
        }
        self.anchors = self.anchors.map(|a| a.filter(|a| a.age_s < LONGEST_S));
        self.doubted &= self.anchors.iter().any(Option::is_some);
    }

    /// The filter begins anew against its gyro: which of the two is right nobody knows until what is carried is old.
    pub fn doubt(&mut self) {
        self.doubted = true;
    }

    /// By how much the attitude given now parts from what is carried more than both are known to, rad.
    fn parts(&mut self, up: Vector, sigma: f64) -> f64 {
        let beyond = |a: &Anchor| {
            let angle = dot(a.up, up).clamp(-1.0, 1.0).acos();
            angle - (SIGMAS * a.sigma.hypot(sigma) + a.drifted)
        };
        let most = self.anchors.iter().flatten().map(beyond).fold(0.0, f64::max);
        if self.next_s <= 0.0 && most == 0.0 && self.bias.is_some() && !self.doubted {
            self.anchors[self.at] = Some(Anchor { up, sigma, age_s: 0.0, drifted: 0.0 });
            self.at = (self.at + 1) % CARRIED;
            self.next_s = APART_S;
        }
        most
    }
}

impl FieldEstimator {
    /// Takes in a gyro's rates, while it is believed, up to `now`; one that is proven also while nothing else is.
    pub(super) fn carry_on(&mut self, now: Time) {
        let unbegun = || self.gyro.newest().filter(|_| self.last.is_none() && self.turns.proven());
        let doubted = || self.gyro.said().filter(|_| self.carried.doubted && !self.turns.contradict());
        let Some(rates) = self.gyro.rates().or_else(unbegun).or_else(doubted) else {
            self.carried = Carried::default();
            return;
        };
        let known = (0..3).map(|i| self.state.p[RATE + i][RATE + i]).fold(0.0, f64::max).sqrt();
        let bias = self.gyro.in_use().then(|| (correction(&self.state), known));
        self.carried.carry(rates, bias, now);
    }

    /// What is said, with what the gyro makes of what was said before.
    pub(super) fn said(&mut self) -> Solution {
        let mut solution = self.solution();
        let Some(attitude) = solution.attitude else { return solution };
        let sigma = (solution.sigma.roll * attitude.pitch.cos()).max(solution.sigma.pitch);
        let parts = self.carried.parts(attitude.vertical(), sigma);
        solution.sigma = Attitude {
            roll: solution.sigma.roll.hypot(parts / attitude.pitch.cos().max(0.2)),
            pitch: solution.sigma.pitch.hypot(parts),
        };
        solution
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(s: f64) -> Time {
        Time::from_secs_f64(100.0 + s)
    }

    const KNOWN: f64 = 0.0005;

    fn up(roll_deg: f64) -> Vector {
        Attitude::from_degrees(roll_deg, 0.0).vertical()
    }

    fn sigma(deg: f64) -> f64 {
        deg.to_radians()
    }

    /// By how many degrees it parts at last, in so many seconds in which it rolls at `seen` and a gyro, which says `bias` too
    /// much, at `said` °/s; σ is 1° all along.
    fn parted_deg(carried: &mut Carried, seconds: f64, [seen, said, bias]: [f64; 3]) -> f64 {
        (1..=(seconds * 50.0) as u32).fold(0.0, |_, i| {
            let (rates, s) = ([said + bias, 0.0, 0.0].map(f64::to_radians), 0.02 * f64::from(i));
            carried.carry(rates, Some(([-bias.to_radians(), 0.0, 0.0], KNOWN)), at(s));
            carried.parts(up(seen * s), sigma(1.0)).to_degrees()
        })
    }

    #[test]
    fn what_turns_as_its_gyro_does_parts_by_nothing() {
        for said in [0.0, 5.0, -40.0] {
            for bias in [0.0, 3.0] {
                assert_eq!(parted_deg(&mut Carried::default(), 60.0, [said, said, bias]), 0.0, "{said} {bias}");
            }
        }
        assert_eq!(parted_deg(&mut Carried::default(), 60.0, [0.1, 0.0, 0.0]), 0.0, "a bias that is not known so well");
    }

    /// 2.8° by both σ, 0.16°/s by the gyro.
    #[test]
    fn what_slides_parts_by_what_both_do_not_explain() {
        for (seconds, expected) in [(1.0, 0.0), (5.0, 11.4), (20.0, 54.0)] {
            let parted = parted_deg(&mut Carried::default(), seconds, [3.0, 0.0, 0.0]);
            assert!((parted - expected).abs() < 1.0, "{seconds} s: {parted}");
        }
    }

    #[test]
    fn it_is_forgotten_in_half_a_minute_and_not_carried_across_a_gap() {
        let mut carried = Carried::default();
        assert!(parted_deg(&mut carried, 10.0, [3.0, 0.0, 0.0]) > 20.0);
        let mut gone = carried;
        let still = |carried: &mut Carried, s: f64| {
            carried.carry([0.0; 3], Some(([0.0; 3], KNOWN)), at(s));
            carried.parts(up(30.0), sigma(1.0))
        };
        let lasts_s = (1..).map(|i| 0.02 * f64::from(i)).find(|s| still(&mut carried, 10.0 + s) == 0.0).unwrap();
        assert!((15.0..30.0).contains(&lasts_s), "{lasts_s} s");
        assert_eq!(still(&mut gone, 11.0), 0.0);
    }

    #[test]
    fn nothing_is_carried_by_a_gyro_that_was_never_used() {
        let mut carried = Carried::default();
        carried.carry([0.0; 3], None, at(0.0));
        carried.parts(up(0.0), sigma(1.0));
        carried.carry([0.0; 3], None, at(0.02));
        assert_eq!(carried.parts(up(90.0), sigma(1.0)), 0.0);
    }

    /// Begun anew the filter knows its bias less well, and while it cannot begin none; nothing of the gyro has changed.
    #[test]
    fn the_best_that_was_known_of_the_bias_is_kept() {
        let mut carried = Carried::default();
        carried.carry([0.0; 3], Some(([0.01, 0.0, 0.0], KNOWN)), at(0.0));
        carried.carry([0.0; 3], None, at(0.02));
        carried.carry([0.0; 3], Some(([0.0; 3], 0.02)), at(0.04));
        carried.parts(up(0.0), sigma(1.0));
        assert!(
            carried.anchors[0].is_some()
                && carried.bias.is_some_and(|(bias, known)| bias[0] == 0.01 && known < 1.01 * KNOWN)
        );
    }

    /// Which of the two was wrong nobody knows: σ holds by how much they part until that is old.
    #[test]
    fn a_filter_that_begins_anew_against_its_gyro_is_held_against_it() {
        let mut carried = Carried::default();
        parted_deg(&mut carried, 6.0, [0.0, 0.0, 0.0]);
        carried.doubt();
        let parts = |carried: &mut Carried, s: f64| {
            carried.carry([0.0; 3], None, at(s));
            carried.parts(up(30.0), sigma(1.0)).to_degrees()
        };
        assert!(parts(&mut carried, 6.02) > 20.0 && carried.doubted);
        for i in 1..1500 {
            parts(&mut carried, 6.02 + 0.02 * f64::from(i));
        }
        assert!(!carried.doubted);
    }
}
