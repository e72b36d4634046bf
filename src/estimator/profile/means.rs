//! What the means of opposed sensors tell: a pair shows the attitude by what its sensors differ by, and by their mean whether
//! one of them is off.

use super::shape::ShapeLearner;
use super::solve::Solved;
use crate::estimator::vector::dot;
use crate::frame::Frame;
use crate::head::Head;
use crate::sky::PairCurve;

/// A pair's mean is off by half of what one of its sensors is, and the attitude that goes along with that sensor explains up to
/// half of that.
const SHOWN: f64 = 0.25;
/// What means part by all the same: by the sensors' own tolerance, K (MLX90614, features: ±0.5 °C each), and where they look at
/// different elevations by a field of view and an averaging that are not as they are taken, as a share of the contrast.
const TOLERANCE_K: f64 = 0.5;
const TOLERANCE: f64 = 0.2;

/// Intervals of the table.
const INTERVALS: usize = 64;

/// What the means of a head's pairs tell.
#[derive(Clone, Debug)]
pub struct Means {
    /// Over the sine of a pair's elevation: by how much its mean lies below the ground, over the contrast, by one curve, and how
    /// much more by the other.
    below: Vec<[f64; 2]>,
    /// The ground as each pair tells it, K or °C; how that goes with the shape, and with what else is not as it is taken.
    grounds: Vec<[f64; 3]>,
}

impl Means {
    /// For so many pairs, under a sky with a shape between those of two curves.
    pub fn new(pairs: usize, [one, other]: &[PairCurve; 2]) -> Self {
        let below = |i: usize| {
            let [one, other] = [one, other].map(|curve| curve.mean(i as f64 / INTERVALS as f64));
            [one, other - one]
        };
        Self { below: (0..=INTERVALS).map(below).collect(), grounds: Vec::with_capacity(pairs) }
    }

    /// What one sensor of `head` may be off by in `frame`, K: by how much more the means of two pairs part than what was
    /// `solved`, with ground and sky as `sign` tells and a shape that is known so well, explains. 0 for a head that shows
    /// differences alone.
    pub fn off_k(&mut self, head: &Head, frame: &Frame, (solved, sign): (&Solved, f64), shape: &ShapeLearner) -> f64 {
        let contrast_k = sign * solved.contrast_k;
        self.grounds.clear();
        self.grounds.extend(head.pairs.iter().enumerate().filter_map(|(i, pair)| {
            let mean_k = head.mean_k(i, frame)?;
            let sine = dot(pair.direction.components(), solved.vertical);
            let place = sine.abs().min(1.0) * INTERVALS as f64;
            let cell = (place as usize).min(INTERVALS - 1);
            let [one, more] = [0, 1].map(|k| {
                let [low, high] = [self.below[cell][k], self.below[cell + 1][k]];
                low + (place - cell as f64) * (high - low)
            });
            let below = [one + shape.share() * more, more * shape.sigma(), sine * sine * TOLERANCE];
            let [ground, by_shape, by_view] = below.map(|b| contrast_k * b);
            Some([mean_k + ground, by_shape, by_view])
        }));
        let beyond = |one: &[f64; 3], other: &[f64; 3]| {
            let [parts_k, by_shape_k, by_view_k] = [0, 1, 2].map(|k| one[k] - other[k]);
            let known_k2 = TOLERANCE_K * TOLERANCE_K + by_shape_k * by_shape_k + by_view_k * by_view_k;
            (parts_k.abs() - known_k2.sqrt()) / SHOWN
        };
        let pairs = self.grounds.iter().enumerate();
        let beyond = pairs.flat_map(|(i, one)| self.grounds[i + 1..].iter().map(move |other| beyond(one, other)));
        beyond.fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::attitude::Attitude;
    use crate::direction::Direction;
    use crate::estimator::Estimator;
    use crate::estimator::profile::ProfileEstimator;
    use crate::estimator::profile::shape::POSSIBLE;
    use crate::estimator::profile::solve::Solver;
    use crate::frame::{Sample, Value};
    use crate::sky::{Averaging, FieldOfView, Response, Sky};
    use crate::time::Time;

    const SKY: Sky = Sky::NAMIBIA;
    const VIEW: FieldOfView = FieldOfView::Gaussian { fwhm_deg: 90.0 };

    fn response() -> Response {
        Response::new(SKY.shape, VIEW, Averaging::Temperature)
    }

    /// What six sensors show at an attitude, one of them more than it should.
    fn frame(response: &Response, attitude: Attitude, (who, more_k): (usize, f64)) -> Frame {
        let mut frame = Frame::new(6);
        for (i, (reading, (_, direction))) in frame.readings.iter_mut().zip(Direction::NAMED).enumerate() {
            let sine = dot(direction.components(), attitude.vertical());
            let more_k = if i == who { more_k } else { 0.0 };
            let object_c = response.sensor_c(sine, SKY.ground_c, SKY.sky_max_k) + more_k;
            let value = Value::Absolute { object_c, ambient_c: None };
            *reading = Ok(Sample { value, time: Time::from_secs_f64(100.0) });
        }
        frame
    }

    #[test]
    fn in_the_model_s_own_sky_nothing_is_off_and_a_sensor_that_is_shows() {
        let (head, response) = (Head::six(), response());
        let curve = response.pair_curve(SKY.ground_c, SKY.sky_max_k);
        let directions: Vec<_> = head.pairs.iter().map(|p| p.direction).collect();
        let solver = Solver::new(&directions, curve.clone()).unwrap();
        let mut means = Means::new(3, &[curve.clone(), curve]);
        let mut off = |attitude, who| {
            let frame = frame(&response, attitude, who);
            let signals: Vec<_> = (0..3).map(|i| head.signal_k(i, &frame).ok()).collect();
            means.off_k(&head, &frame, (&solver.solve(&signals).unwrap(), 1.0), &ShapeLearner::new(POSSIBLE))
        };
        for (roll, pitch) in (-12..=12).flat_map(|roll| (-6..=6).map(move |pitch| (roll, pitch))) {
            let attitude = Attitude::from_degrees(15.0 * f64::from(roll), 15.0 * f64::from(pitch));
            assert_eq!(off(attitude, (0, 0.0)), 0.0, "{attitude:?}");
        }
        for (who, more_k) in (0..4).flat_map(|who| [-8.0, 8.0].map(|k| (who, k))) {
            let seen_k = off(Attitude::default(), (who, more_k));
            assert!((8.0..20.0).contains(&seen_k), "{who} {more_k}: {seen_k}");
        }
    }

    #[test]
    fn sigma_holds_a_level_sensor_that_is_off() {
        for (who, more_k) in (0..4).flat_map(|who| [-12.0, -8.0, 8.0, 12.0].map(|k| (who, k))) {
            let mut method = ProfileEstimator::in_flight(Head::six(), VIEW, 0.1, 3.0);
            let given = method.update(&frame(&response(), Attitude::default(), (who, more_k)));
            let (attitude, sigma) = (given.attitude.unwrap(), given.sigma);
            let off = [attitude.roll.abs() / sigma.roll, attitude.pitch.abs() / sigma.pitch];
            assert!(off.iter().all(|off| *off < 2.0), "{who} {more_k}: {off:?}");
        }
    }
}
