//! Roll that is always the same share of the bank that is flown: what all is divided by is wrong.

use super::{FLYING, LASTS_S, STALE_S};
use crate::attitude::Attitude;
use crate::estimator::references::{Angle, STEEPEST};
use crate::fault::debounce::Debounce;
use crate::fault::wired::{REMEMBERED_S, beside_askew};
use crate::fault::{ActiveFault, Evidence, FaultKind};
use crate::time::Time;

/// So many times roll what is flown must be, and is no more below the second.
const SMALL: (f64, f64) = (1.3, 1.15);
/// So many times what is flown roll must be: GPS smooths what it says of turns.
const LARGE: (f64, f64) = (1.5, 1.3);
/// By so much the squares of the difference, in σ², must be smaller without it.
const SMALLER: f64 = 9.0;

/// Sees that roll is too small, or too large, by a factor. Where nothing is flown but straight on it says nothing.
#[derive(Clone, Debug)]
pub struct Scale {
    /// The sums of weights, of roll, of bank, and of their squares and product, faded.
    sums: [f64; 6],
    heard: Option<Time>,
    /// Whether it is there, by the last that was heard.
    there: bool,
    /// What is flown to what is shown.
    factor: f64,
    amiss: Debounce,
    doubt: Attitude,
}

impl Default for Scale {
    fn default() -> Self {
        Self {
            sums: [0.0; 6],
            heard: None,
            there: false,
            factor: 1.0,
            amiss: Debounce::new(LASTS_S.0, LASTS_S.1),
            doubt: Attitude::default(),
        }
    }
}

impl Scale {
    /// Takes in the mean of roll over the time of a turn, and the bank of that turn.
    pub fn compare(&mut self, roll: f64, bank: Angle, now: Time) {
        // How steep a steep one is nobody knows: it tells nothing where roll is steep, too.
        let bank = Angle { angle: bank.angle.clamp(-STEEPEST, STEEPEST), ..bank };
        if roll.abs() >= STEEPEST && bank.angle.abs() >= STEEPEST {
            return;
        }
        let since_s = self.heard.replace(now).map_or(0.0, |heard| now.since(heard).max(0.0));
        let keep = (-since_s / REMEMBERED_S).exp();
        let weight = bank.weight();
        let new = [1.0, roll, bank.angle, roll * roll, roll * bank.angle, bank.angle * bank.angle];
        self.sums.iter_mut().zip(new).for_each(|(sum, new)| *sum = keep * *sum + weight * new);
        self.find();
    }

    fn find(&mut self) {
        let [weights, roll, bank, shown, both, flown] = self.sums;
        let [shown, both, flown] = [(shown, [roll; 2]), (both, [roll, bank]), (flown, [bank; 2])]
            .map(|(product, sums)| beside_askew(product, sums, weights));
        // By the noise of what divides a quotient is too small: each is asked only whether it is too large.
        let asked = [(shown, SMALL), (flown, LARGE)].map(|(divisor, (on, off))| {
            let times = both / divisor;
            let smaller = (both - divisor).powi(2) / divisor;
            let least = if self.amiss.is_active() { off } else { on };
            (times > least && smaller > SMALLER).then_some(times)
        });
        self.there = asked.iter().any(Option::is_some);
        self.factor = asked[0].or(asked[1].map(f64::recip)).unwrap_or(self.factor);
    }

    /// Takes in that `attitude` is shown now.
    pub fn judge(&mut self, attitude: Attitude, now: Time) {
        let heard = self.heard.is_some_and(|at| (0.0..STALE_S).contains(&now.since(at)));
        self.amiss.update(self.there && heard, now);
        let off = if self.amiss.is_active() { (self.factor - 1.0).abs() } else { 0.0 };
        self.doubt = Attitude { roll: off * attitude.roll.abs().min(FLYING.roll), pitch: off * attitude.pitch.abs() };
    }

    /// How far roll and pitch may be off for it: both are divided by the same.
    pub fn doubt(&self) -> Attitude {
        self.doubt
    }

    /// Adds `roll-disagrees` to `faults` while it is there, with how much of what is flown is shown.
    pub fn report(&self, faults: &mut Vec<ActiveFault>) {
        let limit = if self.factor > 1.0 { SMALL.0.recip() } else { LARGE.0 };
        let [value, limit] = [self.factor.recip(), limit].map(|share| 100.0 * share);
        self.amiss.report(FaultKind::RollDisagrees, Evidence::Limit { value, limit, unit: "%" }, faults);
    }
}
