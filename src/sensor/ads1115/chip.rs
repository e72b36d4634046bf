//! One chip with its pairs, multiplexed: a conversion is started, other work is done, it is read.
//!
//! A reading is believed only when a conversion started for its own channel has ended: no start
//! goes out while an earlier conversion may be under way (the chip would ignore it and its result
//! would look like the new one's), and the chip is asked for its settings before each result is
//! read (it may have lost its supply, and with it the multiplexer's setting).

use super::driver::{AdcError, Ads1115};
use super::ready::ReadyLine;
use super::registers::Conversion;
use super::setup::{Plan, SetupError};
use super::timing::{Clock, SystemClock, abandon, longest, patience, shortest};
use crate::bus::{BusError, WordBus};
use crate::config::settings::Ads1115Settings;
use crate::frame::{Reading, Sample, Value};
use crate::gpio::edge::EdgeInput;
use crate::gpio::{DataReady, GpioError};
use crate::sensor::Chip;
use crate::source::{Integrity, SensorHealth};
use crate::time::Time;
use std::time::Duration;

/// Opens the chip's end of its bus.
pub type OpenBus = Box<dyn FnMut() -> Result<Box<dyn WordBus>, BusError> + Send>;
/// Opens its data-ready line.
pub type OpenLine = Box<dyn FnMut() -> Result<Box<dyn DataReady>, GpioError> + Send>;

/// A conversion that ended longer ago is not read any more: it would be stamped as new.
const STALE: Duration = Duration::from_millis(100);
/// Between two attempts to set up a chip that does not behave like an ADS1115.
const RETRY: Duration = Duration::from_secs(1);
/// Between two complaints about the same chip.
const QUIET: Duration = Duration::from_secs(10);

/// Whether the chip is set up.
#[derive(Clone, Copy, Debug)]
enum State {
    /// It is not, for this reason; not tried again before this time.
    Unset(AdcError, Time),
    /// It is; a conversion from before may be under way until this time.
    Set(Time),
}

/// A conversion that was started; in continuous mode, the next one not yet read.
#[derive(Clone, Copy, Debug)]
struct Flight {
    /// What is measured; `None` when the start failed and nobody knows whether it was heard.
    slot: Option<usize>,
    /// It cannot end before.
    earliest: Time,
    /// It has ended by then, if the chip is sound.
    expected: Time,
    /// It is given up then.
    abandoned: Time,
    /// It was seen to have ended.
    landed: bool,
}

/// An ADS1115 as the hardware source walks over it.
pub struct Ads1115Chip<C: Clock = SystemClock> {
    name: String,
    plan: Plan,
    open_bus: OpenBus,
    open_line: Option<OpenLine>,
    clock: C,
    adc: Option<Ads1115<dyn WordBus>>,
    line: ReadyLine,
    line_trouble: Option<GpioError>,
    state: State,
    flight: Option<Flight>,
    quiet_until: Time,
    opened: bool,
    health: Vec<SensorHealth>,
}

impl Ads1115Chip {
    /// The chip that `sensors` share, in the order of its slots; they all name the same bus and
    /// address. Nothing is opened yet.
    pub fn from_settings(sensors: &[&Ads1115Settings], open_bus: OpenBus) -> Result<Self, SetupError> {
        let plan = Plan::new(sensors)?;
        let first = sensors.first().ok_or(SetupError::Empty)?;
        let name = format!("ADS1115 at {:#04x} on {}", first.address, first.bus.display());
        let open_line = plan.data_ready.clone().map(|settings| -> OpenLine {
            Box::new(move || Ok(Box::new(EdgeInput::open(&settings)?) as Box<dyn DataReady>))
        });
        Ok(Self::new(name, plan, open_bus, open_line, SystemClock))
    }
}

impl<C: Clock> Ads1115Chip<C> {
    /// A chip called `name` in the log, on any bus, line and clock.
    pub fn new(name: String, plan: Plan, open_bus: OpenBus, open_line: Option<OpenLine>, clock: C) -> Self {
        let health = vec![SensorHealth::default(); plan.channels.len()];
        Self {
            name,
            plan,
            open_bus,
            open_line,
            clock,
            adc: None,
            line: ReadyLine::default(),
            line_trouble: None,
            state: State::Unset(AdcError::Bus(BusError::Gone), Time::default()),
            flight: None,
            quiet_until: Time::default(),
            opened: false,
            health,
        }
    }

    fn adc(&mut self) -> Result<&mut Ads1115<dyn WordBus>, AdcError> {
        self.adc.as_mut().ok_or(AdcError::Bus(BusError::Gone))
    }

    fn continuous(&self) -> bool {
        self.plan.conversion == Conversion::Continuous
    }

    /// Opens the data-ready line if it is not; without it the chip is polled.
    fn open_line(&mut self) {
        if self.line.is_there() {
            return;
        }
        match self.open_line.as_mut().map(|open| open()) {
            None => {}
            Some(Ok(line)) => (self.line, self.line_trouble) = (ReadyLine::new(line), None),
            Some(Err(trouble)) => {
                if self.line_trouble.as_ref() != Some(&trouble) {
                    log::error!("data-ready line of {}: {trouble}; conversions are polled", self.name);
                }
                self.line_trouble = Some(trouble);
            }
        }
    }

    /// Sets the chip up, or says why not.
    fn set_up(&mut self) -> Result<(), AdcError> {
        self.flight = None;
        let channel = self.plan.channels[0];
        let done = self.adc().and_then(|adc| adc.prepare(channel));
        let now = self.clock.now();
        match done {
            Ok(busy) => self.state = State::Set(now + busy),
            Err(e) => self.unset(e, now, RETRY),
        }
        done.map(|_| ())
    }

    /// The chip is not, or no longer, set up; it is tried again after `pause` unless a mere
    /// transfer failed.
    fn unset(&mut self, why: AdcError, now: Time, pause: Duration) {
        self.flight = None;
        let foreign = matches!(why, AdcError::Foreign { .. });
        self.state = State::Unset(why, if foreign { now + pause } else { now });
        if foreign && now >= self.quiet_until {
            log::error!("{}: {why}", self.name);
            self.quiet_until = now + QUIET;
        }
    }

    /// Whether a start would be heard: no conversion is under way that was not seen to end.
    fn is_free(&mut self) -> Result<bool, AdcError> {
        let now = self.clock.now();
        match (self.flight, self.state) {
            (_, State::Unset(why, _)) => Err(why),
            (None, State::Set(free)) => Ok(now >= free),
            (Some(f), _) if f.landed || now >= f.abandoned => Ok(true),
            (Some(f), _) => Ok(now >= f.expected && self.adc()?.is_idle()?),
        }
    }

    /// Starts `slot`; the chip must be free.
    fn start(&mut self, slot: usize) -> Result<(), AdcError> {
        let channel = self.plan.channels[slot];
        self.line.clear();
        let before = self.clock.now();
        let done = self.adc().and_then(|adc| adc.start(channel));
        let after = self.clock.now();
        self.flight = Some(Flight {
            slot: done.is_ok().then_some(slot),
            earliest: before + shortest(channel.rate),
            expected: after + longest(channel.rate),
            abandoned: after + abandon(channel.rate),
            landed: false,
        });
        done
    }

    /// Waits until a start would be heard, at most until `deadline`.
    fn wait_free(&mut self, deadline: Time) -> Result<(), AdcError> {
        let from = match (self.flight, self.state) {
            (Some(f), _) if !f.landed => f.expected,
            (None, State::Set(free)) => free,
            _ => Time::default(),
        };
        self.poll(from, deadline, Self::is_free)
    }

    /// Waits for the end of the conversion under way, at most until `deadline`.
    fn land(&mut self, slot: usize, deadline: Time) -> Result<(), AdcError> {
        let Some(flight) = self.flight.filter(|f| !f.landed) else { return Ok(()) };
        let edge = self.line.is_there().then(|| self.listen(flight, deadline)).transpose()?;
        if edge != Some(Edge::Confirmed) {
            self.poll(flight.expected, deadline, |chip| chip.adc()?.is_ready())?;
        }
        if edge == Some(Edge::None) {
            self.health[slot].counters.not_ready += 1;
        }
        self.flight = Some(Flight { landed: true, ..flight });
        Ok(())
    }

    /// Waits for the edge that ends `flight`. A line that has been silent is waited for no longer
    /// than the conversion takes.
    fn listen(&mut self, flight: Flight, deadline: Time) -> Result<Edge, AdcError> {
        let until = if self.line.is_silent() { flight.expected.min(deadline) } else { deadline };
        let mut edge = Edge::None;
        while self.line.wait(left(until, self.clock.now())) {
            if edge == Edge::None {
                self.line.heard(&self.name);
            }
            edge = Edge::Doubtful;
            let now = self.clock.now();
            // An edge that comes too soon is a disturbance: time and the chip must decide.
            if now < flight.earliest {
                break;
            }
            if self.adc()?.is_ready()? {
                return Ok(Edge::Confirmed);
            }
            if now >= until {
                break;
            }
        }
        if edge == Edge::None {
            self.line.missed(&self.name);
        }
        Ok(edge)
    }

    /// Asks `done` from `from` on, until it says so or `deadline` is over. Does not wait at all
    /// when that cannot come in time.
    fn poll(
        &mut self,
        from: Time,
        deadline: Time,
        mut done: impl FnMut(&mut Self) -> Result<bool, AdcError>,
    ) -> Result<(), AdcError> {
        let pause = (self.plan.slowest().conversion_time() / 16).max(Duration::from_micros(200));
        let mut next = from;
        while next <= deadline || next == from && self.clock.now() >= from {
            self.clock.sleep_until(next);
            if done(self)? {
                return Ok(());
            }
            next = self.clock.now() + pause;
        }
        Err(AdcError::NotReady)
    }

    /// One bounded attempt at `slot`: volts, and the end of the transfer that brought them.
    fn measure(&mut self, slot: usize) -> Result<(f64, Time), AdcError> {
        let now = self.clock.now();
        self.adc()?;
        match self.state {
            State::Unset(why, again) if now < again => return Err(why),
            State::Unset(..) => self.set_up()?,
            State::Set(_) => {}
        }
        let deadline = now + patience(self.plan.slowest());
        let stale = |f: Flight| !self.continuous() && now > f.expected + STALE;
        if self.flight.is_none_or(|f| f.slot != Some(slot) || stale(f)) {
            self.wait_free(deadline)?;
            self.start(slot)?;
        }
        self.land(slot, deadline)?;
        let measured = self.adc()?.read();
        let time = self.clock.now();
        match measured {
            // The result is still there for another attempt.
            Err(AdcError::Bus(_)) => {}
            _ if self.continuous() => {
                self.line.clear();
                let expected = time + longest(self.plan.channels[slot].rate);
                self.flight = self.flight.map(|f| Flight { earliest: now, expected, landed: false, ..f });
            }
            _ => {
                self.flight = None;
                if slot + 1 < self.plan.channels.len() {
                    // Should it fail, the read of that slot says why.
                    let _ = self.start(slot + 1);
                }
            }
        }
        measured.map(|volts| (volts, time))
    }

    fn count(&mut self, slot: usize, error: AdcError) {
        let counters = &mut self.health[slot].counters;
        let counter = match error {
            AdcError::Bus(BusError::NoAnswer) => &mut counters.no_answer,
            AdcError::Bus(BusError::Pec) => &mut counters.bad_pec,
            AdcError::Bus(BusError::Held) => &mut counters.held,
            AdcError::Bus(_) => &mut counters.other,
            AdcError::NotReady => &mut counters.not_ready,
            AdcError::Saturated | AdcError::Foreign { .. } => &mut counters.out_of_range,
        };
        *counter += 1;
    }
}

/// What the data-ready line said of a conversion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Edge {
    /// Nothing.
    None,
    /// An edge that the chip did not confirm.
    Doubtful,
    /// It has ended.
    Confirmed,
}

fn left(until: Time, now: Time) -> Duration {
    Duration::from_nanos(until.as_nanos().saturating_sub(now.as_nanos()))
}

impl<C: Clock> Chip for Ads1115Chip<C> {
    fn open(&mut self) -> Result<(), BusError> {
        self.close();
        let bus = (self.open_bus)()?;
        self.open_line();
        self.adc = Some(Ads1115::new(bus, self.plan.conversion, self.line.is_there()));
        // Another chip at the address is no reason to open again: its readings say so.
        if let Err(AdcError::Bus(e)) = self.set_up() {
            self.close();
            return Err(e);
        }
        for health in &mut self.health {
            health.integrity = Integrity::SensorWithout;
            health.counters.reopened += u64::from(self.opened);
        }
        self.opened = true;
        Ok(())
    }

    fn close(&mut self) {
        self.adc = None;
        self.flight = None;
    }

    fn begin(&mut self) {
        // What goes wrong here, the read of the first slot says.
        if !self.continuous() && self.is_free() == Ok(true) {
            let _ = self.start(0);
        }
    }

    fn read(&mut self, slot: usize) -> Reading {
        if slot >= self.plan.channels.len() {
            return Err(crate::frame::Missing::NotYet);
        }
        match self.measure(slot) {
            Ok((volts, time)) => {
                self.health[slot].counters.reads += 1;
                Ok(Sample { value: Value::Volts(volts), time })
            }
            Err(e) => {
                if matches!(e, AdcError::Foreign { .. }) && matches!(self.state, State::Set(_)) {
                    // It was ours a moment ago: set it up again with the next read.
                    let now = self.clock.now();
                    self.unset(e, now, Duration::ZERO);
                }
                self.count(slot, e);
                Err(e.missing())
            }
        }
    }

    fn health(&self, slot: usize) -> SensorHealth {
        self.health.get(slot).copied().unwrap_or_default()
    }
}
