//! The sampling loop: tick, scan, estimate, publish. Nothing in it waits for a publisher, and after
//! its first few rounds nothing in it allocates.

use super::fault_log::{FaultLog, Line};
use super::ticker::Ticker;
use super::watchdog::Watchdog;
use crate::attitude::Estimate;
use crate::clock;
use crate::frame::Frame;
use crate::gpio::lamp::Lamp;
use crate::gpio::output::OutputLine;
use crate::head::Head;
use crate::horizon::Horizon;
use crate::recording::{Taps, Writer};
use crate::source::{FrameSource, SensorHealth};
use crate::state::Shared;
use crate::time::Time;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// The loop's parts.
pub struct Sampling {
    source: Box<dyn FrameSource>,
    horizon: Horizon,
    head: Head,
    shared: Arc<Shared>,
    taps: Arc<Taps>,
    writer: Writer,
    lamp: Option<Lamp<OutputLine>>,
    frame: Frame,
    estimate: Estimate,
    log: FaultLog,
    line: String,
    rate: RateMeter,
    lag_s: Option<f64>,
}

impl Sampling {
    /// Samples `head` through `source`; `lamp` shows the mode.
    pub fn new(
        head: Head,
        source: Box<dyn FrameSource>,
        horizon: Horizon,
        shared: Arc<Shared>,
        taps: Arc<Taps>,
        lamp: Option<Lamp<OutputLine>>,
    ) -> Self {
        // A sensor is lost or saturated, a bus is down, and what there is but once.
        let kinds = 2 * head.sensors.len() + head.buses.len() + 4;
        shared.lock().estimate.faults.reserve(kinds);
        Self {
            frame: Frame::new(head.sensors.len()),
            estimate: Estimate { faults: Vec::with_capacity(kinds), ..Estimate::default() },
            log: FaultLog::with_capacity(kinds),
            writer: Writer::new(&head, ""),
            line: String::with_capacity(1024),
            rate: RateMeter::default(),
            lag_s: None,
            source,
            horizon,
            head,
            shared,
            taps,
            lamp,
        }
    }

    /// Runs `rate_hz` times a second until `stop` is set.
    pub fn run(mut self, rate_hz: f64, stop: &AtomicBool) {
        let mut ticker = Ticker::new(clock::now(), rate_hz);
        let mut watchdog = Watchdog::from_environment();
        let mut told = 0;
        while let Some(tick) = ticker.wait(stop) {
            self.step(tick);
            if let Some(watchdog) = &mut watchdog {
                watchdog.scanned(&self.frame, &self.estimate);
            }
            if ticker.overruns >= told * 10 + 50 {
                told = ticker.overruns;
                log::warn!(
                    "{told} scans left out since start: the machine or the bus is too slow; lower [daemon] rate-hz"
                );
            }
        }
    }

    /// One round, begun at `tick`.
    pub fn step(&mut self, tick: Time) {
        self.source.scan(tick, &mut self.frame);
        let lag_s = lag_s(self.source.health());
        if lag_s != self.lag_s {
            self.lag_s = lag_s;
            lag_s.into_iter().for_each(|lag_s| self.horizon.set_lag_s(lag_s));
        }
        self.horizon.update(&self.frame, self.source.buses_down(), &mut self.estimate);
        let rate_hz = self.rate.update(self.frame.time);
        self.shared.update(|s| {
            s.sequence += 1;
            s.written = self.frame.time;
            s.estimate.clone_from(&self.estimate);
            s.frame.clone_from(&self.frame);
            s.health.clear();
            s.health.extend_from_slice(self.source.health());
            s.rate_hz = rate_hz;
        });
        self.taps.offer(&mut self.line, |line| self.writer.row(&self.frame, line));
        if let Some(lamp) = &mut self.lamp {
            // A lamp that cannot be switched is tried again at the next frame.
            let _ = lamp.show(self.estimate.mode, self.frame.time);
        }
        self.log.update(&self.estimate.faults, self.frame.time, |line| match line {
            Line::Came { fault, unsaid: 0 } => {
                log::warn!("{}: {}", fault.kind.display(&self.head), fault.evidence);
            }
            Line::Came { fault, unsaid } => {
                let name = fault.kind.display(&self.head);
                log::warn!("{name}: {}; came and went {unsaid} times more", fault.evidence);
            }
            Line::Went { kind, after_s, unsaid: 0 } => {
                log::info!("{} is over after {after_s:.1} s", kind.display(&self.head));
            }
            Line::Went { kind, after_s, unsaid } => {
                let name = kind.display(&self.head);
                log::info!("{name} is over after {after_s:.1} s; came and went {unsaid} times more");
            }
        });
    }
}

/// The mean time constant of the sensors that say theirs, s.
fn lag_s(health: &[SensorHealth]) -> Option<f64> {
    let (sum, count) =
        health.iter().filter(|h| h.lag_s > 0.0).fold((0.0, 0.0), |(sum, count), h| (sum + h.lag_s, count + 1.0));
    (count > 0.0).then(|| sum / count)
}

/// Frames a second, over the last second or so.
#[derive(Clone, Copy, Debug, Default)]
struct RateMeter {
    since: Option<Time>,
    frames: u32,
    rate_hz: f64,
}

impl RateMeter {
    fn update(&mut self, now: Time) -> f64 {
        let since = *self.since.get_or_insert(now);
        let elapsed = now.since(since);
        if elapsed >= 1.0 {
            self.rate_hz = f64::from(self.frames) / elapsed;
            self.since = Some(now);
            self.frames = 0;
        } else if self.rate_hz == 0.0 && elapsed > 0.0 {
            // The first second: say what there is rather than nothing.
            self.frames += 1;
            return f64::from(self.frames - 1) / elapsed;
        }
        self.frames += 1;
        self.rate_hz
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lag_is_that_of_the_sensors_that_say_it() {
        let with = |lag_s| SensorHealth { lag_s, ..SensorHealth::default() };
        assert_eq!(lag_s(&[]), None);
        assert_eq!(lag_s(&[with(0.0), with(0.0)]), None);
        assert_eq!(lag_s(&[with(0.25), with(0.0), with(0.75)]), Some(0.5));
    }

    #[test]
    fn the_rate_is_that_of_the_frames() {
        let mut meter = RateMeter::default();
        for i in 0..500 {
            let rate = meter.update(Time::from_secs_f64(5.0 + f64::from(i) * 0.02));
            assert!(i < 2 || (rate - 50.0).abs() < 1.1, "frame {i}: {rate}");
        }
    }
}
