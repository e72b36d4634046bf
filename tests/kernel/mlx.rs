//! Six MLX90614 on a bus, moved by writing their registers.

use crate::adapter::{Adapter, Chip};
use crate::flight::Sensors;
use crate::sky::six_c;

/// Addresses of nose, tail, left, right, up, down.
pub const ADDRESSES: [u16; 6] = [0x5b, 0x5c, 0x5d, 0x5e, 0x5f, 0x60];
pub const NAMES: [&str; 6] = ["nose", "tail", "left", "right", "up", "down"];

/// 0.02 K a bit.
pub fn word(celsius: f64) -> u16 {
    ((celsius + 273.15) * 50.0).round() as u16
}

/// The six sensors' registers.
pub struct SixMlx(Vec<Chip>);

impl SixMlx {
    /// Level flight; dies at 20 to 25 °C, emissivity 0.98, the configuration that parts with one
    /// field of view leave the factory with, identities that end in the address.
    pub fn new(bus: &Adapter) -> Self {
        let mut chips: Vec<Chip> = ADDRESSES.iter().map(|a| bus.chip(*a)).collect();
        for (i, (chip, address)) in chips.iter_mut().zip(ADDRESSES).enumerate() {
            chip.write(0x06, word(20.0 + i as f64));
            chip.write(0x24, 64224);
            chip.write(0x25, 0x9FB4);
            chip.write(0x2E, 0xBE00 + address);
            for (cell, word) in [(0x3C, 0x1234), (0x3D, 0xABCD), (0x3E, 0x0001), (0x3F, address)] {
                chip.write(cell, word);
            }
        }
        let mut six = Self(chips);
        six.show(0.0, 0.0);
        six
    }

    /// Writes the object temperatures' registers, in the order of [`NAMES`].
    pub fn write(&mut self, words: [u16; 6]) {
        for (chip, word) in self.0.iter_mut().zip(words) {
            chip.write(0x07, word);
        }
    }

    /// The part of a configuration that names them.
    pub fn config(bus: &Adapter) -> String {
        let sensor = |(name, address): (&&str, &u16)| {
            format!("[[sensor]]\nname = \"{name}\"\nkind = \"mlx90614\"\nbus = \"{}\"\naddress = {address}\n", bus.path)
        };
        NAMES.iter().zip(&ADDRESSES).map(sensor).collect()
    }
}

impl Sensors for SixMlx {
    fn columns(&self) -> &'static [&'static str] {
        &NAMES
    }

    fn show(&mut self, roll_deg: f64, pitch_deg: f64) -> Vec<f64> {
        let words = six_c(roll_deg, pitch_deg).map(word);
        self.write(words);
        words.map(f64::from).to_vec()
    }

    fn pairs_k(&self, raw: &[f64]) -> [f64; 3] {
        [raw[1] - raw[0], raw[3] - raw[2], raw[5] - raw[4]].map(|bits| bits * 0.02)
    }
}
