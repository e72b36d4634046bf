//! Addresses and meanings of the MLX90614's words.

use crate::frame::Missing;

/// RAM: raw data of IR channel 1, sign and magnitude.
pub const RAW_IR_1: u8 = 0x04;
/// RAM: raw data of IR channel 2, sign and magnitude.
pub const RAW_IR_2: u8 = 0x05;
/// RAM: die temperature.
pub const AMBIENT: u8 = 0x06;
/// RAM: temperature of object 1.
pub const OBJECT_1: u8 = 0x07;
/// RAM: temperature of object 2 (dual-zone parts).
pub const OBJECT_2: u8 = 0x08;
/// EEPROM: emissivity, 65535 = 1.
pub const EMISSIVITY: u8 = 0x24;
/// EEPROM: configuration register 1.
pub const CONFIGURATION: u8 = 0x25;
/// EEPROM: SMBus address in the low byte.
pub const ADDRESS: u8 = 0x2E;
/// EEPROM: identity, four cells.
pub const IDENTITY: [u8; 4] = [0x3C, 0x3D, 0x3E, 0x3F];

/// 0.02 K a bit (datasheet 8.7.3).
fn celsius(word: u16) -> f64 {
    f64::from(word) / 50.0 - 273.15
}

fn temperature(word: u16, lowest_c: f64, highest_c: f64) -> Result<f64, Missing> {
    if word & 0x8000 != 0 {
        return Err(Missing::ErrorFlag);
    }
    let t = celsius(word);
    // Half a bit of tolerance: the limits themselves are not whole bits.
    if t < lowest_c - 0.01 || t > highest_c + 0.01 { Err(Missing::Impossible) } else { Ok(t) }
}

/// The temperature of an object, °C: −70 to 382.19, the range that the datasheet gives.
pub fn object_c(word: u16) -> Result<f64, Missing> {
    temperature(word, -70.0, 382.19)
}

/// The die temperature, °C: −40 to 125, the range that the datasheet gives.
pub fn ambient_c(word: u16) -> Result<f64, Missing> {
    temperature(word, -40.0, 125.0)
}

/// A raw IR channel: sign and magnitude.
pub const fn raw_ir(word: u16) -> i32 {
    let magnitude = (word & 0x7FFF) as i32;
    if word & 0x8000 == 0 { magnitude } else { -magnitude }
}

/// The emissivity that the sensor reckons with, 0 to 1.
pub fn emissivity(word: u16) -> f64 {
    f64::from(word) / 65535.0
}

/// Configuration register 1 (cell 0x25).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Configuration(pub u16);

/// What the factory calibrated with and nobody may change: bits 14 to 11, 7 and 3.
pub const FACTORY_BITS: u16 = 0x7888;

impl Configuration {
    /// The code of the IIR filter, bits 2 to 0.
    pub const fn iir_code(self) -> u16 {
        self.0 & 0x0007
    }

    /// The code of the FIR filter, bits 10 to 8.
    pub const fn fir_code(self) -> u16 {
        self.0 >> 8 & 0x0007
    }

    /// The share of a new value in the IIR filter's output, %.
    pub const fn iir_percent(self) -> u16 {
        [50, 25, 17, 13, 100, 80, 67, 57][self.iir_code() as usize]
    }

    /// The length of the FIR filter.
    pub const fn fir_length(self) -> u16 {
        8 << self.fir_code()
    }

    /// Whether two IR channels are measured (bit 6): dual-zone and gradient-compensated parts.
    pub const fn dual(self) -> bool {
        self.0 & 0x0040 != 0
    }

    /// This with other filters: codes 0 to 7; the rest stays.
    pub const fn with_filters(self, iir_code: u16, fir_code: u16) -> Self {
        Self(self.0 & !0x0707 | iir_code & 7 | (fir_code & 7) << 8)
    }

    /// Settling time, s.
    ///
    /// The rows of 100 %, 50 % and the ends of 13 % are the datasheet's for single-zone parts; the
    /// others follow from the 50 % row by the filter's equation, rounded up. FIR 8 to 64, which the
    /// datasheet recommends against, settle no slower than FIR 128 and are given its time. Two IR
    /// channels take 1.55 times as long (1.33 s of a factory xCF against 0.86 s).
    pub fn settling_s(self) -> f64 {
        const FIR_128_TO_1024: [[f64; 4]; 8] = [
            [0.30, 0.37, 0.54, 0.86], // 50 %
            [0.73, 0.90, 1.31, 2.08], // 25 %
            [1.15, 1.42, 2.06, 3.28], // 17 %
            [1.50, 1.93, 2.81, 4.50], // 13 %
            [0.04, 0.05, 0.06, 0.10], // 100 %
            [0.13, 0.16, 0.24, 0.38], // 80 %
            [0.20, 0.24, 0.35, 0.55], // 67 %
            [0.25, 0.31, 0.45, 0.71], // 57 %
        ];
        let row = FIR_128_TO_1024[usize::from(self.iir_code())];
        let single = row[usize::from(self.fir_code()).saturating_sub(4)];
        if self.dual() { single * 1.55 } else { single }
    }

    /// The time constant of the first-order lag that delays a ramp by as much as the filters do, s.
    ///
    /// The settling time is not a time constant: it is how long until a step is shown, all but 0.3 %
    /// of it. With the IIR filter off (100 %) it is one cycle T of averaging and writing out (the
    /// datasheet's other rows are so many steps of T as the filter's equation takes to 0.3 %). A value
    /// averaged over a cycle is late by T/2, and it stands in its cell for another T/2 on the mean. The
    /// IIR filter `y ← a·x + (1−a)·y` adds (1−a)/a cycles. Together T/a.
    pub fn lag_s(self) -> f64 {
        const SHARE: [f64; 8] = [1.0 / 2.0, 1.0 / 4.0, 1.0 / 6.0, 1.0 / 8.0, 1.0, 4.0 / 5.0, 2.0 / 3.0, 4.0 / 7.0];
        self.with_filters(0b100, self.fir_code()).settling_s() / SHARE[usize::from(self.iir_code())]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The datasheet in hundredths of a degree, in integers: −273.15 °C + 0.02 °C a bit.
    fn hundredths(word: u16) -> i64 {
        i64::from(word) * 2 - 27315
    }

    #[test]
    fn every_word_of_a_temperature_register() {
        for word in 0..=u16::MAX {
            let c = hundredths(word);
            for (reading, lowest, highest) in [(object_c(word), -7000, 38219), (ambient_c(word), -4000, 12500)] {
                match reading {
                    Ok(t) => {
                        assert!(word < 0x8000 && (lowest - 1..=highest + 1).contains(&c), "{word:#06x}");
                        assert!((t * 100.0 - c as f64).abs() < 1e-9, "{word:#06x}: {t}");
                    }
                    Err(Missing::ErrorFlag) => assert!(word >= 0x8000, "{word:#06x}"),
                    Err(Missing::Impossible) => {
                        assert!(word < 0x8000 && !(lowest..=highest).contains(&c), "{word:#06x}");
                    }
                    Err(other) => panic!("{word:#06x}: {other}"),
                }
            }
        }
    }

    #[test]
    fn the_datasheets_examples() {
        assert!((object_c(0x3AF7).unwrap() - 28.75).abs() < 1e-9);
        assert!((object_c(0x3AD2).unwrap() - 28.01).abs() < 1e-9);
        assert!((ambient_c(0x3ADF).unwrap() - 28.27).abs() < 1e-9);
        assert_eq!(object_c(0x8000), Err(Missing::ErrorFlag));
        assert_eq!(object_c(0), Err(Missing::Impossible));
        assert!((object_c(0x7FFF).unwrap() - 382.19).abs() < 1e-9);
    }

    #[test]
    fn raw_channels_are_sign_and_magnitude() {
        for (word, raw) in [(0, 0), (1, 1), (0x7FFF, 32767), (0x8000, 0), (0x8001, -1), (0xFFFF, -32767)] {
            assert_eq!(raw_ir(word), raw, "{word:#06x}");
        }
    }

    #[test]
    fn emissivity_spans_zero_to_one() {
        assert_eq!(emissivity(0xFFFF), 1.0);
        assert_eq!(emissivity(0), 0.0);
        assert!((emissivity(0xF332) - 0.95).abs() < 1e-4);
    }

    #[test]
    fn the_settling_table() {
        // (IIR code, FIR code, s): datasheet, single-zone parts.
        for (iir, fir, settling) in [
            (0b100, 0b100, 0.04),
            (0b100, 0b101, 0.05),
            (0b100, 0b110, 0.06),
            (0b100, 0b111, 0.10),
            (0b000, 0b100, 0.30),
            (0b000, 0b101, 0.37),
            (0b000, 0b110, 0.54),
            (0b000, 0b111, 0.86),
            (0b011, 0b100, 1.50),
            (0b011, 0b111, 4.50),
        ] {
            assert_eq!(Configuration(iir | fir << 8).settling_s(), settling, "{iir:03b} {fir:03b}");
        }
        let xaa = Configuration(0x9FB4);
        assert_eq!((xaa.settling_s(), xaa.iir_percent(), xaa.fir_length(), xaa.dual()), (0.10, 100, 1024, false));
        let two_channels = Configuration(0x0740).settling_s();
        assert!((1.33..1.34).contains(&two_channels), "{two_channels}");
    }

    #[test]
    fn rows_in_between_follow_the_filters_equation() {
        // y ← a·x + (1−a)·y: the steps to settle go with −1/ln(1−a).
        for (code, a) in [(1, 0.25), (2, 1.0 / 6.0), (3, 0.125), (5, 0.8), (6, 2.0 / 3.0), (7, 4.0 / 7.0)] {
            for (fir, half) in [(4, 0.30), (5, 0.37), (6, 0.54), (7, 0.86)] {
                let exact: f64 = half * 0.5_f64.ln() / (1.0_f64 - a).ln();
                let table = Configuration(code | fir << 8).settling_s();
                assert!((table - exact).abs() < 0.02 + 0.04 * exact, "code {code} FIR {fir}: {table} against {exact}");
            }
        }
    }

    /// The filters run step by step on a ramp of 1 K/s, read 50 times in each cycle: how late the
    /// words are on the mean.
    #[test]
    fn the_lag_is_how_late_a_ramp_is_shown() {
        for (word, cycle_s, a) in
            [(0x9FB4, 0.1, 1.0), (0x9FB0, 0.1, 0.5), (0x9CB3, 0.04, 0.125), (0x9EB5, 0.06, 0.8), (0x9FF0, 0.155, 0.5)]
        {
            let (mut word_c, mut late, mut reads) = (0.0_f64, 0.0, 0.0);
            for cycle in 0..400 {
                let end_s = f64::from(cycle + 1) * cycle_s;
                // The mean of the ramp over the cycle that has ended; then it is read till the next.
                word_c += a * (end_s - cycle_s / 2.0 - word_c);
                for i in (0..50).filter(|_| cycle >= 300) {
                    late += end_s + (f64::from(i) + 0.5) / 50.0 * cycle_s - word_c;
                    reads += 1.0;
                }
            }
            let (lag_s, late_s) = (Configuration(word).lag_s(), late / reads);
            assert!((lag_s - late_s).abs() < 1e-6, "{word:04x}: {lag_s} for {late_s}");
        }
        assert!((0..=u16::MAX).all(|word| (0.04..1.3).contains(&Configuration(word).lag_s())));
    }

    #[test]
    fn settling_never_falls_with_more_filtering() {
        for word in 0..=u16::MAX {
            let c = Configuration(word);
            assert!((0.04..=7.0).contains(&c.settling_s()));
            if c.fir_code() < 7 {
                assert!(c.with_filters(c.iir_code(), c.fir_code() + 1).settling_s() >= c.settling_s());
            }
            assert_eq!(c.with_filters(c.iir_code(), c.fir_code()), c);
        }
    }
}
