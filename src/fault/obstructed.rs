//! A scene that is not one horizon: ridge, valley, cloud bank (report sections V.1 and V.2).

use super::debounce::Debounce;
use super::{ActiveFault, Evidence, FaultKind};
use crate::estimator::Solution;
use crate::time::Time;

/// Seconds for which it must be seen, and must be gone.
const LASTS_S: (f64, f64) = (1.0, 3.0);
/// It is gone below this share of the limit.
const HYSTERESIS: f64 = 0.8;

/// Sees `obstructed`: what no attitude under any even sky explains might hide a tilt too large to be left unsaid.
#[derive(Clone, Copy, Debug)]
pub struct Obstructed {
    limit: f64,
    obstructed: Debounce,
    hidden: f64,
}

impl Obstructed {
    /// With the tilt that may be hidden, rad.
    pub fn new(limit: f64) -> Self {
        Self { limit, obstructed: Debounce::new(LASTS_S.0, LASTS_S.1), hidden: 0.0 }
    }

    /// Another tilt that may be hidden, rad.
    pub fn retune(&mut self, limit: f64) {
        self.limit = limit;
    }

    /// Takes in what was seen at `now`.
    pub fn update(&mut self, solution: &Solution, now: Time) {
        let Some(hidden) = solution.hidden else { return };
        self.hidden = hidden;
        let limit = if self.obstructed.is_active() { HYSTERESIS * self.limit } else { self.limit };
        self.obstructed.update(hidden > limit, now);
    }

    /// Nothing can be seen of it for now: what it was before says nothing of after.
    pub fn rest(&mut self) {
        self.obstructed.rest();
    }

    /// Whether it is.
    pub fn is_active(&self) -> bool {
        self.obstructed.is_active()
    }

    /// Adds what is there to `faults`.
    pub fn report(&self, faults: &mut Vec<ActiveFault>) {
        let [value, limit] = [self.hidden, self.limit].map(f64::to_degrees);
        self.obstructed.report(FaultKind::Obstructed, Evidence::Limit { value, limit, unit: "°" }, faults);
    }
}

#[cfg(test)]
mod tests {
    use super::super::kit::{at, told, value};
    use super::*;

    #[test]
    fn it_is_told_after_a_second_and_ends_three_after_there_is_clearly_less() {
        let mut obstructed = Obstructed::new(6_f64.to_radians());
        let mut time_s = 10.0;
        for (seconds, hidden_deg, expected) in [
            (5.0, Some(5.9), false),
            (0.9, Some(6.1), false),
            (0.2, Some(5.9), false),
            (1.1, Some(6.1), true),
            (9.0, Some(4.9), true),
            (9.0, None, true),
            (2.9, Some(4.7), true),
            (0.2, Some(4.7), false),
            (9.0, None, false),
            (9.0, Some(f64::NAN), false),
        ] {
            for _ in 0..(seconds / 0.02_f64).round() as u32 {
                time_s += 0.02;
                let hidden = hidden_deg.map(f64::to_radians);
                obstructed.update(&Solution { hidden, ..Solution::default() }, at(time_s));
            }
            let told = told(|f| obstructed.report(f));
            assert_eq!(told.len(), usize::from(expected), "{seconds} s of {hidden_deg:?}°");
            assert!(told.iter().all(|t| t.0 == FaultKind::Obstructed && value(t).1 == "°"));
        }
    }
}
