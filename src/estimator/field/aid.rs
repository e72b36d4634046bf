//! Slow references: what coordinated turns, the climb and the course say.
//!
//! Each is taken as a measurement whose errors last, so that it weighs little at any moment; what it says
//! beyond the thermopiles for long is an offset state of its own. None is needed.

use super::state::{OFFSET, RATE, State, TURN};
use super::tuning::Tuning;
use crate::estimator::flying::{G_M_S2, Held, flying, keep, speed, wrapped};
use crate::estimator::vector::{Vector, cross};
use crate::frame::Aiding;
use crate::time::Time;
use std::f64::consts::PI;

/// Courses this far apart tell how fast it turns, s.
const SPAN_S: std::ops::Range<f64> = 0.8..2.5;
/// A measurement farther from its prediction than this many standard deviations is none.
const GATE: f64 = 4.0;

/// After so long without them they tell nothing any more, s.
const SILENT_S: f64 = 10.0;

/// The last that was heard of each.
#[derive(Clone, Debug, Default)]
pub struct Aid {
    heard: Option<Time>,
    airspeed: Held,
    ground_speed: Held,
    course: Held,
    heading: Option<Time>,
    climb: Option<Time>,
}

impl Aid {
    /// Whether they have lately told of the attitude.
    pub fn tells(&self, now: Time) -> bool {
        self.heard.is_some_and(|at| (0.0..SILENT_S).contains(&now.since(at)))
    }

    /// Takes in what came with a frame `dt_s` after the last; `gyro` are the body rates in use.
    pub fn update(
        &mut self,
        aiding: &Aiding,
        state: &mut State,
        t: &Tuning,
        (now, dt_s): (Time, f64),
        gyro: Option<Vector>,
    ) {
        keep(&mut self.airspeed, speed(aiding.airspeed_m_s), now);
        keep(&mut self.ground_speed, speed(aiding.ground_speed_m_s), now);
        let ground_speed = flying(self.ground_speed, now);
        let Some(speed) = flying(self.airspeed, now).or(ground_speed) else { return };
        self.heard = Some(now);
        let course = aiding.course_deg.filter(|c| c.abs() <= 360.0).map(f64::to_radians);
        let turning = course.zip(ground_speed).and_then(|(course, _)| {
            self.heading(course, state, t, now);
            self.turning(course, now)
        });
        if let Some(gyro) = gyro {
            // Without sideslip the weight's part along the wing turns the path: V·r = g·u_left.
            let bank = -speed * (gyro[2] + state.x[RATE + 2]) / G_M_S2;
            measure(state, 1, (OFFSET, state.vertical()[2]), Some((RATE + 2, speed / G_M_S2)), bank, t.turn, dt_s);
        } else if let Some((rate, span_s)) = turning {
            let bank = (ground_speed.unwrap_or(speed) * rate / G_M_S2).atan().sin();
            // Half of the span old, and without the airframe's own motion.
            let errors = (2.0 * t.turn.0, t.turn.1);
            measure(state, 1, (OFFSET, state.vertical()[2]), None, bank, errors, span_s);
        }
        if let Some(climb) = aiding.climb_m_s.filter(|c| c.abs() < speed) {
            let span_s = self.climb.map_or(t.climb.1, |at| now.since(at));
            self.climb = Some(now);
            measure(state, 0, (OFFSET + 1, 1.0), None, climb / speed, t.climb, span_s);
        }
    }

    /// How fast the course turns, rad/s, and over which time that was seen, s.
    fn turning(&mut self, course: f64, now: Time) -> Option<(f64, f64)> {
        let (before, at) = *self.course.get_or_insert((course, now));
        let span_s = now.since(at);
        if (0.0..SPAN_S.start).contains(&span_s) {
            return None;
        }
        self.course = Some((course, now));
        let change = wrapped(course - before);
        (SPAN_S.contains(&span_s) && change.abs() < PI / 2.0).then(|| (change / span_s, span_s))
    }

    /// On the average the nose looks along the course; wind puts it beside.
    fn heading(&mut self, course: f64, state: &mut State, t: &Tuning, now: Time) {
        let [north, west, up] = state.axes;
        if up[0].abs() > 0.8 {
            return;
        }
        let error = wrapped(course - (-west[0]).atan2(north[0]));
        // Clockwise from above is about down.
        match self.heading.replace(now) {
            None => state.turn_heading(error),
            Some(at) => {
                let h = [(TURN, -up[0]), (TURN + 1, -up[1]), (TURN + 2, -up[2])];
                state.correct(&h, error, lasting(t.heading, now.since(at)));
                state.settle();
            }
        }
    }
}

/// A measurement of one component of the vertical, with an offset state and perhaps another, `dt_s` after
/// the last; its errors have a size and last for a time.
fn measure(
    state: &mut State,
    component: usize,
    offset: (usize, f64),
    other: Option<(usize, f64)>,
    measured: f64,
    errors: (f64, f64),
    dt_s: f64,
) {
    let up = state.vertical();
    let by_turn = |k: usize| cross(up, std::array::from_fn(|i| f64::from(u8::from(i == k))))[component];
    let other = other.unwrap_or((RATE, 0.0));
    let h = [(TURN, by_turn(0)), (TURN + 1, by_turn(1)), (TURN + 2, by_turn(2)), offset, other];
    let innovation = measured - up[component] - offset.1 * state.x[offset.0];
    let expected = state.variance_of(&h) + errors.0 * errors.0;
    if innovation * innovation < GATE * GATE * expected {
        state.correct(&h, innovation, lasting(errors, dt_s));
        state.settle();
    }
}

/// The variance of a measurement that comes every `dt_s` with errors that last.
fn lasting((sigma, time_s): (f64, f64), dt_s: f64) -> f64 {
    sigma * sigma * (2.0 * time_s / dt_s.max(1e-3)).max(1.0)
}
