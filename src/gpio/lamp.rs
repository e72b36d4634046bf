//! The fault lamp: lit while attitude is withheld or not measured, blinking slowly while it is degraded.

use super::{GpioError, Switch};
use crate::attitude::Mode;
use crate::time::Time;
use std::mem;

/// How long a degraded lamp is lit, then dark, s.
const BLINK_S: u64 = 1;
/// So long after the last time it is switched whether that changes it or not, s: its chip may be another one.
const AGAIN_S: f64 = 1.0;

/// Whether the lamp is lit at `time`.
pub const fn lit(mode: Mode, time: Time) -> bool {
    match mode {
        Mode::Starting | Mode::Faulted => true,
        Mode::Degraded => (time.as_nanos() / (BLINK_S * 1_000_000_000)).is_multiple_of(2),
        Mode::Nominal => false,
    }
}

/// A lamp on a switch.
#[derive(Debug)]
pub struct Lamp<S> {
    switch: S,
    /// What it was switched to last, and when.
    last: Option<(bool, Time)>,
    failed: bool,
}

impl<S: Switch> Lamp<S> {
    /// A lamp on `switch`, in whatever state it is.
    pub const fn new(switch: S) -> Self {
        Self { switch, last: None, failed: false }
    }

    /// Shows `mode` at `time`. What could not be shown is tried again after a second, and an error once.
    pub fn show(&mut self, mode: Mode, time: Time) -> Result<(), GpioError> {
        let on = lit(mode, time);
        let stands = |(last, at): (bool, Time)| (self.failed || last == on) && time.since(at) < AGAIN_S;
        if self.last.is_some_and(stands) {
            return Ok(());
        }
        self.last = Some((on, time));
        let switched = self.switch.set(on);
        if mem::replace(&mut self.failed, switched.is_err()) {
            return Ok(());
        }
        switched
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Default)]
    struct Bulb {
        sets: Vec<bool>,
        broken: bool,
    }

    impl Switch for Bulb {
        fn set(&mut self, on: bool) -> Result<(), GpioError> {
            if self.broken {
                return Err(GpioError::failed("setting", "bulb", "broken"));
            }
            self.sets.push(on);
            Ok(())
        }
    }

    #[test]
    fn solid_while_withheld_dark_when_nominal_slow_when_degraded() {
        let mut lamp = Lamp::new(Bulb::default());
        for (tenths, mode) in
            (0..200).map(|i| (i, [Mode::Starting, Mode::Nominal, Mode::Degraded, Mode::Faulted][i as usize / 50]))
        {
            lamp.show(mode, Time::from_secs_f64(f64::from(tenths) / 10.0)).unwrap();
        }
        // Once a second. 0 s lit, 5 s dark; degraded from 10 s: lit in even seconds; faulted from 15 s.
        let shown = [[true; 5], [false; 5], [true, false, true, false, true], [true; 5]];
        assert_eq!(lamp.switch.sets, shown.concat());
    }

    #[test]
    fn it_changes_at_once() {
        let mut lamp = Lamp::new(Bulb::default());
        for (tenths, mode) in [Mode::Faulted, Mode::Nominal, Mode::Nominal, Mode::Faulted].into_iter().enumerate() {
            lamp.show(mode, Time::from_secs_f64(tenths as f64 / 10.0)).unwrap();
        }
        assert_eq!(lamp.switch.sets, [true, false, true]);
    }

    #[test]
    fn a_lamp_that_failed_is_tried_again_and_told_once() {
        let mut lamp = Lamp::new(Bulb { broken: true, ..Bulb::default() });
        let mut told = |tenths: u32, broken| {
            lamp.switch.broken = broken;
            let told = lamp.show(Mode::Faulted, Time::from_secs_f64(f64::from(tenths) / 10.0)).is_err();
            (told, lamp.switch.sets.len())
        };
        assert_eq!([told(0, true), told(5, true), told(10, true)], [(true, 0), (false, 0), (false, 0)]);
        // Not at each frame: its chip may be gone for good.
        assert_eq!([told(15, false), told(20, false)], [(false, 0), (false, 1)]);
        assert!(told(30, true).0, "that it failed again");
    }
}
