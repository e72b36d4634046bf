//! Slow references: what coordinated turns and climb say of the attitude.

use super::state::{OFFSET, RATE, State, TURN};
use super::tune::Tuning;
use crate::estimator::vector::{Vector, cross};
use crate::frame::Aiding;
use crate::time::Time;

/// Standard gravity, m/s².
const G: f64 = 9.806_65;
/// Slower than this nothing flies, m/s.
const FLYING_M_S: f64 = 6.0;
/// Speeds older than this are none, s.
const AGE_S: f64 = 3.0;

/// The last of each.
#[derive(Clone, Debug, Default)]
pub struct Aid {
    airspeed: Option<(f64, Time)>,
    ground_speed: Option<(f64, Time)>,
    course: Option<(f64, Time)>,
    climb: Option<Time>,
    headed: bool,
}

impl Aid {
    /// Takes in what came with a frame.
    pub fn update(
        &mut self,
        aiding: &Aiding,
        state: &mut State,
        t: &Tuning,
        now: Time,
        dt_s: f64,
        gyro: Option<Vector>,
    ) {
        let keep = |held: &mut Option<(f64, Time)>, new: Option<f64>| {
            if let Some(v) = new.filter(|v| (0.0..200.0).contains(v)) {
                *held = Some((v, now));
            }
        };
        keep(&mut self.airspeed, aiding.airspeed_m_s);
        keep(&mut self.ground_speed, aiding.ground_speed_m_s);
        let fresh = |held: Option<(f64, Time)>| held.filter(|(_, at)| now.since(*at) < AGE_S).map(|(v, _)| v);
        let ground_speed = fresh(self.ground_speed).filter(|v| *v > FLYING_M_S);
        let Some(speed) = fresh(self.airspeed).or(ground_speed).filter(|v| *v > FLYING_M_S) else { return };

        let mut turning = None;
        if let (Some(course), Some(ground_speed)) = (aiding.course_deg.filter(|c| c.is_finite()), ground_speed) {
            self.heading(course.to_radians(), state, t);
            if let Some((before, at)) = self.course {
                let span = now.since(at);
                let change = wrap((course - before).to_radians());
                if span > 0.8 {
                    if span < 2.5 && change.abs() < 1.5 {
                        turning = Some((ground_speed * change / span / G, span));
                    }
                    self.course = Some((course, now));
                }
            } else {
                self.course = Some((course, now));
            }
        }
        let up = state.vertical();
        let by_turn = |component: usize| -> Vector {
            std::array::from_fn(|k| {
                let mut axis = [0.0; 3];
                axis[k] = 1.0;
                cross(up, axis)[component]
            })
        };
        if let Some(gyro) = gyro {
            // Without sideslip the weight's part along the wing turns the path: V·r = g·u_left.
            let [x, y, z] = by_turn(1);
            let h = [(TURN, x), (TURN + 1, y), (TURN + 2, z), (OFFSET, up[2]), (RATE + 2, speed / G)];
            let innovation = -speed * (gyro[2] + state.x[RATE + 2]) / G - up[1] - up[2] * state.x[OFFSET];
            state.correct(&h, innovation, t.turn_sigma.powi(2) * (t.turn_time_s / dt_s).max(1.0));
            state.settle();
        } else if let Some((tangent, span)) = turning {
            let [x, y, z] = by_turn(1);
            let h = [(TURN, x), (TURN + 1, y), (TURN + 2, z), (OFFSET, up[2])];
            let innovation = tangent.atan().sin() - up[1] - up[2] * state.x[OFFSET];
            state.correct(&h, innovation, (2.0 * t.turn_sigma).powi(2) * (t.turn_time_s / span).max(1.0));
            state.settle();
        }
        if let Some(climb) = aiding.climb_m_s.filter(|c| c.abs() < speed) {
            let span = self.climb.map_or(t.climb_time_s, |at| now.since(at));
            self.climb = Some(now);
            let [x, y, z] = by_turn(0);
            let h = [(TURN, x), (TURN + 1, y), (TURN + 2, z), (OFFSET + 1, 1.0)];
            let innovation = climb / speed - state.vertical()[0] - state.x[OFFSET + 1];
            state.correct(&h, innovation, t.climb_sigma.powi(2) * (t.climb_time_s / span.max(1e-3)).max(1.0));
            state.settle();
        }
    }

    /// The nose looks, on the average, along the course.
    fn heading(&mut self, course: f64, state: &mut State, t: &Tuning) {
        let [north, west, up] = state.axes;
        if up[0].abs() > 0.8 {
            return;
        }
        let error = wrap(course - (-west[0]).atan2(north[0]));
        if !self.headed {
            // Clockwise from above is about down.
            state.rotate(up.map(|c| -c * error));
            for i in 0..3 {
                state.add_variance(TURN + i, 0.0);
            }
            self.headed = true;
            return;
        }
        let h = [(TURN, -up[0]), (TURN + 1, -up[1]), (TURN + 2, -up[2])];
        state.correct(&h, error, t.heading_sigma.powi(2) * 200.0);
        state.settle();
    }
}

/// Into (−π, π].
fn wrap(angle: f64) -> f64 {
    let a = angle.rem_euclid(std::f64::consts::TAU);
    if a > std::f64::consts::PI { a - std::f64::consts::TAU } else { a }
}
