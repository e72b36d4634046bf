//! One scan of the head: for each sensor a stamped reading, or the reason why there is none.

use crate::time::Time;
use std::fmt;

/// A die temperature that was read longer ago is not given any more, s.
pub const AMBIENT_LASTS_S: f64 = 10.0;

/// What a sensor measured, in the unit it measures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// An absolute thermopile (MLX90614).
    Absolute {
        /// Temperature of what it looks at, °C.
        object_c: f64,
        /// Its own die temperature, °C, the last one read; `None` before the first.
        ambient_c: Option<f64>,
    },
    /// An ADC channel that carries a pair's difference, V.
    Volts(f64),
}

impl Value {
    /// The sensor's own die temperature, °C, if it shows one and it has been read.
    pub fn ambient_c(self) -> Option<f64> {
        match self {
            Self::Absolute { ambient_c, .. } => ambient_c,
            Self::Volts(_) => None,
        }
    }
}

/// A measurement with the time of its successful conversion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// What was measured.
    pub value: Value,
    /// When: the end of the read that succeeded.
    pub time: Time,
}

/// Why a sensor gave no measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Missing {
    /// Nothing has been asked of it yet.
    NotYet,
    /// No acknowledge at its address (ENXIO, EREMOTEIO, ENODEV).
    NoAnswer,
    /// The packet error code did not match (EBADMSG).
    BadPec,
    /// The sensor's own error bit was set (MLX90614 datasheet, bit 15 of a temperature).
    ErrorFlag,
    /// A value at the end of the converter's range.
    Saturated,
    /// A value that the sensor cannot give (outside its datasheet's range), or cannot have seen (it jumps as no scene does).
    Impossible,
    /// A conversion did not finish in its time.
    NotReady,
    /// The bus is held: the transfer timed out (ETIMEDOUT).
    BusHeld,
    /// Another transfer error of the adapter.
    BusError,
    /// A kernel driver has claimed the address (EBUSY).
    Claimed,
    /// The adapter is absent or went away.
    BusGone,
    /// Another program of this project holds the bus.
    BusInUse,
    /// The device file may not be opened (EACCES, EPERM).
    Denied,
    /// The chip is being power-cycled.
    PoweredOff,
    /// An empty or unusable cell of a recording.
    Empty,
}

impl Missing {
    const ALL: [Self; 15] = [
        Self::NotYet,
        Self::NoAnswer,
        Self::BadPec,
        Self::ErrorFlag,
        Self::Saturated,
        Self::Impossible,
        Self::NotReady,
        Self::BusHeld,
        Self::BusError,
        Self::Claimed,
        Self::BusGone,
        Self::BusInUse,
        Self::Denied,
        Self::PoweredOff,
        Self::Empty,
    ];

    /// Whether it takes the whole bus down, and not one sensor on it.
    pub fn is_of_the_bus(self) -> bool {
        matches!(self, Self::BusGone | Self::BusHeld | Self::BusInUse | Self::Denied)
    }

    /// The reason that is told by these words.
    pub fn from_words(words: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|m| m.as_str() == words)
    }

    /// A few words for status, log and D-Bus.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::NotYet => "not read yet",
            Self::NoAnswer => "no answer",
            Self::BadPec => "PEC mismatch",
            Self::ErrorFlag => "error bit set",
            Self::Saturated => "saturated",
            Self::Impossible => "impossible value",
            Self::NotReady => "conversion not ready",
            Self::BusHeld => "bus held",
            Self::BusError => "bus error",
            Self::Claimed => "claimed by a kernel driver",
            Self::BusGone => "bus gone",
            Self::BusInUse => "bus in use",
            Self::Denied => "permission denied",
            Self::PoweredOff => "being power-cycled",
            Self::Empty => "no reading",
        }
    }
}

impl fmt::Display for Missing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

/// A sensor's part of a frame.
pub type Reading = Result<Sample, Missing>;

/// What other instruments said since the last frame; `None` where nothing new came.
///
/// Never a truth to be believed by itself: see the estimators for what each is used for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Aiding {
    /// Body rates about x (nose), y (right), z (down), °/s.
    pub gyro_deg_s: [Option<f64>; 3],
    /// Airspeed, m/s.
    pub airspeed_m_s: Option<f64>,
    /// GPS ground speed, m/s.
    pub ground_speed_m_s: Option<f64>,
    /// GPS course over ground, ° clockwise from north.
    pub course_deg: Option<f64>,
    /// Climb rate, m/s, up positive.
    pub climb_m_s: Option<f64>,
    /// Altitude, m.
    pub altitude_m: Option<f64>,
}

/// One scan of the head. Hardware, simulation and replay are three sources of frames,
/// alike to everything after them.
#[derive(Debug, Default, PartialEq)]
pub struct Frame {
    /// When the scan ended.
    pub time: Time,
    /// One reading for each sensor of the head, in the head's order.
    pub readings: Vec<Reading>,
    /// What arrived beside them.
    pub aiding: Aiding,
}

/// Copying one frame over another allocates nothing when they have as many readings.
impl Clone for Frame {
    fn clone(&self) -> Self {
        Self { readings: self.readings.clone(), ..*self }
    }

    fn clone_from(&mut self, other: &Self) {
        let mut readings = std::mem::take(&mut self.readings);
        readings.clone_from(&other.readings);
        *self = Self { readings, ..*other };
    }
}

impl Frame {
    /// A frame of `sensors` readings, all [`Missing::NotYet`].
    pub fn new(sensors: usize) -> Self {
        Self { time: Time::default(), readings: vec![Err(Missing::NotYet); sensors], aiding: Aiding::default() }
    }

    /// The time of the newest successful conversion in this frame.
    pub fn sample_time(&self) -> Option<Time> {
        self.readings.iter().flatten().map(|s| s.time).max()
    }
}
