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
}

impl Carried {
    /// Turns on what is carried by a gyro's `rates` with their correction and how well that is known, rad/s on (nose, left,
    /// up), for `dt_s`.
    fn carry(&mut self, rates: Vector, now: (Vector, f64), dt_s: f64) {
        if !(0.0..GAP_S).contains(&dt_s) {
            *self = Self { bias: self.bias, ..Self::default() };
            return;
        }
        // Where the filter begins anew the gyro's bias does not.
        let (correction, known) = *self.bias.insert(match self.bias {
            Some((correction, known)) if known + BIAS_WALK * dt_s < now.1 => (correction, known + BIAS_WALK * dt_s),
            _ => now,
        });
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
    }

    /// By how much the attitude given now parts from what is carried more than both are known to, rad.
    fn parts(&mut self, up: Vector, sigma: f64) -> f64 {
        let beyond = |a: &Anchor| {
            let angle = dot(a.up, up).clamp(-1.0, 1.0).acos();
            angle - (SIGMAS * a.sigma.hypot(sigma) + a.drifted)
        };
        let most = self.anchors.iter().flatten().map(beyond).fold(0.0, f64::max);
        if self.next_s <= 0.0 && most == 0.0 {
            self.anchors[self.at] = Some(Anchor { up, sigma, age_s: 0.0, drifted: 0.0 });
            self.at = (self.at + 1) % CARRIED;
            self.next_s = APART_S;
        }
        most
    }
}

impl FieldEstimator {
    /// Takes in a gyro's rates, while it is believed, for `dt_s`.
    pub(super) fn carry_on(&mut self, dt_s: f64) {
        let Some(rates) = self.gyro.rates() else {
            self.carried = Carried::default();
            return;
        };
        let known = (0..3).map(|i| self.state.p[RATE + i][RATE + i]).fold(0.0, f64::max).sqrt();
        self.carried.carry(rates, (correction(&self.state), known), dt_s);
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
            let rates = [said + bias, 0.0, 0.0].map(f64::to_radians);
            carried.carry(rates, ([-bias.to_radians(), 0.0, 0.0], KNOWN), 0.02);
            carried.parts(up(seen * 0.02 * f64::from(i)), sigma(1.0)).to_degrees()
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
        let still = |carried: &mut Carried| {
            carried.carry([0.0; 3], ([0.0; 3], KNOWN), 0.02);
            carried.parts(up(30.0), sigma(1.0))
        };
        let lasts_s = (0..).take_while(|_| still(&mut carried) > 0.0).count() as f64 * 0.02;
        assert!((15.0..30.0).contains(&lasts_s), "{lasts_s} s");
        gone.carry([0.0; 3], ([0.0; 3], KNOWN), 1.0);
        assert_eq!(still(&mut gone), 0.0);
    }

    /// Begun anew the filter knows its bias less well, and nothing of the gyro has changed.
    #[test]
    fn the_best_that_was_known_of_the_bias_is_kept() {
        let mut carried = Carried::default();
        carried.carry([0.0; 3], ([0.01, 0.0, 0.0], KNOWN), 0.02);
        carried.carry([0.0; 3], ([0.0; 3], 0.02), 0.02);
        assert!(carried.bias.is_some_and(|(bias, known)| bias[0] == 0.01 && known < 1.01 * KNOWN));
    }
}
