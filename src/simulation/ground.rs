//! A ground of warm and cold patches, as fields, woods and lakes are.

use super::noise::Noise;

/// Between two rays of a scene, rad, about: what is finer than that averages out.
const RAY_RAD: f64 = 0.09;
/// The rms of values that are interpolated between corners of rms 1, along both sides of a square.
const INTERPOLATED_RMS: f64 = 26.0 / 35.0;

/// Patches in a square grid, one warmth at each corner, smooth between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patchwork {
    /// Their warmth, K rms.
    pub rms_k: f64,
    /// From one to the next, m.
    pub cell_m: f64,
    /// Which is warm.
    pub seed: u64,
}

impl Patchwork {
    /// The warmth, K, of the ground that is seen in a direction (north, east, up) from a place (m to
    /// north, to east, above the ground); 0 on average, and where the patches blur into each other.
    pub(super) fn warmth_k(&self, from_m: [f64; 3], direction: [f64; 3]) -> f64 {
        let down = -direction[2];
        if down.is_nan() || down < 0.01 {
            return 0.0;
        }
        let reach_m = from_m[2].max(1.0) / down;
        let [x, y] = [0, 1].map(|i| (from_m[i] + direction[i] * reach_m) / self.cell_m);
        let blur_m = RAY_RAD * reach_m / down;
        self.rms_k * (self.cell_m / blur_m).min(1.0) * self.pattern(x, y) / INTERPOLATED_RMS
    }

    fn pattern(&self, x: f64, y: f64) -> f64 {
        let smooth = |v: f64| v * v * (3.0 - 2.0 * v);
        let (left, low) = (x.floor(), y.floor());
        let (dx, dy) = (smooth(x - left), smooth(y - low));
        // A float to integer cast saturates.
        let (left, low) = (left as i64, low as i64);
        let row = |j: i64| {
            let [a, b] = [left, left.wrapping_add(1)].map(|i| self.corner(i, j));
            a + dx * (b - a)
        };
        let (below, above) = (row(low), row(low.wrapping_add(1)));
        below + dy * (above - below)
    }

    /// Uniform, of rms 1.
    fn corner(&self, i: i64, j: i64) -> f64 {
        let place = (i as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ (j as u64).rotate_left(32);
        3.0_f64.sqrt() * (2.0 * Noise::new(self.seed ^ place).uniform() - 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FIELDS: Patchwork = Patchwork { rms_k: 2.0, cell_m: 100.0, seed: 1 };

    #[test]
    fn patches_have_their_strength_and_stay_where_they_are() {
        let below = |north: f64, east: f64| FIELDS.warmth_k([north, east, 50.0], [0.0, 0.0, -1.0]);
        let all: Vec<f64> = (0..40_000).map(|i| below(f64::from(i / 200) * 37.0, f64::from(i % 200) * 37.0)).collect();
        let mean = all.iter().sum::<f64>() / all.len() as f64;
        let rms = (all.iter().map(|k| k * k).sum::<f64>() / all.len() as f64).sqrt();
        assert!(mean.abs() < 0.1 && (rms - 2.0).abs() < 0.1, "{mean} {rms}");
        // Seen aslant from 50 m further south and as high it is the same place.
        let aslant = FIELDS.warmth_k([250.0, 470.0, 50.0], [0.5_f64.sqrt(), 0.0, -(0.5_f64.sqrt())]);
        assert!((aslant - below(300.0, 470.0)).abs() < 1e-9);
        assert!((0..1000).all(|i| (below(f64::from(i), 0.0) - below(f64::from(i) + 1.0, 0.0)).abs() < 0.2));
    }

    #[test]
    fn far_patches_blur_and_the_sky_has_none() {
        let toward = |up: f64| FIELDS.warmth_k([0.0, 0.0, 200.0], [(1.0_f64 - up * up).sqrt(), 0.0, up]);
        assert_eq!([toward(0.3), toward(0.0), toward(f64::NAN)], [0.0; 3]);
        assert!((10..100).all(|i| toward(-0.001 * f64::from(i)).abs() < 0.3));
        for x in [f64::NAN, f64::INFINITY, -1e300, 0.0] {
            FIELDS.warmth_k([x; 3], [0.0, 0.0, -1.0]);
            Patchwork { cell_m: x, ..FIELDS }.warmth_k([1.0; 3], [0.0, 0.6, -0.8]);
        }
    }
}
