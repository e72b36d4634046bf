//! Where frames come from: hardware, simulation and replay behind one trait.

use crate::bus::Counters;
use crate::frame::{Frame, Missing};
use crate::time::Time;

/// How the words that a sensor sends are checked on their way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Integrity {
    /// Nothing is read from a bus, or nothing was read yet.
    #[default]
    None,
    /// The adapter checks the packet error code of every word.
    Pec,
    /// The packet error code is checked in this process.
    SoftwarePec,
    /// The adapter has no PEC; words are unchecked.
    AdapterWithout,
    /// The sensor knows no PEC (ADS1115).
    SensorWithout,
    /// Switched off in the configuration (`pec = "off"`).
    SwitchedOff,
}

impl Integrity {
    /// A few words for log, status and D-Bus.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Pec => "pec",
            Self::SoftwarePec => "software-pec",
            Self::AdapterWithout => "unchecked: adapter has no PEC",
            Self::SensorWithout => "unchecked: sensor has no PEC",
            Self::SwitchedOff => "unchecked: PEC switched off",
        }
    }
}

/// What a source knows of one of its sensors besides the readings.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SensorHealth {
    /// How its words are checked.
    pub integrity: Integrity,
    /// What went well and what did not since start.
    pub counters: Counters,
    /// The time after which a step is shown, by the sensor's filter settings, s; 0 when unknown.
    pub settling_s: f64,
    /// The time constant of a first-order lag that is late by as much on the mean, s; 0 when unknown.
    pub lag_s: f64,
    /// Emissivity set in the sensor (MLX90614 cell 0x24), 0..1.
    pub emissivity: Option<f64>,
    /// The chip's identity (MLX90614 cells 0x3C to 0x3F, first cell in the highest 16 bits).
    pub identity: Option<u64>,
}

/// A source of frames.
pub trait FrameSource: Send {
    /// Makes one scan, begun at `tick`, into `frame`, whose readings number as many as the head's
    /// sensors. Bounded in time; what cannot be read becomes a [`Missing`].
    fn scan(&mut self, tick: Time, frame: &mut Frame);

    /// What is known of each sensor, in the head's order.
    fn health(&self) -> &[SensorHealth];

    /// Why each bus is down, in the head's order of buses; `None` for one that works.
    fn buses_down(&self) -> &[Option<Missing>];
}
