//! The method `field` on frames as they should not come: values that are no numbers, stamps out of order,
//! gaps, and a sensor that shows the same for ever.

mod field;
mod model_sky;

use field::field;
use irhorizon::attitude::Attitude;
use irhorizon::estimator::{Estimator, FieldEstimator, Solution};
use irhorizon::frame::{Aiding, Frame, Value};
use irhorizon::head::Head;
use irhorizon::simulation::Flight;
use irhorizon::time::Time;
use model_sky::{CLEAR, TICK_NS, fly, off_deg};
use proptest::prelude::*;
use std::sync::LazyLock;

const LAG_S: f64 = 0.1;
/// Forty seconds of the demonstration flight.
static FLIGHT: LazyLock<Vec<(Frame, Attitude)>> = LazyLock::new(|| fly(Flight::demo(3), 40));

fn fresh() -> FieldEstimator {
    field(&Head::six(), LAG_S)
}

/// Every number in it is one, and an attitude is not said to be certain.
fn is_sound(said: &Solution) -> bool {
    let Solution { attitude, sigma, contrast_k, .. } = said;
    let sigmas = [sigma.roll, sigma.pitch];
    attitude.is_none_or(|a| a.roll.is_finite() && a.pitch.is_finite() && sigmas.iter().all(|s| *s > 0.0))
        && sigmas.iter().all(|s| s.is_finite())
        && contrast_k.is_none_or(f64::is_finite)
}

fn sound(said: &Solution) {
    assert!(is_sound(said), "{said:?}");
}

/// `frame` with every stamp made another by `stamp`.
fn stamped(frame: &Frame, stamp: impl Fn(u64) -> u64) -> Frame {
    let mut frame = frame.clone();
    let change = |t: Time| Time::from_nanos(stamp(t.as_nanos()));
    frame.time = change(frame.time);
    for sample in frame.readings.iter_mut().flatten() {
        sample.time = change(sample.time);
    }
    frame
}

fn set(frame: &mut Frame, sensor: usize, to_c: f64) {
    if let Ok(sample) = &mut frame.readings[sensor] {
        sample.value = Value::Absolute { object_c: to_c, ambient_c: None };
    }
}

/// Puts `value` in place of one of the fourteen that a frame holds: the aiding's eight, then the sensors' six.
fn spoil(frame: &mut Frame, which: usize, value: f64) {
    if let Some(sensor) = which.checked_sub(8) {
        return set(frame, sensor, value);
    }
    let Aiding { gyro_deg_s, airspeed_m_s, ground_speed_m_s, course_deg, climb_m_s, altitude_m } = &mut frame.aiding;
    let [p, q, r] = gyro_deg_s;
    *[p, q, r, airspeed_m_s, ground_speed_m_s, course_deg, climb_m_s, altitude_m][which] = Some(value);
}

/// Puts `value` in place of value `which` for half a second, twelve seconds of rest around it; gives what went
/// wrong, then or nine seconds later.
fn spoilt(which: usize, value: f64) -> Vec<String> {
    let truth = Attitude::from_degrees(12.0, -4.0);
    let (mut estimator, mut last, mut wrong) = (fresh(), Solution::default(), Vec::new());
    for i in 0..600 {
        let mut frame = CLEAR.frame(&Head::six(), truth, i * TICK_NS);
        frame.aiding = Aiding {
            gyro_deg_s: [Some(0.0); 3],
            airspeed_m_s: Some(18.0),
            ground_speed_m_s: Some(18.0),
            course_deg: Some(90.0),
            climb_m_s: Some(-1.2),
            altitude_m: Some(100.0),
        };
        if (100..125).contains(&i) {
            spoil(&mut frame, which, value);
        }
        last = estimator.update(&frame);
        if wrong.is_empty() && !is_sound(&last) {
            wrong.push(format!("value {which} as {value:e}: frame {i}, {last:?}"));
        }
    }
    let off = off_deg(&last, truth);
    if !off.lt(&3.0) {
        wrong.push(format!("value {which} as {value:e}: {off:.1}° off nine seconds later"));
    }
    wrong
}

#[test]
fn what_is_no_number_goes_nowhere() {
    let values = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, -f64::MAX];
    let wrong: Vec<String> = values.iter().flat_map(|v| (0..14).flat_map(|which| spoilt(which, *v))).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// A sensor that shows nonsense which a sensor can show, while a gyro says that nothing moved.
#[test]
fn half_a_second_of_nonsense_is_forgotten() {
    let values = [-40.0, 0.0, 60.0];
    let wrong: Vec<String> = values.iter().flat_map(|v| (8..14).flat_map(|which| spoilt(which, *v))).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// No sky is a thousand kelvin colder than the ground: what was made of half a second of anything that a broken bus can give
/// is given up.
#[test]
fn a_contrast_of_no_world_is_given_up() {
    let truth = Attitude::from_degrees(12.0, -4.0);
    let mut anything = 1_u32;
    for beginning in 0..40 {
        let (mut estimator, mut last) = (fresh(), Solution::default());
        for i in 0..300 {
            let mut frame = CLEAR.frame(&Head::six(), truth, i * TICK_NS);
            for sensor in 0..if i < 25 { 6 } else { 0 } {
                anything = anything.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                set(&mut frame, sensor, -273.15 + 1273.15 * f64::from(anything >> 8) / f64::from(1 << 24));
            }
            last = estimator.update(&frame);
            sound(&last);
            assert!(last.contrast_k.is_none_or(|k| k.abs() <= 200.0), "{beginning}, {i}: {last:?}");
        }
        assert!(off_deg(&last, truth) < 3.0, "{beginning}: {last:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Frames that come twice, and old ones that come again, say nothing new and change nothing.
    #[test]
    fn what_was_seen_before_changes_nothing(again in proptest::collection::vec((100..900_usize, 0..60_usize), 1..40)) {
        let (mut plain, mut disturbed) = (fresh(), fresh());
        for (i, (frame, _)) in FLIGHT.iter().take(1000).enumerate() {
            let said = plain.update(frame);
            prop_assert_eq!(disturbed.update(frame), said);
            for (_, back) in again.iter().filter(|(at, _)| *at == i) {
                prop_assert_eq!(disturbed.update(&FLIGHT[i - back].0).attitude, None);
            }
        }
    }

    /// A sensor's samples that are up to two frames late are used or not, and do no harm.
    #[test]
    fn late_samples_do_no_harm(late_ns in 0..2 * TICK_NS, sensor in 0..6_usize, every in 2..7_usize) {
        let mut estimator = fresh();
        for (i, (frame, truth)) in FLIGHT.iter().enumerate() {
            let mut frame = frame.clone();
            if i.is_multiple_of(every) && let Ok(sample) = &mut frame.readings[sensor] {
                sample.time = Time::from_nanos(sample.time.as_nanos().saturating_sub(late_ns));
            }
            let said = estimator.update(&frame);
            sound(&said);
            let off = off_deg(&said, *truth);
            prop_assert!(i < 250 || off < 3.0, "frame {i}: {off}° off");
        }
    }
}

/// After an hour without a frame the sky, the ground and the attitude are others: all is begun anew.
#[test]
fn an_hour_without_a_frame() {
    let (before, after) = (Attitude::from_degrees(-30.0, 5.0), Attitude::from_degrees(40.0, -10.0));
    let mut estimator = fresh();
    CLEAR.rest(&mut estimator, &Head::six(), before, 0, 10);
    let other = model_sky::ModelSky { shape: 5, contrast_k: 18.0 };
    let hour_ns = 3_600_000_000_000;
    let first = estimator.update(&other.frame(&Head::six(), after, hour_ns));
    let settled = other.rest(&mut estimator, &Head::six(), after, hour_ns + TICK_NS, 2);
    let off = [first, settled].map(|s| off_deg(&s, after));
    println!("{:.2}° off at once, {:.2}° off two seconds later", off[0], off[1]);
    assert!(off[0] < 5.0 && off[1] < 1.0, "{off:?}");
}

/// Frames a nanosecond apart bring no more news than one.
#[test]
fn frames_a_nanosecond_apart() {
    let mut estimator = fresh();
    for (i, (frame, truth)) in FLIGHT.iter().enumerate() {
        for by_ns in 0..3 {
            let said = estimator.update(&stamped(frame, |ns| ns + by_ns));
            sound(&said);
            let off = off_deg(&said, *truth);
            assert!(i < 250 || off < 3.0, "frame {i}: {off}° off");
        }
    }
}

/// Stamps on an irregular clock: between 1 and 400 ms apart, at rest.
#[test]
fn an_irregular_clock() {
    let truth = Attitude::from_degrees(-25.0, 7.0);
    let mut estimator = fresh();
    let mut ns = 0;
    let mut last = Solution::default();
    for i in 0..600_u64 {
        ns += 1_000_000 + (i * i * 7_919) % 399_000_000;
        last = estimator.update(&CLEAR.frame(&Head::six(), truth, ns));
        sound(&last);
    }
    let off = off_deg(&last, truth);
    // Between frames far apart there is doubt, and an angle in doubt is shown larger on purpose.
    let doubt = last.sigma.roll.max(last.sigma.pitch).to_degrees();
    assert!(off < 0.3 + 0.5 * doubt, "{off}° off, σ {doubt}°");
}

/// A sensor that shows the same from the tenth second on. By itself the filter trusts all six: what it
/// says is then wrong by no more than the sensor pulls it, and its standard deviation stays finite.
#[test]
fn a_stuck_sensor_pulls_no_further_than_it_is_strong() {
    let mut worst = 0.0;
    for sensor in 0..6 {
        let mut estimator = fresh();
        let (mut most, mut stuck_c) = (0.0, f64::NAN);
        for (i, (frame, truth)) in FLIGHT.iter().enumerate() {
            let mut frame = frame.clone();
            if i < 500 {
                if let Ok(sample) = frame.readings[sensor]
                    && let Value::Absolute { object_c, .. } = sample.value
                {
                    stuck_c = object_c;
                }
            } else {
                set(&mut frame, sensor, stuck_c);
            }
            let said = estimator.update(&frame);
            sound(&said);
            let off = off_deg(&said, *truth);
            if !off.le(&most) {
                most = off;
            }
        }
        println!("sensor {sensor} stuck at {stuck_c:.1} °C: up to {most:.1}° off");
        worst = f64::max(worst, most);
    }
    assert!(worst < 40.0, "{worst}° off");
}
