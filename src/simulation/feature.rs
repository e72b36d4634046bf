//! What makes a scene differ from direction to direction: a warm side, ridges, clouds.

use super::noise::Noise;
use std::f64::consts::PI;

/// How warmth goes round the compass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Round {
    /// `½ (1 + cos)` of the azimuth from the warmest one.
    Cosine,
    /// One half of the compass and not the other.
    Half,
    /// As the cosine at the horizon, evenly across the zenith: to heat it is nearly a horizon that leans.
    Slope,
}

/// One side of the world is warmer: the sun on a slope, a coast, the evening sky.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WarmSide {
    /// The warmest direction, ° clockwise from north.
    pub azimuth_deg: f64,
    /// The warmest direction less the coldest, K.
    pub amplitude_k: f64,
    /// How it goes round.
    pub round: Round,
    /// Whether the sky has it.
    pub sky: bool,
    /// Whether the ground has it.
    pub ground: bool,
}

/// A [`WarmSide`] as its rays are asked, and the unit vector to where it is warmest: to north, to east.
#[derive(Clone, Copy, Debug)]
pub(super) struct Warmth {
    side: WarmSide,
    warmest: [f64; 2],
}

impl From<WarmSide> for Warmth {
    fn from(side: WarmSide) -> Self {
        let (sin, cos) = side.azimuth_deg.to_radians().sin_cos();
        Self { side, warmest: [cos, sin] }
    }
}

impl Warmth {
    /// The warmth, K, in the direction whose unit vector has `north` and `east`, of the ground or of the sky.
    pub(super) fn kelvin(&self, north: f64, east: f64, ground: bool) -> f64 {
        let Self { side, warmest } = self;
        if !(if ground { side.ground } else { side.sky }) {
            return 0.0;
        }
        let toward = north * warmest[0] + east * warmest[1];
        let share = match side.round {
            Round::Half => f64::from(toward > 0.0),
            Round::Cosine => 0.5 + 0.5 * toward / horizontal(north, east).max(1e-12),
            Round::Slope => 0.5 + 0.5 * toward,
        };
        side.amplitude_k * share
    }
}

/// A ridge above the horizon, as warm as the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ridge {
    /// Its middle, ° clockwise from north.
    pub azimuth_deg: f64,
    /// From end to end, °.
    pub width_deg: f64,
    /// At its middle, ° above the horizon; it falls to nothing at its ends as a raised cosine.
    pub height_deg: f64,
}

impl Ridge {
    /// The tangent of its elevation at an azimuth, rad; 0 beside it.
    pub(super) fn outline(&self, azimuth: f64) -> f64 {
        let off = wrapped(azimuth - self.azimuth_deg.to_radians()).to_degrees() / self.width_deg;
        if off.abs() < 0.5 { (self.height_deg * (0.5 + 0.5 * (2.0 * PI * off).cos())).to_radians().tan() } else { 0.0 }
    }
}

/// A round cloud.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cloud {
    /// Its middle, ° clockwise from north.
    pub azimuth_deg: f64,
    /// Its middle, ° above the horizon.
    pub elevation_deg: f64,
    /// Where its opacity has fallen by half, ° from its middle.
    pub radius_deg: f64,
    /// Its opacity in the middle, 0..1.
    pub opacity: f64,
    /// Its edge from full to none, °.
    pub edge_deg: f64,
}

/// A cloud's underside is this much colder than the ground, K.
pub(super) const CLOUD_BASE_K: f64 = 8.0;
const AZIMUTHS: usize = 360;
const ELEVATIONS: usize = 91;

/// Clouds that go round together: a map of their opacity, 1° by 1°.
#[derive(Clone, Debug, PartialEq)]
pub struct Clouds {
    map: Vec<f64>,
    drift: f64,
    base_k: f64,
}

impl Clouds {
    /// These clouds, going round by `drift_deg_s` clockwise; their underside is `base_k` colder than
    /// the ground, or as cold as the sky behind where that is the warmer one.
    pub fn new(clouds: &[Cloud], drift_deg_s: f64, base_k: f64) -> Self {
        let mut made = Self { map: vec![0.0; AZIMUTHS * ELEVATIONS], drift: drift_deg_s.to_radians(), base_k };
        for cloud in clouds {
            made.add(cloud);
        }
        made
    }

    /// Cumulus that covers `cover` (0..1) of the sky, chosen by `seed`: clouds of so many degrees of radius
    /// (least, most) with soft edges, 8 K colder than the ground, that drift by 0.1 °/s.
    pub fn cumulus(cover: f64, radius_deg: (f64, f64), seed: u64) -> Self {
        let mut made = Self::new(&[], 0.1, CLOUD_BASE_K);
        let mut noise = Noise::new(seed);
        // Each adds about half a percent: a sky that cannot be filled ends too.
        for _ in 0..2000 {
            if made.cover() >= cover {
                break;
            }
            made.add(&Cloud {
                azimuth_deg: 360.0 * noise.uniform(),
                elevation_deg: noise.uniform().asin().to_degrees(),
                radius_deg: radius_deg.0 + (radius_deg.1 - radius_deg.0) * noise.uniform(),
                opacity: 0.8 + 0.2 * noise.uniform(),
                edge_deg: 4.0,
            });
        }
        made
    }

    /// Where clouds lie over each other the densest counts.
    fn add(&mut self, cloud: &Cloud) {
        let (sin, cos) = cloud.elevation_deg.to_radians().sin_cos();
        for azimuth in 0..AZIMUTHS {
            for elevation in 0..ELEVATIONS {
                let (s, c) = (elevation as f64).to_radians().sin_cos();
                let round = (azimuth as f64 - cloud.azimuth_deg).to_radians().cos();
                let off_deg = (sin * s + cos * c * round).clamp(-1.0, 1.0).acos().to_degrees();
                let inside = (0.5 + (cloud.radius_deg - off_deg) / cloud.edge_deg.max(0.01)).clamp(0.0, 1.0);
                let opacity = cloud.opacity * inside * inside * (3.0 - 2.0 * inside);
                let cell = &mut self.map[elevation * AZIMUTHS + azimuth];
                *cell = cell.max(opacity);
            }
        }
    }

    /// The share of the sky that is covered, 0..1.
    pub fn cover(&self) -> f64 {
        let (mut covered, mut whole) = (0.0, 0.0);
        for (i, opacity) in self.map.iter().enumerate() {
            let area = ((i / AZIMUTHS) as f64).to_radians().cos();
            covered += opacity * area;
            whole += area;
        }
        covered / whole
    }

    /// The opacity, 0..1, at an azimuth and elevation, rad, `time_s` after the flight began.
    fn opacity(&self, azimuth: f64, elevation: f64, time_s: f64) -> f64 {
        let x = (azimuth - self.drift * time_s).to_degrees().rem_euclid(AZIMUTHS as f64);
        let y = elevation.to_degrees().clamp(0.0, (ELEVATIONS - 1) as f64);
        let (left, low) = (x as usize % AZIMUTHS, (y as usize).min(ELEVATIONS - 2));
        let right = (left + 1) % AZIMUTHS;
        let (dx, dy) = (x.fract(), y - low as f64);
        let row = |e: usize| self.map[e * AZIMUTHS + left] * (1.0 - dx) + self.map[e * AZIMUTHS + right] * dx;
        row(low) * (1.0 - dy) + row(low + 1) * dy
    }

    /// What is left of a sky that is `deficit_k` colder than the ground, K.
    pub(super) fn through_k(&self, deficit_k: f64, azimuth: f64, elevation: f64, time_s: f64) -> f64 {
        behind_k(deficit_k, self.opacity(azimuth, elevation, time_s), self.base_k)
    }
}

/// What is left of a sky that is `deficit_k` colder than the ground behind a cloud of an opacity of
/// 0..1, `base_k` colder than the ground, or as cold as the sky where that is the warmer one. K.
pub(super) fn behind_k(deficit_k: f64, opacity: f64, base_k: f64) -> f64 {
    deficit_k - opacity * (deficit_k - deficit_k.min(base_k))
}

/// How much of a direction is horizontal.
pub(super) fn horizontal(north: f64, east: f64) -> f64 {
    (north * north + east * east).sqrt()
}

/// An angle in (−π, π].
pub(super) fn wrapped(angle: f64) -> f64 {
    let turned = (angle + PI).rem_euclid(2.0 * PI) - PI;
    if turned <= -PI { PI } else { turned }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn warmth_goes_round_the_compass() {
        let east = WarmSide { azimuth_deg: 90.0, amplitude_k: 4.0, round: Round::Cosine, sky: true, ground: false };
        for (north, east_part, warmth_k) in [(0.0, 0.7, 4.0), (0.0, -0.1, 0.0), (1.0, 0.0, 2.0), (0.0, 0.0, 2.0)] {
            assert!((Warmth::from(east).kelvin(north, east_part, false) - warmth_k).abs() < 1e-9);
            assert_eq!(Warmth::from(east).kelvin(north, east_part, true), 0.0);
        }
        let half = WarmSide { round: Round::Half, ..east };
        assert_eq!([0.1, -0.1].map(|east| Warmth::from(half).kelvin(9.0, east, false)), [4.0, 0.0]);
        let slope = WarmSide { round: Round::Slope, azimuth_deg: 0.0, ..half };
        assert_eq!(
            [1.0, 0.5, 0.0, -1.0].map(|north| Warmth::from(slope).kelvin(north, 0.0, false)),
            [4.0, 3.0, 2.0, 0.0]
        );
    }

    #[test]
    fn a_ridge_rises_from_its_ends_to_its_middle() {
        let ridge = Ridge { azimuth_deg: 350.0, width_deg: 60.0, height_deg: 8.0 };
        let height = |azimuth: f64| ridge.outline(azimuth.to_radians()).atan().to_degrees();
        assert!((height(-10.0) - 8.0).abs() < 1e-9 && (height(5.0) - 4.0).abs() < 1e-9);
        assert_eq!([height(30.0), height(170.0)], [0.0, 0.0]);
    }

    #[test]
    fn a_cloud_hides_the_sky_in_its_middle_and_drifts() {
        let cloud = Cloud { azimuth_deg: 10.0, elevation_deg: 40.0, radius_deg: 10.0, opacity: 0.5, edge_deg: 4.0 };
        let clouds = Clouds::new(&[cloud], 2.0, 8.0);
        let left = |azimuth: f64, elevation: f64, time_s| {
            clouds.through_k(30.0, azimuth.to_radians(), elevation.to_radians(), time_s)
        };
        // Half of the way from 30 K to the underside's 8 K.
        assert!((left(10.0, 40.0, 0.0) - 19.0).abs() < 1e-9);
        assert!((left(10.0, 50.0, 0.0) - 24.5).abs() < 0.1);
        assert_eq!(left(10.0, 55.0, 0.0), 30.0);
        assert!((left(350.0, 40.0, -10.0) - 19.0).abs() < 1e-9);
        // Behind it the sky is as warm already.
        assert_eq!(clouds.through_k(5.0, 0.175, 0.698, 0.0), 5.0);
    }

    #[test]
    fn cumulus_covers_what_is_asked() {
        for seed in 0..5 {
            let cover = Clouds::cumulus(0.3, (5.0, 15.0), seed).cover();
            assert!((0.3..0.34).contains(&cover), "{cover}");
        }
        assert_eq!(Clouds::cumulus(0.0, (5.0, 15.0), 1).cover(), 0.0);
        assert!(Clouds::cumulus(f64::NAN, (5.0, 15.0), 1).cover() < 1.0);
        assert_ne!(Clouds::cumulus(0.3, (5.0, 15.0), 1), Clouds::cumulus(0.3, (5.0, 15.0), 2));
    }
}
