//! From surprises to standings.

use super::case::{Case, many};
use super::{Model, Witnesses};
use crate::estimator::Standing;

/// From this sum of surprises on a sensor is left out, if it is so much ahead of all others,
const CONVICT: f64 = 20.0;
const AHEAD: f64 = 5.0;
/// in so many steps.
const STEPS: u8 = 3;
/// As many sensors can be doubted at once; more are no sensors' matter.
const DOUBTED: usize = 2;

impl Witnesses {
    /// Hears again whom the others confirm, doubts, and leaves out. `enough`: as many are heard as that takes;
    /// `second`: one is left out already.
    pub(super) fn judge(&mut self, model: &Model, own_k: f64, enough: bool, second: bool) {
        let n = model.sensors();
        if let Some(i) = self.cases[..n].iter().position(Case::is_acquitted) {
            self.cases[i] = Case::default();
            if let Some(all) = self.all.take() {
                self.swear(model, all.hearing(i, own_k));
            }
            return;
        }
        let cases = &mut self.cases[..n];
        if cases.iter().any(Case::is_small_matter) && !cases.iter().any(Case::is_grave) {
            return self.restart();
        }
        // Once one is suspect all are as surprising that might be the cause as well.
        let most = cases.iter().filter(|c| c.is_suspect()).map(|c| c.surprise).reduce(f64::max);
        let most = most.unwrap_or(f64::INFINITY);
        let enough = enough && self.elsewhere() < most - AHEAD;
        let plausible = |c: &Case| enough && c.standing != Standing::LeftOut && c.surprise > most - AHEAD;
        let cases = &mut self.cases[..n];
        let count = cases.iter().filter(|c| plausible(c)).count();
        let mut convicted = None;
        for (i, case) in cases.iter_mut().enumerate() {
            let plausible = plausible(case);
            let alone = plausible && count == 1 && case.is_guilty() && most > many(second) * CONVICT;
            case.ahead = if alone { case.ahead + 1 } else { 0 };
            if case.ahead >= STEPS {
                convicted = Some(i);
            }
            if case.standing != Standing::LeftOut {
                let doubted = plausible && count <= DOUBTED;
                case.standing = if doubted { Standing::Doubted } else { Standing::Heard };
            }
        }
        if let Some(k) = convicted {
            self.cases[k].standing = Standing::LeftOut;
            let all = self.without[k].clone();
            self.swear(model, all);
        }
    }

    /// Whether a sensor surprises, or few do, and it is not decided which is to be left out.
    pub fn undecided(&self) -> bool {
        let most =
            self.cases.iter().filter(|c| c.standing != Standing::LeftOut).map(|c| c.surprise).fold(0.0, f64::max);
        most > self.elsewhere().max(0.0)
    }

    /// How much less the readings surprise where no sensor is to blame: the gyro is, or the weather.
    fn elsewhere(&self) -> f64 {
        self.others.iter().map(|o| o.surprise).fold(f64::NEG_INFINITY, f64::max)
    }
}
