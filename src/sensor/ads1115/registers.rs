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
/// The comparator stays at its reset state (traditional, active low, not latching): bits 4:2 are
/// written 0.
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
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Datasheet table of the config register, restated: name or value, code.
    const MUX: [(&str, u16); 8] = [
        ("ain0-ain1", 0b000),
        ("ain0-ain3", 0b001),
        ("ain1-ain3", 0b010),
        ("ain2-ain3", 0b011),
        ("ain0", 0b100),
        ("ain1", 0b101),
        ("ain2", 0b110),
        ("ain3", 0b111),
    ];
    const PGA: [(f64, u16); 6] =
        [(6.144, 0b000), (4.096, 0b001), (2.048, 0b010), (1.024, 0b011), (0.512, 0b100), (0.256, 0b101)];
    const DR: [(u16, u16); 8] =
        [(8, 0b000), (16, 0b001), (32, 0b010), (64, 0b011), (128, 0b100), (250, 0b101), (475, 0b110), (860, 0b111)];

    fn input(name: &str) -> AdcInput {
        AdcInput::NAMED.iter().find(|(n, _)| *n == name).unwrap().1
    }

    #[test]
    fn every_input_gain_and_rate_has_its_bits_and_comes_back() {
        for (name, mux) in MUX {
            for (full_scale_v, pga) in PGA {
                for (sps, dr) in DR {
                    for (os, single, queue) in [(0, 0, 0), (0, 1, 1), (1, 0, 2), (1, 1, 3)] {
                        let config = Config {
                            os: os == 1,
                            input: input(name),
                            gain: Gain::from_full_scale_v(full_scale_v).unwrap(),
                            conversion: [Conversion::Continuous, Conversion::SingleShot][single as usize],
                            rate: Rate::from_sps(sps).unwrap(),
                            queue: [Queue::One, Queue::Two, Queue::Four, Queue::Off][queue as usize],
                        };
                        let word = os * 32768 + mux * 4096 + pga * 512 + single * 256 + dr * 32 + queue;
                        assert_eq!(config.encode(), word, "{config:?}");
                        assert_eq!(Config::decode(word), config);
                    }
                }
            }
        }
    }

    #[test]
    fn the_reset_value_is_the_datasheets() {
        assert_eq!(Config::default().encode(), 0x8583);
        assert_eq!(Config::decode(0x8583), Config::default());
    }

    #[test]
    fn conversion_ready_needs_the_thresholds_top_bits_apart() {
        assert_eq!((READY_HI >> 15, READY_LO >> 15), (1, 0));
        assert_eq!((CONVERSION, CONFIG, LO_THRESH, HI_THRESH), (0, 1, 2, 3));
    }

    #[test]
    fn what_the_chip_cannot_do_is_none() {
        for v in [0.0, 2.0, 5.0, -2.048, f64::NAN, f64::INFINITY] {
            assert_eq!(Gain::from_full_scale_v(v), None, "{v}");
        }
        for sps in [0, 9, 1000, u16::MAX] {
            assert_eq!(Rate::from_sps(sps), None, "{sps}");
        }
    }

    #[test]
    fn volts_of_a_code() {
        // Size of a bit, µV: datasheet table "Full-scale range and corresponding LSB size".
        for (full_scale_v, lsb_uv) in
            [(6.144, 187.5), (4.096, 125.0), (2.048, 62.5), (1.024, 31.25), (0.512, 15.625), (0.256, 7.8125)]
        {
            let gain = Gain::from_full_scale_v(full_scale_v).unwrap();
            for code in [-32767_i16, -16384, -1000, -1, 0, 1, 2, 1000, 16384, 32766] {
                let volts = gain.volts(code).unwrap();
                assert!((volts - f64::from(code) * lsb_uv * 1e-6).abs() < 1e-12, "{full_scale_v} {code}");
            }
            assert_eq!(gain.volts(0x7fff), None);
            assert_eq!(gain.volts(0x8000_u16 as i16), None);
        }
    }

    #[test]
    fn conversion_times() {
        for (sps, micros) in [(8, 125_000.0), (128, 7_812.5), (250, 4_000.0), (860, 1_162.79)] {
            let time_s = Rate::from_sps(sps).unwrap().conversion_time().as_secs_f64();
            assert!((time_s * 1e6 - micros).abs() < 0.01, "{sps}");
        }
    }

    proptest! {
        #[test]
        fn any_word_decodes_and_keeps_its_meaning(word: u16) {
            let config = Config::decode(word);
            prop_assert_eq!(Config::decode(config.encode()), config);
            let spare_gain = word >> 9 & 7 > 5;
            if !spare_gain {
                prop_assert_eq!(config.encode(), word & !0x001c);
            }
        }
    }
}
