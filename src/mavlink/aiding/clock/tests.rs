use super::*;
use proptest::prelude::*;

/// Our clock, s.
fn at(s: f64) -> Time {
    Time::from_secs_f64(s)
}

fn ns(s: f64) -> i64 {
    (s * 1e9).round() as i64
}

/// How far `clock` is off, s, at `now`, where theirs is ours less `behind`.
fn off(clock: &Clock, now: f64, behind: f64) -> f64 {
    clock.ours(at(now), ns(now - behind)).unwrap().since(at(now))
}

#[test]
fn the_quickest_message_tells_the_offset_and_an_answer_tells_it_better() {
    let (mut clock, behind) = (Clock::default(), 1234.5);
    for i in 0..500 {
        let sent = 2000.0 + f64::from(i) * 0.02;
        let way = 0.03 + 0.001 * f64::from(i * 7 % 20);
        clock.arrived(at(sent + way), ns(sent - behind));
    }
    // Late by the way of the quickest, 30 ms: what is stamped now seems to be of later, which cannot be.
    assert_eq!(off(&clock, 2010.5, behind), 0.0);
    assert!((clock.ours(at(2010.5), ns(2010.0 - behind)).unwrap().since(at(2010.03))).abs() < 1e-6);
    assert!(!clock.is_synced() && clock.delay_s(at(2010.5)) == 0.0);
    // A slow answer that came back by a slower way, and a quick one.
    clock.answered(at(2010.6), ns(2010.65 - behind), at(2010.9));
    clock.answered(at(2011.0), ns(2011.03 - behind), at(2011.06));
    assert!(off(&clock, 2011.1, behind).abs() < 1e-6);
    assert!((clock.delay_s(at(2011.1)) - 0.03).abs() < 1e-6);
}

#[test]
fn an_answer_of_another_clock_or_after_a_long_time_is_none() {
    let mut clock = Clock::default();
    clock.answered(at(9.0), 0, at(9.01));
    assert!(!clock.is_synced(), "nothing has arrived yet");
    clock.arrived(at(10.0), ns(5.0));
    clock.answered(at(10.0), 1_700_000_000_000_000_000, at(10.01));
    clock.answered(at(10.0), ns(5.0), at(12.0));
    clock.answered(at(10.0), ns(5.0), at(9.0));
    assert!(!clock.is_synced());
    clock.answered(at(10.0), ns(5.005), at(10.01));
    assert!(clock.is_synced());
}

/// 100 ppm for an hour, with an answer every 10 s.
#[test]
fn a_clock_that_drifts_is_followed() {
    let mut clock = Clock::default();
    let theirs = |s: f64| 50.0 + s * 1.0001;
    let mut worst = 0.0_f64;
    for i in 0..180_000 {
        let now = 100.0 + f64::from(i) * 0.02;
        assert!(!clock.arrived(at(now), ns(theirs(now - 0.02 - 0.0005 * f64::from(i * 13 % 20)))));
        if i % 500 == 0 {
            clock.answered(at(now - 0.05), ns(theirs(now - 0.025)), at(now));
        }
        if i > 500 {
            worst = worst.max((clock.ours(at(now), ns(theirs(now - 0.05))).unwrap().since(at(now - 0.05))).abs());
        }
    }
    assert!(worst < 0.003, "{worst}");
}

#[test]
fn a_start_of_the_autopilot_is_seen_and_one_stray_stamp_is_not_one() {
    let mut clock = Clock::default();
    let send = |clock: &mut Clock, now: f64, ms: u32| {
        let sent = clock.of_millis(ms);
        clock.arrived(at(now), sent)
    };
    for i in 0..100 {
        assert!(!send(&mut clock, 100.0 + f64::from(i) * 0.02, 50_000 + 20 * i));
    }
    clock.answered(at(102.0), ns(52.01), at(102.02));
    assert!(!send(&mut clock, 102.02, 3), "one alone");
    assert!(!send(&mut clock, 102.04, 52_040));
    assert!(clock.is_synced());
    assert!(!send(&mut clock, 105.0, 200));
    assert!(send(&mut clock, 105.02, 220), "two that go on");
    assert!(!clock.is_synced(), "what was known of the other clock is no more");
    assert!(clock.ours(at(105.04), ns(0.24)).unwrap().since(at(105.04)).abs() < 0.001);
    // Set forward.
    assert!(!send(&mut clock, 105.04, 900_000) && send(&mut clock, 105.06, 900_020));
}

#[test]
fn milliseconds_begin_anew_after_49_days_and_a_start_after_30_is_one() {
    let mut clock = Clock::default();
    let mut ms = u32::MAX - 1000;
    for i in 0..100 {
        let now = 5_000_000.0 + f64::from(i) * 0.02;
        let sent = clock.of_millis(ms);
        assert!(!clock.arrived(at(now), sent), "{ms}");
        ms = ms.wrapping_add(20);
    }
    let now = 5_000_002.0;
    assert!(clock.ours(at(now), clock.of_millis(ms)).unwrap().since(at(now)).abs() < 0.002);
    // An answer in nanoseconds that have not begun anew.
    clock.answered(at(now - 0.01), (i64::from(ms) + (1 << 32)) * 1_000_000, at(now + 0.01));
    clock.answered(at(now - 0.01), i64::from(ms) * 1_000_000, at(now + 0.01));
    assert!(clock.is_synced() && clock.delay_s(at(now)) < 0.02);

    let mut clock = Clock::default();
    clock.arrived(at(3_000_000.0), clock.of_millis(2_600_000_000));
    let began: Vec<bool> = [1000, 1020]
        .map(|ms| {
            let sent = clock.of_millis(ms);
            clock.arrived(at(3_000_010.0 + f64::from(ms) / 1000.0), sent)
        })
        .into();
    assert_eq!(began, [false, true]);
}

proptest! {
    #[test]
    fn nothing_hostile_panics_or_is_of_the_future(
        steps in prop::collection::vec((any::<u64>(), any::<i64>(), any::<u32>(), any::<bool>()), 1..60),
    ) {
        let mut clock = Clock::default();
        for (now, sent, ms, ask) in steps {
            let now = Time::from_nanos(now);
            clock.arrived(now, if ask { sent } else { clock.of_millis(ms) });
            clock.answered(Time::from_nanos(now.as_nanos() / 2), sent, now);
            prop_assert!(clock.ours(now, sent).is_none_or(|t| t <= now));
            prop_assert!(clock.delay_s(now) >= 0.0);
        }
    }
}
