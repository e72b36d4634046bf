//! Attitude and what is said about it: standard deviation, mode, faults.

use crate::fault::ActiveFault;
use crate::time::Time;
use std::fmt;

/// Roll and pitch, radians. Roll is positive right wing down, in (−π, π]; pitch positive nose up,
/// in [−π/2, π/2].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Attitude {
    /// Roll, rad.
    pub roll: f64,
    /// Pitch, rad.
    pub pitch: f64,
}

impl Attitude {
    /// From degrees.
    pub fn from_degrees(roll_deg: f64, pitch_deg: f64) -> Self {
        Self { roll: roll_deg.to_radians(), pitch: pitch_deg.to_radians() }
    }

    /// The upward vertical on the axes (nose, left, up): `(sin θ, sin φ cos θ, cos φ cos θ)`.
    pub fn vertical(self) -> [f64; 3] {
        let (sr, cr) = self.roll.sin_cos();
        let (sp, cp) = self.pitch.sin_cos();
        [sp, sr * cp, cr * cp]
    }
}

/// How far the published attitude may be trusted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// Not enough has been seen yet; attitude withheld.
    #[default]
    Starting,
    /// Every sensor contributes and nothing speaks against the attitude.
    Nominal,
    /// The attitude stands, with less behind it than was configured.
    Degraded,
    /// The attitude cannot be trusted and is withheld.
    Faulted,
}

impl Mode {
    /// The word used on D-Bus, in recordings and in `status`.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Starting => "starting",
            Self::Nominal => "nominal",
            Self::Degraded => "degraded",
            Self::Faulted => "faulted",
        }
    }
}

impl fmt::Display for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

/// What the daemon says after a frame.
///
/// `attitude` is `None` exactly while it must not be used: while `mode` is `starting` or `faulted`.
#[derive(Debug, Default, PartialEq)]
pub struct Estimate {
    /// The newest successful conversion that went into it.
    pub time: Time,
    /// Roll and pitch, or nothing while they are withheld.
    pub attitude: Option<Attitude>,
    /// Standard deviations of roll and pitch, rad; meaningful only beside an attitude.
    pub sigma: Attitude,
    /// What was learnt in flight of the head's mounting, beyond the configured trim, rad: taken off already.
    pub trim: Attitude,
    /// The ground's temperature less the zenith's, as the vertical pair sees it, K; `None` before
    /// it was first seen.
    pub contrast_k: Option<f64>,
    /// How far to trust it.
    pub mode: Mode,
    /// What speaks against it, in the vocabulary's order.
    pub faults: Vec<ActiveFault>,
}

/// Copying one estimate over another allocates nothing once there was room for as many faults.
impl Clone for Estimate {
    fn clone(&self) -> Self {
        Self { faults: self.faults.clone(), ..*self }
    }

    fn clone_from(&mut self, other: &Self) {
        let mut faults = std::mem::take(&mut self.faults);
        faults.clone_from(&other.faults);
        *self = Self { faults, ..*other };
    }
}
