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

/// An output whose GPIO chip may come and go: it is requested again where it is not there or fails.
#[derive(Debug)]
pub struct PlugInLine {
    settings: LineSettings,
    line: Option<OutputLine>,
}

impl PlugInLine {
    /// Requested when it is first switched.
    pub fn new(settings: &LineSettings) -> Self {
        Self { settings: settings.clone(), line: None }
    }
}

impl Switch for PlugInLine {
    fn set(&mut self, on: bool) -> Result<(), GpioError> {
        let line = match self.line.take() {
            None => OutputLine::open(&self.settings, on)?,
            Some(mut line) => match line.set(on) {
                Ok(()) => line,
                Err(_) => {
                    // The chip has one line for one handle.
                    drop(line);
                    OutputLine::open(&self.settings, on)?
                }
            },
        };
        self.line = Some(line);
        Ok(())
    }
}
