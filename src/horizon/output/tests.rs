use super::*;
use crate::config::Settings;
use crate::fault::{ActiveFault, Evidence, FaultKind};
use proptest::prelude::*;

/// An output that is given a verdict 50 times a second.
struct Stage {
    output: Output,
    estimate: Estimate,
    now_s: f64,
}

fn deg(roll: f64, pitch: f64) -> Attitude {
    Attitude::from_degrees(roll, pitch)
}

fn given(attitude: Attitude, sigma_deg: f64) -> Verdict {
    Verdict::Given { attitude, sigma: deg(sigma_deg, sigma_deg), limited: false, degraded: false }
}

/// The angle between two verticals, °.
fn apart_deg(a: Attitude, b: Attitude) -> f64 {
    let (a, b) = (a.vertical(), b.vertical());
    let chord: f64 = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
    2.0 * (chord / 2.0).min(1.0).asin().to_degrees()
}

/// The standard deviation of the vertical's direction, °: the larger of both ways.
fn unsure_deg(e: &Estimate) -> f64 {
    let pitch = e.attitude.unwrap().pitch;
    (e.sigma.roll * pitch.cos()).max(e.sigma.pitch).to_degrees()
}

impl Stage {
    fn new(on_fault: OnFault) -> Self {
        let faults = FaultSettings { on_fault, hold_s: 3.0, ..Settings::default().faults };
        Self { output: Output::new(&faults), estimate: Estimate::default(), now_s: 50.0 }
    }

    /// The estimate after a frame `dt_s` later; a fault is listed while it withholds.
    fn after(&mut self, dt_s: f64, verdict: Verdict) -> &Estimate {
        self.now_s += dt_s;
        let now = Time::from_secs_f64(self.now_s);
        self.estimate.faults.clear();
        if verdict == Verdict::Withheld {
            let evidence = Evidence::Limit { value: 1.0, limit: 2.0, unit: "K" };
            self.estimate.faults.push(ActiveFault { kind: FaultKind::LowContrast, since: now, evidence });
        }
        self.output.update(verdict, now, Some(now), &mut self.estimate);
        &self.estimate
    }

    /// Body rates as they were known before.
    fn turning(&mut self) {
        self.estimate.rates = Some([0.1; 3]);
    }

    /// As many frames as `seconds` hold; the estimate after the last.
    fn for_s(&mut self, seconds: f64, verdict: Verdict) -> Estimate {
        for _ in 0..(seconds * 50.0).round() as u32 {
            self.after(0.02, verdict);
        }
        self.estimate.clone()
    }
}

#[test]
fn body_rates_are_those_of_a_measured_attitude() {
    for on_fault in [OnFault::Withhold, OnFault::Hold, OnFault::Level] {
        let mut stage = Stage::new(on_fault);
        stage.turning();
        assert!(stage.for_s(1.0, given(deg(20.0, 5.0), 1.0)).rates.is_some());
        assert_eq!(stage.after(0.02, Verdict::Withheld).rates, None, "{on_fault:?}");
    }
}

#[test]
fn withheld_is_nothing_and_what_comes_back_is_no_step() {
    let mut s = Stage::new(OnFault::Withhold);
    s.for_s(1.0, given(deg(40.0, 5.0), 1.0));
    let e = s.for_s(1.0, Verdict::Withheld);
    assert_eq!((e.mode, e.attitude), (Mode::Faulted, None));
    let e = s.after(0.02, given(deg(-50.0, 0.0), 1.0));
    assert_eq!((e.mode, e.attitude, e.sigma), (Mode::Nominal, Some(deg(-50.0, 0.0)), deg(1.0, 1.0)));
}

#[test]
fn a_held_attitude_stands_and_is_ever_less_sure_until_its_time_is_over() {
    let mut s = Stage::new(OnFault::Hold);
    s.for_s(5.0, given(deg(30.0, 10.0), 1.0));
    let mut last = s.estimate.sigma;
    for i in 0..150 {
        let e = s.after(0.02, Verdict::Withheld);
        assert_eq!((e.mode, e.attitude, e.faults.len()), (Mode::Degraded, Some(deg(30.0, 10.0)), 1), "frame {i}");
        assert!(e.sigma.roll > last.roll && e.sigma.pitch > last.pitch);
        last = e.sigma;
    }
    // 1° of its own, 6° a second.
    assert!((last.pitch.to_degrees() - 18.0_f64.hypot(1.0)).abs() < 0.2, "{last:?}");
    s.after(0.04, Verdict::Withheld);
    assert_eq!((s.estimate.mode, s.estimate.attitude), (Mode::Faulted, None));
}

#[test]
fn what_stands_in_goes_on_from_what_was_published() {
    let carried = deg(34.0, 10.0);
    for on_fault in [OnFault::Hold, OnFault::Level] {
        let mut s = Stage::new(on_fault);
        s.for_s(5.0, given(deg(30.0, 10.0), 1.0));
        s.output.published(carried, deg(2.0, 2.0));
        let mut last = carried;
        for i in 1..150 {
            let e = s.after(0.02, Verdict::Withheld).clone();
            let now = e.attitude.unwrap();
            let t = 0.02 * f64::from(i);
            let unsure = 2.0_f64.hypot(6.0 * t).hypot(apart_deg(carried, now));
            assert!((unsure_deg(&e) - unsure).abs() < 0.05 * unsure, "{on_fault:?}, frame {i}: {e:?}");
            assert!(apart_deg(last, now) < 0.4, "{on_fault:?}, frame {i}: {e:?}");
            assert_eq!(on_fault == OnFault::Hold, now == carried);
            last = now;
        }
    }
}

#[test]
fn a_moment_of_trust_gives_no_more_time_to_hold() {
    let mut s = Stage::new(OnFault::Hold);
    s.for_s(5.0, given(deg(0.0, 0.0), 1.0));
    let mut held = 0;
    for _ in 0..20 {
        for _ in 0..50 {
            held += u32::from(s.after(0.02, Verdict::Withheld).attitude.is_some());
        }
        s.for_s(0.5, given(deg(0.0, 0.0), 1.0));
    }
    assert!((148..=170).contains(&held), "{held} frames held, of 150 and the first of each");
    s.for_s(3.1, given(deg(0.0, 0.0), 1.0));
    assert_eq!(s.for_s(2.9, Verdict::Withheld).mode, Mode::Degraded, "after 3 s of trust there are 3 s again");
}

#[test]
fn what_is_held_is_as_old_as_it_is_and_no_older_than_may_be_held() {
    let mut s = Stage::new(OnFault::Hold);
    s.for_s(5.0, given(deg(30.0, 10.0), 1.0));
    assert_eq!(s.after(120.0, Verdict::Withheld).attitude, None, "after a gap of minutes");
    let mut s = Stage::new(OnFault::Hold);
    s.for_s(5.0, given(deg(30.0, 10.0), 1.0));
    s.for_s(0.4, Verdict::Nothing);
    assert_eq!(s.for_s(2.58, Verdict::Withheld).mode, Mode::Degraded);
    assert_eq!(s.for_s(0.04, Verdict::Withheld).mode, Mode::Faulted, "3 s after it was given");
}

#[test]
fn level_is_eased_to_and_says_that_it_is_not_known() {
    for from in [deg(60.0, 20.0), deg(179.0, 0.0), deg(0.0, 89.9), deg(180.0, 0.0), deg(-120.0, -70.0)] {
        let mut s = Stage::new(OnFault::Level);
        s.for_s(1.0, given(from, 1.0));
        let level = deg(0.0, 0.0);
        let (mut before, mut last) = (s.estimate.clone(), apart_deg(from, level));
        for _ in 0..1500 {
            let e = s.after(0.02, Verdict::Withheld).clone();
            let (now, shown) = (apart_deg(e.attitude.unwrap(), level), e.attitude.unwrap());
            assert_eq!(e.mode, Mode::Faulted);
            assert!(now <= last + 1e-6 && apart_deg(shown, before.attitude.unwrap()) <= unsure_deg(&e));
            assert!(e.sigma.pitch >= before.sigma.pitch);
            (last, before) = (now, e);
        }
        assert!(last < 0.01 && (unsure_deg(&before) - 90.0).abs() < 1e-6, "{last} {before:?}");
    }
}

#[test]
fn where_nothing_was_shown_nothing_stands_in() {
    for on_fault in [OnFault::Withhold, OnFault::Hold, OnFault::Level] {
        let mut s = Stage::new(on_fault);
        assert_eq!(s.after(0.02, Verdict::Nothing).mode, Mode::Starting);
        let e = s.after(0.02, Verdict::Withheld);
        assert_eq!((e.mode, e.attitude), (Mode::Faulted, None));
    }
}

#[test]
fn what_stands_in_is_taken_back_without_a_step() {
    for on_fault in [OnFault::Hold, OnFault::Level] {
        let mut s = Stage::new(on_fault);
        s.for_s(5.0, given(deg(50.0, 0.0), 1.0));
        let held = s.for_s(1.0, Verdict::Withheld).attitude.unwrap();
        let e = s.after(0.02, given(deg(-30.0, 5.0), 1.0)).clone();
        assert!((apart_deg(held, e.attitude.unwrap()) - 1.0).abs() < 0.01, "one standard deviation");
        let error = apart_deg(e.attitude.unwrap(), deg(-30.0, 5.0));
        assert!(unsure_deg(&e) >= error && e.mode == Mode::Nominal, "{error} {e:?}");
        let e = s.for_s(1.0, given(deg(-30.0, 5.0), 1.0));
        let later = apart_deg(e.attitude.unwrap(), deg(-30.0, 5.0));
        assert!((later / error - (-1.0_f64).exp()).abs() < 0.02, "{error} {later}");
        let e = s.for_s(15.0, given(deg(-30.0, 5.0), 1.0));
        assert_eq!((e.attitude, e.sigma), (Some(deg(-30.0, 5.0)), deg(1.0, 1.0)));
    }
}

#[test]
fn an_estimate_that_jumps_in_steady_flight_is_followed_without_a_step() {
    let mut s = Stage::new(OnFault::Withhold);
    s.for_s(6.0, given(deg(10.0, 0.0), 1.5));
    let mut before = s.estimate.attitude.unwrap();
    for _ in 0..50 {
        let e = s.after(0.02, given(deg(17.0, -3.0), 1.5)).clone();
        let shown = e.attitude.unwrap();
        // 2° is what it may have turned in a frame, at 100 °/s.
        assert!(apart_deg(before, shown) <= 1.5 + 2.01);
        assert!(unsure_deg(&e) + 1e-9 >= 1.5 + apart_deg(shown, deg(17.0, -3.0)));
        before = shown;
    }
}

#[test]
fn the_fastest_rolls_and_loops_are_not_held_back() {
    let mut s = Stage::new(OnFault::Withhold);
    for i in 0..1000 {
        let t = f64::from(i) * 0.02;
        // 0.5 s to 360 °/s, then rolls, then a loop at 90 °/s.
        let roll = if t < 0.5 { 360.0 * t * t } else { 90.0 + 360.0 * (t - 0.5) };
        let spun = (t - 5.25).max(0.0) * 90.0;
        let a = if t < 5.25 { deg(roll, 0.0) } else { deg(0.0, spun) };
        let a = Attitude::from_vertical(a.vertical());
        assert_eq!(s.after(0.02, given(a, 1.0)).attitude, Some(a), "at {t} s");
    }
}

#[test]
fn an_attitude_that_nobody_can_be_sure_of_is_withheld_with_a_reason() {
    let mut s = Stage::new(OnFault::Withhold);
    s.for_s(1.0, given(deg(0.0, 0.0), 19.0));
    assert_eq!(s.for_s(0.1, given(deg(0.0, 0.0), 25.0)).mode, Mode::Nominal, "its σ says enough at first");
    let e = s.for_s(0.2, given(deg(0.0, 0.0), 25.0));
    assert_eq!((e.mode, e.attitude), (Mode::Faulted, None));
    assert_eq!(e.faults[0].kind, FaultKind::Obstructed);
    assert_eq!(e.faults[0].evidence.to_string(), "25.00 °, limit 20.00 °");
    assert_eq!(s.for_s(5.0, given(deg(0.0, 0.0), 17.0)).attitude, None, "not under 0.8 of the limit");
    assert_eq!(s.for_s(0.9, given(deg(0.0, 0.0), 15.0)).attitude, None);
    let e = s.for_s(0.2, given(deg(0.0, 0.0), 15.0));
    assert_eq!((e.mode, e.faults.len()), (Mode::Nominal, 0));
}

#[test]
fn towards_the_zenith_a_large_sigma_of_roll_is_no_doubt_of_the_vertical() {
    let mut s = Stage::new(OnFault::Withhold);
    let verdict = Verdict::Given { attitude: deg(0.0, 88.0), sigma: deg(57.0, 2.0), limited: false, degraded: false };
    assert_eq!(s.for_s(2.0, verdict).mode, Mode::Nominal);
}

#[test]
fn a_roll_at_its_limit_is_a_bound_and_given_however_far_beyond_it_the_aircraft_may_be() {
    let mut s = Stage::new(OnFault::Withhold);
    let at_limit =
        |pitch| Verdict::Given { attitude: deg(45.0, 0.0), sigma: deg(60.0, pitch), limited: true, degraded: false };
    assert_eq!(s.for_s(2.0, at_limit(2.0)).mode, Mode::Nominal);
    assert_eq!(s.for_s(2.0, at_limit(25.0)).mode, Mode::Faulted);
}

#[test]
fn a_fault_beside_no_new_attitude_is_no_longer_nominal() {
    let mut s = Stage::new(OnFault::Withhold);
    s.for_s(1.0, given(deg(3.0, 4.0), 1.0));
    let evidence = Evidence::Limit { value: 1.0, limit: 2.0, unit: "s" };
    s.estimate.faults.push(ActiveFault { kind: FaultKind::SensorLost(1), since: Time::default(), evidence });
    let now = Time::from_secs_f64(s.now_s + 0.02);
    s.output.update(Verdict::Nothing, now, Some(now), &mut s.estimate);
    assert_eq!((s.estimate.mode, s.estimate.attitude), (Mode::Degraded, Some(deg(3.0, 4.0))));
}

fn verdicts() -> impl Strategy<Value = Verdict> {
    let angle = || prop_oneof![20 => -180.0_f64..180.0, 1 => Just(f64::NAN), 1 => Just(f64::INFINITY)];
    let sigma = || prop_oneof![20 => 0.1_f64..15.0, 3 => 0.0_f64..120.0, 1 => Just(f64::NAN)];
    let attitude = (angle(), -90.0_f64..=90.0, sigma(), sigma(), any::<bool>());
    prop_oneof![
        3 => attitude.prop_map(|(roll, pitch, a, b, degraded)| Verdict::Given {
            attitude: deg(roll, pitch), sigma: deg(a, b), limited: false, degraded
        }),
        1 => Just(Verdict::Nothing),
        2 => Just(Verdict::Withheld),
    ]
}

proptest! {
    #[test]
    fn whatever_comes_it_is_finite_and_says_how_far_to_trust_it(
        on_fault in prop::sample::select(OnFault::NAMED.to_vec()),
        steps in prop::collection::vec((verdicts(), 1_u32..40, prop_oneof![9 => Just(0.02), 1 => 0.0_f64..5.0]), 1..30),
    ) {
        let mut s = Stage::new(on_fault.1);
        for (verdict, frames, dt_s) in steps {
            for _ in 0..frames {
                let before = s.estimate.clone();
                let e = s.after(dt_s, verdict).clone();
                prop_assert_eq!(e.attitude.is_none(), match e.mode {
                    Mode::Starting => true,
                    Mode::Nominal | Mode::Degraded => false,
                    Mode::Faulted => on_fault.1 != OnFault::Level || before.attitude.is_none(),
                });
                let Some(a) = e.attitude else { continue };
                prop_assert!([a.roll, a.pitch, e.sigma.roll, e.sigma.pitch].into_iter().all(f64::is_finite));
                if e.mode == Mode::Nominal && e.valid_at != before.valid_at {
                    let whole = matches!(verdict, Verdict::Given { degraded: false, .. });
                    prop_assert!(whole && e.faults.is_empty());
                }
                if verdict == Verdict::Withheld && e.mode == Mode::Degraded && before.mode == Mode::Degraded
                    && !before.faults.is_empty()
                {
                    prop_assert!(e.sigma.roll >= before.sigma.roll && e.sigma.pitch >= before.sigma.pitch);
                }
                if let (Some(b), true) = (before.attitude, dt_s > 0.0 && matches!(verdict, Verdict::Given { .. })) {
                    let step = apart_deg(a, b);
                    let turned = 400.0 * e.valid_at.since(before.valid_at);
                    prop_assert!(step <= unsure_deg(&e) + turned + 1e-6, "{step} {e:?}");
                }
            }
        }
    }
}
