//! From frames to attitude. Pure: time comes with the frame; the same frames give the same bytes.
//!
//! - [`inverse_sine`]: the report's scheme (section IV.B), the baseline of every comparison;
//! - [`profile`]: three pairs or more, inverted through the sky's shape;
//! - [`contrast_vector`]: pairs in any direction, solved for one vector;
//! - [`field`]: every sensor by itself, the sky estimated together with the attitude;
//! - [`trim`]: how the head is mounted, learnt in flight from slow references;
//! - [`flying`]: what the readers of slow references share;
//! - [`guard`]: where in doubt, to the safe side;
//! - [`references`]: what GPS and airspeed say: the bank of a coordinated turn, the angle of climb, the heading;
//! - [`wind`]: the wind, and how far the airspeed is off;
//! - [`sides`]: which side is up; [`wiring`]: the ways to wire a head;
//! - [`range`]: the low-pass filter of the adaptive range;
//! - [`suits`]: which heads each method works with;
//! - [`whiteness`]: how much moves, learnt from innovations;
//! - [`vector`], [`normal`], [`noise`]: three components, least squares over directions, and the noise that every σ
//!   assumes.
//!
//! A method is an [`Estimator`]; [`crate::horizon`] runs it beside the fault detectors.

pub mod contrast_vector;
pub mod field;
pub mod flying;
pub mod guard;
pub mod inverse_sine;
pub mod linear;
pub mod noise;
pub mod normal;
pub mod profile;
pub mod range;
pub mod references;
pub mod sides;
pub mod suits;
pub mod trim;
pub mod vector;
pub mod whiteness;
pub mod wind;
pub mod wiring;

pub use field::FieldEstimator;
pub use inverse_sine::InverseSineEstimator;
pub use profile::ProfileEstimator;

use crate::attitude::{Attitude, Hint};
use crate::frame::Frame;
use field::MAX_SENSORS;
use vector::Vector;

/// What a level pair of 90° shows for a radian of tilt, as a share of the contrast.
pub const PAIR_SLOPE: f64 = 1.1;

/// By how much the attitude may be off, rad, with this upward vertical, where one side is warmer and nothing shows it: by
/// the 2° that the horizon may lean.
///
/// Three pairs fit some attitude whatever they see: nothing is left over that would tell of clouds or of a warm side.
pub fn unseen_lean([_, left, up]: Vector) -> Attitude {
    const LEAN: f64 = 0.035;
    Attitude { roll: LEAN / left.hypot(up).max(0.2), pitch: LEAN }
}

/// Whether a method makes use of a sensor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Standing {
    /// It is heard.
    #[default]
    Heard,
    /// Others contradict it: not heard until that is decided.
    Doubted,
    /// It is not heard until it has long been in accord with the others.
    LeftOut,
    /// It repeats itself while it should change.
    Stuck,
}

/// What a method makes of one sensor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Hearing {
    /// Whether it is heard.
    pub standing: Standing,
    /// What the other sensors say that it should show, °C or K; `None` where that is not known.
    pub expected_k: Option<f64>,
    /// What it shows beyond what attitude and sky explain, K.
    pub residual_k: Option<f64>,
    /// How much of what it should show it does not follow, 0..1; `None` where it is heard, or nothing has changed since.
    pub lost: Option<f64>,
}

/// What a method makes of a frame, before the fault detectors have had their say.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Solution {
    /// Roll and pitch, trims not yet taken off; `None` where the method has none to give.
    pub attitude: Option<Attitude>,
    /// Standard deviations of roll and pitch, rad.
    pub sigma: Attitude,
    /// The contrast that scaled the angles, K; `None` before it was first seen.
    pub contrast_k: Option<f64>,
    /// The components of the contrast vector on (nose, left, up) as seen in this frame alone, K.
    pub seen_k: Option<[f64; 3]>,
    /// Each sensor by itself, in the head's order, for methods that hear them one by one.
    pub sensors: [Hearing; MAX_SENSORS],
    /// The tilt that a scene unlike a horizon may hide, rad; `None` where the method cannot tell.
    pub hidden: Option<f64>,
    /// Something warm beside, where that can be told.
    pub hint: Option<Hint>,
    /// The head as it would be wired for a gyro to be right that turns otherwise than is seen; `None` where the gyro turns as
    /// is seen, or no way to wire the head explains how it turns.
    pub wired: Option<Otherwise>,
}

/// What is said of a head that turns the other way round, with left and right exchanged, or about another axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Otherwise {
    /// The attitude if it is wired so, trims not yet taken off.
    pub attitude: Attitude,
    /// Whether roll and whether pitch is another then.
    pub angles: [bool; 2],
    /// The share of the squares of what turns that is left, the head as it is configured; of one that turns the other way
    /// round, 4.
    pub left: f64,
}

/// A method of estimation.
pub trait Estimator: Send {
    /// Takes in a frame, gives what can be said after it.
    fn update(&mut self, frame: &Frame) -> Solution;

    /// The roll and pitch that the head shows in level flight: how body rates lie to its axes.
    fn set_trim(&mut self, _trim: Attitude) {}

    /// The sensors' first-order time constant, s, for methods that make use of it; one that is not
    /// finite or not in 0..=5 changes nothing.
    fn set_lag_s(&mut self, _lag_s: f64) {}

    /// Whether it hears a gyro and tells whether that turns as is seen.
    fn judges_rates(&self) -> bool {
        false
    }

    /// What is to be added to the gyro's body rates, rad/s on (nose, left, up): minus its bias, where that is known. `None`
    /// where a gyro is not believed, and for methods that cannot tell.
    fn rate_correction(&self) -> Option<Vector> {
        None
    }

    /// How fast the head turned after the last frame, rad/s on its (nose, left, up); `None` for methods that do not know.
    fn rates(&self) -> Option<Vector> {
        None
    }
}
