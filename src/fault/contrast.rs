//! Too little contrast, and contrast the wrong way round.

use super::debounce::{Debounce, State};
use super::{ActiveFault, Evidence, FaultKind};
use crate::estimator::Solution;
use crate::time::Time;

/// A fault of contrast ends where this much more than its limit is seen.
const HYSTERESIS: f64 = 1.25;

/// Seconds for which the contrast must be low, and must be back.
const LOW_S: (f64, f64) = (0.2, 1.0);

/// Seconds for which the vertical pair must be reversed, and must be upright again.
const INVERTED_S: (f64, f64) = (0.1, 1.0);

/// Sees fog and heavy overcast (`low-contrast`), and hail on the ground or the aircraft on its back
/// (`inverted-contrast`; report section V.3). A single frame does not tell the last two apart.
#[derive(Clone, Copy, Debug)]
pub struct ContrastDetector {
    limit_k: f64,
    low: Debounce,
    inverted: Debounce,
    lowest_k: f64,
    vertical_k: f64,
}

impl ContrastDetector {
    /// With the contrast below which there is no attitude, K.
    pub fn new(limit_k: f64) -> Self {
        Self {
            limit_k,
            low: Debounce::new(LOW_S.0, LOW_S.1),
            inverted: Debounce::new(INVERTED_S.0, INVERTED_S.1),
            lowest_k: 0.0,
            vertical_k: 0.0,
        }
    }

    /// Takes in what was seen at `now`; whether attitude may be given as far as this detector
    /// knows. A frame in which nothing was seen changes nothing.
    pub fn update(&mut self, solution: &Solution, now: Time) -> bool {
        if let Some([x, y, z]) = solution.seen_k {
            let seen = (x * x + y * y + z * z).sqrt();
            // Both count: what is seen now, and the range that scales the angles.
            self.lowest_k = solution.contrast_k.map_or(seen, |c| seen.min(c.abs()));
            self.vertical_k = z;
            let low = if self.low.is_active() { self.limit_k * HYSTERESIS } else { self.limit_k };
            let low = self.low.update(self.lowest_k < low, now);
            // Half the limit: with the vertical pair reversed by less than this the contrast is low.
            let reversed = if self.inverted.is_active() { 0.0 } else { -0.5 * self.limit_k };
            let inverted = self.inverted.update(z < reversed, now);
            return low == State::Clear && inverted == State::Clear;
        }
        !self.low.is_active() && !self.inverted.is_active()
    }

    /// Adds what is there to `faults`.
    pub fn report(&self, faults: &mut Vec<ActiveFault>) {
        let mut add = |d: &Debounce, kind, value, limit| {
            if d.is_active() {
                faults.push(ActiveFault {
                    kind,
                    since: d.since(),
                    evidence: Evidence::Limit { value, limit, unit: "K" },
                });
            }
        };
        add(&self.low, FaultKind::LowContrast, self.lowest_k, self.limit_k);
        add(&self.inverted, FaultKind::InvertedContrast, self.vertical_k, -0.5 * self.limit_k);
    }
}
