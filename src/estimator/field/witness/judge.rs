//! From surprises to standings.

use super::super::model::Scene;
use super::case::{Case, many};
use super::other::opposed;
use super::{Model, Rival, Witnesses};
use crate::estimator::Standing;

/// From this sum of surprises on a sensor is left out, if it is so much ahead of all others for some time.
const CONVICT: f64 = 20.0;
const AHEAD: f64 = 5.0;
/// So much less the verdict that has been found right surprises.
const SURE: f64 = 30.0;
/// A sensor below this sine above the horizon sees more of it than of sky or ground.
const LEVEL: f64 = 0.7;
/// A film makes two that look apart suspect, and while neither is heard nothing tells of the attitude but a gyro: without
/// one, from this sum on, one of them is heard if it is less suspect by so much.
const SURELY: f64 = 40.0;
const NEARLY: f64 = 2.0;
/// Of two that look up and down the one that is off so many times less is not suspect: what the other does looks like a cloud to
/// who does not hear this one, and leaves it a little off.
const FARTHER: f64 = 3.0;
/// More sensors than so many, each with such a share of what the most suspect one surprises by, are no sensor's matter.
const COMMON: (usize, f64) = (3, 0.5);
/// As many sensors can be doubted at once; more are no sensors' matter.
const DOUBTED: usize = 2;

impl Witnesses {
    /// Hears again whom the others confirm, doubts, and leaves out. `enough`: as many are heard as that takes;
    /// `second`: one is left out already.
    pub(super) fn judge(&mut self, model: &Model, own_k: f64, enough: bool, second: bool) {
        let n = model.sensors();
        if let Some(i) = self.cases[..n].iter().position(Case::is_acquitted) {
            self.cases[i] = Case::default();
            self.rival = None;
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
        let most = cases.iter().filter(|c| c.is_suspect(self.even)).map(|c| c.surprise).reduce(f64::max);
        let most = most.unwrap_or(f64::INFINITY);
        // Where not to hear any of several is worth as much, the witness who hears all has lost its way: at a wall, in a valley.
        let worth = |c: &&Case| c.standing != Standing::LeftOut && c.surprise > COMMON.1 * most;
        let common = cases.iter().filter(worth).count() > COMMON.0;
        let film = self.film(model).filter(|_| enough && !second);
        let enough = enough && !common && self.elsewhere() < most - AHEAD;
        let leads = |c: &Case| enough && c.standing != Standing::LeftOut && c.surprise > most - AHEAD;
        let (cases, steady) = (&mut self.cases[..n], &self.steady);
        let upright = (0..n).filter(|i| is_upright(model, *i) && leads(&cases[*i]));
        let farthest_k = upright.filter_map(|i| cases[i].residual_k).fold(0.0, |most: f64, k| most.max(k.abs()));
        let is_near = |c: &Case| c.residual_k.is_some_and(|k| FARTHER * k.abs() < farthest_k);
        let spared = |i: usize| steady.spares(model, i);
        let plausible = |i: usize, c: &Case| leads(c) && !(is_upright(model, i) && is_near(c)) && !spared(i);
        let count = cases.iter().enumerate().filter(|(i, c)| plausible(*i, c)).count();
        let apart = level_pairs(model).any(|(i, j)| plausible(i, &cases[i]) && plausible(j, &cases[j]));
        let nearly = if apart && most > SURELY && self.shown.is_none() { NEARLY } else { AHEAD };
        let mut convicted = None;
        for (i, case) in cases.iter_mut().enumerate() {
            let plausible = plausible(i, case);
            let alone = plausible && count == 1 && case.is_guilty() && most > many(second) * CONVICT;
            if case.leads(alone) {
                convicted = Some(i);
            }
            if case.standing != Standing::LeftOut {
                let doubted = plausible && count <= DOUBTED && case.surprise > most - nearly;
                case.standing = if doubted { Standing::Doubted } else { Standing::Heard };
            }
        }
        if let Some(k) = convicted.or(film) {
            self.cases[k].standing = Standing::LeftOut;
            let all = self.without[k].clone();
            self.rival = self.rival_to(k, model);
            self.swear(model, all);
        }
    }

    /// The one sensor that a film is on.
    fn film(&self, model: &Model) -> Option<usize> {
        let is_one = |i: &usize| self.cases[*i].has_film(is_upright(model, *i)) && !self.steady.spares(model, *i);
        let mut films = (0..model.sensors()).filter(is_one);
        films.next().filter(|_| films.next().is_none())
    }

    /// The other verdict beside that on sensor `k`; a gyro tells which of the two is to blame.
    pub(super) fn rival_to(&self, k: usize, model: &Model) -> Option<Rival> {
        let (i, j) = level_pairs(model).find(|(i, j)| *i == k || *j == k)?;
        let other = if i == k { j } else { i };
        let behind = self.cases[k].surprise - self.cases[other].surprise;
        let open = self.cases[other].standing != Standing::LeftOut && self.shown.is_none();
        open.then(|| Rival::new((other, k), self.without[other].clone(), behind))
    }

    /// Exchanges the verdicts if the other one is found to be right; whether it was.
    pub(super) fn reconsider(&mut self, model: &Model, sky: &Scene) -> bool {
        let Some(rival) = &self.rival else { return false };
        let (k, culprit) = (rival.left_out, rival.culprit);
        if rival.is_right() {
            self.revised = Some(rival.witness.told(sky));
            let all = rival.witness.clone();
            self.cases[k] = Case::default();
            self.cases[culprit].standing = Standing::LeftOut;
            self.rival = self.all.take().map(|all| Rival::new((k, culprit), all, SURE));
            self.swear(model, all);
            return true;
        }
        if rival.is_wrong() {
            self.rival = None;
        }
        false
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

/// The pairs that look apart and along the horizon: what is too warm for one of them is so for the other.
pub fn level_pairs(model: &Model) -> impl Iterator<Item = (usize, usize)> {
    opposed(model).filter(|(i, _)| !is_upright(model, *i))
}

/// Whether sensor `i` looks up or down.
pub fn is_upright(model: &Model, i: usize) -> bool {
    model.direction(i)[2].abs() >= LEVEL
}
