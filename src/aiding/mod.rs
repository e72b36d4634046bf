//! What an autopilot says beside the thermopiles, brought to the frames that it belongs to.
//!
//! - [`inbox`]: from the thread that hears to the one that samples;
//! - [`rates`]: body rates against time, [`foresight`]: and what follows the newest of them; pure;
//! - [`carry`]: an attitude turned on by body rates; pure;
//! - [`align`]: frames held back until the rates of their time are there; pure;
//! - [`compare`]: the autopilot's attitude beside ours, for show alone; pure.

pub mod align;
pub mod carry;
pub mod compare;
pub mod foresight;
pub mod inbox;
pub mod rates;

pub use align::Aligner;
pub use inbox::Inbox;

use crate::attitude::Attitude;
use crate::frame::Aiding;
use crate::time::Time;

/// Something that the autopilot said.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Said {
    /// The moment that it speaks of, on our clock; never after `arrived`.
    pub time: Time,
    /// When it arrived.
    pub arrived: Time,
    /// What it says.
    pub what: What,
}

/// What an autopilot says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum What {
    /// Body rates about x (nose), y (right), z (down), °/s.
    Rates([f64; 3]),
    /// Its attitude, and where its nose points, rad clockwise from north. Never used for ours.
    Attitude(Attitude, f64),
    /// GPS, airspeed, climb: everything but rates.
    Slow(Aiding),
}

/// How the autopilot is heard.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Link {
    /// Its system id; `None` before it was heard.
    pub system: Option<u8>,
    /// When a message of it arrived last.
    pub heard: Time,
    /// Whether what it says is to aid the attitude, and not only to be shown.
    pub aids: bool,
    /// Body rates, fixes and airspeeds a second.
    pub rates_hz: f64,
    /// See `rates_hz`.
    pub gps_hz: f64,
    /// See `rates_hz`.
    pub airspeed_hz: f64,
    /// Whether its clock is known by TIMESYNC, and not only by when its messages arrive.
    pub synced: bool,
}

/// The autopilot as it is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Autopilot {
    /// How it is heard.
    pub link: Link,
    /// How old its body rates are when they arrive, s; `None` while there are none.
    pub late_s: Option<f64>,
    /// Whether they are used.
    pub used: bool,
    /// Its roll and pitch less ours, over the last second or so, rad.
    pub differs: Option<Attitude>,
    /// Its newest attitude, rad, and where its nose points, rad clockwise from north.
    pub attitude: Option<(Attitude, f64)>,
}
