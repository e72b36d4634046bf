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

    /// The attitude in which the upward vertical is `vertical` on (nose, left, up), of any length; roll is 0 where
    /// there is none to tell, straight up or down.
    pub fn from_vertical([nose, left, up]: [f64; 3]) -> Self {
        Self { roll: left.atan2(up), pitch: nose.atan2(left.hypot(up)) }
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
    /// The attitude cannot be trusted: it is withheld, or what is shown in its place is not measured.
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

/// Something warm above the horizon to one side: a ridge, a cloud bank (report section V: the positive side of
/// what misleads the attitude).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hint {
    /// Where, rad clockwise from the nose, in (−π, π].
    pub bearing: f64,
    /// How much warmer than the opposite side it is, K.
    pub strength_k: f64,
}

/// What the daemon says after a frame.
///
/// `attitude` is `None` while it must not be used: while `mode` is `starting`, and while it is `faulted` unless
/// something is shown in its place (`on-fault = "level"`).
#[derive(Debug, Default, PartialEq)]
pub struct Estimate {
    /// The newest successful conversion that went into it.
    pub time: Time,
    /// The moment that the attitude speaks of, and what tells a new one from the last: `time`, or the frame's time
    /// for an attitude that stands in for a measured one.
    pub valid_at: Time,
    /// Roll and pitch, or nothing while they are withheld.
    pub attitude: Option<Attitude>,
    /// Whether that was measured at `valid_at`, and does not stand in for one that is withheld.
    pub measured: bool,
    /// Standard deviations of roll and pitch, rad; meaningful only beside an attitude.
    pub sigma: Attitude,
    /// Body rates about x (nose), y (right), z (down), rad/s; `None` where they are not known.
    pub rates: Option<[f64; 3]>,
    /// What was learnt in flight of the head's mounting, beyond the configured trim, rad: taken off already.
    pub trim: Attitude,
    /// The ground's temperature less the zenith's, as the vertical pair sees it, K; `None` before
    /// it was first seen.
    pub contrast_k: Option<f64>,
    /// What each sensor shows beyond what attitude and sky explain, K, in the head's order; `None` where the method
    /// has none to tell.
    pub residuals_k: Vec<Option<f64>>,
    /// A warm obstacle beside, where that can be told.
    pub hint: Option<Hint>,
    /// How far to trust it.
    pub mode: Mode,
    /// What speaks against it, in the vocabulary's order.
    pub faults: Vec<ActiveFault>,
}

/// Copying one estimate over another allocates nothing once there was room for as many faults.
impl Clone for Estimate {
    fn clone(&self) -> Self {
        Self { faults: self.faults.clone(), residuals_k: self.residuals_k.clone(), ..*self }
    }

    fn clone_from(&mut self, other: &Self) {
        let mut faults = std::mem::take(&mut self.faults);
        faults.clone_from(&other.faults);
        let mut residuals_k = std::mem::take(&mut self.residuals_k);
        residuals_k.clone_from(&other.residuals_k);
        *self = Self { faults, residuals_k, ..*other };
    }
}
