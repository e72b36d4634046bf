//! All detectors on whatever may come: nothing panics, and what is told can be told.

use super::super::kit::alike;
use super::*;
use crate::config::Settings;
use crate::direction::Direction;
use crate::estimator::{Hearing, Otherwise, Standing};
use crate::frame::{Aiding, Reading, Sample, Value};
use crate::head::SensorKind;
use crate::time::Time;
use proptest::collection::vec;
use proptest::option::of;
use proptest::prelude::*;

fn number() -> impl Strategy<Value = f64> {
    let odd = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, f64::MIN, f64::MIN_POSITIVE, 0.0, -0.0, 1e-300];
    prop_oneof![4 => -50.0..50.0_f64, 1 => proptest::sample::select(odd.to_vec()), 1 => any::<f64>()]
}

fn time() -> impl Strategy<Value = Time> {
    prop_oneof![8 => 0_u64..60_000_000_000, 1 => any::<u64>()].prop_map(Time::from_nanos)
}

fn reading() -> impl Strategy<Value = Reading> {
    let absolute = (number(), of(number())).prop_map(|(object_c, ambient_c)| Value::Absolute { object_c, ambient_c });
    let value = prop_oneof![4 => absolute, 1 => number().prop_map(Value::Volts)];
    let sample = (value, time()).prop_map(|(value, time)| Ok(Sample { value, time }));
    prop_oneof![6 => sample, 1 => Just(Err(Missing::NoAnswer)), 1 => Just(Err(Missing::Saturated))]
}

fn aiding() -> impl Strategy<Value = Aiding> {
    (of(number()), of(number()), of(number()), of(number())).prop_map(|(airspeed, ground_speed, course, climb)| {
        Aiding {
            airspeed_m_s: airspeed,
            ground_speed_m_s: ground_speed,
            course_deg: course,
            climb_m_s: climb,
            ..Aiding::default()
        }
    })
}

fn solution() -> impl Strategy<Value = Solution> {
    let standing =
        proptest::sample::select(vec![Standing::Heard, Standing::Doubted, Standing::LeftOut, Standing::Stuck]);
    let hearing = (standing, of(number()), of(number()), of(number()))
        .prop_map(|(standing, expected_k, residual_k, lost)| Hearing { standing, expected_k, residual_k, lost });
    let angles = || (number(), number()).prop_map(|(roll, pitch)| Attitude { roll, pitch });
    let seen = of(proptest::array::uniform3(number()));
    let wired = (angles(), any::<[bool; 2]>(), number()).prop_map(|(attitude, angles, left)| Otherwise {
        attitude,
        angles,
        left,
    });
    (of(angles()), angles(), of(number()), seen, proptest::array::uniform8(hearing), of(number()), of(wired)).prop_map(
        |(attitude, sigma, contrast_k, seen_k, sensors, hidden, wired)| Solution {
            attitude,
            sigma,
            contrast_k,
            seen_k,
            sensors,
            hidden,
            hint: None,
            wired,
        },
    )
}

/// Heads of none to sixteen sensors, pairs' channels and mixed ones among them.
fn head() -> impl Strategy<Value = Head> {
    let volts = SensorKind::Pair { neutral_v: 1.6, kelvin_per_v: -40.0 };
    let mixed = move |count: usize| {
        let mut sensors = alike(count, SensorKind::ABSOLUTE).sensors;
        for (i, sensor) in sensors.iter_mut().enumerate() {
            (sensor.direction, sensor.bus) = (Direction::NAMED[i % 6].1, Some(i % 2));
            if i % 3 == 2 {
                sensor.kind = volts;
            }
        }
        Head::new(sensors, vec!["/dev/i2c-1".into(), "/dev/i2c-2".into()])
    };
    let of_kind = move |count| {
        prop_oneof![Just(alike(count, SensorKind::ABSOLUTE)), Just(alike(count, volts)), Just(mixed(count))]
    };
    prop_oneof![2 => Just(Head::six()), 1 => (0..=16_usize).prop_flat_map(of_kind)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]
    #[test]
    fn whatever_comes_nothing_panics(
        head in head(),
        steps in vec((time(), vec(reading(), 0..17), aiding(), solution(), any::<bool>()), 0..40),
    ) {
        let mut detectors = Detectors::new(&Settings::default().faults, &head);
        for (time, readings, aiding, solution, down) in steps {
            let frame = Frame { time, readings, aiding };
            let buses = [down.then_some(Missing::BusHeld), None, Some(Missing::BusGone)];
            detectors.hear(&frame);
            let trusted = detectors.update(&frame, &solution, &buses[..usize::from(down) * 3]);
            let doubt = detectors.compare(solution.attitude.filter(|_| trusted).map(|a| (a, solution.sigma)), false, &frame);
            prop_assert!(!(doubt.roll < 0.0 || doubt.pitch < 0.0));
            let mut faults = Vec::new();
            detectors.report(&mut faults);
            for fault in &faults {
                prop_assert!(!fault.kind.display(&head).to_string().contains('?'), "{fault:?}");
                prop_assert!(!fault.evidence.to_string().is_empty());
                detectors.withholds(fault.kind);
                detectors.name_all_missing(&frame);
            }
            let low = |f: &ActiveFault| matches!(f.kind, FaultKind::LowContrast | FaultKind::InvertedContrast);
            prop_assert!(!trusted || !faults.iter().any(low), "{faults:?}");
            for i in [0, 7, 8, 16, usize::MAX] {
                detectors.is_stuck(i);
            }
        }
    }
}

/// What was hidden before the contrast went says nothing of after, neither that something is nor that nothing is.
#[test]
fn a_wall_seen_for_a_moment_before_the_fog_is_not_told_at_the_first_sight_after_it() {
    use super::super::kit::{at, frame, seen};
    let mut detectors = Detectors::new(&Settings::default().faults, &Head::six());
    let mut time_s = 10.0;
    let mut fly = |detectors: &mut Detectors, seconds: f64, contrast_k: f64, hidden_deg: f64| {
        for _ in 0..(50.0 * seconds).round() as u32 {
            time_s += 0.02;
            let solution = Solution { hidden: Some(hidden_deg.to_radians()), ..seen(contrast_k) };
            let frame = frame(time_s, &[3.0; 6], None);
            detectors.hear(&frame);
            detectors.update(&frame, &solution, &[]);
        }
        let mut faults = Vec::new();
        detectors.report(&mut faults);
        faults.iter().find(|f| f.kind == FaultKind::Obstructed).map(|f| at(time_s).since(f.since))
    };
    assert_eq!(fly(&mut detectors, 5.0, 30.0, 0.0), None);
    assert_eq!(fly(&mut detectors, 0.1, 30.0, 20.0), None);
    assert_eq!(fly(&mut detectors, 60.0, 0.0, 20.0), None);
    assert_eq!(fly(&mut detectors, 1.2, 30.0, 20.0), None, "the contrast has just come back");
    assert!(fly(&mut detectors, 2.0, 30.0, 20.0).is_some_and(|s| s < 3.0));
    // And the other way round.
    assert!(fly(&mut detectors, 0.1, 30.0, 0.0).is_some());
    assert!(fly(&mut detectors, 60.0, 0.0, 0.0).is_some());
    assert!(fly(&mut detectors, 2.0, 30.0, 0.0).is_some());
    assert!(fly(&mut detectors, 3.0, 30.0, 0.0).is_none());
}
