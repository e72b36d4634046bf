use super::*;
use crate::frame::Sample;
use crate::frame::Value;

fn at(ms: u32) -> Time {
    Time::from_secs_f64(50.0 + f64::from(ms) / 1000.0)
}

fn frame(ms: u32) -> Frame {
    let mut frame = Frame::new(1);
    frame.time = at(ms);
    frame.readings[0] = Ok(Sample { value: Value::Volts(f64::from(ms)), time: at(ms) });
    frame
}

fn rates(ms: u32, arrived: u32, p: f64) -> Said {
    Said { time: at(ms), arrived: at(arrived), what: What::Rates([p, 0.0, 0.0]) }
}

fn heard(aids: bool, ms: u32) -> Link {
    Link { system: Some(1), heard: at(ms), aids, ..Link::default() }
}

/// Frames at 50 Hz with what came out: frame, when, the rate in it.
fn run(
    aligner: &mut Aligner,
    ms: std::ops::Range<u32>,
    mut said: impl FnMut(u32) -> Vec<Said>,
) -> Vec<(u32, u32, Option<f64>)> {
    let (mut out, mut gone) = (frame(0), Vec::new());
    for now in ms.step_by(20) {
        said(now).iter().for_each(|s| aligner.hear(s));
        aligner.offer(&frame(now));
        while aligner.next(at(now), &mut out) {
            let ms = (out.time.since(at(0)) * 1e3).round() as u32;
            gone.push((ms, now, out.aiding.gyro_deg_s[0]));
        }
    }
    gone
}

#[test]
fn without_an_autopilot_frames_pass_at_once() {
    let mut aligner = Aligner::new(1);
    let gone = run(&mut aligner, 0..1000, |_| Vec::new());
    assert!(gone.len() == 50 && gone.iter().all(|(ms, now, rate)| ms == now && rate.is_none()), "{gone:?}");
    assert_eq!(aligner.autopilot(at(1000)), Autopilot::default());
}

/// The rates of a moment 10 ms before each frame, 40 ms late: of rate = ms.
fn late(now: u32) -> Vec<Said> {
    now.checked_sub(50).map(|ms| rates(ms, now, f64::from(ms))).into_iter().collect()
}

#[test]
fn a_frame_waits_for_the_rates_around_it() {
    let mut aligner = Aligner::new(1);
    aligner.linked(heard(true, 0));
    let gone = run(&mut aligner, 0..2000, late);
    for (ms, now, rate) in gone.into_iter().filter(|(ms, ..)| *ms > 200) {
        assert_eq!(now - ms, 60, "of {ms}");
        assert!((rate.unwrap() - f64::from(ms)).abs() < 1e-6, "{rate:?} of {ms}");
    }
    let shown = aligner.autopilot(at(2000));
    assert!(shown.used && (shown.late_s.unwrap() - 0.05).abs() < 0.001, "{shown:?}");
}

#[test]
fn lost_rates_are_interpolated_and_silence_lets_all_pass() {
    let mut aligner = Aligner::new(1);
    aligner.linked(heard(true, 0));
    // One in three is lost; from 1 s on all are.
    let gone = run(&mut aligner, 0..2000, |now| if now % 60 == 0 || now > 1000 { Vec::new() } else { late(now) });
    assert_eq!(gone.iter().map(|g| g.0).collect::<Vec<u32>>(), (0..2000).step_by(20).collect::<Vec<u32>>());
    for (ms, now, rate) in gone.into_iter().filter(|(ms, ..)| *ms > 200) {
        if ms < 940 {
            assert!((60..=100).contains(&(now - ms)) && (rate.unwrap() - f64::from(ms)).abs() < 1e-6, "{ms} {now}");
        }
        assert!(f64::from(now - ms) <= 1e3 * LONGEST_S);
        assert!(ms < 1260 || (ms == now && rate.is_none()), "{ms} {now} {rate:?}");
    }
}

#[test]
fn rates_that_come_too_late_or_are_not_wanted_are_not_waited_for() {
    for (by, aids) in [(200, true), (50, false)] {
        let mut aligner = Aligner::new(1);
        aligner.linked(heard(aids, 0));
        let gone =
            run(&mut aligner, 0..3000, |now| now.checked_sub(by).map(|ms| rates(ms, now, 1.0)).into_iter().collect());
        let since = gone.iter().filter(|(ms, ..)| *ms > 1000);
        assert!(since.clone().count() == 99 && since.clone().all(|(ms, now, r)| ms == now && r.is_none()), "{gone:?}");
        assert!(!aligner.autopilot(at(3000)).used);
    }
}

#[test]
fn rates_that_carry_nothing_on_are_heard_and_not_waited_for() {
    let mut aligner = Aligner::new(1);
    aligner.linked(heard(true, 0));
    aligner.carries(false);
    let gone = run(&mut aligner, 0..2000, late);
    let since = gone.iter().filter(|(ms, ..)| *ms > 200);
    assert!(since.clone().all(|(ms, now, rate)| ms == now && rate.is_some()), "{gone:?}");
}

/// Nothing is carried on over half a second.
#[test]
fn frames_that_are_far_apart_do_not_wait_for_the_next() {
    let mut aligner = Aligner::new(1);
    aligner.linked(heard(true, 0));
    let (mut out, mut passed) = (frame(0), 0);
    for now in (0..10_000).step_by(20) {
        late(now).iter().for_each(|s| aligner.hear(s));
        if now % 500 == 0 {
            aligner.offer(&frame(now));
            while aligner.next(at(now), &mut out) {
                passed += i32::from(out.time == at(now));
            }
        }
    }
    assert_eq!(passed, 20);
}

#[test]
fn what_the_source_says_itself_is_left_as_it_is() {
    let mut aligner = Aligner::new(1);
    aligner.linked(heard(true, 0));
    let mut out = frame(0);
    for now in (0..1000).step_by(20) {
        late(now).iter().for_each(|s| aligner.hear(s));
        let mut own = frame(now);
        own.aiding.airspeed_m_s = (now % 100 == 0).then_some(15.0);
        aligner.offer(&own);
        assert!(aligner.next(at(now), &mut out));
        assert_eq!(out, own);
    }
}

#[test]
fn a_fix_goes_into_the_frame_nearest_to_it_and_into_no_other() {
    let mut aligner = Aligner::new(1);
    aligner.linked(heard(true, 0));
    let fix = |ms: u32, arrived: u32| {
        let slow = Aiding { ground_speed_m_s: Some(f64::from(ms)), ..Aiding::default() };
        Said { time: at(ms), arrived: at(arrived), what: What::Slow(slow) }
    };
    let (mut out, mut seen) = (frame(0), Vec::new());
    for now in (0..2000).step_by(20) {
        late(now).iter().for_each(|s| aligner.hear(s));
        if now == 1060 {
            aligner.hear(&fix(1031, now));
            aligner.hear(&fix(900, now));
        }
        aligner.offer(&frame(now));
        while aligner.next(at(now), &mut out) {
            seen.extend(out.aiding.ground_speed_m_s.map(|v| (out.time, v)));
        }
    }
    // The frame of its time is gone: the next one to go has it.
    assert_eq!(seen, [(at(1000), 900.0), (at(1040), 1031.0)]);
}

#[test]
fn another_autopilot_and_a_clock_set_back_begin_anew() {
    let mut aligner = Aligner::new(1);
    aligner.linked(heard(true, 0));
    run(&mut aligner, 1000..2000, late);
    assert!(aligner.has_rates(at(1990)));
    aligner.linked(Link { system: Some(2), ..heard(true, 0) });
    assert!(!aligner.has_rates(at(1990)));
    aligner.hear(&rates(1900, 1950, 5.0));
    aligner.hear(&rates(10, 50, 7.0));
    assert_eq!(aligner.rates.newest(), Some(at(10)));
    aligner.hear(&Said { what: What::Rates([f64::NAN, 0.0, 0.0]), ..rates(30, 60, 0.0) });
    assert_eq!(aligner.rates.newest(), Some(at(10)));
}
