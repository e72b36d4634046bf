//! A head that turns otherwise than a gyro says, or than the turns and climbs that are flown: wired the other way round.

mod ways;

use super::debounce::Debounce;
use super::{ActiveFault, Evidence, FaultKind};
use crate::attitude::Attitude;
use crate::estimator::references::Angle;
use crate::estimator::{Otherwise, Solution};
use crate::time::Time;
use std::f64::consts::PI;
use ways::Ways;

pub(super) use ways::{ASKEW, REMEMBERED_S, beside_askew};

/// Seconds for which it must be gone; the method has taken its time to find it.
const GONE_S: f64 = 3.0;
/// Without a reference for so long, s, none is heard.
const STALE_S: f64 = 5.0;
/// The percentage of the squares of what turns that is left, from which on it turns otherwise.
const LIMIT: f64 = 70.0;

/// Sees that roll, or pitch, turns the other way round. Without a gyro or GPS it says nothing.
#[derive(Clone, Debug)]
pub struct Wired {
    /// Roll and pitch.
    angles: [Debounce; 2],
    left: f64,
    doubt: Attitude,
    ways: Ways,
    /// When the last reference came.
    heard: Option<Time>,
}

impl Default for Wired {
    fn default() -> Self {
        Self {
            angles: [Debounce::new(0.0, GONE_S); 2],
            left: 0.0,
            doubt: Attitude::default(),
            ways: Ways::default(),
            heard: None,
        }
    }
}

impl Wired {
    /// Takes in what a method makes of a frame.
    pub fn update(&mut self, solution: &Solution, now: Time) {
        let by_references = solution.attitude.and_then(|is| self.ways.found(is));
        // A gyro may sit otherwise than the head, and the head be right: what is flown knows which.
        let hears = self.heard.is_some_and(|at| (0.0..STALE_S).contains(&now.since(at)));
        let found = by_references.or(solution.wired.filter(|_| !hears && !self.ways.acquits()));
        let angles = found.map_or([false; 2], |otherwise| otherwise.angles);
        for (angle, there) in self.angles.iter_mut().zip(angles) {
            angle.update(there, now);
        }
        let both = solution.attitude.zip(found);
        self.doubt = both.map_or_else(Attitude::default, |(is, Otherwise { attitude, .. })| {
            let apart = (is.roll - attitude.roll).abs() % (2.0 * PI);
            Attitude { roll: apart.min(2.0 * PI - apart), pitch: (is.pitch - attitude.pitch).abs() }
        });
        self.left = found.map_or(self.left, |otherwise| 100.0 * otherwise.left);
    }

    /// Takes in an attitude and the bank and angle of climb that came with it.
    pub fn compare(&mut self, attitude: Attitude, references: [Option<Angle>; 2], now: Time) {
        if references.iter().any(Option::is_some) {
            self.heard = Some(now);
        }
        self.ways.update(attitude, references);
    }

    /// What to add to the standard deviations of roll and pitch: how far off they are if the head is wired so.
    pub fn doubt(&self) -> Attitude {
        self.doubt
    }

    /// Whether `angle` (0 is roll, 1 pitch) turns otherwise.
    pub fn tells(&self, angle: usize) -> bool {
        self.angles[angle].is_active()
    }

    /// Adds `kind` to `faults` where `angle` (0 is roll, 1 pitch) turns otherwise.
    pub fn report(&self, angle: usize, kind: FaultKind, faults: &mut Vec<ActiveFault>) {
        let evidence = Evidence::Limit { value: self.left, limit: LIMIT, unit: "%" };
        self.angles[angle].report(kind, evidence, faults);
    }
}

#[cfg(test)]
mod tests {
    use super::super::kit::{at, told};
    use super::*;

    fn said(wired: &Wired) -> Vec<FaultKind> {
        told(|faults| {
            wired.report(0, FaultKind::RollDisagrees, faults);
            wired.report(1, FaultKind::PitchDisagrees, faults);
        })
        .iter()
        .map(|t| t.0)
        .collect()
    }

    /// One reference says little, and is not heard for ever.
    #[test]
    fn a_gyro_tells_where_nothing_that_is_flown_does() {
        let attitude = Attitude::from_degrees(20.0, 0.0);
        let other = Otherwise { attitude: Attitude::from_degrees(-20.0, 0.0), angles: [true, false], left: 3.9 };
        let solution = Solution { attitude: Some(attitude), wired: Some(other), ..Solution::default() };
        let bank = |deg: f64| Some(Angle { angle: deg.to_radians(), sigma: 0.14, stays: 0.0, span_s: 1.0 });
        for (seconds, acquitted) in [(1, false), (120, true)] {
            let mut wired = Wired::default();
            for s in 0..seconds {
                let deg = 30.0 * (0.2 * f64::from(s)).sin();
                wired.compare(Attitude::from_degrees(deg, 0.0), [bank(deg), None], at(f64::from(s)));
            }
            let last = f64::from(seconds);
            wired.update(&solution, at(last));
            assert_eq!(said(&wired), [], "while it is heard");
            wired.update(&solution, at(last + 2.0 * STALE_S));
            assert_eq!(said(&wired).is_empty(), acquitted, "{seconds} s");
        }
    }

    #[test]
    fn what_turns_the_other_way_round_is_told_and_doubted_by_all_that_it_may_be_off() {
        let attitude = Some(Attitude::from_degrees(170.0, 10.0));
        let other = Otherwise { attitude: Attitude::from_degrees(-170.0, 10.0), angles: [true, false], left: 3.9 };
        let mut wired = Wired::default();
        wired.update(&Solution { attitude, ..Solution::default() }, at(1.0));
        assert_eq!((said(&wired), wired.doubt()), (vec![], Attitude::default()));
        wired.update(&Solution { attitude, wired: Some(other), ..Solution::default() }, at(2.0));
        assert_eq!(said(&wired), [FaultKind::RollDisagrees]);
        assert!((wired.doubt().roll.to_degrees() - 20.0).abs() < 1e-9 && wired.doubt().pitch == 0.0);
        // Where it is decided that it was the gyro, it ends.
        for (t, kinds) in [(3.0, 1), (5.9, 1), (6.0, 0)] {
            wired.update(&Solution { attitude, ..Solution::default() }, at(t));
            assert_eq!((said(&wired).len(), wired.doubt()), (kinds, Attitude::default()), "{t} s");
        }
    }
}
