//! Contrast the wrong way round: hail on the ground (report section V.3).

use super::debounce::{Debounce, State};
use super::{ActiveFault, Evidence, FaultKind};
use crate::estimator::Solution;
use crate::estimator::sides::{BACK_S, HAIL_K};
use crate::estimator::vector::length;
use crate::time::Time;

/// Seconds for which ground and sky must be exchanged, and must be upright again by more than any hail makes the sky warmer; by
/// less, as they look to an aircraft on its back over hail, for [`BACK_S`].
const LASTS_S: (f64, f64) = (0.1, 1.0);
/// They are exchanged beyond this share of the least contrast: with less the contrast is low.
const REVERSED: f64 = 0.5;

/// Sees `inverted-contrast`. What tells it from an aircraft on its back is how it comes about: a method that knows
/// inverted flight follows the vertical round by degrees, and says that ground and sky are exchanged only where
/// the contrast went through nothing ([`crate::estimator::sides`]).
#[derive(Clone, Copy, Debug)]
pub struct Inverted {
    limit_k: f64,
    inverted: Debounce,
    vertical_k: f64,
    upright_since: Option<Time>,
}

impl Inverted {
    /// With the contrast below which there is no attitude, K.
    pub fn new(low_k: f64) -> Self {
        let inverted = Debounce::new(LASTS_S.0, LASTS_S.1);
        Self { limit_k: -REVERSED * low_k, inverted, vertical_k: 0.0, upright_since: None }
    }

    /// Another contrast below which there is no attitude, K.
    pub fn retune(&mut self, low_k: f64) {
        self.limit_k = -REVERSED * low_k;
    }

    /// Takes in what was seen at `now`. A frame in which nothing was seen changes nothing.
    pub fn update(&mut self, solution: &Solution, now: Time) -> State {
        let Some(seen @ [_, _, z]) = solution.seen_k else { return self.inverted.state() };
        // What a method goes by may still be upside down.
        let z = solution.contrast_k.map_or(z, |contrast| contrast.min(z));
        self.vertical_k = z;
        self.upright_since = (z >= 0.0).then(|| self.upright_since.unwrap_or(now));
        let for_long = self.upright_since.is_some_and(|since| now.since(since) > BACK_S - LASTS_S.1);
        let limit_k = match (self.inverted.is_active(), for_long) {
            (false, _) => self.limit_k,
            (true, false) => HAIL_K,
            (true, true) => 0.0,
        };
        // Where nothing is seen, nothing is seen the wrong way round, whatever a method still goes by.
        let shown = self.inverted.is_active() || length(seen) > -self.limit_k;
        self.inverted.update(shown && z < limit_k, now)
    }

    /// Adds what is there to `faults`.
    pub fn report(&self, faults: &mut Vec<ActiveFault>) {
        let evidence = Evidence::Limit { value: self.vertical_k, limit: self.limit_k, unit: "K" };
        self.inverted.report(FaultKind::InvertedContrast, evidence, faults);
    }
}

#[cfg(test)]
mod tests {
    use super::super::kit::{at, seen, told, value};
    use super::*;

    #[test]
    fn it_is_told_beyond_half_the_least_contrast_and_ends_when_all_is_upright() {
        let mut inverted = Inverted::new(2.0);
        let mut time_s = 10.0;
        for (seconds, z, expected) in [
            (5.0, Some(30.0), State::Clear),
            (5.0, Some(-0.9), State::Clear),
            (0.04, Some(-1.1), State::Suspected),
            // Nothing seen changes nothing, however long it lasts.
            (5.0, None, State::Suspected),
            (0.04, Some(-1.1), State::Active),
            (5.0, Some(-0.1), State::Active),
            (5.0, None, State::Active),
            (0.96, Some(10.1), State::Active),
            (0.1, Some(10.1), State::Clear),
            (0.2, Some(-1.1), State::Active),
            // So little is what hail shows to an aircraft on its back.
            (9.9, Some(4.0), State::Active),
            (0.2, Some(4.0), State::Clear),
        ] {
            let mut state = inverted.update(&Solution::default(), at(time_s));
            for _ in 0..(seconds / 0.02_f64).round() as u32 {
                time_s += 0.02;
                state = inverted.update(&z.map_or_else(Solution::default, seen), at(time_s));
            }
            assert_eq!(state, expected, "{seconds} s of {z:?}");
            let told = told(|f| inverted.report(f));
            assert_eq!(told.len(), usize::from(expected == State::Active));
            assert!(told.iter().all(|t| t.0 == FaultKind::InvertedContrast && value(t).1 == "K"));
        }
    }

    /// What one frame shows is upright, what the method goes by is not.
    #[test]
    fn a_method_that_is_upside_down_itself_is_told_too() {
        for (seen_k, contrast_k, expected) in [
            (3.0, Some(-1.1), State::Active),
            (3.0, Some(3.0), State::Clear),
            (3.0, None, State::Clear),
            // It goes by what is not there any more.
            (0.0, Some(-1.1), State::Clear),
        ] {
            let mut inverted = Inverted::new(2.0);
            let solution = Solution { contrast_k, ..seen(seen_k) };
            let state = (0..10).map(|i| inverted.update(&solution, at(10.0 + 0.02 * f64::from(i)))).last();
            assert_eq!(state, Some(expected), "{seen_k} {contrast_k:?}");
        }
    }

    #[test]
    fn a_moment_is_none() {
        let mut inverted = Inverted::new(2.0);
        for i in 0..500 {
            let z = if i % 5 == 0 { 3.0 } else { -3.0 };
            assert_ne!(inverted.update(&seen(z), at(10.0 + 0.02 * f64::from(i))), State::Active);
        }
    }
}
