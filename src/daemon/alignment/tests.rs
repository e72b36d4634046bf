use super::*;
use crate::aiding::{Link, What};
use crate::config::Settings;
use crate::config::settings::Method;
use crate::head::Head;

fn at(ms: u32) -> Time {
    Time::from_secs_f64(100.0 + f64::from(ms) / 1000.0)
}

/// In a roll of 20 deg/s whose frames wait 0.2 s for the rates; what is published of an estimate at a time, ms.
struct Roll {
    alignment: Alignment,
    horizon: Horizon,
}

impl Roll {
    fn new() -> Self {
        let mut settings = Settings::default();
        settings.estimator.method = Some(Method::Field);
        let horizon = Horizon::new(&settings, Head::six());
        let mut alignment = Alignment::new(6, 16);
        alignment.aligner.linked(Link { system: Some(1), aids: true, ..Link::default() });
        for ms in (0..=1000).step_by(20) {
            let what = What::Rates([20.0, 0.0, 0.0]);
            alignment.aligner.hear(&Said { time: at(ms), arrived: at(ms), what });
        }
        Self { alignment, horizon }
    }

    fn shown(&mut self, ms: u32, attitude: Attitude, mode: Mode, measured: bool) -> Estimate {
        let time = at(ms - 200);
        let scan = Frame { time: at(ms), ..Frame::new(6) };
        let sigma = Attitude::from_degrees(2.0, 2.0);
        let estimate =
            Estimate { time, valid_at: time, attitude: Some(attitude), sigma, mode, measured, ..Estimate::default() };
        self.alignment.shown(&estimate, &self.horizon, &scan).clone()
    }
}

fn degrees(e: &Estimate) -> [f64; 2] {
    [e.attitude.unwrap().roll.to_degrees(), e.attitude.unwrap().pitch.to_degrees()]
}

#[test]
fn what_is_held_is_what_was_published() {
    let mut roll = Roll::new();
    let given = Attitude::from_degrees(10.0, 3.0);
    let carried = roll.shown(800, given, Mode::Nominal, true);
    assert!((degrees(&carried)[0] - 14.0).abs() < 0.01 && carried.sigma.roll >= given.roll * 0.1, "{carried:?}");
    for ms in (820..2000).step_by(20) {
        let held = roll.shown(ms, given, Mode::Degraded, false);
        assert_eq!(held.attitude, carried.attitude, "{ms}");
        assert!(held.sigma.roll >= carried.sigma.roll - 1e-12 && held.sigma.pitch >= carried.sigma.pitch - 1e-12);
    }
    // Measured again, and held again.
    let again = roll.shown(1000, Attitude::from_degrees(-5.0, 0.0), Mode::Nominal, true);
    assert!((degrees(&again)[0] + 1.0).abs() < 0.01, "{again:?}");
    assert_eq!(roll.shown(1020, Attitude::from_degrees(-5.0, 0.0), Mode::Degraded, false).attitude, again.attitude);
}

#[test]
fn what_is_eased_to_level_begins_at_what_was_published() {
    let mut roll = Roll::new();
    let given = Attitude::from_degrees(10.0, 0.0);
    let carried = roll.shown(800, given, Mode::Nominal, true);
    let mut last = degrees(&carried)[0];
    for i in 1..500_u32 {
        let t = f64::from(i) * 0.02;
        let level = Attitude::from_degrees(10.0 * (-t / 2.0).exp(), 0.0);
        let e = roll.shown(800 + 20 * i, level, Mode::Faulted, false);
        let [now, _] = degrees(&e);
        assert!(now < last + 1e-9 && last - now < 0.25, "{last} {now} at {t} s");
        assert!(e.sigma.roll >= carried.sigma.roll);
        last = now;
    }
    assert!(last.abs() < 0.1, "{last}");
}
