//! What a sensor sees of a world that differs all around.
//!
//! The sky that is the same all around comes from its exact [`Response`]; only what differs from it
//! is integrated over the field of view, on a few hundred rays.

use super::bundle::{Ray, rays};
use super::fault::surroundings::Seen;
use super::feature::{Clouds, Ridge, WarmSide, Warmth, horizontal};
use super::ground::Patchwork;
use super::orientation::Orientation;
use super::script::Weather;
use super::straight::Straight;
use crate::direction::Direction;
use crate::sky::{Averaging, FieldOfView, Response, Sky};

const ZERO_C_IN_K: f64 = 273.15;

/// A sky and a ground, and what breaks their symmetry, seen through one field of view.
#[derive(Clone, Debug)]
pub struct Scene {
    sky: Sky,
    averaging: Averaging,
    response: Response,
    rays: Vec<Ray>,
    warm: Vec<Warmth>,
    ridges: Vec<Ridge>,
    clouds: Option<Clouds>,
    patchwork: Option<Patchwork>,
}

impl Scene {
    /// A sky that is the same all around. Takes a few milliseconds.
    pub fn new(sky: Sky, field: FieldOfView, averaging: Averaging) -> Self {
        Self {
            sky,
            averaging,
            response: Response::new(sky.shape, field, averaging),
            rays: rays(field),
            warm: Vec::new(),
            ridges: Vec::new(),
            clouds: None,
            patchwork: None,
        }
    }

    /// With a side that is warmer.
    pub fn with_warm_side(mut self, warm: WarmSide) -> Self {
        self.warm.push(warm.into());
        self
    }

    /// With a ridge.
    pub fn with_ridge(mut self, ridge: Ridge) -> Self {
        self.ridges.push(ridge);
        self
    }

    /// With clouds, in place of those that were there.
    pub fn with_clouds(mut self, clouds: Clouds) -> Self {
        self.clouds = Some(clouds);
        self
    }

    /// With a ground of patches, in place of those that were there.
    pub fn with_patchwork(mut self, patchwork: Patchwork) -> Self {
        self.patchwork = Some(patchwork);
        self
    }

    /// The sky without what breaks its symmetry.
    pub fn sky(&self) -> Sky {
        self.sky
    }

    /// What is seen of it from an airframe at `orientation` in `weather`, 100 m above the ground.
    pub fn view<'a>(&'a self, orientation: Orientation, weather: &'a Weather) -> View<'a> {
        View { scene: self, orientation, weather, place_m: [0.0, 0.0, 100.0], beside: &[] }
    }

    /// What is seen of the even sky, over a ground of `ground_c`.
    pub(super) fn seen(&self, ground_c: f64) -> Seen {
        Seen { contrast: self.response.pair_k(1.0, ground_c, 1.0), up: self.response.deficit(1.0) }
    }

    fn is_symmetrical(&self) -> bool {
        self.warm.is_empty() && self.ridges.is_empty() && self.clouds.is_none() && self.patchwork.is_none()
    }

    /// What a view has in one direction (north, east, up) less what the symmetrical sky would show, in
    /// the averaged quantity.
    fn excess(&self, view: &View<'_>, [north, east, up]: [f64; 3]) -> f64 {
        let View { weather, place_m, beside, .. } = *view;
        let hides = self.clouds.is_some() || !self.ridges.is_empty() || !beside.is_empty();
        // Where nothing hides the sky, and temperatures are averaged, it falls out of the difference.
        let deficit_k = if hides || self.averaging == Averaging::Radiance {
            weather.sky_max_k * self.sky.shape.deficit(up)
        } else {
            0.0
        };
        let mut seen_k = deficit_k;
        let mut ground = up <= 0.0;
        if !ground && hides {
            let azimuth = east.atan2(north);
            let level = horizontal(north, east);
            ground = self.ridges.iter().any(|r| up < level * r.outline(azimuth))
                || beside.iter().any(|s| s.is_ground([north, east, up]));
            let sky_k = match &self.clouds {
                Some(clouds) => clouds.through_k(deficit_k, azimuth, up.atan2(level), weather.time_s),
                None => deficit_k,
            };
            let through_k = |sky_k, s: &Straight| s.through_k(sky_k, [north, east, up]);
            seen_k = if ground { 0.0 } else { beside.iter().fold(sky_k, through_k) };
        }
        for warm in &self.warm {
            seen_k -= warm.kelvin(north, east, ground);
        }
        if let Some(patchwork) = &self.patchwork {
            seen_k -= patchwork.warmth_k(place_m, [north, east, up]);
        }
        match self.averaging {
            Averaging::Temperature => deficit_k - seen_k,
            Averaging::Radiance => {
                let ground_k = weather.ground_c + ZERO_C_IN_K;
                (ground_k - seen_k).max(0.0).powi(4) - (ground_k - deficit_k).max(0.0).powi(4)
            }
        }
    }
}

/// A scene from where the airframe is now.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    scene: &'a Scene,
    orientation: Orientation,
    weather: &'a Weather,
    place_m: [f64; 3],
    beside: &'a [Straight],
}

impl<'a> View<'a> {
    /// The same from a place: m to north, to east, above the ground.
    pub fn from(mut self, place_m: [f64; 3]) -> Self {
        self.place_m = place_m;
        self
    }

    /// With what runs past it.
    pub fn beside(mut self, beside: &'a [Straight]) -> Self {
        self.beside = beside;
        self
    }

    /// What a sensor that looks in `direction` sees, °C.
    pub fn sensor_c(&self, direction: Direction) -> f64 {
        let (scene, weather) = (self.scene, self.weather);
        let axis = self.orientation.to_world(direction.components());
        let even_c = scene.response.sensor_c(axis[2], weather.ground_c, weather.sky_max_k);
        if scene.is_symmetrical() && self.beside.is_empty() {
            return even_c;
        }
        let level = axis[0].hypot(axis[1]);
        // Straight up or down any perpendicular will do.
        let [cos, sin] = if level > 1e-9 { [axis[0] / level, axis[1] / level] } else { [1.0, 0.0] };
        let above = [-axis[2] * cos, -axis[2] * sin, level];
        let beside = [-sin, cos, 0.0];
        let excess: f64 = scene
            .rays
            .iter()
            .map(|r| {
                let world = std::array::from_fn(|i| r.along * axis[i] + r.across * above[i] + r.aside * beside[i]);
                r.weight * scene.excess(self, world)
            })
            .sum();
        match scene.averaging {
            Averaging::Temperature => even_c + excess,
            Averaging::Radiance => ((even_c + ZERO_C_IN_K).powi(4) + excess).max(0.0).sqrt().sqrt() - ZERO_C_IN_K,
        }
    }

    /// A pair's signal, K, with its positive direction along `direction`: what looks the other way
    /// less what looks there.
    pub fn pair_k(&self, direction: Direction) -> f64 {
        self.sensor_c(direction.opposite()) - self.sensor_c(direction)
    }
}
