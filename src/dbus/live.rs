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
    /// From when on a first frame is waited for.
    pub since: Time,
}

impl Live {
    /// Before the first look, at `now`.
    pub fn new(info: Arc<ServiceInfo>, now: Time) -> Self {
        Self { snapshot: Snapshot::default(), info, overdue: false, since: now }
    }

    /// What `all` has for a sensor that is told of, where the newest frame is of these sensors.
    pub fn of_sensor<'a, T>(&'a self, all: &'a [T], index: usize) -> Option<&'a T> {
        all.get(index).filter(|_| self.is_of_these_sensors())
    }

    /// Whether the newest frame is of the sensors that are told of: not between a reload and its first frame.
    fn is_of_these_sensors(&self) -> bool {
        let (told, measured) = (&self.info.head.sensors, &self.snapshot.head.sensors);
        told.iter().map(|s| &s.name).eq(measured.iter().map(|s| &s.name))
    }

    /// Takes in `newest` when it is a later frame; withdraws the attitude when at `now` even the
    /// newest is too old. A sampling loop that hangs cannot say so itself.
    pub fn look(&mut self, newest: &Snapshot, now: Time) {
        let limit = self.info.overdue.as_secs_f64();
        let written = if newest.sequence == 0 { self.since } else { newest.written };
        let age = now.since(written);
        let overdue = age > limit;
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
                    let since = written + self.info.overdue;
                    estimate.faults.push(ActiveFault { kind: FaultKind::Stale, since, evidence });
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Settings;

    #[test]
    fn a_loop_that_hangs_is_told_whether_it_has_written_or_not() {
        let at = Time::from_secs_f64;
        for (sequence, written) in [(0, Time::default()), (1, at(100.0))] {
            let mut live = Live::new(Arc::new(ServiceInfo::new(&Settings::default())), at(100.0));
            let newest = Snapshot { sequence, written, ..Snapshot::default() };
            let mut look = |secs| {
                live.look(&newest, at(secs));
                let estimate = &live.snapshot.estimate;
                (estimate.mode, estimate.faults.iter().map(|f| (f.kind, f.since)).collect::<Vec<_>>())
            };
            assert_eq!(look(100.1), (Mode::Starting, vec![]), "frame {sequence}");
            assert_eq!(look(110.0), (Mode::Faulted, vec![(FaultKind::Stale, at(100.54))]), "frame {sequence}");
        }
    }

    #[test]
    fn what_other_sensors_measured_is_not_told_of_these() {
        let settings = Settings::default();
        let mut live = Live::new(Arc::new(ServiceInfo::new(&settings)), Time::default());
        let mut head = settings.head();
        for same in [true, false] {
            let newest =
                Snapshot { sequence: live.snapshot.sequence + 1, head: Arc::new(head.clone()), ..Snapshot::default() };
            live.look(&newest, Time::default());
            assert_eq!(live.is_of_these_sensors(), same);
            head.sensors.reverse();
        }
    }
}
