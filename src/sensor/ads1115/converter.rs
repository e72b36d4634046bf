//! From a start to its result: who may start, how its end is waited for, when the result is
//! believed.
//!
//! A reading is believed only when a conversion started for its own channel has ended: no start
//! goes out while an earlier conversion may be under way (the chip would ignore it and its result
//! would look like the new one's), and the chip is asked for its settings before each result is
//! read (it may have lost its supply, and with it the multiplexer's setting).

use super::driver::{AdcError, Ads1115};
use super::ready::ReadyLine;
use super::registers::{Conversion, Rate};
use super::setup::Plan;
use super::timing::{Clock, abandon, longest, patience, shortest};
use crate::bus::{BusError, WordBus};
use crate::time::Time;
use std::time::Duration;

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
    /// It is.
    Set,
}

/// A conversion that was started; in continuous mode, the next one not yet read.
#[derive(Clone, Copy, Debug)]
struct Flight {
    /// What is measured; `None` for one from before it was set up, and when the start failed and nobody knows whether it was
    /// heard.
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

impl Flight {
    /// One started between two times.
    fn new(slot: Option<usize>, rate: Rate, (before, after): (Time, Time)) -> Self {
        let (earliest, expected, abandoned) = (before + shortest(rate), after + longest(rate), after + abandon(rate));
        Self { slot, earliest, expected, abandoned, landed: false }
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

/// A result that is believed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// V.
    pub volts: f64,
    /// The end of the transfer that brought it.
    pub time: Time,
    /// Whether the data-ready line did not tell its end.
    pub unannounced: bool,
}

/// The conversions of one chip, one after the other.
pub struct Converter<C: Clock> {
    name: String,
    plan: Plan,
    clock: C,
    adc: Option<Ads1115<dyn WordBus>>,
    /// The line that ALERT/RDY is wired to.
    pub line: ReadyLine,
    state: State,
    flight: Option<Flight>,
    /// The line has fallen silent: the chip may have lost what makes it speak.
    mute: bool,
    quiet_until: Time,
}

impl<C: Clock> Converter<C> {
    /// Conversions of the chip called `name` in the log; nothing is transferred yet.
    pub fn new(name: String, plan: Plan, clock: C) -> Self {
        Self {
            name,
            plan,
            clock,
            adc: None,
            line: ReadyLine::default(),
            state: State::Unset(AdcError::Bus(BusError::Gone), Time::default()),
            flight: None,
            mute: false,
            quiet_until: Time::default(),
        }
    }

    /// Takes over the chip behind `bus` and sets it up. Unless a transfer failed, it stays taken
    /// over: a chip that is no ADS1115 is tried again now and then.
    pub fn connect(&mut self, bus: Box<dyn WordBus>) -> Result<(), AdcError> {
        self.adc = Some(Ads1115::new(bus, self.plan.conversion, self.line.is_there()));
        self.set_up()
    }

    /// Lets go of the bus.
    pub fn disconnect(&mut self) {
        self.adc = None;
        self.flight = None;
    }

    /// Starts the first channel if the chip is free to. Where its line has fallen silent the chip is set up anew before,
    /// once: a supply that drops between two conversions leaves no trace but the thresholds.
    pub fn begin(&mut self) {
        // What goes wrong here, the measurement of the first slot says.
        if std::mem::take(&mut self.mute) {
            let _ = self.set_up();
        }
        if !self.continuous() && self.is_free() == Ok(true) {
            let _ = self.start(0);
        }
    }

    /// One bounded attempt at `slot`, which is one of the plan's.
    pub fn measure(&mut self, slot: usize) -> Result<Measured, AdcError> {
        let measured = self.attempt(slot);
        if let (Err(why @ AdcError::Foreign { .. }), State::Set) = (measured, self.state) {
            // It was ours a moment ago: it is set up again with the next attempt.
            let now = self.clock.now();
            self.unset(why, now);
        }
        measured
    }

    fn attempt(&mut self, slot: usize) -> Result<Measured, AdcError> {
        let now = self.clock.now();
        self.adc()?;
        match self.state {
            State::Unset(why, again) if now < again => return Err(why),
            State::Unset(..) => self.set_up()?,
            State::Set => {}
        }
        let deadline = now + patience(self.plan.slowest());
        let stale = |f: Flight| !self.continuous() && now > f.expected + STALE;
        if self.flight.is_none_or(|f| f.slot != Some(slot) || stale(f)) {
            self.wait_free(deadline)?;
            self.start(slot)?;
        }
        let unannounced = self.land(deadline)?;
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
        measured.map(|volts| Measured { volts, time, unannounced })
    }

    fn adc(&mut self) -> Result<&mut Ads1115<dyn WordBus>, AdcError> {
        self.adc.as_mut().ok_or(AdcError::Bus(BusError::Gone))
    }

    fn continuous(&self) -> bool {
        self.plan.conversion == Conversion::Continuous
    }

    /// Sets the chip up, or says why not.
    fn set_up(&mut self) -> Result<(), AdcError> {
        self.flight = None;
        let channel = self.plan.channels[0];
        let done = self.adc().and_then(|adc| adc.prepare(channel));
        let now = self.clock.now();
        match done {
            Ok(under_way) => {
                self.state = State::Set;
                self.flight = under_way.map(|rate| Flight::new(None, rate, (now, now)));
            }
            Err(e @ AdcError::Foreign { .. }) => self.unset(e, now + RETRY),
            Err(e) => self.unset(e, now),
        }
        done.map(|_| ())
    }

    /// The chip is not, or no longer, set up for this reason; it is tried again from `again` on.
    fn unset(&mut self, why: AdcError, again: Time) {
        self.flight = None;
        self.state = State::Unset(why, again);
        let now = self.clock.now();
        if matches!(why, AdcError::Foreign { .. }) && now >= self.quiet_until {
            log::error!("{}: {why}", self.name);
            self.quiet_until = now + QUIET;
        }
    }

    /// Whether a start would be heard: no conversion is under way that was not seen to end.
    fn is_free(&mut self) -> Result<bool, AdcError> {
        let now = self.clock.now();
        match (self.flight, self.state) {
            (_, State::Unset(why, _)) => Err(why),
            (None, State::Set) => Ok(true),
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
        self.flight = Some(Flight::new(done.is_ok().then_some(slot), channel.rate, (before, after)));
        done
    }

    /// Waits until a start would be heard, at most until `deadline`.
    fn wait_free(&mut self, deadline: Time) -> Result<(), AdcError> {
        let from = self.flight.filter(|f| !f.landed).map_or(Time::default(), |f| f.expected);
        self.poll(from, deadline, Self::is_free)
    }

    /// Waits for the end of the conversion under way, at most until `deadline`. Tells whether the
    /// line, if there is one, did not.
    fn land(&mut self, deadline: Time) -> Result<bool, AdcError> {
        let Some(flight) = self.flight else { return Ok(false) };
        if flight.landed {
            // Its transfer failed; where the supply dropped, another one would bring the zero after a reset.
            return if self.adc()?.is_ready()? { Ok(false) } else { Err(AdcError::NotReady) };
        }
        let edge = self.line.is_there().then(|| self.listen(flight, deadline)).transpose()?;
        if edge != Some(Edge::Confirmed) {
            self.poll(flight.expected, deadline, |converter| converter.adc()?.is_ready())?;
        }
        self.flight = Some(Flight { landed: true, ..flight });
        Ok(edge == Some(Edge::None))
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
                self.line.early(&self.name);
                break;
            }
            self.line.timely();
            if self.adc()?.is_ready()? {
                return Ok(Edge::Confirmed);
            }
            if now >= until {
                break;
            }
        }
        if edge == Edge::None {
            self.mute |= self.line.missed(&self.name);
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
}

fn left(until: Time, now: Time) -> Duration {
    Duration::from_nanos(until.as_nanos().saturating_sub(now.as_nanos()))
}
