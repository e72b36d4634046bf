//! Flights and scenes with names, for tests, for tuning and for whoever wants to try the estimators.

use super::aerobatics::{aerobatics, rolls};
use super::aircraft::Aircraft;
use super::feature::{Clouds, Ridge, Round, WarmSide};
use super::flight::Flight;
use super::ground::Patchwork;
use super::instruments::{Fitted, Instruments};
use super::manoeuvre::{Random, Style};
use super::noise::Noise;
use super::scene::Scene;
use super::script::Weather;
use super::source::SimulatedSource;
use super::trajectory::Trajectory;
use crate::config::settings::SimulationSettings;
use crate::direction::Direction;
use crate::head::{Head, Sensor, SensorKind};
use crate::sky::{Averaging, FieldOfView, Response, Shape, Sky};

/// How long a scenario lasts unless said otherwise, s.
pub const SECONDS: f64 = 300.0;
/// The sensors' field of view.
const USUAL: FieldOfView = FieldOfView::Gaussian { fwhm_deg: 90.0 };

/// The names, with what they stand for.
pub const LIST: [(&str, &str); 21] = [
    ("clear-dry", "a dry grey atmosphere, contrast 40 K"),
    ("clear-humid", "a humid grey atmosphere, contrast 25 K"),
    ("namibia", "the report's Namibian night"),
    ("durham", "the report's Durham afternoon"),
    ("overcast", "a closed cloud cover, contrast 8 K"),
    ("scattered", "small drifting clouds over a third of a clear sky"),
    ("cumulus", "large ones, some of them in clumps to one side"),
    ("warm-side", "ground and sky warmer by 5 K to one side"),
    ("warm-sky", "the sky alone warmer by 5 K to one side"),
    ("warm-slope", "the same, evenly across the zenith"),
    ("warm-side-sharp", "ground and sky warmer by 5 K over one half of the compass"),
    ("into-cloud", "from 40 K to 10 K in 1.5 s and back, again and again"),
    ("lag-0.3", "clear and dry, sensors that lag by 0.3 s"),
    ("no-lag", "clear and dry, sensors without lag"),
    ("inverted", "clear and dry, rolls and inverted flight"),
    ("aerobatics", "clear and dry, loops, rolls, half of each"),
    ("ridge", "clear and dry, with ridges of 20° and 8°"),
    ("patchwork", "clear and dry, over fields and woods that differ by 3 K rms"),
    ("radiance", "clear and dry, sensors that average radiance"),
    ("uncoordinated", "clear and dry, a heading that lags the turn and yaws about it"),
    ("narrow", "clear and dry, sensors of 70° that are told to be of 90°"),
];

/// A flight under a scene, before chance has had its say.
#[derive(Clone, Debug)]
pub struct Scenario {
    name: &'static str,
    sky: Sky,
    averaging: Averaging,
    seeing: FieldOfView,
    lag_s: f64,
    noise_k: f64,
    weather: Vec<Weather>,
    aircraft: Option<Aircraft>,
    style: Option<Style>,
    fitted: Option<Fitted>,
    differential: bool,
    seconds: f64,
    dropped: f64,
}

impl Scenario {
    /// The scenario called `name`, one of [`LIST`].
    pub fn named(name: &str) -> Option<Self> {
        let name = LIST.iter().find(|(n, _)| *n == name)?.0;
        let dry = grey(15.0, 40.0, 0.3);
        let mut made = Self {
            name,
            sky: dry,
            averaging: Averaging::Temperature,
            seeing: USUAL,
            lag_s: 0.1,
            noise_k: 0.08,
            weather: Vec::new(),
            aircraft: None,
            style: None,
            fitted: Some(Fitted::default()),
            differential: false,
            seconds: SECONDS,
            dropped: 0.0,
        };
        match name {
            "clear-humid" => made.sky = grey(24.0, 25.0, 1.5),
            "namibia" => made.sky = Sky::NAMIBIA,
            "durham" => made.sky = Sky::DURHAM,
            "overcast" => made.sky = grey(12.0, 8.0, 3.0),
            "into-cloud" => {
                made.sky = Sky::NAMIBIA;
                made.weather = into_cloud();
            }
            "lag-0.3" => made.lag_s = 0.3,
            "no-lag" => made.lag_s = 0.0,
            "inverted" => made.style = Some(Style::Scripted(rolls())),
            "aerobatics" => made.style = Some(Style::Scripted(aerobatics())),
            "radiance" => made.averaging = Averaging::Radiance,
            "narrow" => made.seeing = FieldOfView::Gaussian { fwhm_deg: 70.0 },
            _ => {}
        }
        Some(made)
    }

    /// Its name.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// For so many seconds, up to a day, after which the aircraft stays as it is.
    pub fn lasting(mut self, seconds: f64) -> Self {
        self.seconds = seconds;
        self
    }

    /// How long it lasts, s.
    pub fn seconds(&self) -> f64 {
        self.seconds
    }

    /// Flown by the demonstration's script, whose turbulence is a sum of sines, where the scenario
    /// has no script of its own.
    pub fn scripted(mut self, seed: u64) -> Self {
        self.style.get_or_insert(Style::Scripted(Flight::demo(seed).with_turbulence(1.3, 0.4, seed)));
        self
    }

    /// Flown by another aircraft, in its own wind; else in one of 5 m/s from anywhere.
    pub fn with_aircraft(mut self, aircraft: Aircraft) -> Self {
        self.aircraft = Some(aircraft);
        self
    }

    /// With other instruments, or none.
    pub fn with_instruments(mut self, fitted: Option<Fitted>) -> Self {
        self.fitted = fitted;
        self
    }

    /// Under a sky of the same shape of which a vertical pair of the usual field sees `contrast_k`.
    pub fn with_contrast(mut self, contrast_k: f64) -> Self {
        self.sky = sky(self.sky.ground_c, contrast_k, self.sky.shape);
        self
    }

    /// With sensors that average radiance, or temperature.
    pub fn with_averaging(mut self, averaging: Averaging) -> Self {
        self.averaging = averaging;
        self
    }

    /// With sensors that see otherwise than an estimator is told.
    pub fn seeing(mut self, field: FieldOfView) -> Self {
        self.seeing = field;
        self
    }

    /// With sensors whose noise is `noise_k` rms.
    pub fn with_noise(mut self, noise_k: f64) -> Self {
        self.noise_k = noise_k;
        self
    }

    /// With a head of three pairs in volts.
    pub fn differential(mut self) -> Self {
        self.differential = true;
        self
    }

    /// With scans of which nothing arrives: 0..1 of all.
    pub fn with_dropped(mut self, share: f64) -> Self {
        self.dropped = share;
        self
    }

    /// The head.
    pub fn head(&self) -> Head {
        if !self.differential {
            return Head::six();
        }
        let kind = SensorKind::Pair { neutral_v: 0.0, kelvin_per_v: 40.0 };
        let pairs = [("long", Direction::NOSE), ("lat", Direction::LEFT), ("vert", Direction::UP)];
        let sensors = pairs.map(|(name, direction)| Sensor { name: name.to_owned(), direction, kind, bus: None });
        Head::new(sensors.into(), Vec::new())
    }

    /// The field of view that an estimator is told; the sensors' true one but in `narrow`, and where they are
    /// [seeing](Self::seeing) otherwise.
    pub fn field(&self) -> FieldOfView {
        USUAL
    }

    /// Chance has its say: the same seed gives the same frames.
    pub fn source(&self, seed: u64) -> SimulatedSource {
        let mut seeds = Noise::new(seed);
        let (noise_c, lag_s, seed) = (self.noise_k, self.lag_s, seeds.bits());
        let settings = SimulationSettings { noise_c, lag_s, seed, ..SimulationSettings::default() };
        let (sin, cos) = (std::f64::consts::TAU * seeds.uniform()).sin_cos();
        let uncoordinated = self.name == "uncoordinated";
        let usual = Aircraft { wind_m_s: [5.0 * cos, 5.0 * sin], uncoordinated, ..Aircraft::default() };
        let aircraft = self.aircraft.unwrap_or(usual);
        let style = self.style.clone().unwrap_or(Style::Random(Random::default()));
        let trajectory = Trajectory::fly(&aircraft, &style, self.seconds + 1.0, seeds.bits());
        let field = self.seeing;
        let mut source = SimulatedSource::new(&settings, &self.head(), field)
            .with_scene(self.scene(field, &mut seeds))
            .with_weather(self.weather.clone())
            .with_trajectory(trajectory)
            .with_dropped(self.dropped, seeds.bits());
        if let Some(fitted) = self.fitted {
            source = source.with_instruments(Instruments::new(fitted, seeds.bits()));
        }
        source
    }

    fn scene(&self, field: FieldOfView, seeds: &mut Noise) -> Scene {
        let scene = Scene::new(self.sky, field, self.averaging);
        let azimuth_deg = 360.0 * seeds.uniform();
        let warm = |round, ground| WarmSide { azimuth_deg, amplitude_k: 5.0, round, sky: true, ground };
        let ridge = |turn, width_deg, height_deg| Ridge { azimuth_deg: azimuth_deg + turn, width_deg, height_deg };
        match self.name {
            "scattered" => scene.with_clouds(Clouds::cumulus(0.3, (4.0, 10.0), seeds.bits())),
            "cumulus" => scene.with_clouds(Clouds::cumulus(0.3, (5.0, 15.0), seeds.bits())),
            "warm-side" => scene.with_warm_side(warm(Round::Cosine, true)),
            "warm-sky" => scene.with_warm_side(warm(Round::Cosine, false)),
            "warm-slope" => scene.with_warm_side(warm(Round::Slope, false)),
            "warm-side-sharp" => scene.with_warm_side(warm(Round::Half, true)),
            "ridge" => scene.with_ridge(ridge(0.0, 120.0, 20.0)).with_ridge(ridge(170.0, 60.0, 8.0)),
            "patchwork" => scene.with_patchwork(Patchwork { rms_k: 3.0, cell_m: 250.0, seed: seeds.bits() }),
            _ => scene,
        }
    }
}

/// A grey atmosphere under which a vertical pair of the usual field sees `contrast_k`.
fn grey(ground_c: f64, contrast_k: f64, depth: f64) -> Sky {
    sky(ground_c, contrast_k, Shape::Grey { depth })
}

/// A sky of which a vertical pair of the usual field sees `contrast_k`.
fn sky(ground_c: f64, contrast_k: f64, shape: Shape) -> Sky {
    let share = Response::new(shape, USUAL, Averaging::Temperature).pair_k(1.0, 0.0, 1.0);
    Sky { ground_c, sky_max_k: contrast_k / share, shape }
}

/// A cloud every 40 s that stays for 15 s.
fn into_cloud() -> Vec<Weather> {
    let at = |time_s, sky_max_k| Weather { time_s, ground_c: Sky::NAMIBIA.ground_c, sky_max_k };
    let cycle = |i: u32| {
        let begin = 20.0 + 40.0 * f64::from(i);
        [at(begin, 40.0), at(begin + 1.5, 10.0), at(begin + 16.5, 10.0), at(begin + 18.0, 40.0)]
    };
    (0..2160).flat_map(cycle).collect()
}
