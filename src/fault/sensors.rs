//! Sensors and buses that give nothing, and measurements that are too old.

use super::debounce::{Debounce, State};
use super::{ActiveFault, Evidence, FaultKind};
use crate::frame::{Frame, Missing};
use crate::head::Head;
use crate::time::Time;

/// What is kept of one sensor.
#[derive(Clone, Copy, Debug)]
struct Watch {
    gone: Debounce,
    reason: Missing,
    /// Failed reads in a row, until now and at most since it was last sound.
    failures: u32,
    most: u32,
}

/// Sees `sensor-lost`, `sensor-saturated`, `bus-down` and `stale`.
#[derive(Clone, Debug)]
pub struct SensorDetector {
    head: Head,
    sensors: Vec<Watch>,
    buses: Vec<Watch>,
    stale_after_s: f64,
    newest: Option<Time>,
    started: Option<Time>,
    now: Time,
}

impl SensorDetector {
    /// A sensor is lost after `lost_after_s` without a measurement and back after `back_after_s` and
    /// ten of measurements; all together are stale when the newest is older than `stale_after_s`.
    pub fn new(head: Head, lost_after_s: f64, back_after_s: f64, stale_after_s: f64) -> Self {
        let watch = Watch {
            gone: Debounce::new(lost_after_s, back_after_s).wary(),
            reason: Missing::NotYet,
            failures: 0,
            most: 0,
        };
        Self {
            sensors: vec![watch; head.sensors.len()],
            buses: vec![watch; head.buses.len()],
            head,
            stale_after_s,
            newest: None,
            started: None,
            now: Time::default(),
        }
    }

    /// Other times; see [`new`](Self::new).
    pub fn retune(&mut self, lost_after_s: f64, back_after_s: f64, stale_after_s: f64) {
        self.stale_after_s = stale_after_s;
        for watch in self.sensors.iter_mut().chain(&mut self.buses) {
            watch.gone.retune(lost_after_s, back_after_s);
        }
    }

    /// Takes in a frame and the reason for which each bus is down.
    pub fn update(&mut self, frame: &Frame, buses_down: &[Option<Missing>]) {
        self.now = frame.time;
        self.started.get_or_insert(frame.time);
        self.newest = self.newest.max(frame.sample_time());
        for (watch, reading) in self.sensors.iter_mut().zip(&frame.readings) {
            watch.update(reading.err(), frame.time);
        }
        for (watch, down) in self.buses.iter_mut().zip(buses_down) {
            watch.update(*down, frame.time);
        }
    }

    /// Whether sensor `i` has been missing for so long.
    pub fn is_gone(&self, i: usize) -> bool {
        self.sensors.get(i).is_some_and(|watch| watch.gone.is_active())
    }

    /// Adds what is there to `faults`. A sensor on a bus that is down is not counted a second time.
    pub fn report(&self, faults: &mut Vec<ActiveFault>) {
        for (i, (watch, sensor)) in self.sensors.iter().zip(&self.head.sensors).enumerate() {
            let bus_down = sensor.bus.and_then(|b| self.buses.get(b)).is_some_and(|b| b.gone.is_active());
            if watch.gone.is_active() && !bus_down {
                let kind = match watch.reason {
                    Missing::Saturated => FaultKind::SensorSaturated(i),
                    _ => FaultKind::SensorLost(i),
                };
                faults.push(watch.fault(kind));
            }
        }
        for (i, watch) in self.buses.iter().enumerate() {
            if watch.gone.is_active() {
                faults.push(watch.fault(FaultKind::BusDown(i)));
            }
        }
        let since = self.newest.or(self.started).unwrap_or(self.now);
        let age = self.now.since(since);
        if age > self.stale_after_s {
            let evidence = Evidence::Limit { value: age, limit: self.stale_after_s, unit: "s" };
            faults.push(ActiveFault { kind: FaultKind::Stale, since, evidence });
        }
    }
}

impl Watch {
    fn update(&mut self, missing: Option<Missing>, now: Time) {
        if let Some(reason) = missing {
            self.reason = reason;
            self.failures = self.failures.saturating_add(1);
        } else {
            self.failures = 0;
        }
        let sound = self.gone.update(missing.is_some(), now) == State::Clear;
        self.most = if sound { 0 } else { self.most.max(self.failures) };
    }

    fn fault(&self, kind: FaultKind) -> ActiveFault {
        let evidence = Evidence::Missing { reason: self.reason, failures: self.most };
        ActiveFault { kind, since: self.gone.since(), evidence }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fault::kit::{frame, told};

    #[test]
    fn the_evidence_is_of_the_longest_silence_while_the_fault_stands() {
        let mut detector = SensorDetector::new(Head::six(), 0.1, 0.1, 0.5);
        let mut now_s = 10.0;
        let mut after = |missed: u32, read: u32| {
            for i in 0..missed + read {
                now_s += 0.02;
                let mut frame = frame(now_s, &[3.0; 6], None);
                if i < missed {
                    frame.readings[2] = Err(Missing::NoAnswer);
                }
                detector.update(&frame, &[]);
            }
            told(|faults| detector.report(faults)).first().map(|(_, evidence)| evidence.to_string())
        };
        assert_eq!(after(3, 5), None);
        for (missed, read) in [(9, 0), (0, 1), (2, 1), (8, 5)] {
            assert_eq!(after(missed, read).as_deref(), Some("no answer, 9 reads in a row"));
        }
        assert_eq!(after(12, 1).as_deref(), Some("no answer, 12 reads in a row"));
        assert_eq!(after(0, 9), None);
        assert_eq!(after(6, 0).as_deref(), Some("no answer, 6 reads in a row"), "another fault");
        let mut slow = SensorDetector::new(Head::six(), 0.0, 0.1, 0.5);
        let mut missed = frame(20.0, &[3.0; 6], None);
        missed.readings[2] = Err(Missing::NoAnswer);
        slow.update(&missed, &[]);
        assert_eq!(told(|faults| slow.report(faults))[0].1.to_string(), "no answer, 1 read");
    }
}
