//! The state as clients see it: a copy of the newest snapshot, and no attitude when that is old.

use super::info::ServiceInfo;
use crate::attitude::Mode;
use crate::fault::{ActiveFault, Evidence, FaultKind};
use crate::state::Snapshot;
use crate::time::Time;
use std::sync::Arc;

/// What every property is read from.
///
/// Only the service's thread changes it, between two calls: all properties that one `GetAll`
/// reads are of one frame.
#[derive(Clone, Debug)]
pub struct Live {
    /// The newest snapshot.
    pub snapshot: Snapshot,
    /// What holds beside it.
    pub info: Arc<ServiceInfo>,
    /// The sampling loop has not written for too long; nothing measured is shown.
    pub overdue: bool,
}

impl Live {
    /// Before the first look.
    pub fn new(info: Arc<ServiceInfo>) -> Self {
        Self { snapshot: Snapshot::default(), info, overdue: false }
    }

    /// Takes in `newest` when it is a later frame; withdraws the attitude when at `now` even the
    /// newest is too old. A sampling loop that hangs cannot say so itself.
    pub fn look(&mut self, newest: &Snapshot, now: Time) {
        let limit = self.info.overdue.as_secs_f64();
        let age = now.since(newest.written);
        let overdue = newest.sequence > 0 && age > limit;
        let seen = (self.snapshot.sequence, self.snapshot.generation);
        if seen != (newest.sequence, newest.generation) || (self.overdue && !overdue) {
            self.snapshot = newest.clone();
        }
        self.overdue = overdue;
        if overdue {
            let estimate = &mut self.snapshot.estimate;
            estimate.attitude = None;
            estimate.contrast_k = None;
            estimate.hint = None;
            estimate.residuals_k.clear();
            estimate.mode = Mode::Faulted;
            self.snapshot.rate_hz = 0.0;
            let evidence = Evidence::Limit { value: age, limit, unit: "s" };
            match estimate.faults.iter_mut().find(|f| f.kind == FaultKind::Stale) {
                Some(fault) => fault.evidence = evidence,
                None => {
                    let since = newest.written + self.info.overdue;
                    estimate.faults.push(ActiveFault { kind: FaultKind::Stale, since, evidence });
                }
            }
        }
    }
}
