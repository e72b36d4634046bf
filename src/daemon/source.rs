//! Which source of frames a configuration asks for.

use crate::clock;
use crate::config::Settings;
use crate::head::Head;
use crate::sensor::hardware::HardwareSource;
use crate::simulation::SimulatedSource;
use crate::sky::FieldOfView;
use crate::source::FrameSource;

/// Errors when the sensors cannot be read in the time that the rate leaves, or cannot share an address. [`open`] does so
/// too, and needs the buses and lines to be free.
pub fn check(settings: &Settings, head: &Head) -> Result<(), String> {
    if settings.simulation.is_some() {
        return Ok(());
    }
    HardwareSource::check(settings, head).map_err(|e| e.to_string())
}

/// The simulated flight where one is configured, the hardware otherwise.
///
/// Errors as [`check`] does. Hardware that is absent is no error: it may come, and until then its faults say what is missing.
pub fn open(settings: &Settings, head: &Head) -> Result<Box<dyn FrameSource>, String> {
    match &settings.simulation {
        Some(simulation) => {
            let field = FieldOfView::Gaussian { fwhm_deg: settings.head.field_of_view_deg };
            log::info!("simulated flight: no hardware is read, the attitude is made up");
            for fault in &simulation.faults {
                log::info!("simulated fault: {fault}");
            }
            // With it and the seed another program flies the same flight at the same time.
            let origin = clock::now();
            log::debug!("the simulated flight begins at {} µs of CLOCK_BOOTTIME", origin.as_micros());
            Ok(Box::new(SimulatedSource::new(simulation, head, field).with_origin(origin)))
        }
        None => Ok(Box::new(HardwareSource::open(settings, head).map_err(|e| e.to_string())?)),
    }
}
