//! What the means of opposed sensors tell: a pair shows the attitude by what its sensors differ by, and by their mean whether
//! one of them is off.

use super::solve::{Solved, Solver};
use crate::estimator::vector::dot;
use crate::frame::Frame;
use crate::head::Head;

/// A pair's mean is off by half of what one of its sensors is, and the attitude that goes along with that sensor explains up to
/// half of that.
const SHOWN: f64 = 0.25;
/// What means part by all the same: by the sensors' own tolerance, K (MLX90614, table 8: ±0.5 °C each), and where they look at
/// different elevations by a field of view and an averaging that are not as they are taken, as a share of the contrast.
const TOLERANCE_K: f64 = 0.5;
const TOLERANCE: f64 = 0.2;

/// What one sensor of `head` may be off by in `frame`, K: by how much more the means of two pairs part than what was `solved`,
/// with ground and sky as `sign` tells and a shape that is known to `sigma`, explains. 0 for a head that shows differences
/// alone.
pub fn off_k(head: &Head, frame: &Frame, solver: &Solver, (solved, sign): (&Solved, f64), sigma: f64) -> f64 {
    let contrast_k = sign * solved.contrast_k;
    // The ground, as the pair tells it, how that goes with the shape, and with what is else not as it is taken.
    let ground = |i: usize| {
        let sine = dot(head.pairs[i].direction.components(), solved.vertical);
        let [below, by_share] = solver.mean(sine);
        let ground_k = head.mean_k(i, frame)? + contrast_k * below;
        Some([ground_k, contrast_k * by_share * sigma, contrast_k * sine * sine * TOLERANCE])
    };
    let beyond = |one: [f64; 3], other: [f64; 3]| {
        let [parts_k, by_shape_k, by_view_k] = [0, 1, 2].map(|k| one[k] - other[k]);
        (parts_k.abs() - TOLERANCE_K.hypot(by_shape_k).hypot(by_view_k)) / SHOWN
    };
    let pairs = || (0..head.pairs.len()).filter_map(ground);
    pairs()
        .enumerate()
        .flat_map(|(i, one)| pairs().skip(i + 1).map(move |other| beyond(one, other)))
        .fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::attitude::Attitude;
    use crate::direction::Direction;
    use crate::estimator::Estimator;
    use crate::estimator::profile::ProfileEstimator;
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
        let directions: Vec<_> = head.pairs.iter().map(|p| p.direction).collect();
        let solver = Solver::new(&directions, response.pair_curve(SKY.ground_c, SKY.sky_max_k)).unwrap();
        let off = |attitude, who| {
            let frame = frame(&response, attitude, who);
            let signals: Vec<_> = (0..3).map(|i| head.signal_k(i, &frame).ok()).collect();
            off_k(&head, &frame, &solver, (&solver.solve(&signals).unwrap(), 1.0), 0.0)
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
