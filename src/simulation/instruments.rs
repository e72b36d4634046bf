//! What other instruments say of a flight: gyro, GPS, airspeed.

use super::noise::Noise;
use super::trajectory::Trajectory;
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
            aiding.altitude_m = Some(noisy(then.place_m[2], ALTITUDE_NOISE_M));
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

#[cfg(test)]
mod tests {
    use super::super::aircraft::Aircraft;
    use super::super::flight::{Flight, Waypoint};
    use super::super::manoeuvre::Style;
    use super::*;

    /// A minute at a bank of 30°, then a roll to 0 within a second, then level.
    fn trajectory() -> Trajectory {
        let at = |time_s, roll_deg| Waypoint { time_s, roll_deg, pitch_deg: 0.0 };
        let aircraft = Aircraft { airspeed_rms_m_s: 0.0, updraught_m_s: 0.0, ..Aircraft::default() };
        let style = Style::Scripted(Flight::scripted(vec![at(60.0, 30.0), at(61.0, 0.0)]));
        Trajectory::fly(&aircraft, &style, 70.0, 1)
    }

    fn read(fitted: Fitted, seed: u64) -> Vec<Aiding> {
        let (trajectory, mut instruments) = (trajectory(), Instruments::new(fitted, seed));
        (0..3000).map(|i| instruments.read(&trajectory, f64::from(i) * 0.02)).collect()
    }

    fn spread(values: &[f64]) -> (f64, f64) {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        (mean, (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt())
    }

    #[test]
    fn each_speaks_at_its_own_rate_with_its_own_noise() {
        let all = read(Fitted::default(), 1);
        let airspeed: Vec<f64> = all.iter().filter_map(|a| a.airspeed_m_s).collect();
        let climb: Vec<f64> = all.iter().filter_map(|a| a.climb_m_s).collect();
        let course = all.iter().filter_map(|a| a.course_deg);
        assert_eq!((airspeed.len(), climb.len(), course.count()), (600, 300, 300));
        let (mean, rms) = spread(&airspeed);
        assert!((mean - 18.0).abs() < 0.05 && (rms - 0.3).abs() < 0.04, "{mean} {rms}");
        assert!((spread(&climb).1 - 0.2).abs() < 0.03);
        // Turning to the right, level: the rate is all about down and right.
        let turn = (9.80665 * 30_f64.to_radians().tan() / 18.0).to_degrees();
        for (axis, expected) in [0.0, turn * 0.5, turn * 30_f64.to_radians().cos()].into_iter().enumerate() {
            let rates: Vec<f64> = all.iter().filter_map(|a| a.gyro_deg_s[axis]).collect();
            let (mean, rms) = spread(&rates);
            assert_eq!(rates.len(), 3000);
            assert!((mean - expected).abs() < 2.0 && (mean - expected).abs() > 0.001, "{axis}: {mean}");
            assert!((0.095..0.13).contains(&rms), "{axis}: {rms}");
        }
    }

    #[test]
    fn a_fix_is_as_old_as_it_is_said_to_be() {
        let trajectory = trajectory();
        let course = |gps_delay_s: f64| {
            let mut sum = 0.0;
            for seed in 0..200 {
                let mut gps = Instruments::new(Fitted { gps_delay_s, ..Fitted::default() }, seed);
                sum += gps.read(&trajectory, 30.0).course_deg.unwrap();
            }
            sum / 200.0
        };
        let turn = (9.80665 * 30_f64.to_radians().tan() / 18.0).to_degrees();
        let behind = (course(0.0) - course(0.5)).rem_euclid(360.0);
        assert!((behind - 0.5 * turn).abs() < 0.3, "{behind}");
    }

    #[test]
    fn what_is_not_fitted_says_nothing_and_changes_no_other() {
        let none = Fitted { gyro: false, gps: false, airspeed: false, gps_delay_s: 0.1 };
        assert!(read(none, 1).iter().all(|a| *a == Aiding::default()));
        let gps = read(Fitted { gps: true, ..none }, 1);
        let all = read(Fitted::default(), 1);
        assert!(gps.iter().zip(&all).all(|(a, b)| a.course_deg == b.course_deg && a.gyro_deg_s == [None; 3]));
    }
}
