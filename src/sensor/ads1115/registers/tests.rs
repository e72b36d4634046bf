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
