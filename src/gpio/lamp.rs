//! The fault lamp: lit while attitude is withheld or not measured, blinking slowly while it is degraded.

use super::{GpioError, Switch};
use crate::attitude::Mode;
use crate::time::Time;

/// How long a degraded lamp is lit, then dark, s.
const BLINK_S: u64 = 1;

/// Whether the lamp is lit at `time`.
pub const fn lit(mode: Mode, time: Time) -> bool {
    match mode {
        Mode::Starting | Mode::Faulted => true,
        Mode::Degraded => (time.as_nanos() / (BLINK_S * 1_000_000_000)).is_multiple_of(2),
        Mode::Nominal => false,
    }
}

/// A lamp on a switch, which is touched only when the lamp changes.
#[derive(Debug)]
pub struct Lamp<S> {
    switch: S,
    shown: Option<bool>,
}

impl<S: Switch> Lamp<S> {
    /// A lamp on `switch`, in whatever state it is.
    pub const fn new(switch: S) -> Self {
        Self { switch, shown: None }
    }

    /// Shows `mode` at `time`. What could not be shown is tried again the next time.
    pub fn show(&mut self, mode: Mode, time: Time) -> Result<(), GpioError> {
        let on = lit(mode, time);
        if self.shown == Some(on) {
            return Ok(());
        }
        let switched = self.switch.set(on);
        self.shown = switched.is_ok().then_some(on);
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
        // 0 s lit, 5 s dark; degraded from 10 s: lit in even seconds; faulted from 15 s.
        assert_eq!(lamp.switch.sets, [true, false, true, false, true, false, true]);
    }

    #[test]
    fn a_lamp_that_failed_is_tried_again() {
        let mut lamp = Lamp::new(Bulb { broken: true, ..Bulb::default() });
        assert!(lamp.show(Mode::Faulted, Time::default()).is_err());
        lamp.switch.broken = false;
        lamp.show(Mode::Faulted, Time::default()).unwrap();
        assert_eq!(lamp.switch.sets, [true]);
    }
}
