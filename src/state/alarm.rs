//! For those who look at the state only now and then: what must not wait until they do.

use super::Snapshot;
use crate::attitude::Mode;
use crate::fault::FaultKind;
use std::future::poll_fn;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::task::{Poll, Waker};

/// Rings when the mode, the faults or the settings have changed, or the daemon stops.
#[derive(Debug, Default)]
pub struct Alarm(Mutex<Inner>);

#[derive(Debug, Default)]
struct Inner {
    mode: Mode,
    faults: Vec<FaultKind>,
    generation: u64,
    stopping: bool,
    rung: u64,
    waiting: Vec<Waker>,
}

impl Alarm {
    fn lock(&self) -> MutexGuard<'_, Inner> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Room for so many faults at once, so that nothing has to be made when they come.
    pub fn reserve(&self, faults: usize) {
        self.lock().faults.reserve(faults);
    }

    /// Rings if `newest` says anything of that sort that the one before did not. Allocates only when there are more
    /// faults than ever before.
    pub(super) fn hear(&self, newest: &Snapshot) {
        let mut inner = self.lock();
        let mode = newest.estimate.mode;
        let kinds = || newest.estimate.faults.iter().map(|f| f.kind);
        let same = (inner.mode, inner.generation, inner.stopping) == (mode, newest.generation, newest.stopping);
        if same && kinds().eq(inner.faults.iter().copied()) {
            return;
        }
        (inner.mode, inner.generation, inner.stopping) = (mode, newest.generation, newest.stopping);
        inner.faults.clear();
        inner.faults.extend(kinds());
        inner.rung += 1;
        inner.waiting.drain(..).for_each(Waker::wake);
    }

    /// How often it has rung.
    pub fn rung(&self) -> u64 {
        self.lock().rung
    }

    /// Waits until it has rung more often than `seen`.
    pub async fn beyond(&self, seen: u64) {
        poll_fn(|cx| {
            let mut inner = self.lock();
            if inner.rung > seen {
                return Poll::Ready(());
            }
            if !inner.waiting.iter().any(|w| w.will_wake(cx.waker())) {
                inner.waiting.push(cx.waker().clone());
            }
            Poll::Pending
        })
        .await;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fault::{ActiveFault, Evidence};
    use crate::time::Time;

    #[test]
    fn it_rings_for_what_must_not_wait_and_for_nothing_else() {
        let alarm = Alarm::default();
        let mut state = Snapshot::default();
        let mut rings = |change: &dyn Fn(&mut Snapshot)| {
            let before = alarm.rung();
            change(&mut state);
            alarm.hear(&state);
            alarm.rung() - before
        };
        let fault = |value| ActiveFault {
            kind: FaultKind::LowContrast,
            since: Time::default(),
            evidence: Evidence::Limit { value, limit: 2.0, unit: "K" },
        };
        assert_eq!(rings(&|s| s.sequence += 1), 0);
        assert_eq!(rings(&|s| s.estimate.mode = Mode::Nominal), 1);
        assert_eq!(rings(&|s| s.estimate.contrast_k = Some(9.0)), 0);
        assert_eq!(rings(&|s| s.estimate.faults = vec![fault(1.0)]), 1);
        assert_eq!(rings(&|s| s.estimate.faults = vec![fault(0.5)]), 0, "the same one, in other words");
        assert_eq!(rings(&|s| s.estimate.faults.clear()), 1);
        assert_eq!(rings(&|s| s.generation += 1), 1);
        assert_eq!(rings(&|s| s.stopping = true), 1);
    }

    #[test]
    fn who_waits_is_woken_by_the_next_ring_and_not_by_an_earlier_one() {
        let alarm = Alarm::default();
        let mut state = Snapshot { generation: 1, ..Snapshot::default() };
        alarm.hear(&state);
        zbus::block_on(alarm.beyond(0));
        std::thread::scope(|scope| {
            let waits = scope.spawn(|| zbus::block_on(alarm.beyond(1)));
            while alarm.lock().waiting.is_empty() {
                std::thread::yield_now();
            }
            assert!(!waits.is_finished());
            state.stopping = true;
            alarm.hear(&state);
            waits.join().unwrap();
        });
    }
}
