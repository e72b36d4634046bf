//! `[[sensor]]`: what is read, and by which lines.

use crate::direction::Direction;
use std::path::PathBuf;

/// One `[[sensor]]`.
#[derive(Clone, Debug, PartialEq)]
pub struct SensorSettings {
    /// Lower-case letters, digits and `_`, a letter first.
    pub name: String,
    /// Where it looks; for a pair, the direction whose rising raises its signal.
    pub direction: Direction,
    /// The chip it is read from.
    pub device: DeviceSettings,
    /// A line that feeds it, to power-cycle it when it hangs.
    pub power: Option<LineSettings>,
}

/// The chip a sensor is read from.
#[derive(Clone, Debug, PartialEq)]
pub enum DeviceSettings {
    /// A digital thermopile.
    Mlx90614(Mlx90614Settings),
    /// A channel of an ADC that carries a pair's difference.
    Ads1115(Ads1115Settings),
}

impl DeviceSettings {
    /// The bus it is on.
    pub fn bus(&self) -> &PathBuf {
        match self {
            Self::Mlx90614(m) => &m.bus,
            Self::Ads1115(a) => &a.bus,
        }
    }

    /// Its address on the bus, 7 bits.
    pub fn address(&self) -> u8 {
        match self {
            Self::Mlx90614(m) => m.address,
            Self::Ads1115(a) => a.address,
        }
    }
}

/// A digital thermopile (`kind = "mlx90614"`).
#[derive(Clone, Debug, PartialEq)]
pub struct Mlx90614Settings {
    /// `/dev/i2c-N`.
    pub bus: PathBuf,
    /// 0x03 to 0x77.
    pub address: u8,
    /// Which of a dual-zone part's objects: 1 or 2.
    pub object: u8,
    /// What to do about the packet error code.
    pub pec: PecPolicy,
    /// How much more it shows than the head's others of the same scene, K.
    pub offset_c: f64,
}

/// What to do about the packet error code of an MLX90614.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PecPolicy {
    /// Check it where the adapter can, say so where it cannot.
    #[default]
    Auto,
    /// Without it the sensor counts as lost.
    Required,
    /// Never check it: for parts and adapters whose read PEC does not match.
    Off,
}

/// A channel of an ADC (`kind = "ads1115"`).
#[derive(Clone, Debug, PartialEq)]
pub struct Ads1115Settings {
    /// `/dev/i2c-N`.
    pub bus: PathBuf,
    /// 0x48 to 0x4b.
    pub address: u8,
    /// The pins.
    pub input: AdcInput,
    /// Full scale, V: 6.144, 4.096, 2.048, 1.024, 0.512 or 0.256.
    pub gain_v: f64,
    /// Samples a second: 8, 16, 32, 64, 128, 250, 475 or 860.
    pub data_rate_sps: u16,
    /// Convert all the time (needs the chip to itself) instead of once for each scan.
    pub continuous: bool,
    /// The pair's voltage when it sees no difference, V.
    pub neutral_v: f64,
    /// Kelvin for a volt; negative for a pair wired inverted; never 0.
    pub kelvin_per_v: f64,
    /// The line that ALERT/RDY is wired to; without it the conversion is waited for and polled.
    pub data_ready: Option<LineSettings>,
}

/// Which pins an ADC channel measures: ADS1115 datasheet, MUX 14:12.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AdcInput {
    /// `ain0-ain1`
    Ain0Ain1,
    /// `ain0-ain3`
    Ain0Ain3,
    /// `ain1-ain3`
    Ain1Ain3,
    /// `ain2-ain3`
    Ain2Ain3,
    /// `ain0`, against ground.
    Ain0,
    /// `ain1`, against ground.
    Ain1,
    /// `ain2`, against ground.
    Ain2,
    /// `ain3`, against ground.
    Ain3,
}

impl AdcInput {
    /// All inputs with the names that configuration spells them by, in the order of the MUX codes.
    pub const NAMED: [(&'static str, Self); 8] = [
        ("ain0-ain1", Self::Ain0Ain1),
        ("ain0-ain3", Self::Ain0Ain3),
        ("ain1-ain3", Self::Ain1Ain3),
        ("ain2-ain3", Self::Ain2Ain3),
        ("ain0", Self::Ain0),
        ("ain1", Self::Ain1),
        ("ain2", Self::Ain2),
        ("ain3", Self::Ain3),
    ];
}

/// A GPIO line.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct LineSettings {
    /// The chip's label (`pinctrl-bcm2711`), or `/dev/gpiochipN`.
    pub chip: String,
    /// The line's offset on it.
    pub line: u32,
    /// Whether the line is active when low.
    pub active_low: bool,
}
