//! Reads that are missed: now and then, for a while, and always one or another.

use super::*;
use crate::config::settings::OnFault;

#[test]
fn one_missed_read_says_nothing_new_and_is_no_fault() {
    let mut f = Flight::new();
    let before = f.for_s(1.0, 10.0, 30.0, &[]).clone();
    assert_eq!(*f.fly(20.0, 30.0, &[(2, Missing::BadPec)]), before, "the old estimate with its old stamp");
    assert!(f.fly(20.0, 30.0, &[]).time > before.time);
}

#[test]
fn a_sensor_that_is_silent_for_a_tenth_of_a_second_is_lost_and_comes_back() {
    let mut f = Flight::new();
    f.for_s(1.0, 10.0, 30.0, &[]);
    let lost = f.for_s(0.2, 10.0, 30.0, &[(2, Missing::BadPec)]).clone();
    assert_eq!((lost.mode, lost.attitude), (Mode::Faulted, None));
    assert_eq!(f.kinds(), [FaultKind::SensorLost(2)]);
    assert!(lost.faults[0].evidence.to_string().starts_with("PEC mismatch"));
    let back = f.for_s(0.2, 10.0, 30.0, &[]);
    assert_eq!((back.mode, back.faults.len()), (Mode::Nominal, 0));
}

#[test]
fn silence_of_all_is_stale() {
    let mut f = Flight::new();
    f.for_s(1.0, 0.0, 30.0, &[]);
    let all: Vec<_> = (0..6).map(|i| (i, Missing::NoAnswer)).collect();
    f.for_s(0.7, 0.0, 30.0, &all);
    assert_eq!(f.kinds().len(), 7);
    assert_eq!(f.kinds()[6], FaultKind::Stale);
    assert_eq!(f.estimate.attitude, None);
}

#[test]
fn an_attitude_that_no_frame_renews_is_stale() {
    // Each has the whole head in no frame, and no sensor is silent for long.
    let missing = |i: usize| [(2 * (i % 2), Missing::BadPec)];
    for method in [Method::InverseSine, Method::Profile] {
        let mut f = Flight::by(method);
        f.for_s(1.0, 0.0, 30.0, &[]);
        let since = Time::from_secs_f64(f.now_s);
        let told: Vec<_> = (0..100).map(|i| (f.fly(40.0, 30.0, &missing(i)).mode, f.kinds())).collect();
        assert!(told[..25].iter().all(|t| *t == (Mode::Nominal, vec![])), "{method:?}: {told:?}");
        assert!(told[25..].iter().all(|t| *t == (Mode::Faulted, vec![FaultKind::Stale])), "{method:?}: {told:?}");
        assert_eq!((f.estimate.attitude, f.estimate.contrast_k), (None, None));
        assert_eq!(f.estimate.faults[0].since, since);
        assert_eq!(f.estimate.faults[0].evidence.to_string(), "2.00 s, limit 0.50 s");
        f.fly(40.0, 30.0, &[]);
        assert_eq!((f.estimate.mode, f.kinds()), (Mode::Nominal, vec![]), "{method:?}: at once, when one does");
    }
}

#[test]
fn an_attitude_that_never_came_is_stale_too() {
    let mut f = Flight::new();
    for i in 0..100 {
        f.fly(0.0, 30.0, &[(2 * (i % 2), Missing::BadPec)]);
    }
    assert_eq!((f.estimate.mode, f.kinds()), (Mode::Faulted, vec![FaultKind::Stale]));
}

#[test]
fn what_withholds_stays_named_through_a_missed_read() {
    let mut settings = by(Method::InverseSine);
    settings.faults.sigma_limit_deg = 2.0;
    settings.estimator.roll_limit_deg = Some(0.0);
    let mut f = Flight::with(&settings);
    f.for_s(1.0, 0.0, 30.0, &[]);
    f.for_s(1.0, 35.0, 30.0, &[]);
    assert_eq!((f.estimate.mode, f.kinds()), (Mode::Faulted, vec![FaultKind::Obstructed]));
    f.fly(35.0, 30.0, &[(2, Missing::BadPec)]);
    assert_eq!((f.estimate.mode, f.kinds()), (Mode::Faulted, vec![FaultKind::Obstructed]));
}

#[test]
fn missed_reads_end_no_disagreement() {
    for (method, period) in [(Method::InverseSine, 0), (Method::InverseSine, 150), (Method::Profile, 150)] {
        let mut f = Flight::by(method);
        let mut told = 0;
        for i in 0..1500 {
            // Shown level, in a turn with 25° of bank at 18 m/s.
            let turned = f64::from(i) * 0.02 * 25_f64.to_radians().tan() * 9.80665 / 18.0;
            f.aiding = Aiding::default();
            if i % 50 == 0 {
                f.aiding.ground_speed_m_s = Some(18.0);
                f.aiding.course_deg = Some(turned.to_degrees() % 360.0);
            }
            let missing = [(2, Missing::BadPec)];
            f.fly(0.0, 30.0, if period > 0 && i % period == 7 { &missing } else { &[] });
            told += i32::from(f.kinds().contains(&FaultKind::RollDisagrees));
        }
        assert!(told > 1200, "{method:?}, a miss in {period}: in {told} of 1500");
    }
}

#[test]
fn one_missed_read_is_no_fault_at_any_rate() {
    let mut f = Flight::new();
    f.fly(10.0, 30.0, &[]);
    f.now_s += 1.0;
    let mode = f.fly(10.0, 30.0, &[(2, Missing::BadPec)]).mode;
    assert_eq!((mode, f.kinds()), (Mode::Nominal, vec![]));
}

#[test]
fn a_sensor_that_answers_now_and_then_withholds_until_it_does_for_a_while() {
    for method in [Method::InverseSine, Method::Profile] {
        let mut f = Flight::by(method);
        f.for_s(1.0, 10.0, 30.0, &[]);
        f.for_s(0.2, 10.0, 30.0, &[(2, Missing::NoAnswer)]);
        for i in 0..500 {
            f.fly(10.0, 30.0, if i % 4 == 3 { &[(2, Missing::NoAnswer)] } else { &[] });
            assert_eq!((f.estimate.mode, f.estimate.attitude), (Mode::Faulted, None), "{method:?}, frame {i}");
            assert_eq!(f.kinds(), [FaultKind::SensorLost(2)]);
        }
        let e = f.for_s(0.2, 10.0, 30.0, &[]);
        assert_eq!((e.mode, e.faults.len()), (Mode::Nominal, 0), "{method:?}");
    }
}

/// Solves what lacks one sensor at most.
struct OneToSpare;

impl Estimator for OneToSpare {
    fn update(&mut self, frame: &Frame) -> crate::estimator::Solution {
        let solved = frame.readings.iter().filter(|r| r.is_err()).count() <= 1;
        crate::estimator::Solution {
            attitude: solved.then(Attitude::default),
            contrast_k: Some(30.0),
            seen_k: Some([0.0, 0.0, 30.0]),
            ..Default::default()
        }
    }
}

#[test]
fn a_read_missed_beside_a_sensor_that_can_be_spared_is_a_missed_read() {
    let mut f = Flight::new();
    f.horizon.estimator = Box::new(OneToSpare);
    let (one, two) = ([(2, Missing::NoAnswer)], [(2, Missing::NoAnswer), (4, Missing::BadPec)]);
    f.for_s(1.0, 0.0, 30.0, &one);
    for i in 0..201 {
        let before = f.estimate.time;
        let missed = i % 3 == 1;
        let e = f.fly(0.0, 30.0, if missed { &two } else { &one });
        assert_eq!((e.mode, e.attitude), (Mode::Degraded, Some(Attitude::default())), "frame {i}");
        assert_eq!(e.time > before, !missed, "frame {i}");
    }
    f.for_s(0.1, 0.0, 30.0, &two);
    assert_eq!((f.estimate.mode, f.estimate.attitude), (Mode::Degraded, Some(Attitude::default())));
    f.fly(0.0, 30.0, &two);
    assert_eq!((f.estimate.mode, f.estimate.attitude), (Mode::Faulted, None), "both are lost");
}

#[test]
fn what_withholds_is_named_until_an_attitude_is_given() {
    for on_fault in [OnFault::Withhold, OnFault::Hold, OnFault::Level] {
        let mut settings = by(Method::InverseSine);
        settings.faults.on_fault = on_fault;
        let mut f = Flight::with(&settings);
        f.for_s(1.0, 10.0, 30.0, &[]);
        f.for_s(0.2, 10.0, 30.0, &[(2, Missing::NoAnswer)]);
        f.for_s(0.18, 10.0, 30.0, &[]);
        // It is back with a frame in which another one is missed.
        let e = f.fly(10.0, 30.0, &[(4, Missing::BadPec)]);
        assert!(!e.measured, "{on_fault:?}");
        assert_eq!(f.kinds(), [FaultKind::SensorLost(2)], "{on_fault:?}");
        let e = f.fly(10.0, 30.0, &[]);
        assert!(e.measured && e.mode == Mode::Nominal && e.faults.is_empty(), "{on_fault:?}: {e:?}");
    }
}

#[test]
fn a_sensor_that_is_stuck_no_more_is_heard_with_the_same_frame() {
    let mut f = Flight::new();
    let (mut stuck, mut frozen) = (0, None);
    for i in 0..1000_u32 {
        let roll_deg = 40.0 * (f64::from(i) * 0.04).sin();
        let mut frame = f.frame(roll_deg, 40.0, &[]);
        for reading in &mut frame.readings[..2] {
            let Ok(Sample { value: Value::Absolute { object_c, .. }, .. }) = reading else { panic!("{reading:?}") };
            *object_c += 0.3 * (f64::from(i) * 0.7).sin();
        }
        let time = frame.time;
        if (300..600).contains(&i) {
            let value = *frozen.get_or_insert(frame.readings[2].unwrap().value);
            frame.readings[2] = Ok(Sample { value, time });
        }
        f.horizon.update(&frame, &[], &mut f.estimate);
        stuck += u32::from(f.kinds() == [FaultKind::SensorStuck(2)] && f.estimate.mode == Mode::Faulted);
        let withheld = f.estimate.mode == Mode::Faulted;
        assert!(!withheld || f.kinds().contains(&FaultKind::SensorStuck(2)), "frame {i}: {:?}", f.kinds());
        // It has said something else for half a second.
        assert!(i < 625 || !withheld, "frame {i}");
    }
    assert!(stuck > 100 && f.estimate.mode == Mode::Nominal, "{stuck} {:?}", f.estimate);
}

/// Ten frames a second of a contact that comes and goes: by chance two in a row, but hardly ten.
#[test]
fn a_loose_contact_is_one_fault_at_any_rate() {
    let mut f = Flight::by(Method::Field);
    let (mut onsets, mut was, mut noise) = (0, false, 1_u32);
    for _ in 0..600 {
        noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f.now_s += 0.08;
        f.fly(10.0, 30.0, if noise >> 31 == 1 { &[(0, Missing::NoAnswer)] } else { &[] });
        let is = f.kinds().contains(&FaultKind::SensorLost(0));
        onsets += u32::from(is && !was);
        was = is;
    }
    assert!((1..=3).contains(&onsets), "{onsets}");
}
