//! The fuzz targets of MAVLink over a fixed number of mutated seeds, without a fuzzer.

use irhorizon::mavlink::encode::Encoder;
use irhorizon::mavlink::messages;
use irhorizon::mavlink::signing::{Key, Signing};
use irhorizon::time::Time;

#[path = "../fuzz/bodies/mavlink_receive.rs"]
mod receive;
#[path = "../fuzz/bodies/mavlink_service.rs"]
mod serve;

/// xorshift64*: the same inputs each time.
struct Random(u64);

impl Random {
    fn below(&mut self, end: usize) -> usize {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 33) as usize % end.max(1)
    }
}

/// One of the seeds, or two of them joined, with a few bytes changed, taken out or put in.
fn mutated(seeds: &[Vec<u8>], random: &mut Random) -> Vec<u8> {
    let mut data = seeds[random.below(seeds.len())].clone();
    if random.below(2) == 0 {
        data.extend(&seeds[random.below(seeds.len())]);
    }
    for _ in 0..random.below(8) {
        let at = random.below(data.len());
        match random.below(4) {
            0 if data.len() > 1 => drop(data.remove(at)),
            1 => data.insert(at, random.below(256) as u8),
            2 => data.truncate(data.len() - random.below(4).min(data.len() - 1)),
            _ => data[at] = [0, 1, 2, 0x7f, 0x80, 0xfd, 0xff, random.below(256) as u8][random.below(8)],
        }
    }
    data
}

#[test]
fn whatever_arrives() {
    let mut encoder = Encoder::new(1, 191);
    let mut other = Signing::new(Key::new([1; 32]), 0, 0);
    let messages = [messages::autopilot_version(), messages::component_information(Time::from_nanos(5))];
    let mut seeds: Vec<Vec<u8>> = Vec::new();
    for message in &messages {
        seeds.push([&[7], encoder.encode(message)].concat());
        seeds.push([&[30], encoder.encode_signed(message, &mut other, 1, 5)].concat());
    }
    // HEARTBEAT of a quadrotor, MAVLink 1 and its CRC; and headers that promise more.
    seeds.push(vec![255, 0xfe, 9, 7, 3, 1, 0, 0, 0, 0, 0, 2, 3, 0, 4, 3, 0xfd, 0xff, 0, 0xfe, 0xff]);
    let mut random = Random(1);
    for _ in 0..50_000 {
        receive::receive(&mutated(&seeds, &mut random));
    }
}

#[test]
fn whatever_is_asked() {
    let mut seeds: Vec<Vec<u8>> = Vec::new();
    let command = |number: u16, params: [f32; 7]| {
        let mut payload: Vec<u8> = params.iter().flat_map(|p| p.to_le_bytes()).collect();
        payload.extend(number.to_le_bytes());
        payload.extend([1, 191, 0]);
        [&[4, 3, 3, 33], payload.as_slice()].concat()
    };
    for (number, params) in [
        (241, [0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0]),
        (510, [30.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
        (511, [31.0, 1e5, 0.0, 0.0, 0.0, 0.0, 0.0]),
        (512, [396.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
        (9999, [1.0; 7]),
    ] {
        seeds.push(command(number, params));
    }
    for (name, value) in [("IRH_ROLL_TRIM", 3.0_f32), ("IRH_ON_FAULT", 1.0), ("IRH_E1_ATT_HZ", 5.0)] {
        let mut id = [0; 16];
        id[..name.len()].copy_from_slice(name.as_bytes());
        seeds.push([&[2, 20, 3, 23], value.to_le_bytes().as_slice(), &[1, 191], &id, &[9]].concat());
        seeds.push([[0, 1, 3, 20, 0xff, 0xff, 1, 191].as_slice(), &id].concat());
    }
    seeds.push(vec![1, 1, 3, 2, 1, 191]);
    // Time goes by: a calibration ends, a list goes on.
    seeds.push([1_u8, 5, 3, 2, 1, 191].repeat(120));
    let mut random = Random(2);
    for _ in 0..3_000 {
        serve::serve(&mutated(&seeds, &mut random));
    }
}
