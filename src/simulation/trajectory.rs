//! A flight that was flown: attitude, heading, speed and path against time.

use super::aircraft::{Aircraft, State};
use super::manoeuvre::{Motion, Pilot, Style};
use super::noise::Noise;
use super::turbulence::{Gusts, Wander};

/// Between two states kept, s.
const STEP_S: f64 = 0.005;
/// Height above the ground at the start, m.
const START_M: f64 = 300.0;
/// The flight path follows the nose behind by this, s.
const PATH_LAG_S: f64 = 0.4;
/// The nose of an uncoordinated aircraft follows its turn behind by this, s.
const NOSE_LAG_S: f64 = 0.5;

/// A flight that was flown: its states, 200 a second.
#[derive(Clone, Debug, PartialEq)]
pub struct Trajectory {
    states: Vec<State>,
}

impl Trajectory {
    /// Flies `seconds` (at most a day) in a style; `seed` chooses what is left to chance.
    pub fn fly(aircraft: &Aircraft, style: &Style, seconds: f64, seed: u64) -> Self {
        let mut noise = Noise::new(seed);
        let mut pilot = Pilot::new(style, noise.bits());
        let mut speed = Wander::new(aircraft.airspeed_rms_m_s, 8.0, &mut noise);
        let mut updraught = Wander::new(aircraft.updraught_m_s, 5.0, &mut noise);
        let mut yawing = Gusts::new(3.0_f64.to_radians(), 1.5, 0.5, noise.bits());
        // The direction of flight through the air, how fast it turns, and where the nose is.
        let mut course = std::f64::consts::TAU * noise.uniform();
        let (mut turn, mut nose, mut nose_turn) = (0.0, course, 0.0);
        let mut place_m = [0.0, 0.0, START_M];
        let mut path = None;
        let count = (seconds.clamp(0.0, 86_400.0) / STEP_S).ceil() as usize + 1;
        let states = (0..count)
            .map(|i| {
                let time_s = i as f64 * STEP_S;
                let m: Motion = pilot.step(time_s, STEP_S, |roll| aircraft.lift(roll));
                let airspeed_m_s = aircraft.airspeed_m_s + speed.step(STEP_S, &mut noise);
                let before = turn;
                turn = aircraft.turn_rate(m.roll, airspeed_m_s);
                course += 0.5 * (before + turn) * STEP_S;
                let (yaw, yaw_rate) = if aircraft.uncoordinated {
                    let [shake, shake_rate] = yawing.step(STEP_S);
                    let before = nose_turn;
                    nose_turn = (course - nose) / NOSE_LAG_S;
                    nose += 0.5 * (before + nose_turn) * STEP_S;
                    (nose + shake, nose_turn + shake_rate)
                } else {
                    (course, turn)
                };
                let climb = m.pitch - aircraft.lift_at(m.roll, m.pitch);
                let path = path.get_or_insert(climb);
                *path += (climb - *path) * STEP_S / PATH_LAG_S;
                let (sin, cos) = path.sin_cos();
                let up = airspeed_m_s * sin + updraught.step(STEP_S, &mut noise);
                let level = airspeed_m_s * cos;
                let [wind_north, wind_east] = aircraft.wind_m_s;
                let velocity_m_s = [level * course.cos() + wind_north, level * course.sin() + wind_east, up];
                if i > 0 {
                    place_m = std::array::from_fn(|j| place_m[j] + velocity_m_s[j] * STEP_S);
                }
                State {
                    angles: [m.roll, m.pitch, yaw],
                    rates: [m.roll_rate, m.pitch_rate, yaw_rate],
                    airspeed_m_s,
                    velocity_m_s,
                    place_m,
                }
            })
            .collect();
        Self { states }
    }

    /// The state `time_s` seconds after the flight began: the first before, the last, at rest, after.
    pub fn at(&self, time_s: f64) -> State {
        let x = (time_s / STEP_S).max(0.0);
        let i = x as usize;
        match (self.states.get(i), self.states.get(i.saturating_add(1))) {
            (Some(a), Some(b)) => a.toward(b, STEP_S, x.fract()),
            _ => State { rates: [0.0; 3], ..self.states.last().copied().unwrap_or_default() },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::aerobatics::aerobatics;
    use super::super::feature::wrapped;
    use super::super::flight::Flight;
    use super::super::manoeuvre::Random;
    use super::super::orientation::Orientation;
    use super::*;

    const QUIET: Aircraft = Aircraft {
        airspeed_m_s: 20.0,
        airspeed_rms_m_s: 0.0,
        attack_deg: 3.0,
        attack_per_g_deg: 4.0,
        wind_m_s: [0.0; 2],
        updraught_m_s: 0.0,
        uncoordinated: false,
    };

    fn random(aircraft: &Aircraft, seconds: f64, seed: u64) -> Trajectory {
        Trajectory::fly(aircraft, &Style::Random(Random::default()), seconds, seed)
    }

    /// The up or the north of the world (`axis` 2 or 0) on the airframe's axes.
    fn world_axis(s: &State, axis: usize) -> [f64; 3] {
        let orientation = Orientation::new(s.attitude(), s.yaw());
        std::array::from_fn(|j| orientation.to_world(std::array::from_fn(|i| f64::from(u8::from(i == j))))[axis])
    }

    #[test]
    fn body_rates_integrate_back_to_the_attitude() {
        let usual = Aircraft::default();
        let over_the_top = Trajectory::fly(&usual, &Style::Scripted(aerobatics()), 240.0, 5);
        let slack = random(&Aircraft { uncoordinated: true, ..usual }, 60.0, 5);
        let flights = [(random(&usual, 60.0, 5), 60), (slack, 60), (over_the_top, 240)];
        for ((trajectory, seconds), axis) in flights.iter().flat_map(|flight| [(flight, 2), (flight, 0)]) {
            // The world's vertical and north turn against the airframe: v' = v × ω on its axes.
            let mut v = world_axis(&trajectory.at(0.0), axis);
            let dt = 0.0025;
            for i in 0..400 * seconds {
                let [p, q, r] = trajectory.at((f64::from(i) + 0.5) * dt).body_rates_deg_s().map(f64::to_radians);
                // About nose, left, up.
                let w = [p, -q, -r];
                let turned =
                    |v: [f64; 3]| [v[1] * w[2] - v[2] * w[1], v[2] * w[0] - v[0] * w[2], v[0] * w[1] - v[1] * w[0]];
                let half = turned(v);
                let middle: [f64; 3] = std::array::from_fn(|j| v[j] + 0.5 * dt * half[j]);
                let whole = turned(middle);
                v = std::array::from_fn(|j| v[j] + dt * whole[j]);
            }
            let truth = world_axis(&trajectory.at(f64::from(*seconds)), axis);
            let off = v.iter().zip(&truth).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt().to_degrees();
            assert!(off < 0.1, "axis {axis} after {seconds} s: {off}°");
        }
    }

    #[test]
    fn a_coordinated_turn_turns_by_its_bank_and_its_path_is_the_pitch_less_the_angle_of_attack() {
        let bank = 40.0_f64.to_radians();
        // 3° and what a load of 1/cos adds, times cos.
        let attack_deg = (3.0 + 4.0 * (1.0 / bank.cos() - 1.0)) * bank.cos();
        let style = Style::Scripted(Flight::steady(40.0, attack_deg + 5.0));
        let wind = Aircraft { wind_m_s: [3.0, -4.0], ..QUIET };
        let [still, windy] = [QUIET, wind].map(|a| Trajectory::fly(&a, &style, 30.0, 1));
        let (a, b) = (still.at(10.0), still.at(20.0));
        let turned = b.angles[2] - a.angles[2];
        assert!((turned - 10.0 * 9.80665 * bank.tan() / 20.0).abs() < 1e-6);
        assert!((b.place_m[2] - a.place_m[2] - 200.0 * 5.0_f64.to_radians().sin()).abs() < 1e-3);
        let ground = windy.at(20.0).velocity_m_s;
        assert!(
            (ground[0] - b.velocity_m_s[0] - 3.0).abs() < 1e-9 && (ground[1] - b.velocity_m_s[1] + 4.0).abs() < 1e-9
        );
        assert!((b.velocity_m_s[0].hypot(b.velocity_m_s[1]) - 20.0 * 5.0_f64.to_radians().cos()).abs() < 1e-9);
    }

    #[test]
    fn without_coordination_the_nose_lags_the_path() {
        let style = Style::Scripted(Flight::steady(30.0, 3.0));
        let slack = Aircraft { uncoordinated: true, ..QUIET };
        let trajectory = Trajectory::fly(&slack, &style, 300.0, 1);
        let behind = |i: u32| {
            let state = trajectory.at(f64::from(i) * 0.1);
            let [north, east, _] = state.velocity_m_s;
            wrapped(east.atan2(north) - state.angles[2])
        };
        let mean = (50..3000).map(behind).sum::<f64>() / 2950.0;
        let turn = 9.80665 * 30.0_f64.to_radians().tan() / 20.0;
        assert!((mean - 0.5 * turn).abs() < 0.01, "{mean}");
    }

    #[test]
    fn roll_rates_are_those_of_rough_flights_and_angles_stay_within_the_limits() {
        let mut roll_rates: Vec<f64> = Vec::new();
        let (mut squares, mut steepest) = (0.0, [0.0_f64; 2]);
        for seed in 0..10 {
            let trajectory = random(&Aircraft::default(), 300.0, seed);
            for i in 0..15_000 {
                let state = trajectory.at(f64::from(i) * 0.02);
                roll_rates.push(state.body_rates_deg_s()[0].abs());
                assert!((20.0..800.0).contains(&state.place_m[2]), "{:?}", state.place_m);
                squares += state.rates[1].to_degrees().powi(2);
                let angles = [state.angles[0], state.angles[1]].map(|a| a.to_degrees().abs());
                steepest = std::array::from_fn(|j| steepest[j].max(angles[j]));
            }
        }
        let n = roll_rates.len();
        let rms = (roll_rates.iter().map(|r| r * r).sum::<f64>() / n as f64).sqrt();
        roll_rates.sort_by(f64::total_cmp);
        assert!((6.5..8.5).contains(&rms), "{rms}");
        assert!((21.0..29.0).contains(&roll_rates[n * 99 / 100]), "{}", roll_rates[n * 99 / 100]);
        let pitch_rms = (squares / n as f64).sqrt();
        assert!((2.0..3.0).contains(&pitch_rms), "{pitch_rms}");
        assert!((50.0..70.0).contains(&steepest[0]) && (15.0..28.0).contains(&steepest[1]), "{steepest:?}");
    }

    #[test]
    fn a_loop_goes_round_and_comes_out_where_it_went_in() {
        let aircraft = Aircraft { airspeed_rms_m_s: 0.0, updraught_m_s: 0.0, ..QUIET };
        let trajectory = Trajectory::fly(&aircraft, &Style::Scripted(aerobatics()), 240.0, 1);
        // From 6 to 12 s; at 9 s it is on top, on its back, and flies the other way.
        let course = |s: &State| s.velocity_m_s[1].atan2(s.velocity_m_s[0]);
        let [before, top, after] = [6.0, 9.4, 13.0].map(|t| trajectory.at(t));
        assert!(
            wrapped(course(&top) - course(&before)).abs() > 2.6
                && wrapped(course(&after) - course(&before)).abs() < 0.5
        );
        assert!((15.0..80.0).contains(&(top.place_m[2] - before.place_m[2])));
        let mut last = trajectory.at(0.0);
        for i in 1..48_000 {
            let s = trajectory.at(f64::from(i) * 0.005);
            let turned = [0, 2].map(|axis| {
                let (a, b) = (world_axis(&last, axis), world_axis(&s, axis));
                a.iter().zip(&b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
            });
            // No faster than 450 °/s, over the top or not.
            assert!(turned.iter().all(|t| *t < 0.04), "{turned:?} at {} s", f64::from(i) * 0.005);
            assert!((50.0..1500.0).contains(&s.place_m[2]), "{:?}", s.place_m);
            assert!(s.attitude().pitch.abs() <= std::f64::consts::FRAC_PI_2);
            last = s;
        }
    }

    #[test]
    fn a_flight_is_its_seed_s_moves_smoothly_and_rests_at_its_end() {
        let trajectory = random(&Aircraft::default(), 20.0, 9);
        assert_eq!(trajectory, random(&Aircraft::default(), 20.0, 9));
        assert_ne!(trajectory, random(&Aircraft::default(), 20.0, 10));
        for i in 0..20_000 {
            let t = f64::from(i) * 0.001;
            let [a, b] = [t, t + 0.001].map(|t| trajectory.at(t).attitude());
            assert!((a.roll - b.roll).abs() < 0.002 && (a.pitch - b.pitch).abs() < 0.001, "{t} s");
        }
        let end = trajectory.at(1e9);
        assert_eq!(end.rates, [0.0; 3]);
        assert_eq!(trajectory.at(-1.0).angles, trajectory.at(0.0).angles);
        assert!(trajectory.at(f64::NAN).airspeed_m_s.is_finite());
    }
}
