//! What each sensor of the head should show, with the slopes.

use super::state::MAX_SENSORS;
use crate::estimator::vector::{Vector, add_scaled, cross, dot, unit};
use crate::frame::Frame;
use crate::head::{Head, SensorKind};
use crate::sky::family::RADIANCE_K;
use crate::sky::{Family, FieldOfView};
use crate::time::Time;

/// The share of averaging in radiance: sensors do something between that and averaging in temperature, and which of them
/// is less to be told apart than how wide they see.
const AVERAGED: f64 = 0.5;

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
    /// With the sensor's own scene: the share of sky in what it sees.
    pub sky: f64,
    /// With the spread of the field of view, K.
    pub by_spread: f64,
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
    /// How much wider the sensors see than they are said to, as [`Family`] counts it.
    pub spread: f64,
    /// How far the horizon that is seen leans up to north and to west, where it is warmer, rad.
    pub lean: [f64; 2],
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

    /// What sensor `i` shows at rest with these level axes (rows: north, west, up on the body).
    pub fn seen(&self, i: usize, axes: &[Vector; 3], scene: &Scene) -> Seen {
        let Channel { direction, kind } = self.channels[i];
        let [north, west, up] = axes;
        let up = add_scaled(add_scaled(*up, -scene.lean[0], *north), -scene.lean[1], *west);
        let up = unit(up).unwrap_or(axes[2]);
        let sine = dot(direction, up);
        let averaged = AVERAGED * scene.contrast_k / RADIANCE_K;
        let level = |sine: f64| self.family.level(sine, scene.ln_depth, averaged, scene.spread);
        let high = level(sine);
        let by_turn = |slope: f64| cross(direction, up.map(|c| slope * c));
        let by_lean = |slope: f64| [north, west].map(|level| -slope * dot(direction, *level));
        match kind {
            SensorKind::Absolute { .. } => {
                let slope = -scene.contrast_k * high.by_sine;
                Seen {
                    value: scene.ground_c - scene.contrast_k * high.value,
                    by_turn: by_turn(slope),
                    by_ground: 1.0,
                    by_contrast: -high.value,
                    by_depth: -scene.contrast_k * high.by_ln_depth,
                    sky: (high.value * 3.0).clamp(0.35, 1.0),
                    by_spread: -scene.contrast_k * high.by_spread,
                    by_lean: by_lean(slope),
                }
            }
            SensorKind::Pair { .. } => {
                let low = level(-sine);
                let slope = scene.contrast_k * (high.by_sine + low.by_sine);
                Seen {
                    value: scene.contrast_k * (high.value - low.value),
                    by_turn: by_turn(slope),
                    by_ground: 0.0,
                    by_contrast: high.value - low.value,
                    by_depth: scene.contrast_k * (high.by_ln_depth - low.by_ln_depth),
                    sky: 1.4,
                    by_spread: scene.contrast_k * (high.by_spread - low.by_spread),
                    by_lean: by_lean(slope),
                }
            }
        }
    }
}
