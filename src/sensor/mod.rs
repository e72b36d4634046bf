//! The chips that thermopiles are read by.
//!
//! A [`Chip`] is one address on one bus with one or more of the head's sensors behind it. The
//! hardware source walks over the chips along its schedule.
//!
//! - [`ads1115`]: an ADC for amplified pairs.
//! - [`hardware`]: the chips as a source of frames.
//! - [`mlx90614`]: the digital thermopile.
//! - [`power`], [`recovery`]: what is done about chips that fail, step by step.
//! - [`schedule`]: when in a scan each sensor is read.

pub mod ads1115;
pub mod hardware;
pub mod mlx90614;
pub mod power;
pub mod recovery;
pub mod schedule;

use crate::bus::BusError;
use crate::frame::Reading;
use crate::source::SensorHealth;

/// One address on one bus, with one or more of the head's sensors behind it.
pub trait Chip: Send {
    /// Opens the device and prepares the chip: identity, settling, packet error code. Called at
    /// start and again after the chip or its bus was lost; takes at most a few transfers.
    fn open(&mut self) -> Result<(), BusError>;

    /// Lets go of the device file, so that an adapter can be removed.
    fn close(&mut self);

    /// Begins a scan: an ADC starts its first conversion here, so that several run side by side.
    fn begin(&mut self) {}

    /// Reads sensor `slot` (0 for the chip's first). One bounded attempt: trying again is the
    /// caller's decision. The reading is stamped with the end of the transfer that succeeded.
    fn read(&mut self, slot: usize) -> Reading;

    /// Does what is done rarely, at most one transfer: an MLX90614 reads its die temperature.
    /// Called at the end of a scan, of one chip at most, and of each about once a second.
    fn housekeep(&mut self) {}

    /// What is known of sensor `slot`.
    fn health(&self, slot: usize) -> SensorHealth;
}
