//! A line that is switched: the sensors' supply, the fault lamp.

use super::lines::{CONSUMER, Shown, find, refused};
use super::{GpioError, Switch};
use crate::config::settings::LineSettings;
use gpio_cdev::{LineHandle, LineRequestFlags};

/// An output. It is on when the line is active: low where the settings say `active-low`, which
/// the kernel takes care of.
#[derive(Debug)]
pub struct OutputLine {
    handle: LineHandle,
}

impl OutputLine {
    /// Requests the line, on or off from the first moment. What it does after it was let go of is
    /// the GPIO chip's choice; most keep it as it is.
    pub fn open(settings: &LineSettings, on: bool) -> Result<Self, GpioError> {
        let line = find(settings)?;
        let mut flags = LineRequestFlags::OUTPUT;
        flags.set(LineRequestFlags::ACTIVE_LOW, settings.active_low);
        let handle = line.request(flags, on.into(), CONSUMER).map_err(|e| refused(&line, "driving", &e))?;
        Ok(Self { handle })
    }
}

impl Switch for OutputLine {
    fn set(&mut self, on: bool) -> Result<(), GpioError> {
        self.handle.set_value(on.into()).map_err(|e| GpioError::failed("setting", Shown(self.handle.line()), e))
    }
}
