//! What a sensor and a pair put out against the elevation of their axis, and the way back.

use super::{FieldOfView, Shape};

/// What a sensor averages over its field of view.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Averaging {
    /// Temperature, as the report does: linear, so that a pair's shape is the same for every contrast.
    #[default]
    Temperature,
    /// Radiance, the fourth power of temperature, as thermopiles do.
    Radiance,
}

const STEPS_PER_DEG: usize = 4;
const QUARTER: usize = 90 * STEPS_PER_DEG;
/// Steps of the sky's profile over the sine of elevation, while a table is being made.
const PROFILE_STEPS: usize = 4096;
const ZERO_C_IN_K: f64 = 273.15;

/// A sensor's response to a sky's shape: a table over the elevation of its axis.
///
/// Ground temperature and `SkyMax` are arguments of each look-up, so that a table stays good while
/// the weather changes. Linear between entries 0.25° apart.
#[derive(Clone, Debug)]
pub struct Response {
    averaging: Averaging,
    /// Means of the deficit and its 2nd, 3rd and 4th power over the field of view, from −90° up.
    moments: Vec<[f64; 4]>,
}

impl Response {
    /// Makes the table, in a few milliseconds; good to 0.005 K for a 90° field under a sky of 40 K.
    pub fn new(shape: Shape, field: FieldOfView, averaging: Averaging) -> Self {
        let nodes = field.nodes();
        let profile: Vec<f64> = (0..=PROFILE_STEPS).map(|i| shape.deficit(i as f64 / PROFILE_STEPS as f64)).collect();
        let mut least = [0.0_f64; 4];
        let moments = (0..=2 * QUARTER)
            .map(|i| {
                let (sin, cos) = (i as f64 / STEPS_PER_DEG as f64 - 90.0).to_radians().sin_cos();
                let mut mean = [0.0; 4];
                for n in &nodes {
                    let s = n.along * sin + n.across * cos;
                    if s > 0.0 {
                        let p = interpolate(s * PROFILE_STEPS as f64, &profile, |v| *v);
                        let wp = n.weight * p;
                        mean[0] += wp;
                        mean[1] += wp * p;
                        mean[2] += wp * p * p;
                        mean[3] += wp * p * p * p;
                    }
                }
                // It rises with elevation but for rounding; the way back needs it without exception.
                least = std::array::from_fn(|j| mean[j].max(least[j]));
                least
            })
            .collect();
        Self { averaging, moments }
    }

    /// The mean deficit over the field of view with the axis at the elevation whose sine is
    /// `sin_elevation`: 0..1, never falling. With averaging in temperature the sensor shows the
    /// ground less `SkyMax` times this.
    pub fn deficit(&self, sin_elevation: f64) -> f64 {
        interpolate(entry(sin_elevation) + QUARTER as f64, &self.moments, |m| m[0])
    }

    /// What a sensor shows, °C, over a ground of `ground_c` under a sky of `sky_max_k`.
    pub fn sensor_c(&self, sin_elevation: f64, ground_c: f64, sky_max_k: f64) -> f64 {
        let x = entry(sin_elevation) + QUARTER as f64;
        match self.averaging {
            Averaging::Temperature => ground_c - sky_max_k * interpolate(x, &self.moments, |m| m[0]),
            Averaging::Radiance => {
                // The mean of (G − D·p)⁴.
                let (g, d) = (ground_c + ZERO_C_IN_K, sky_max_k);
                let [m1, m2, m3, m4] = [0, 1, 2, 3].map(|j| interpolate(x, &self.moments, |m| m[j]));
                let deficit = d * (4.0 * g.powi(3) * m1 - 6.0 * g * g * d * m2 + 4.0 * g * d * d * m3 - d.powi(3) * m4);
                (g.powi(4) - deficit).max(0.0).sqrt().sqrt() - ZERO_C_IN_K
            }
        }
    }

    /// A pair's signal, K, with its positive direction at the elevation whose sine is
    /// `sin_elevation`: what looks down less what looks up.
    pub fn pair_k(&self, sin_elevation: f64, ground_c: f64, sky_max_k: f64) -> f64 {
        self.sensor_c(-sin_elevation, ground_c, sky_max_k) - self.sensor_c(sin_elevation, ground_c, sky_max_k)
    }

    /// The pair's contrast, shape and its inverse. With averaging in temperature the shape does not
    /// depend on the arguments, and the contrast is proportional to `sky_max_k`.
    pub fn pair_curve(&self, ground_c: f64, sky_max_k: f64) -> PairCurve {
        // Without a contrast there is no shape to see; that of a small one stands in for it.
        let visible_k = if sky_max_k.abs() < 0.01 { 0.01 } else { sky_max_k };
        let whole_k = self.pair_k(1.0, ground_c, visible_k);
        let (mut g, mean): (Vec<f64>, Vec<f64>) = (0..=QUARTER)
            .map(|i| {
                let sin = (i as f64 / STEPS_PER_DEG as f64).to_radians().sin();
                let [low, high] = [-sin, sin].map(|sin| self.sensor_c(sin, ground_c, visible_k));
                ((low - high) / whole_k, (ground_c - 0.5 * (low + high)) / whole_k)
            })
            .unzip();
        // Rounding away, and whatever is not a number.
        g[0] = 0.0;
        for i in 1..g.len() {
            g[i] = g[i].max(g[i - 1]).min(1.0);
        }
        PairCurve { contrast_k: self.pair_k(1.0, ground_c, sky_max_k), g, mean }
    }
}

/// A pair's output `D·g`: `D` with its axis vertical, `g` odd, never falling, `g(±1) = ±1`.
#[derive(Clone, Debug)]
pub struct PairCurve {
    contrast_k: f64,
    /// From 0° to 90°.
    g: Vec<f64>,
    /// The same for [`mean`](Self::mean).
    mean: Vec<f64>,
}

impl PairCurve {
    /// The pair's output with its axis vertical, K.
    pub fn contrast_k(&self) -> f64 {
        self.contrast_k
    }

    /// The pair's output over its contrast, at the elevation whose sine is `sin_elevation`: −1..1.
    pub fn g(&self, sin_elevation: f64) -> f64 {
        let x = entry(sin_elevation);
        interpolate(x.abs(), &self.g, |v| *v).copysign(x)
    }

    /// By how much the mean of the pair's two sensors lies below the ground, over the contrast, at the elevation whose sine is
    /// `sin_elevation`: even, about a half when vertical.
    pub fn mean(&self, sin_elevation: f64) -> f64 {
        interpolate(entry(sin_elevation).abs(), &self.mean, |v| *v)
    }

    /// The sine of the elevation at which [`g`](Self::g) is `ratio`; ±1 beyond ±1, NaN for NaN.
    pub fn inverse(&self, ratio: f64) -> f64 {
        let r = ratio.abs();
        if r.is_nan() {
            return f64::NAN;
        }
        // The first entry beyond r: the one before it is at or below.
        let above = self.g.partition_point(|v| *v <= r);
        let Some(high) = self.g.get(above) else { return 1.0_f64.copysign(ratio) };
        let low = self.g[above - 1];
        let x = (above - 1) as f64 + (r - low) / (high - low);
        (x / STEPS_PER_DEG as f64).to_radians().sin().copysign(ratio)
    }
}

/// The place in a table, in steps from the horizon up.
fn entry(sin_elevation: f64) -> f64 {
    sin_elevation.clamp(-1.0, 1.0).asin().to_degrees() * STEPS_PER_DEG as f64
}

/// Between the entries of a table, at its ends beyond them. `x` counts entries; NaN gives NaN.
fn interpolate<T>(x: f64, table: &[T], value: impl Fn(&T) -> f64) -> f64 {
    let i = (x as usize).min(table.len() - 2);
    let (a, b) = (value(&table[i]), value(&table[i + 1]));
    a + (x - i as f64).min(1.0) * (b - a)
}
