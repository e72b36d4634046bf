//! What other instruments say of a flight: gyro, GPS, airspeed.

use super::aircraft::Trajectory;
use super::noise::Noise;
use crate::frame::Aiding;

/// Noise of the gyro, °/s rms a reading; its bias at the start, and how that walks in a second.
const GYRO_NOISE_DEG_S: f64 = 0.1;
const GYRO_BIAS_DEG_S: f64 = 0.5;
const GYRO_WALK_DEG_S: f64 = 0.005;
/// Between two fixes and between two readings of the airspeed, s.
const FIX_EVERY_S: f64 = 0.2;
const AIRSPEED_EVERY_S: f64 = 0.1;
/// Noise of a fix: speed, m/s; course, °; climb, m/s; altitude, m.
const SPEED_NOISE_M_S: f64 = 0.1;
const COURSE_NOISE_DEG: f64 = 1.0;
const CLIMB_NOISE_M_S: f64 = 0.2;
const ALTITUDE_NOISE_M: f64 = 0.5;
/// Noise of the airspeed, m/s.
const AIRSPEED_NOISE_M_S: f64 = 0.3;

/// Which instruments there are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fitted {
    /// Body rates, with every scan.
    pub gyro: bool,
    /// Ground speed, course, climb and altitude, five times a second.
    pub gps: bool,
    /// Airspeed, ten times a second.
    pub airspeed: bool,
    /// How old a fix is when it arrives, s.
    pub gps_delay_s: f64,
}

impl Default for Fitted {
    /// All of them, with fixes 0.1 s old.
    fn default() -> Self {
        Self { gyro: true, gps: true, airspeed: true, gps_delay_s: 0.1 }
    }
}

/// The instruments with their errors. Nothing is allocated after they are made.
#[derive(Clone, Debug)]
pub struct Instruments {
    fitted: Fitted,
    gyro: Noise,
    bias_deg_s: [f64; 3],
    gps: Noise,
    airspeed: Noise,
    last_s: Option<f64>,
    next_fix_s: f64,
    next_airspeed_s: f64,
}

impl Instruments {
    /// Their errors come from `seed`, each instrument's on its own.
    pub fn new(fitted: Fitted, seed: u64) -> Self {
        let mut seeds = Noise::new(seed);
        let [mut gyro, gps, airspeed] = [(); 3].map(|()| Noise::new(seeds.bits()));
        let bias_deg_s = [(); 3].map(|()| GYRO_BIAS_DEG_S * gyro.normal());
        Self { fitted, gyro, bias_deg_s, gps, airspeed, last_s: None, next_fix_s: 0.0, next_airspeed_s: 0.0 }
    }

    /// What is new at `time_s` of the flight.
    pub fn read(&mut self, trajectory: &Trajectory, time_s: f64) -> Aiding {
        let mut aiding = Aiding::default();
        let dt_s = self.last_s.replace(time_s).map_or(0.0, |last| (time_s - last).max(0.0));
        let now = trajectory.at(time_s);
        if self.fitted.gyro {
            for (i, rate) in now.body_rates_deg_s().into_iter().enumerate() {
                self.bias_deg_s[i] += GYRO_WALK_DEG_S * dt_s.sqrt() * self.gyro.normal();
                aiding.gyro_deg_s[i] = Some(rate + self.bias_deg_s[i] + GYRO_NOISE_DEG_S * self.gyro.normal());
            }
        }
        if self.fitted.airspeed && due(&mut self.next_airspeed_s, time_s, AIRSPEED_EVERY_S) {
            aiding.airspeed_m_s = Some((now.airspeed_m_s + AIRSPEED_NOISE_M_S * self.airspeed.normal()).max(0.0));
        }
        if self.fitted.gps && due(&mut self.next_fix_s, time_s, FIX_EVERY_S) {
            let then = trajectory.at(time_s - self.fitted.gps_delay_s);
            let [north, east, up] = then.velocity_m_s;
            let mut noisy = |value: f64, rms: f64| value + rms * self.gps.normal();
            let course_deg = noisy(east.atan2(north).to_degrees(), COURSE_NOISE_DEG).rem_euclid(360.0);
            aiding.ground_speed_m_s = Some(noisy(north.hypot(east), SPEED_NOISE_M_S).max(0.0));
            aiding.course_deg = Some(course_deg);
            aiding.climb_m_s = Some(noisy(up, CLIMB_NOISE_M_S));
            aiding.altitude_m = Some(noisy(then.altitude_m, ALTITUDE_NOISE_M));
        }
        aiding
    }
}

/// Whether it is time again; if so the next time is set.
fn due(next_s: &mut f64, time_s: f64, every_s: f64) -> bool {
    // A hair early counts: the scans' own times are rounded.
    let is_due = time_s >= *next_s - 1e-6;
    if is_due {
        *next_s = (*next_s + every_s).max(time_s + 0.5 * every_s);
    }
    is_due
}
