//! What each sensor shows too much, or too little: wherever it looks, and as a share of what is colder than the ground.
//!
//! Half a kelvin is what a datasheet allows, and more far from the die's temperature; as a tilt it is half a degree or more.
//! It turns with the body and stays, as no scene does; from an attitude only a gyro tells it. Most heads show none, and a
//! filter that expects any waits for it to be ruled out: so little is expected until much is far likelier, for long.

use super::FieldEstimator;
use super::expected::{IfExpected, expect};
use super::moved::Moved;
use super::state::State;

/// How many times more likely, as a logarithm, large errors must be; for so long, s.
const SURE: f64 = 35.0;
const LASTS_S: f64 = 20.0;
/// And so many times what they are unlikely by themselves: large errors explain some of what no sky of the family shows, the
/// longer it is seen the more, but those that do are ever larger.
const TIMES: f64 = 4.0;
/// Nothing tells of them but in a minute in which it looked around as far, rad: more than a gyro's bias makes of it.
const ALL_AROUND: f64 = 2.5;
/// How surely the readings have fitted no even sky for long: what a gyro does wrong leaves them alike all around.
const UNLIKE: f64 = 0.5;

impl FieldEstimator {
    /// Expects the sensors to be off once that shows.
    pub(super) fn calibrate(&mut self, dt_s: f64) {
        // Straight on a warm side looks the same.
        let around = self.around.lately() > ALL_AROUND;
        self.state.tell(self.state.errors(), around || !self.around.is_known());
        let shows = around
            && self.gyro.in_use()
            && self.scene.long_unlike() > UNLIKE
            && self.if_large(&self.state).is_some_and(|then| then.likelier > SURE.max(TIMES * then.unlikely));
        self.off_s = if shows { self.off_s + dt_s } else { 0.0 };
        if self.off_s > LASTS_S {
            self.off_s = 0.0;
            let (states, was, large) = (self.state.errors(), self.state.error2, self.large());
            expect(&mut self.state, states, &[], (was, large));
            self.state.error2 = large;
            // What moves the sky's shape then is no wall.
            self.moved = Moved::default();
        }
    }

    /// The variance of large errors, K².
    fn large(&self) -> f64 {
        self.tuning.error.1.powi(2)
    }

    /// What is known of the errors by `state` were large ones expected; none where they are.
    fn if_large(&self, state: &State) -> Option<IfExpected> {
        IfExpected::of(state, state.errors(), &[], (state.error2, self.large()))
    }

    /// How many times more likely, as a logarithm, large errors are by `state`; none where they are expected.
    pub(super) fn errors_likelier(&self, state: &State) -> f64 {
        self.if_large(state).map_or(0.0, |then| then.likelier)
    }

    /// What readings have said of the sensors tells of them no more: something else had said it.
    pub(super) fn acquit_sensors(&mut self) {
        self.state.errors().for_each(|i| self.state.x[i] = 0.0);
        self.expect_least();
        self.off_s = 0.0;
    }

    fn expect_least(&mut self) {
        let (least, s) = (self.tuning.error.0.powi(2), &mut self.state);
        s.error2 = least;
        s.errors().for_each(|i| s.set_variance(i, least));
    }

    /// With the first gyro little is expected; what was learnt by the last one stays.
    pub(super) fn set_errors(&mut self) {
        if self.gyro.in_use() && self.state.error2 <= 0.0 {
            self.expect_least();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::after;
    use super::*;
    use crate::frame::{Sample, Value};
    use crate::simulation::scenario::Scenario;

    /// Some minutes with sensors that show so much too much, K.
    fn flown((scene, minutes): (&str, u32), errors_k: [f64; 6], gyro: bool) -> FieldEstimator {
        let scenario = Scenario::named(scene).unwrap().lasting(60.0 * f64::from(minutes));
        after(&scenario, 23, minutes * 60 * 50, |frame| {
            for (reading, error_k) in frame.readings.iter_mut().zip(errors_k) {
                if let Ok(Sample { value: Value::Absolute { object_c, .. }, .. }) = reading {
                    *object_c += error_k;
                }
            }
            if !gyro {
                frame.aiding.gyro_deg_s = [None; 3];
            }
        })
    }

    const CLEAR: (&str, u32) = ("clear-dry", 5);

    #[test]
    fn sensors_that_are_off_are_found_out_in_flight() {
        let errors_k = [0.4, -0.3, 0.2, -0.4, 0.3, -0.1];
        let e = flown(CLEAR, errors_k, true);
        assert!(e.state.error2 > 0.01, "nothing shows");
        // What all have in common is the ground's temperature, what the upper one alone has is the contrast: neither
        // tilts anything.
        for pair in [0, 2] {
            let found = e.state.x[e.state.errors().start + pair] - e.state.x[e.state.errors().start + pair + 1];
            let off = found - (errors_k[pair] - errors_k[pair + 1]);
            assert!(off.abs() < 0.15, "pair {pair}: {found}");
        }
    }

    #[test]
    fn where_all_are_right_nothing_is_found() {
        let e = flown(CLEAR, [0.0; 6], true);
        assert!(e.state.error2 < 0.01);
        assert!(e.state.errors().all(|i| e.state.x[i].abs() < 0.01));
    }

    #[test]
    fn fields_and_woods_are_not_taken_for_errors() {
        let e = flown(("patchwork", 10), [0.0; 6], true);
        assert!(e.state.error2 < 0.01);
    }

    #[test]
    fn without_a_gyro_nothing_tells() {
        let e = flown(CLEAR, [0.4, -0.3, 0.2, -0.4, 0.3, -0.1], false);
        assert_eq!(e.state.error2, 0.0);
        assert!(e.state.errors().all(|i| e.state.x[i] == 0.0 && e.state.p[i][i] == 0.0));
    }
}
