//! The rhythm of the sampling loop.

use crate::clock;
use crate::time::Time;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// The longest sleep at a stretch: how soon a stop is noticed at low rates.
const SLICE: Duration = Duration::from_millis(100);

/// What is late by more is no slow machine, s: it slept, or something hung.
const STILL_S: f64 = 2.0;

/// Ticks at a steady rate, without drift; ticks that were missed are left out, never made up for.
#[derive(Debug)]
pub struct Ticker {
    next: Time,
    period: Duration,
    /// Ticks left out since start.
    pub overruns: u64,
    /// For how long everything stood still before the last tick, s: no ticks of that time are counted.
    pub still_s: Option<f64>,
}

impl Ticker {
    /// Ticks `rate_hz` times a second, the first at `start`.
    pub fn new(start: Time, rate_hz: f64) -> Self {
        Self { next: start, period: Duration::from_secs_f64(1.0 / rate_hz), overruns: 0, still_s: None }
    }

    /// The instant of the tick after `now`, and moves on to the one behind it.
    fn advance(&mut self, now: Time) -> Time {
        let late = now.since(self.next);
        let period = self.period.as_secs_f64();
        if late > period {
            let missed = (late / period).floor();
            if late > STILL_S {
                self.still_s = Some(late);
            } else {
                self.overruns += missed as u64;
            }
            self.next = self.next + self.period.mul_f64(missed);
        }
        let tick = self.next;
        self.next = tick + self.period;
        tick
    }

    /// Sleeps until the next tick and gives its instant; `None` once `stop` is set.
    pub fn wait(&mut self, stop: &AtomicBool) -> Option<Time> {
        let tick = self.advance(clock::now());
        loop {
            if stop.load(Ordering::Relaxed) {
                return None;
            }
            let slice = clock::now() + SLICE;
            if tick <= slice {
                clock::sleep_until(tick);
                return Some(tick);
            }
            clock::sleep_until(slice);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(s: f64) -> Time {
        Time::from_secs_f64(s)
    }

    #[test]
    fn no_drift_and_no_catching_up() {
        let mut t = Ticker::new(at(10.0), 50.0);
        assert_eq!(t.advance(at(10.0)), at(10.0));
        assert_eq!(t.advance(at(10.015)), at(10.02));
        assert_eq!(t.advance(at(10.05)), at(10.04), "late by half a period: still this tick");
        let tick = t.advance(at(11.005));
        assert!(tick.since(at(11.0)).abs() < 1e-6, "after a stall the rhythm goes on: {tick:?}");
        assert_eq!((t.overruns, t.still_s), (47, None));
        // As long as a night: nothing that a lower rate would mend.
        t.advance(at(30011.01));
        assert!(t.overruns == 47 && t.still_s.is_some_and(|s| (s - 30000.0).abs() < 0.02), "{:?}", t.still_s);
    }

    #[test]
    fn a_stop_ends_a_long_wait() {
        let mut t = Ticker::new(clock::now() + Duration::from_secs(3600), 50.0);
        assert_eq!(t.wait(&AtomicBool::new(true)), None);
    }
}
