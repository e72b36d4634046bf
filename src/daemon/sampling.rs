//! The sampling loop: tick, scan, estimate, publish. Nothing in it waits for a publisher, and after
//! its first few rounds nothing in it allocates.

use super::alignment::Alignment;
use super::fault_log::{FaultLog, Line};
use super::ticker::Ticker;
use super::watchdog::Watchdog;
use crate::aiding::Inbox;
use crate::attitude::{Estimate, Mode};
use crate::clock;
use crate::config::Settings;
use crate::frame::Frame;
use crate::gpio::lamp::Lamp;
use crate::gpio::output::PlugInLine;
use crate::head::Head;
use crate::horizon::Horizon;
use crate::mavlink::publisher::Publisher;
use crate::recording::{Taps, Writer};
use crate::source::{FrameSource, SensorHealth};
use crate::state::Shared;
use crate::time::Time;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex};

/// Settings for the loop to take up as it goes.
pub type Retune = Arc<Mutex<Option<Box<Settings>>>>;

/// The loop's parts.
pub struct Sampling {
    source: Box<dyn FrameSource>,
    horizon: Horizon,
    head: Arc<Head>,
    shared: Arc<Shared>,
    taps: Arc<Taps>,
    writer: Writer,
    lamp: Option<Lamp<PlugInLine>>,
    publisher: Option<Arc<Publisher>>,
    /// The newest scan.
    frame: Frame,
    alignment: Alignment,
    estimate: Estimate,
    log: FaultLog,
    retune: Retune,
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
        lamp: Option<Lamp<PlugInLine>>,
    ) -> Self {
        // A sensor is lost or saturated, a bus is down, and what there is but once.
        let kinds = 2 * head.sensors.len() + head.buses.len() + 4;
        shared.lock().estimate.faults.reserve(kinds);
        shared.alarm.reserve(kinds);
        Self {
            frame: Frame::new(head.sensors.len()),
            alignment: Alignment::new(head.sensors.len(), kinds),
            estimate: Estimate { faults: Vec::with_capacity(kinds), ..Estimate::default() },
            log: FaultLog::with_capacity(kinds),
            retune: Retune::default(),
            writer: Writer::new(&head, ""),
            line: String::with_capacity(1024),
            rate: RateMeter::default(),
            lag_s: None,
            source,
            horizon,
            head: Arc::new(head),
            shared,
            taps,
            lamp,
            publisher: None,
        }
    }

    /// Tells `publisher` of each frame.
    pub fn with_publisher(mut self, publisher: Arc<Publisher>) -> Self {
        self.publisher = Some(publisher);
        self
    }

    /// Takes up thresholds and trims from `retune`.
    pub fn with_retune(mut self, retune: Retune) -> Self {
        self.retune = retune;
        self
    }

    /// Takes what an autopilot says of its rates, GPS and airspeed out of `inbox`.
    pub fn with_inbox(mut self, inbox: Arc<Inbox>) -> Self {
        self.alignment.listen(inbox);
        self
    }

    /// Runs `rate_hz` times a second until `stop` is set.
    pub fn run(mut self, rate_hz: f64, stop: &AtomicBool) {
        let mut ticker = Ticker::new(clock::now(), rate_hz);
        let mut watchdog = Watchdog::from_environment();
        let mut told = 0;
        self.shine(Mode::Starting, clock::now());
        while let Some(tick) = ticker.wait(stop) {
            self.step(tick);
            if let Some(watchdog) = &mut watchdog {
                watchdog.scanned(&self.frame, &self.estimate);
            }
            if let Some(still_s) = ticker.still_s.take() {
                log::warn!(
                    "sampling stood still for {still_s:.1} s: the machine slept, the daemon was stopped, or a bus was held"
                );
            }
            if ticker.overruns >= told * 10 + 50 {
                told = ticker.overruns;
                log::warn!(
                    "{told} scans left out since start: the machine or the bus is too slow; lower [daemon] rate-hz"
                );
            }
        }
        // Nobody measures any more: dark would say that all is well.
        self.shine(Mode::Faulted, clock::now());
    }

    fn shine(&mut self, mode: Mode, time: Time) {
        if let Some(Err(e)) = self.lamp.as_mut().map(|lamp| lamp.show(mode, time)) {
            log::error!("fault lamp: {e}; tried again every second");
        }
    }

    /// One round, begun at `tick`.
    pub fn step(&mut self, tick: Time) {
        self.source.scan(tick, &mut self.frame);
        // Whoever writes it holds it for a moment only; what is missed now is taken up at the next frame.
        let retuned = self.retune.try_lock().ok().and_then(|mut settings| settings.take());
        retuned.iter().for_each(|settings| self.horizon.retune(settings));
        let lag_s = lag_s(self.source.health());
        if lag_s != self.lag_s {
            self.lag_s = lag_s;
            lag_s.into_iter().for_each(|lag_s| self.horizon.set_lag_s(lag_s));
        }
        let Self { source, horizon, frame, alignment, estimate, taps, line, writer, .. } = self;
        alignment.offer(frame);
        while let Some(aligned) = alignment.next(frame.time, horizon) {
            horizon.update(aligned, source.buses_down(), estimate);
            taps.offer(line, |line| writer.row(aligned, line));
            alignment.compare(estimate);
        }
        let autopilot = alignment.autopilot(horizon, frame.time);
        let shown = alignment.shown(estimate, horizon, frame);
        let rate_hz = self.rate.update(self.frame.time);
        self.shared.put(|s| {
            s.sequence += 1;
            s.written = self.frame.time;
            if !Arc::ptr_eq(&s.head, &self.head) {
                s.head = Arc::clone(&self.head);
            }
            s.estimate.clone_from(shown);
            s.autopilot = autopilot;
            s.frame.clone_from(&self.frame);
            s.health.clear();
            s.health.extend_from_slice(self.source.health());
            s.rate_hz = rate_hz;
        });
        if !self.publisher.as_ref().is_some_and(|publisher| publisher.tell(&self.shared)) {
            self.shared.ring();
        }
        self.shine(self.estimate.mode, self.frame.time);
        self.log.update(&self.estimate.faults, self.frame.time, |line| match line {
            Line::Came { fault, unsaid: 0 } => {
                log::warn!("{}: {}", fault.kind.display(&*self.head), fault.evidence);
            }
            Line::Came { fault, unsaid } => {
                let name = fault.kind.display(&*self.head);
                log::warn!("{name}: {}; came and went {unsaid} times more", fault.evidence);
            }
            Line::Went { kind, after_s, unsaid: 0 } => {
                log::info!("{} is over after {after_s:.1} s", kind.display(&*self.head));
            }
            Line::Went { kind, after_s, unsaid } => {
                let name = kind.display(&*self.head);
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
