//! What each sensor of the head should show, with the slopes.

use super::state::MAX_SENSORS;
use crate::estimator::vector::{Vector, add_scaled, cross, dot, unit};
use crate::frame::Frame;
use crate::head::{Head, SensorKind};
use crate::sky::family::{Level, RADIANCE_K, View};
use crate::sky::{Family, FieldOfView};
use crate::time::Time;

/// One sensor.
#[derive(Clone, Copy, Debug)]
struct Channel {
    direction: Vector,
    kind: SensorKind,
}

/// The head under a sky of the family.
#[derive(Clone, Debug)]
pub struct Model {
    family: Family,
    channels: Vec<Channel>,
}

/// What a sensor shows at rest, and its slopes.
#[derive(Clone, Copy, Debug, Default)]
pub struct Seen {
    /// K or °C.
    pub value: f64,
    /// With a turn of the body, K/rad.
    pub by_turn: Vector,
    /// With the ground's temperature.
    pub by_ground: f64,
    /// With the contrast.
    pub by_contrast: f64,
    /// With the logarithm of the sky's depth, K.
    pub by_depth: f64,
    /// With the sensor's own scene: what of one it sees.
    pub scene: f64,
    /// The share of sky in what it sees, 0..1; in what a pair's first sees.
    pub sky: f64,
    /// With how much is averaged in radiance, K.
    pub by_radiance: f64,
    /// With the field of view, K.
    pub by_view: View,
    /// With how far the horizon leans up to north and to west, K/rad.
    pub by_lean: [f64; 2],
}

/// What lies around.
#[derive(Clone, Copy, Debug)]
pub struct Scene {
    /// The ground, °C.
    pub ground_c: f64,
    /// A vertical pair's signal, K.
    pub contrast_k: f64,
    /// The logarithm of the sky's depth, as [`Family`] counts it.
    pub ln_depth: f64,
    /// How much of what they see the sensors average in radiance, 0..1: the rest in temperature.
    pub radiance: f64,
    /// How else the sensors see than they are said to.
    pub view: View,
    /// How far the horizon that is seen leans up to north and to west, where it is warmer, rad.
    pub lean: [f64; 2],
    /// The share that what looks straight down sees of a scene.
    pub beneath: f64,
}

impl Model {
    /// For `head`, at most [`MAX_SENSORS`] of whose sensors are used, with the field of view of each.
    pub fn new(head: &Head, field: FieldOfView) -> Self {
        let channels = head.sensors.iter().take(MAX_SENSORS);
        let channels = channels.map(|s| Channel { direction: s.direction.components(), kind: s.kind }).collect();
        Self { family: Family::new(field), channels }
    }

    /// How many sensors.
    pub fn sensors(&self) -> usize {
        self.channels.len()
    }

    /// Whether any sensor shows a temperature of its own, from which the ground's can be told.
    pub fn is_absolute(&self) -> bool {
        self.channels.iter().any(|c| c.kind.is_absolute())
    }

    /// Whether the sensors are more than the unknowns, so that a scene of its own that one of them sees is left over.
    pub fn shows_scenes(&self) -> bool {
        self.is_absolute() || self.sensors() > 3
    }

    /// Where sensor `i` looks.
    pub fn direction(&self, i: usize) -> Vector {
        self.channels[i].direction
    }

    /// The reading of sensor `i` in K or °C, and its stamp.
    pub fn reading(&self, i: usize, frame: &Frame) -> Option<(f64, Time)> {
        let sample = frame.readings.get(i)?.ok()?;
        Some((self.channels.get(i)?.kind.kelvin(sample.value)?, sample.time))
    }

    /// How much colder than the ground an even horizon looks, as a share of the contrast, were that [`RADIANCE_K`].
    pub fn at_horizon(&self, scene: &Scene) -> Level {
        self.family.level(0.0, scene.ln_depth, scene.radiance, scene.view)
    }

    /// What sensor `i` shows at rest with these level axes (rows: north, west, up on the body).
    pub fn seen(&self, i: usize, axes: &[Vector; 3], scene: &Scene) -> Seen {
        let Channel { direction, kind } = self.channels[i];
        let [north, west, up] = axes;
        let up = add_scaled(add_scaled(*up, -scene.lean[0], *north), -scene.lean[1], *west);
        let up = unit(up).unwrap_or(axes[2]);
        let sine = dot(direction, up);
        let share = scene.contrast_k / RADIANCE_K;
        let averaged = scene.radiance * share;
        let level = |sine: f64| self.family.level(sine, scene.ln_depth, averaged, scene.view);
        let high = level(sine);
        // What the level adds to a reading, times the contrast: a sensor shows what the sky is less than the ground.
        let sky = (high.value * 3.0).clamp(0.0, 1.0);
        let (sign, ground_c, by_ground, own, level) = match kind {
            SensorKind::Absolute { .. } => (-1.0, scene.ground_c, 1.0, sky.max(scene.beneath), high),
            SensorKind::Pair { .. } => {
                let low = level(-sine);
                let pair = Level {
                    value: high.value - low.value,
                    by_sine: high.by_sine + low.by_sine,
                    by_ln_depth: high.by_ln_depth - low.by_ln_depth,
                    by_radiance: high.by_radiance - low.by_radiance,
                    by_view: std::array::from_fn(|k| high.by_view[k] - low.by_view[k]),
                };
                (1.0, 0.0, 0.0, 1.4, pair)
            }
        };
        let by_level = sign * scene.contrast_k;
        let slope = by_level * level.by_sine;
        Seen {
            value: ground_c + by_level * level.value,
            by_turn: cross(direction, up.map(|c| slope * c)),
            by_ground,
            by_contrast: sign * (level.value + averaged * level.by_radiance),
            by_depth: by_level * level.by_ln_depth,
            by_radiance: share * by_level * level.by_radiance,
            scene: own,
            sky,
            by_view: level.by_view.map(|by| by_level * by),
            by_lean: [north, west].map(|axis| -slope * dot(direction, *axis)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimator::vector::rotation;

    const SKY: Scene = Scene {
        ground_c: 15.0,
        contrast_k: 35.0,
        ln_depth: -1.1,
        radiance: 0.3,
        view: [0.2, 0.3, -0.2],
        lean: [0.0; 2],
        beneath: 0.4,
    };

    /// Each slope is what a small step changes, of sensors that show their own temperature and of pairs.
    #[test]
    fn slopes_are_differences() {
        let axes = rotation([0.3, -0.2, 0.5]);
        let pair = SensorKind::Pair { neutral_v: 0.0, kelvin_per_v: 40.0 };
        let mut head = Head::six();
        head.sensors.iter_mut().take(3).for_each(|s| s.kind = pair);
        let model = Model::new(&head, FieldOfView::Gaussian { fwhm_deg: 90.0 });
        type Slope = (&'static str, fn(&Seen) -> f64, fn(&mut Scene, f64), f64);
        let slopes: [Slope; 9] = [
            ("ground", |s| s.by_ground, |s, h| s.ground_c += h, 1e-6),
            ("contrast", |s| s.by_contrast, |s, h| s.contrast_k += h, 0.01),
            ("depth", |s| s.by_depth, |s, h| s.ln_depth += h, 1e-3),
            ("radiance", |s| s.by_radiance, |s, h| s.radiance += h, 1e-3),
            ("spread", |s| s.by_view[0], |s, h| s.view[0] += h, 1e-3),
            ("one form", |s| s.by_view[1], |s, h| s.view[1] += h, 1e-3),
            ("another", |s| s.by_view[2], |s, h| s.view[2] += h, 1e-3),
            ("lean to north", |s| s.by_lean[0], |s, h| s.lean[0] += h, 1e-3),
            ("lean to west", |s| s.by_lean[1], |s, h| s.lean[1] += h, 1e-3),
        ];
        for i in 0..model.sensors() {
            let seen = model.seen(i, &axes, &SKY);
            for (name, slope, change, limit) in slopes {
                let value = |h: f64| {
                    let mut sky = SKY;
                    change(&mut sky, h);
                    model.seen(i, &axes, &sky).value
                };
                let difference = (value(1e-5) - value(-1e-5)) / 2e-5;
                assert!((slope(&seen) - difference).abs() < limit, "{i} {name}: {}, {difference}", slope(&seen));
            }
        }
    }
}
