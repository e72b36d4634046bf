//! The same two traits over any embedded-hal pin, linux-embedded-hal's `CdevPin` among them: for
//! lines that cannot tell edges, as those of many I²C expanders.
//!
//! A pin's high and low are levels: `CdevPin` undoes the kernel's `active-low`, so whether a line is
//! active when low is said here.

use super::{DataReady, GpioError, Switch};
use embedded_hal::digital::{InputPin, OutputPin, PinState};
use std::time::{Duration, Instant};

/// Between two looks at a pin.
const LOOK: Duration = Duration::from_micros(100);

/// A pin that is switched.
#[derive(Debug)]
pub struct PinSwitch<P> {
    pin: P,
    active_low: bool,
}

impl<P> PinSwitch<P> {
    /// Over `pin`, an output.
    pub const fn new(pin: P, active_low: bool) -> Self {
        Self { pin, active_low }
    }
}

impl<P: OutputPin + Send> Switch for PinSwitch<P> {
    fn set(&mut self, on: bool) -> Result<(), GpioError> {
        let level = PinState::from(on != self.active_low);
        self.pin.set_state(level).map_err(|e| GpioError::failed("setting", "a pin", format!("{e:?}")))
    }
}

/// A pin that is low from the end of a conversion to the next start: ALERT/RDY in single-shot
/// mode. The pulses of continuous mode are too short to be looked for.
#[derive(Debug)]
pub struct PinReady<P> {
    pin: P,
}

impl<P> PinReady<P> {
    /// Over `pin`, an input.
    pub const fn new(pin: P) -> Self {
        Self { pin }
    }
}

impl<P: InputPin + Send> DataReady for PinReady<P> {
    fn wait(&mut self, timeout: Duration) -> Result<bool, GpioError> {
        let begun = Instant::now();
        loop {
            if self.pin.is_low().map_err(|e| GpioError::failed("reading", "a pin", format!("{e:?}")))? {
                return Ok(true);
            }
            let left = timeout.saturating_sub(begun.elapsed());
            if left.is_zero() {
                return Ok(false);
            }
            std::thread::sleep(LOOK.min(left));
        }
    }

    fn clear(&mut self) {}
}

#[cfg(test)]
mod tests {
    use super::*;
    use embedded_hal::digital::{Error, ErrorKind, ErrorType};

    /// A pin whose level can be seen; broken when it has none.
    struct Wire(Option<bool>);

    #[derive(Debug)]
    struct Broken;

    impl Error for Broken {
        fn kind(&self) -> ErrorKind {
            ErrorKind::Other
        }
    }

    impl ErrorType for Wire {
        type Error = Broken;
    }

    impl OutputPin for Wire {
        fn set_low(&mut self) -> Result<(), Broken> {
            *self.0.as_mut().ok_or(Broken)? = false;
            Ok(())
        }

        fn set_high(&mut self) -> Result<(), Broken> {
            *self.0.as_mut().ok_or(Broken)? = true;
            Ok(())
        }
    }

    impl InputPin for Wire {
        fn is_high(&mut self) -> Result<bool, Broken> {
            self.0.ok_or(Broken)
        }

        fn is_low(&mut self) -> Result<bool, Broken> {
            Ok(!self.is_high()?)
        }
    }

    #[test]
    fn on_is_the_active_level() {
        for (active_low, on, level) in
            [(false, true, true), (false, false, false), (true, true, false), (true, false, true)]
        {
            let mut switch = PinSwitch::new(Wire(Some(!level)), active_low);
            switch.set(on).unwrap();
            assert_eq!(switch.pin.0, Some(level), "active low {active_low}, on {on}");
        }
        assert!(PinSwitch::new(Wire(None), false).set(true).is_err());
    }

    #[test]
    fn low_is_ready() {
        assert_eq!(PinReady::new(Wire(Some(false))).wait(Duration::ZERO), Ok(true));
        assert_eq!(PinReady::new(Wire(Some(true))).wait(Duration::from_micros(300)), Ok(false));
        assert!(PinReady::new(Wire(None)).wait(Duration::ZERO).is_err());
    }

    #[test]
    fn the_pins_of_linux_embedded_hal_fit() {
        fn fits<S: Switch, R: DataReady>() {}
        fits::<PinSwitch<linux_embedded_hal::CdevPin>, PinReady<linux_embedded_hal::CdevPin>>();
    }
}
