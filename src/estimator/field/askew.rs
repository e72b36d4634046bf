//! A gyro whose axes are not the head's: turned from them, and of another scale about each.
//!
//! Nobody mounts two boxes to a degree, and a degree is what a turn by 60° brings into the horizon. The thermopiles tell, as
//! a sky does not turn with the gyro's axes; but a horizon that leans looks much the same over half a turn, and waits for it
//! to be ruled out: so little is expected until much is far likelier. What was learnt until then is kept, and doubted.

use super::FieldEstimator;
use super::expected::{IfExpected, expect};
use super::state::{ASKEW, RATE, SCALE, State, TURN};
use crate::estimator::vector::Vector;
use std::ops::Range;

/// How many times more likely, as a logarithm, axes far askew must be; for so long, s: a ridge looks like them for a while.
const SURE: f64 = 10.0;
const LASTS_S: f64 = 3.0;
/// Sensors are off as well where that is as much more likely beside such axes, as a logarithm.
const OFF: f64 = 15.0;
/// A scale is expected to be off by such a share for each radian that the axes are.
const SCALE_SHARE: f64 = 0.2;
/// So many standard deviations from what is expected it is not the gyro.
const FAR: f64 = 3.0;
/// So much of what is expected is expected with sensors that cannot show a scene.
const BLIND_SHARE: f64 = 0.6;

/// The states.
pub const STATES: Range<usize> = ASKEW..SCALE + 3;

/// What of the rates about each axis a gyro's `rates` do not show, by each state.
fn by_axes(rates: Vector) -> [[(usize, f64); 3]; 3] {
    std::array::from_fn(|i| {
        let (next, last) = ((i + 1) % 3, (i + 2) % 3);
        [(ASKEW + next, rates[last]), (ASKEW + last, -rates[next]), (SCALE + i, SCALE_SHARE * rates[i])]
    })
}

/// What a gyro's `rates` do not show.
pub fn unshown(state: &State, rates: Vector) -> Vector {
    by_axes(rates).map(|by| by.iter().map(|(k, share)| share * state.x[*k]).sum())
}

/// By how much more a gyro is taken to be askew, or of another scale, than it can be: rad, and a share.
pub fn unbelievable(state: &State) -> f64 {
    let most = FAR * state.askew2.sqrt();
    let more = |i: usize| (state.x[i].abs() - most).max(0.0) * if i < SCALE { 1.0 } else { SCALE_SHARE };
    STATES.map(more).map(|m| m * m).sum::<f64>().sqrt()
}

/// Rows and columns of the turn, in `dt_s` at a gyro's `rates`.
pub fn move_rows(state: &mut State, dt_s: f64, rates: Vector) {
    let (n, by) = (state.size(), by_axes(rates.map(|c| dt_s * c)));
    let p = &mut state.p;
    for (i, by) in by.iter().enumerate() {
        for (k, share) in by {
            let row = p[*k];
            p[TURN + i][..n].iter_mut().zip(&row[..n]).for_each(|(v, k)| *v += share * k);
        }
    }
    for row in &mut p[..n] {
        for (i, by) in by.iter().enumerate() {
            row[TURN + i] += by.iter().map(|(k, share)| share * row[*k]).sum::<f64>();
        }
    }
}

/// The process noise of `dt_s`.
pub fn walk(state: &mut State, walk: f64, dt_s: f64) {
    let variance = walk * walk * dt_s;
    STATES.for_each(|i| state.add_variance(i, variance));
    state.askew2 += variance;
}

impl FieldEstimator {
    /// The first gyro is expected to be mounted well: the more so where scenes cannot be told from turns. What was learnt of
    /// it stays while it is away.
    pub(super) fn set_askew(&mut self) {
        let share = if self.model.shows_scenes() { 1.0 } else { BLIND_SHARE };
        let s = &mut self.state;
        if self.gyro.in_use() && s.askew2 <= 0.0 {
            s.askew2 = (share * self.tuning.askew.0).powi(2);
            STATES.for_each(|i| s.set_variance(i, s.askew2));
        }
    }

    /// The axes on which its rates are taken have been turned by minus `turned`, rad: what is known of them turns with them.
    pub(super) fn turn_axes(&mut self, turned: Vector) {
        if self.state.askew2 > 0.0 {
            self.state.x[ASKEW..ASKEW + 3].iter_mut().zip(turned).for_each(|(x, t)| *x += t);
        }
    }

    /// Expects a gyro's axes to be far askew once that shows; never with sensors to which a scene looks the same.
    pub(super) fn doubt_axes(&mut self, dt_s: f64) {
        let large = self.tuning.askew.1.powi(2);
        let expected = (self.state.askew2, large);
        let tells = self.gyro.in_use() && self.model.shows_scenes();
        let then = tells.then(|| IfExpected::of(&self.state, STATES, &[], expected)).flatten();
        self.askew_s = if then.is_some_and(|then| then.likelier > SURE) { self.askew_s + dt_s } else { 0.0 };
        if self.askew_s > LASTS_S {
            self.askew_s = 0.0;
            let mut beside = self.state.clone();
            expect(&mut beside, STATES, &[], expected);
            STATES.for_each(|i| self.state.add_variance(i, large));
            // What the axes did may have been taken for a bias.
            (RATE..RATE + 3).for_each(|i| self.state.add_variance(i, self.tuning.bias.0.powi(2)));
            self.state.askew2 = large;
            // And readings that fitted no sky, for errors of the sensors.
            if self.errors_likelier(&beside) < OFF {
                self.acquit_sensors();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{FieldEstimator, Tuning};
    use super::*;
    use crate::estimator::Estimator;
    use crate::estimator::vector::{add_scaled, length, product, rotation};
    use crate::frame::Frame;
    use crate::simulation::Scenario;
    use crate::source::FrameSource;
    use crate::time::Time;

    /// A vector that is turned a little and shown on turned axes is the vector.
    #[test]
    fn what_is_added_turns_the_rates_back() {
        let (turn, scale) = ([0.002, -0.003, 0.001], [0.004, 0.0, -0.002]);
        let mut state = State::new(6);
        for i in 0..3 {
            state.x[ASKEW + i] = turn[i];
            state.x[SCALE + i] = scale[i] / SCALE_SHARE;
        }
        let truly = [1.0, -0.4, 0.7];
        let shown = product(&rotation(turn.map(|c| -c)), std::array::from_fn(|i| truly[i] * (1.0 - scale[i])));
        let found = add_scaled(shown, 1.0, unshown(&state, shown));
        assert!(length(add_scaled(found, -1.0, truly)) < 3e-5, "{found:?}");
    }

    #[test]
    fn a_gyro_that_cannot_be_is_doubted_by_what_is_too_much() {
        let mut state = State::new(6);
        state.askew2 = 0.05_f64.powi(2);
        (state.x[ASKEW], state.x[SCALE + 2]) = (0.14, -0.15);
        assert_eq!(unbelievable(&state), 0.0, "usual");
        // A scale that is off by 17 %, of which 3 % may be.
        state.x[SCALE] = 0.85;
        assert!((unbelievable(&state) - 0.14).abs() < 1e-9);
        state.x[ASKEW + 1] = -0.25;
        assert!((unbelievable(&state) - 0.14_f64.hypot(0.1)).abs() < 1e-9);
    }

    /// Rows and columns as by the whole matrix: the turn gains `dt` times what is not shown.
    #[test]
    fn the_turn_errs_by_what_is_not_shown() {
        let (rates, dt_s) = ([0.5, -1.0, 2.0], 0.1);
        let mut state = State::new(6);
        for (k, i) in STATES.enumerate() {
            state.set_variance(i, 0.01 * (k + 1) as f64);
        }
        let before = state.clone();
        move_rows(&mut state, dt_s, rates);
        let share = |i: usize, k: usize| {
            let mut unit = State::new(6);
            unit.x[k] = dt_s;
            unshown(&unit, rates)[i]
        };
        for i in 0..3 {
            for k in STATES {
                let expected = share(i, k) * before.p[k][k];
                assert!(
                    (state.p[TURN + i][k] - expected).abs() < 1e-12 && (state.p[k][TURN + i] - expected).abs() < 1e-12
                );
            }
            for j in 0..3 {
                let expected: f64 = STATES.map(|k| share(i, k) * share(j, k) * before.p[k][k]).sum();
                assert!((state.p[TURN + i][TURN + j] - expected).abs() < 1e-12);
            }
        }
    }

    /// Two minutes with a gyro that is turned so about its axes, rad.
    fn flown(scene: &str, turn: Vector) -> FieldEstimator {
        let scenario = Scenario::named(scene).unwrap().lasting(120.0);
        let (mut source, head) = (scenario.source(21), scenario.head());
        let mut e = FieldEstimator::new(&head, scenario.field(), Tuning::default());
        let mut frame = Frame::new(head.sensors.len());
        for i in 0..120 * 50 {
            source.scan(Time::from_secs_f64(100.0 + f64::from(i) * 0.02), &mut frame);
            let [p, q, r] = frame.aiding.gyro_deg_s.map(Option::unwrap);
            let [p, q, r] = product(&rotation(turn), [p, -q, -r]);
            frame.aiding.gyro_deg_s = [Some(p), Some(-q), Some(-r)];
            e.update(&frame);
        }
        e
    }

    #[test]
    fn a_gyro_that_is_mounted_askew_is_found_out() {
        let turn = [3.0, -4.0, 2.0].map(f64::to_radians);
        for scene in ["clear-dry", "overcast", "scattered"] {
            let e = flown(scene, turn);
            for (i, turned) in turn.iter().enumerate() {
                let off = (e.state.x[ASKEW + i] + turned).to_degrees();
                assert!(off.abs() < 0.8, "{scene}, about {i}: {off}° off");
            }
        }
    }

    #[test]
    fn one_that_is_mounted_well_is_not() {
        for scene in ["clear-dry", "overcast", "scattered", "warm-slope"] {
            let e = flown(scene, [0.0; 3]);
            assert!(e.state.askew2 < 1e-4, "{scene}");
        }
    }
}
