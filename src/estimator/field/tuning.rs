//! What the filter takes the world to be like.

/// Noise and time constants, found on simulated flights. Angles in rad, temperatures in K, times in s;
/// a `walk` is what a random walk has gone in a second.
#[derive(Clone, Copy, Debug)]
pub struct Tuning {
    /// The sensors' first-order time constant.
    pub lag_s: f64,
    /// With a gyro the time constant is estimated: the standard deviation of its logarithm at first.
    pub lag_sigma: f64,
    /// Noise of one reading, quantisation included.
    pub noise_k: f64,
    /// Body rates without a gyro, about nose, left and up, rad/s; how fast that is learnt, 1/s.
    pub rate_sigma: [f64; 3],
    /// How long a rate lasts.
    pub rate_time_s: f64,
    /// How fast the size of the rates is learnt, 1/s.
    pub rate_learning: f64,
    /// The airspeed from which a heading is reckoned without a gyro, m/s.
    pub cruise_m_s: f64,
    /// The attitude's walk by the gyro's noise, and by its scale and axes for each rad/s.
    pub gyro_walk: (f64, f64),
    /// The gyro's bias at first and its walk, rad/s.
    pub bias: (f64, f64),
    /// How far the gyro's axes are turned from the head's: expected at first, once it shows, and its walk.
    pub askew: (f64, f64, f64),
    /// How far the gyro's clock is from the sensors'.
    pub clock_s: f64,
    /// The walk of the ground's temperature.
    pub ground_walk: f64,
    /// The walk of the contrast as a share of it, and how fast a larger one is learnt, 1/s.
    pub contrast: (f64, f64),
    /// The logarithm of the sky's optical depth, as [`Family`](crate::sky::family::Family) counts it: mean, standard
    /// deviation, walk.
    pub depth: (f64, f64, f64),
    /// Its walk while another sky would explain what is seen.
    pub unlike_depth_walk: f64,
    /// How much of what they see the sensors average in radiance, the rest in temperature: mean, standard deviation.
    pub radiance: (f64, f64),
    /// How much wider the sensors see than they are said to, as [`Family`](crate::sky::family::Family) counts it: standard
    /// deviation.
    pub spread: f64,
    /// How much they see as each of [two other forms](crate::sky::family::View) does, once it shows that they do: standard
    /// deviation.
    pub form: f64,
    /// How far a horizon leans where one side is warmer: at first and its walk.
    pub lean: (f64, f64),
    /// What its walk is more, as a share of what has been found.
    pub lean_share: f64,
    /// Its walk while the scene is seen to be unlike a sky alike all around.
    pub unlike_lean_walk: f64,
    /// What scenes stronger than usual may hide: so much is nothing, rad; of more, the walk for each rad.
    pub new_lean: (f64, f64),
    /// With a gyro, how far it is thought to lean once it does.
    pub unlike_lean: f64,
    /// What else the attitude may be wrong by once the scene is found to be unlike.
    pub unlike_turn: f64,
    /// How large a warm side may then be that nothing shows, without a gyro; with one, beyond what the
    /// states know of it.
    pub unlike_side_k: (f64, f64),
    /// Without a gyro a strong scene hides as much in what looks like an attitude: so many times itself.
    pub hidden: (f64, f64),
    /// A sensor's own scene at first (for a contrast of 35 K), and its least size.
    pub scene: (f64, f64),
    /// What a sensor shows too much, by its zero and, 15 K below the ground, by its scale: expected at first, once it shows,
    /// and its walk.
    pub error: (f64, f64, f64),
    /// How long a scene lasts at rest.
    pub scene_time_s: f64,
    /// The angle that turns a scene into another, with a gyro.
    pub scene_angle: f64,
    /// The same without: while there was none before it, and once there have been some for long.
    pub unaided_scene_angle: (f64, f64),
    /// How fast a stronger scene is learnt, and a weaker one, s.
    pub scene_learning_s: (f64, f64),
    /// Bank and pitch offsets against the slow references: at first and their walk.
    pub offset: (f64, f64),
    /// The bank by airspeed and yaw rate: its error and how long that lasts, until more is known.
    pub turn: (f64, f64),
    /// How long errors of a bank by the course, and of an angle of climb, last until more is known; how large they are [the
    /// references](crate::estimator::references) tell.
    pub lasting: (f64, f64),
}

impl Default for Tuning {
    fn default() -> Self {
        let deg = f64::to_radians;
        Self {
            lag_s: 0.1,
            lag_sigma: 0.3,
            noise_k: 0.085,
            rate_sigma: [deg(9.0), deg(3.5), deg(3.5)],
            rate_time_s: 0.6,
            rate_learning: 0.5,
            cruise_m_s: 15.0,
            gyro_walk: (deg(0.027), 0.0015),
            bias: (deg(1.0), deg(0.003)),
            askew: (deg(0.3), deg(3.0), deg(0.001)),
            clock_s: 0.01,
            ground_walk: 0.1,
            contrast: (0.02, 5.0),
            depth: (-1.2, 0.8, 0.005),
            unlike_depth_walk: 0.05,
            radiance: (0.3, 0.5),
            spread: 0.4,
            form: 0.7,
            lean: (deg(0.05), deg(0.0022)),
            lean_share: 0.006,
            unlike_lean_walk: deg(0.1),
            new_lean: (deg(0.5), 0.5),
            unlike_lean: deg(2.5),
            unlike_turn: deg(0.3),
            unlike_side_k: (1.4, 0.25),
            hidden: (3.5, 1.0),
            scene: (0.15, 0.012),
            error: (0.001, 0.3, 0.0001),
            scene_time_s: 60.0,
            scene_angle: 0.8,
            unaided_scene_angle: (3.0, 1.5),
            scene_learning_s: (2.0, 8.0),
            offset: (deg(6.0), deg(0.02)),
            turn: (deg(3.0), 1.0),
            lasting: (1.0, 2.0),
        }
    }
}
