//! What the filter takes the world to be like.

/// Noise and time constants. Angles in rad, temperatures in K, times in s.
#[derive(Clone, Copy, Debug)]
pub struct Tuning {
    /// The sensors' time constant.
    pub lag_s: f64,
    /// Noise of one reading, K.
    pub noise_k: f64,
    /// Body rates without a gyro: their standard deviation about nose, left, up, rad/s.
    pub rate_sigma: [f64; 3],
    /// And how long they last.
    pub rate_time_s: f64,
    /// Random walk of the attitude by the gyro's noise, rad/√s.
    pub gyro_walk: f64,
    /// Of the gyro's bias, rad/s/√s.
    pub bias_walk: f64,
    /// The gyro's bias at first, rad/s.
    pub bias_sigma: f64,
    /// Of the ground's temperature, K/√s.
    pub ground_walk: f64,
    /// Of the contrast, of itself, 1/√s.
    pub contrast_walk: f64,
    /// Of the depth's logarithm, 1/√s.
    pub depth_walk: f64,
    /// The depth's logarithm at first, and its standard deviation.
    pub depth: (f64, f64),
    /// The share of averaging in radiance, and its standard deviation.
    pub radiance: (f64, f64),
    /// A warm side at first, K.
    pub side_sigma: f64,
    /// And of the ground, K.
    pub ground_side_sigma: f64,
    /// K
    pub doubt_k: f64,
    /// K/√s
    pub unlike_walk: f64,
    /// K/√s.
    pub blind_side_walk: f64,
    /// K.
    pub blind_side: f64,
    /// m/s
    pub cruise_m_s: f64,
    /// K/√s.
    pub side_walk: f64,
    /// Offsets against slow references at first, rad.
    pub offset_sigma: f64,
    /// rad/√s.
    pub offset_walk: f64,
    /// How fast rates and scenes are learnt, 1/s.
    pub adapt: f64,
    /// 1/s
    pub adapt_scene: f64,
    /// s
    pub attack_scene: f64,
    /// K
    pub scene_start: f64,
    /// 1/s
    pub adapt_contrast: f64,
    /// The angle the head turns through until it sees another scene, rad.
    pub scene_angle: f64,
    /// Each sensor's own scene, K.
    pub scene_sigma: f64,
    /// And how long it lasts.
    pub scene_time_s: f64,
    /// The sine of the bank by coordinated turns, and how long its errors last.
    pub turn_sigma: f64,
    /// s
    pub turn_time_s: f64,
    /// The sine of the pitch by the climb, and how long its errors last.
    pub climb_sigma: f64,
    /// s
    pub climb_time_s: f64,
    /// The nose against the course.
    pub heading_sigma: f64,
    /// The logarithm of the sensors' time constant at first, with a gyro.
    pub lag_sigma: f64,
}

impl Default for Tuning {
    fn default() -> Self {
        let deg = f64::to_radians;
        Self {
            lag_s: 0.1,
            noise_k: 0.085,
            rate_sigma: [deg(9.0), deg(3.5), deg(3.5)],
            rate_time_s: 0.5,
            gyro_walk: deg(0.05),
            bias_walk: deg(0.003),
            bias_sigma: deg(2.0),
            ground_walk: 0.1,
            contrast_walk: 0.02,
            depth_walk: 0.01,
            depth: (-1.2, 0.8),
            radiance: (0.5, 0.5),
            side_sigma: 1.0,
            ground_side_sigma: 1.0,
            doubt_k: 1.1,
            unlike_walk: 0.05,
            blind_side_walk: 0.0,
            blind_side: 0.0,
            cruise_m_s: 15.0,
            side_walk: 0.02,
            offset_sigma: deg(6.0),
            offset_walk: deg(0.02),
            scene_sigma: 0.03,
            adapt: 0.5,
            adapt_scene: 8.0,
            attack_scene: 2.0,
            scene_start: 0.5,
            adapt_contrast: 5.0,
            scene_angle: 0.7,
            scene_time_s: 60.0,
            turn_sigma: deg(3.0),
            turn_time_s: 1.0,
            climb_sigma: deg(2.0),
            climb_time_s: 1.0,
            heading_sigma: deg(15.0),
            lag_sigma: 0.5,
        }
    }
}
