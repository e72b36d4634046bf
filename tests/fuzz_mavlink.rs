//! The fuzz targets of MAVLink over a fixed number of mutated seeds, without a fuzzer.

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
    let seeds = receive::seeds();
    let mut random = Random(1);
    for _ in 0..50_000 {
        receive::receive(&mutated(&seeds, &mut random));
    }
}

#[test]
fn whatever_is_asked() {
    let seeds = serve::seeds();
    let mut random = Random(2);
    for _ in 0..3_000 {
        serve::serve(&mutated(&seeds, &mut random));
    }
}
