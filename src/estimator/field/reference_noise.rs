//! How much a slow reference is off, and for how long: learnt from how far it strays from the attitude.
//!
//! Air that rises and sinks, sideslip, an airspeed by a poor tube: no two aircraft are alike in it, and no two days. What
//! counts is what is left after seconds, the errors' variance times the time they last.

/// What strays is averaged over so long, s: longer than a gust.
const BLOCK_S: f64 = 8.0;
/// What is expected at first counts as much as so many blocks; so many are remembered.
const EXPECTED: f64 = 3.0;
const REMEMBERED: f64 = 30.0;
/// No less than this of what is expected, and no more.
const SIZES: (f64, f64) = (0.1, 30.0);

/// What one reference is off by, over what is expected of it.
#[derive(Clone, Copy, Debug)]
pub struct ReferenceNoise {
    size: f64,
    blocks: f64,
    block: Block,
}

#[derive(Clone, Copy, Debug, Default)]
struct Block {
    time_s: f64,
    /// The integral of what strays, rad s.
    off: f64,
    /// Of the errors that were expected, rad² s².
    expected: f64,
}

impl Default for ReferenceNoise {
    fn default() -> Self {
        Self { size: 1.0, blocks: 0.0, block: Block::default() }
    }
}

impl ReferenceNoise {
    /// How large the errors' variance is, over what is expected.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// For `dt_s` it strayed by `off` (rad), where errors of `expected` (rad² s: a variance times how long they last) were
    /// expected; `known` tells with what variance (rad²) all else is known that it was compared with.
    pub fn hear(&mut self, off: f64, expected: f64, dt_s: f64, known: impl FnOnce() -> f64) {
        let block = &mut self.block;
        block.time_s += dt_s;
        block.off += dt_s * off;
        block.expected += dt_s * expected;
        if block.time_s < BLOCK_S {
            return;
        }
        let Block { time_s, off, expected } = std::mem::take(block);
        let own = self.size * expected / (time_s * time_s);
        let variance = own + known();
        let stray = (off / time_s).powi(2) / variance;
        self.blocks = (self.blocks + 1.0).min(REMEMBERED);
        let learnt = 1.0 + own / variance * (stray - 1.0) / (EXPECTED + self.blocks);
        self.size = (self.size * learnt).clamp(SIZES.0, SIZES.1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulation::noise::Noise;

    /// Errors of `sigma` that are new every `lasts_s`, where 0.1 rad for a second each were expected; all else is known with
    /// `known`.
    fn learnt(sigma: f64, lasts_s: f64, seconds: f64, known: f64) -> f64 {
        let (mut noise, mut errors) = (ReferenceNoise::default(), Noise::new(3));
        let (mut off, mut next_s) = (0.0, 0.0);
        for i in 0..(seconds / 0.1) as u32 {
            if 0.1 * f64::from(i) >= next_s {
                off = sigma * errors.normal();
                next_s += lasts_s;
            }
            noise.hear(off, 0.01, 0.1, || known);
        }
        noise.size()
    }

    /// The variance of a mean over T of errors that last for t is σ²·t/T.
    #[test]
    fn it_finds_the_variance_times_the_time() {
        for (sigma, lasts_s) in [(0.05, 1.0), (0.1, 1.0), (0.2, 1.0), (0.2, 2.0)] {
            let (found, truly) = (learnt(sigma, lasts_s, 1200.0, 0.0), sigma * sigma * lasts_s / 0.01);
            assert!((0.6..1.6).contains(&(found / truly)), "{sigma} rad for {lasts_s} s: {found} of {truly}");
        }
    }

    #[test]
    fn what_is_not_known_itself_tells_little() {
        assert!(learnt(0.3, 1.0, 80.0, 0.0) > 3.0);
        assert!(learnt(0.3, 1.0, 80.0, 1.0) < 1.1);
    }

    #[test]
    fn it_stays_within_its_bounds_whatever_is_heard() {
        assert_eq!(learnt(1e3, 1.0, 800.0, 0.0), SIZES.1);
        assert_eq!(learnt(0.0, 1.0, 4000.0, 0.0), SIZES.0);
    }
}
