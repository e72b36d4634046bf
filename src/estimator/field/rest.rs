//! Whether what the sensors see moves: only then do readings tell of their lag.
//!
//! At rest a gyro's noise looks like motion that the sensors do not show, and the lag that explains it best is a long one.

use super::FieldEstimator;
use super::state::LAG;
use crate::estimator::vector::{add_scaled, length};

/// The vertical is compared with where it has been on the average over this time, s.
const AVERAGED_S: f64 = 10.0;
/// As near to that, rad, it is at rest: farther than noise takes it.
const REST: f64 = 2_f64.to_radians();

impl FieldEstimator {
    /// Learns of the lag while what is seen moves.
    pub(super) fn tell_lag(&mut self, dt_s: f64) {
        let moved = add_scaled(self.state.vertical(), -1.0, self.vertical_lately);
        let share = -(-dt_s / AVERAGED_S).exp_m1();
        self.vertical_lately = add_scaled(self.vertical_lately, share, moved);
        self.state.tell(LAG..LAG + 1, length(moved) > REST);
    }
}
