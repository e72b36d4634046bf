//! Slow references: what coordinated turns, the climb and the course say.
//!
//! Each is taken as a measurement whose errors last, so that it weighs little at any moment; what it says
//! beyond the thermopiles for long is an offset state of its own. None is needed.

use super::lean;
use super::rates::rates;
use super::reference_noise::ReferenceNoise;
use super::state::{OFFSET, RATE, State, TURN};
use super::tuning::Tuning;
use crate::estimator::flying::{G_M_S2, wrapped};
use crate::estimator::references::References;
use crate::estimator::vector::{Vector, cross};
use crate::estimator::wind::{Speed, ThroughAir};
use crate::frame::Aiding;
use crate::time::Time;

/// A measurement farther from its prediction than this many standard deviations is none.
const GATE: f64 = 4.0;

/// After so long without them they tell nothing any more, s.
const SILENT_S: f64 = 10.0;

/// The nose is off the heading by sideslip and by a fix that is late in a turn, rad; that and a drift that is not known last
/// so long, s.
const BESIDE: f64 = 8_f64.to_radians();
const BESIDE_S: f64 = 20.0;
/// A heading that is off by more is another one, and all that was learnt by the compass turns with it, rad.
const ELSEWHERE: f64 = 45_f64.to_radians();

/// The last that was heard of each, and how much each is off.
#[derive(Clone, Debug, Default)]
pub struct Aid {
    heard: Option<Time>,
    references: References,
    heading: Option<Time>,
    by_rate: ReferenceNoise,
    by_course: ReferenceNoise,
    by_climb: ReferenceNoise,
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
        let up = state.vertical();
        let heard = self.references.hear(aiding, up[1].atan2(up[2]), now);
        let Some(Speed { m_s: speed, share, measured }) = heard.speed else { return };
        self.heard = Some(now);
        if let Some(air) = heard.air {
            self.heading(air, state, now);
        }
        let up = state.vertical();
        if let Some(gyro) = gyro.filter(|_| measured) {
            // Without sideslip the weight's part along the wing turns the path: V·r = g·u_left.
            let bank = -speed * rates(state, t, Some(gyro))[2] / G_M_S2;
            let errors = (t.turn.0.hypot(share * bank), t.turn.1);
            let said = Said { component: 1, offset: up[2], rate: speed / G_M_S2, off: bank - up[1], errors, dt_s };
            measure(state, t, &said, &mut self.by_rate);
        } else if let Some((bank, roll)) = heard.gentle_bank() {
            let (off, errors) = (up[2] * (bank.angle - roll), (bank.sigma, t.lasting.0));
            let said = Said { component: 1, offset: up[2], rate: 0.0, off, errors, dt_s: bank.span_s };
            measure(state, t, &said, &mut self.by_course);
        }
        if let Some(climb) = heard.climb {
            let (off, errors) = (climb.angle.sin() - up[0], (climb.sigma_by(t.lasting.1), t.lasting.1));
            let said = Said { component: 0, offset: 1.0, rate: 0.0, off, errors, dt_s: climb.span_s };
            measure(state, t, &said, &mut self.by_climb);
        }
    }

    fn heading(&mut self, ThroughAir { heading, sigma, .. }: ThroughAir, state: &mut State, now: Time) {
        let [north, west, up] = state.axes;
        if up[0].abs() > 0.8 {
            return;
        }
        let error = wrapped(heading - (-west[0]).atan2(north[0]));
        // Clockwise from above is about down.
        match self.heading.replace(now) {
            Some(at) if error.abs() < ELSEWHERE => {
                let h = [(TURN, -up[0]), (TURN + 1, -up[1]), (TURN + 2, -up[2])];
                state.correct(&h, error, lasting((sigma.hypot(BESIDE), BESIDE_S), now.since(at)));
                state.settle();
            }
            // No correction: a linear one would move the attitude, too.
            _ => state.turn_heading(error),
        }
    }
}

/// What a reference says of a component of the vertical.
struct Said {
    component: usize,
    /// The share of its offset in it, and that of the rate about up, s.
    offset: f64,
    rate: f64,
    /// How far it is off the attitude.
    off: f64,
    /// How large its errors are and for how long they last, s.
    errors: (f64, f64),
    /// How long after the last.
    dt_s: f64,
}

/// Takes in what a reference says, and how noisy it is.
fn measure(state: &mut State, t: &Tuning, said: &Said, noise: &mut ReferenceNoise) {
    let (up, k, (sigma, time_s)) = (state.vertical(), said.component, said.errors);
    let by_turn = |i: usize| cross(up, std::array::from_fn(|j| f64::from(u8::from(i == j))))[k];
    let offset = (OFFSET + 1 - k, said.offset);
    let h = [(TURN, by_turn(0)), (TURN + 1, by_turn(1)), (TURN + 2, by_turn(2)), offset, (RATE + 2, said.rate)];
    let innovation = said.off - said.offset * state.x[offset.0];
    let (size, known) = (noise.size(), state.variance_of(&h));
    if innovation * innovation < GATE * GATE * (known + size.max(1.0) * sigma * sigma) {
        let leaning = || lean::unexpected(state, t.unlike_lean)[1 - k];
        noise.hear(innovation, 2.0 * time_s * sigma * sigma, said.dt_s, || known + leaning());
        state.correct(&h, innovation, size * lasting(said.errors, said.dt_s));
        state.settle();
    }
}

/// The variance of a measurement that comes every `dt_s` with errors that last.
fn lasting((sigma, time_s): (f64, f64), dt_s: f64) -> f64 {
    sigma * sigma * (2.0 * time_s / dt_s.max(1e-3)).max(1.0)
}
