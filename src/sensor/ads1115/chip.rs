//! One chip with its pairs, as the hardware source walks over it: opening, counting, stamping.

use super::converter::Converter;
use super::driver::AdcError;
use super::ready::ReadyLine;
use super::setup::{Plan, SetupError};
use super::timing::{Clock, SystemClock};
use crate::bus::{BusError, WordBus};
use crate::config::settings::Ads1115Settings;
use crate::frame::{Missing, Reading, Sample, Value};
use crate::gpio::edge::EdgeInput;
use crate::gpio::{DataReady, GpioError};
use crate::sensor::Chip;
use crate::source::{Integrity, SensorHealth};

/// Opens the chip's end of its bus.
pub type OpenBus = Box<dyn FnMut() -> Result<Box<dyn WordBus>, BusError> + Send>;
/// Opens its data-ready line.
pub type OpenLine = Box<dyn FnMut() -> Result<Box<dyn DataReady>, GpioError> + Send>;

/// An ADS1115 with one or more sensors.
pub struct Ads1115Chip<C: Clock = SystemClock> {
    name: String,
    open_bus: OpenBus,
    open_line: Option<OpenLine>,
    line_trouble: Option<GpioError>,
    converter: Converter<C>,
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
        let converter = Converter::new(name.clone(), plan, clock);
        Self { name, open_bus, open_line, line_trouble: None, converter, opened: false, health }
    }

    /// Opens the data-ready line if it is not; without it the chip is polled.
    fn open_line(&mut self) {
        if self.converter.line.is_there() {
            return;
        }
        match self.open_line.as_mut().map(|open| open()) {
            None => {}
            Some(Ok(line)) => (self.converter.line, self.line_trouble) = (ReadyLine::new(line), None),
            Some(Err(trouble)) => {
                if self.line_trouble.as_ref() != Some(&trouble) {
                    log::error!("data-ready line of {}: {trouble}; conversions are polled", self.name);
                }
                self.line_trouble = Some(trouble);
            }
        }
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

impl<C: Clock> Chip for Ads1115Chip<C> {
    fn open(&mut self) -> Result<(), BusError> {
        self.close();
        let bus = (self.open_bus)()?;
        self.open_line();
        // Another chip at the address is no reason to open again: its readings say so.
        if let Err(AdcError::Bus(e)) = self.converter.connect(bus) {
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
        self.converter.disconnect();
    }

    fn begin(&mut self) {
        self.converter.begin();
    }

    fn read(&mut self, slot: usize) -> Reading {
        if slot >= self.health.len() {
            return Err(Missing::NotYet);
        }
        match self.converter.measure(slot) {
            Ok(measured) => {
                let counters = &mut self.health[slot].counters;
                counters.reads += 1;
                counters.not_ready += u64::from(measured.unannounced);
                Ok(Sample { value: Value::Volts(measured.volts), time: measured.time })
            }
            Err(e) => {
                self.count(slot, e);
                Err(e.missing())
            }
        }
    }

    fn health(&self, slot: usize) -> SensorHealth {
        self.health.get(slot).copied().unwrap_or_default()
    }
}
