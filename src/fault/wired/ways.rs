//! How a head would have to be wired for its roll and pitch to be those of the turns and climbs that are flown.

use crate::attitude::Attitude;
use crate::estimator::Otherwise;
use crate::estimator::references::{Angle, STEEPEST};
use crate::estimator::vector::{Vector, add_scaled};
use crate::estimator::wiring::Wiring;

/// What is compared is remembered for about so long, s: to roll and to pitch hardly more than once a minute is usual.
pub const REMEMBERED_S: f64 = 120.0;
/// By so much the squares of what is left, in σ², are smaller by the way that is believed than as it is configured, and
/// such a share is left at most of these and of what is flown; above the second share it is believed no more.
const SMALLER: f64 = 30.0;
const LEFT: (f64, f64) = (0.3, 0.6);
/// Ways that differ by less are about as good, σ².
const AS_GOOD: f64 = 10.0;
/// A head may sit askew by about so much (1σ), rad: what is always the same of a difference tells no more.
pub const ASKEW: f64 = 8_f64.to_radians();

/// What a head that sits askew does not explain of the weighted sum `product` of two values whose weighted sums are `sums`.
pub fn beside_askew(product: f64, sums: [f64; 2], weights: f64) -> f64 {
    product - sums[0] * sums[1] / (weights + ASKEW.powi(-2))
}

/// Compares what is flown with each way to wire the head.
#[derive(Clone, Debug, Default)]
pub struct Ways {
    /// The sum of verticals since the last reference of each angle.
    verticals: [Vector; 2],
    /// Of roll and of pitch, what is flown.
    flown: [Squares; 2],
    /// What each way leaves of it.
    left: [[Squares; Wiring::ALL.len()]; 2],
    found: Option<Wiring>,
}

/// The sums over the time that is remembered of weights, weighted values and their weighted squares.
#[derive(Clone, Copy, Debug, Default)]
struct Squares([f64; 3]);

impl Squares {
    fn take(&mut self, value: f64, weight: f64, keep: f64) {
        let new = [1.0, value, value.powi(2)];
        self.0.iter_mut().zip(new).for_each(|(sum, new)| *sum = keep * *sum + weight * new);
    }

    /// The squares without what a head that sits askew explains of them, σ².
    fn sum(&self) -> f64 {
        let [weights, values, squares] = self.0;
        beside_askew(squares, [values; 2], weights)
    }
}

impl Ways {
    /// Takes in an attitude and the bank and angle of climb that came with it.
    pub fn update(&mut self, attitude: Attitude, references: [Option<Angle>; 2]) {
        for (angle, reference) in references.into_iter().enumerate() {
            let sum = &mut self.verticals[angle];
            *sum = add_scaled(*sum, 1.0, attitude.vertical());
            if let Some(reference) = reference {
                let mean = Attitude::from_vertical(std::mem::take(sum));
                self.compare(mean, angle, reference);
                self.judge();
            }
        }
    }

    /// Takes in that `mean` was shown over the time of a reference of roll (0) or pitch (1).
    fn compare(&mut self, mean: Attitude, angle: usize, reference: Angle) {
        let keep = (-reference.span_s / REMEMBERED_S).exp();
        let weight = reference.weight();
        // How steep a steep one is nobody knows.
        let within = |a: f64| a.clamp(-STEEPEST, STEEPEST);
        let flown = within(reference.angle);
        self.flown[angle].take(flown, weight, keep);
        for (left, way) in self.left[angle].iter_mut().zip(Wiring::ALL) {
            let Attitude { roll, pitch } = way.attitude(mean);
            left.take(within([roll, pitch][angle]) - flown, weight, keep);
        }
    }

    /// What each way leaves of what is flown, σ².
    fn left(&self) -> [f64; Wiring::ALL.len()] {
        std::array::from_fn(|way| self.left.iter().map(|left| left[way].sum()).sum())
    }

    /// Whether what is flown is as the head shows it, and so much of it that no other way of wiring would.
    pub fn acquits(&self) -> bool {
        let [as_configured, ..] = self.left();
        self.found.is_none() && self.flown() - as_configured > SMALLER
    }

    /// What is flown, σ².
    fn flown(&self) -> f64 {
        self.flown.iter().map(Squares::sum).sum()
    }

    fn judge(&mut self) {
        let lefts = self.left();
        let [as_configured, ..] = lefts;
        // That pitch alone is the other way round may be an autopilot that says its climb upside down.
        let others = || lefts.iter().zip(Wiring::ALL).skip(1).filter(|(_, way)| way.angles()[0]);
        let least = others().map(|(left, _)| *left).fold(f64::INFINITY, f64::min);
        // Of those that are about as good the one that changes least.
        let best = others().find(|(left, _)| **left <= least + AS_GOOD);
        let Some((left, way)) = best else { return };
        let kept = self.found.filter(|_| *left < LEFT.1 * as_configured);
        let believed = as_configured - left > SMALLER && *left < LEFT.0 * as_configured.min(self.flown());
        self.found = if believed { Some(way) } else { kept };
    }

    /// The head as it would be wired, which shows `attitude` now; `None` where it is as it is configured, or nothing tells.
    pub fn found(&self, attitude: Attitude) -> Option<Otherwise> {
        let way = self.found?;
        let [as_configured, ..] = self.left();
        let left = as_configured / self.flown().max(f64::MIN_POSITIVE);
        Some(Otherwise { attitude: way.attitude(attitude), angles: way.angles(), left })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Circuits with turns to both sides and climbs, as `shown` shows them: what is found after so many seconds, and how
    /// much of what is flown is left.
    fn found(seconds: u32, shown: impl Fn(Attitude) -> Attitude) -> Option<Otherwise> {
        flown(seconds, 1.0, |_, is| shown(is))
    }

    /// The same with turns and climbs of such a share, and what is shown at a time.
    fn flown(seconds: u32, share: f64, shown: impl Fn(f64, Attitude) -> Attitude) -> Option<Otherwise> {
        let mut ways = Ways::default();
        let mut attitude = Attitude::default();
        for i in 0..seconds * 10 {
            let t = 0.1 * f64::from(i);
            let is = (30.0 * (0.2 * t).sin().powi(3), 8.0 * (0.07 * t).sin());
            attitude = Attitude::from_degrees(share * is.0, share * is.1);
            // A reference each second, off by what a gust does.
            let gust = 4.0_f64.to_radians() * (1.7 * t).sin();
            let is = |angle: f64, sigma: f64| Some(Angle { angle: angle + gust, sigma, stays: 0.0, span_s: 1.0 });
            let references = if i % 10 == 0 { [is(attitude.roll, 0.14), is(attitude.pitch, 0.07)] } else { [None; 2] };
            ways.update(shown(t, attitude), references);
        }
        ways.found(shown(f64::from(seconds), attitude))
    }

    #[test]
    fn each_way_to_wire_a_head_is_found_and_a_right_one_is_let_be() {
        for way in Wiring::ALL.into_iter().skip(1) {
            // What it shows is what undoes it to the attitude.
            let shown = |is: Attitude| {
                let is_shown = |w: &Wiring| {
                    let a = way.attitude(w.attitude(is));
                    (a.roll - is.roll).abs() < 1e-9 && (a.pitch - is.pitch).abs() < 1e-9
                };
                Wiring::ALL.into_iter().find(is_shown).unwrap().attitude(is)
            };
            let told = found(120, shown);
            if !way.angles()[0] {
                assert_eq!(told, None, "the climb is upside down");
                continue;
            }
            let told = told.unwrap_or_else(|| panic!("{way:?}"));
            assert_eq!(told.angles, way.angles(), "{way:?}");
            let back = way.attitude(shown(Attitude::from_degrees(20.0, 5.0)));
            assert!((back.roll.to_degrees() - 20.0).abs() < 1e-6 && told.left > 0.7, "{way:?}: {told:?}");
        }
        let off = |roll: f64, pitch: f64| {
            move |is: Attitude| Attitude::from_degrees(is.roll.to_degrees() + roll, is.pitch.to_degrees() + pitch)
        };
        for (roll, pitch) in [(0.0, 0.0), (15.0, 0.0), (-25.0, 0.0), (0.0, 15.0), (10.0, -10.0)] {
            assert_eq!(found(300, off(roll, pitch)), None, "{roll} {pitch}");
        }
        // Nor is an error that comes when hardly anything is flown, or while much is.
        for share in [0.1, 1.0] {
            for (roll, pitch) in [(0.0, 15.0), (20.0, 0.0), (-20.0, 15.0)] {
                let late = |t: f64, is: Attitude| if t < 100.0 { is } else { off(roll, pitch)(is) };
                assert_eq!(flown(150, share, late), None, "{share} {roll} {pitch}");
            }
        }
        // Half of what is flown, as with a wet pair, and none of it, is not the other way round.
        for share in [0.5, 0.0] {
            let shown = |is: Attitude| Attitude { roll: share * is.roll, ..is };
            assert_eq!(found(300, shown), None, "{share}");
        }
    }
}
