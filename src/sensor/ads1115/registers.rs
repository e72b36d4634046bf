//! Registers, bits and units: ADS1115 datasheet 8.1 (register map of SBAS444).

use crate::config::settings::AdcInput;
use std::time::Duration;

/// Conversion register: the last result, two's complement.
pub const CONVERSION: u8 = 0;
/// Config register.
pub const CONFIG: u8 = 1;
/// Lo_thresh register.
pub const LO_THRESH: u8 = 2;
/// Hi_thresh register.
pub const HI_THRESH: u8 = 3;

/// Lo_thresh that makes ALERT/RDY the conversion-ready output: bit 15 clear.
pub const READY_LO: u16 = 0x0000;
/// Hi_thresh that makes ALERT/RDY the conversion-ready output: bit 15 set.
pub const READY_HI: u16 = 0x8000;

/// Full scale of the programmable gain amplifier, PGA 11:9.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Gain {
    /// ±6.144 V (never more than the supply + 0.3 V on a pin).
    V6_144,
    /// ±4.096 V.
    V4_096,
    /// ±2.048 V.
    #[default]
    V2_048,
    /// ±1.024 V.
    V1_024,
    /// ±0.512 V.
    V0_512,
    /// ±0.256 V.
    V0_256,
}

impl Gain {
    /// All gains in the order of their codes.
    pub const ALL: [Self; 6] = [Self::V6_144, Self::V4_096, Self::V2_048, Self::V1_024, Self::V0_512, Self::V0_256];

    /// Full scale, V.
    pub const fn full_scale_v(self) -> f64 {
        match self {
            Self::V6_144 => 6.144,
            Self::V4_096 => 4.096,
            Self::V2_048 => 2.048,
            Self::V1_024 => 1.024,
            Self::V0_512 => 0.512,
            Self::V0_256 => 0.256,
        }
    }

    /// The gain whose full scale is `v` volts; `None` when the chip has none such.
    pub fn from_full_scale_v(v: f64) -> Option<Self> {
        Self::ALL.into_iter().find(|g| (g.full_scale_v() - v).abs() < 1e-6)
    }

    /// The volts that `code` stands for; `None` at either end of the range, where the input may
    /// be anything beyond.
    pub fn volts(self, code: i16) -> Option<f64> {
        if code == i16::MAX || code == i16::MIN {
            return None;
        }
        Some(f64::from(code) * self.full_scale_v() / 32768.0)
    }
}

/// Conversions a second, DR 7:5.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Rate {
    /// 8 a second.
    Sps8,
    /// 16 a second.
    Sps16,
    /// 32 a second.
    Sps32,
    /// 64 a second.
    Sps64,
    /// 128 a second.
    #[default]
    Sps128,
    /// 250 a second.
    Sps250,
    /// 475 a second.
    Sps475,
    /// 860 a second.
    Sps860,
}

impl Rate {
    /// All rates in the order of their codes.
    pub const ALL: [Self; 8] =
        [Self::Sps8, Self::Sps16, Self::Sps32, Self::Sps64, Self::Sps128, Self::Sps250, Self::Sps475, Self::Sps860];

    /// Conversions a second.
    pub const fn sps(self) -> u16 {
        match self {
            Self::Sps8 => 8,
            Self::Sps16 => 16,
            Self::Sps32 => 32,
            Self::Sps64 => 64,
            Self::Sps128 => 128,
            Self::Sps250 => 250,
            Self::Sps475 => 475,
            Self::Sps860 => 860,
        }
    }

    /// The rate of `sps` conversions a second; `None` when the chip has none such.
    pub fn from_sps(sps: u16) -> Option<Self> {
        Self::ALL.into_iter().find(|r| r.sps() == sps)
    }

    /// The nominal time of a conversion; the oscillator is good to 10 % (datasheet 6.5).
    pub fn conversion_time(self) -> Duration {
        Duration::from_nanos(1_000_000_000_u64.div_ceil(u64::from(self.sps())))
    }
}

/// MODE 8: how the chip converts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Conversion {
    /// All the time.
    Continuous,
    /// Once for each start, powered down between.
    #[default]
    SingleShot,
}

/// COMP_QUE 1:0: whether ALERT/RDY does anything.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Queue {
    /// After one conversion.
    One,
    /// After two.
    Two,
    /// After four.
    Four,
    /// Off: the pin is high-impedance.
    #[default]
    Off,
}

/// The config register. The default is what the chip holds after a reset (0x8583).
///
/// The comparator stays at its reset state (traditional, active low, not latching): bits 4:2 are 0
/// here; what the driver makes of them where it is off, it says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Config {
    /// OS 15. Written: start a conversion, without effect while one is under way. Read: no
    /// conversion is under way.
    pub os: bool,
    /// MUX 14:12.
    pub input: AdcInput,
    /// PGA 11:9.
    pub gain: Gain,
    /// MODE 8.
    pub conversion: Conversion,
    /// DR 7:5.
    pub rate: Rate,
    /// COMP_QUE 1:0.
    pub queue: Queue,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            os: true,
            input: AdcInput::Ain0Ain1,
            gain: Gain::default(),
            conversion: Conversion::default(),
            rate: Rate::default(),
            queue: Queue::default(),
        }
    }
}

impl Config {
    /// The bits that decide what is measured and how: MUX, PGA, MODE, DR. They read back as
    /// written, or the chip is not the one that was set up.
    pub const SETTINGS: u16 = 0x7fe0;

    /// The register's word.
    pub fn encode(self) -> u16 {
        let mux = AdcInput::NAMED.iter().position(|(_, i)| *i == self.input).unwrap_or(0) as u16;
        u16::from(self.os) << 15
            | mux << 12
            | (self.gain as u16) << 9
            | (self.conversion as u16) << 8
            | (self.rate as u16) << 5
            | self.queue as u16
    }

    /// What `word` says; the PGA's two spare codes mean ±0.256 V, as in the chip.
    pub fn decode(word: u16) -> Self {
        Self {
            os: word & 0x8000 != 0,
            input: AdcInput::NAMED[usize::from(word >> 12 & 7)].1,
            gain: Gain::ALL[usize::from(word >> 9 & 7).min(5)],
            conversion: if word & 0x0100 != 0 { Conversion::SingleShot } else { Conversion::Continuous },
            rate: Rate::ALL[usize::from(word >> 5 & 7)],
            queue: [Queue::One, Queue::Two, Queue::Four, Queue::Off][usize::from(word & 3)],
        }
    }
}

#[cfg(test)]
mod tests;
