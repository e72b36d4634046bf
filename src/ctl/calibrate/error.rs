//! Why nothing was measured or saved, with the next step.

use crate::ctl::error::CtlError;
use std::io;
use std::path::PathBuf;
use thiserror::Error;

/// Why nothing was measured or saved.
#[derive(Debug, Error)]
pub enum CalibrateError {
    /// The daemon gives no attitude, or one with something wrong.
    #[error("the daemon is {0}: only a nominal attitude is averaged; see irhorizonctl status")]
    Withheld(String),
    /// It gives one that is not sure enough.
    #[error(
        "the daemon's standard deviation is {sigma_deg:.1}°, more than {limit_deg}°: wait a minute, or find a freer view"
    )]
    Uncertain {
        /// The larger one of roll and pitch, °.
        sigma_deg: f64,
        /// The limit, °.
        limit_deg: f64,
    },
    /// It moves, or the scene does.
    #[error(
        "{what} changed by {range:.2}{unit} meanwhile, more than {limit}: keep still and try again, or longer: --seconds"
    )]
    Moving {
        /// What changed.
        what: String,
        /// By how much.
        range: f64,
        /// The limit.
        limit: f64,
        /// The unit of both.
        unit: &'static str,
    },
    /// A trim too large for one.
    #[error(
        "the trim would be {trim_deg:.1}°, more than {limit_deg}°: is the aircraft level, are the directions of the sensors right?"
    )]
    NotLevel {
        /// The larger one of roll and pitch, °.
        trim_deg: f64,
        /// The limit, °.
        limit_deg: f64,
    },
    /// Too few measurements came.
    #[error("too few measurements came: see irhorizonctl doctor, or try longer: --seconds")]
    TooFew,
    /// It is not known well enough.
    #[error("{what} is known to ±{error:.2} K, not to {limit}: keep it covered and still, or try longer: --seconds")]
    Unsure {
        /// What.
        what: String,
        /// Its standard error, K.
        error: f64,
        /// The limit, K.
        limit: f64,
    },
    /// Sensors see different things.
    #[error(
        "{sensor} shows {apart:+.1} K against the others, more than ±{limit}: does all of the head see the same, and does \
         nothing warm touch it?"
    )]
    NotCovered {
        /// Which.
        sensor: String,
        /// How far apart, K.
        apart: f64,
        /// The limit, K.
        limit: f64,
    },
    /// There is no analogue pair, and nothing to compare digital sensors with.
    #[error(
        "the configuration has no ads1115, and no two mlx90614 to compare: there is nothing neutral to be measured"
    )]
    NothingNeutral,
    /// A sensor gives nothing.
    #[error("{sensor} gives nothing ({why}); see irhorizonctl sensors")]
    Silent {
        /// Which.
        sensor: String,
        /// Why.
        why: String,
    },
    /// Another drop-in says otherwise, later.
    #[error(
        "a drop-in that is read after {0} sets the same: take that out first; irhorizonctl validate lists the files"
    )]
    Overruled(PathBuf),
    /// The user does not want it.
    #[error("nothing was measured; answer y, or give --yes")]
    Declined,
    /// The user could not be asked.
    #[error("nobody can be asked; give --yes")]
    Ask(#[source] io::Error),
    /// There is nothing to bring back.
    #[error("nothing is kept beside {0} to be brought back")]
    NothingToUndo(PathBuf),
    /// It is saved, and the daemon goes on with what it had.
    #[error("it is saved, but the daemon has not taken it up; sudo systemctl reload irhorizond")]
    NotReloaded(#[source] Box<CtlError>),
    /// The daemon has reloaded, and does not go by it.
    #[error(
        "{0} holds it now, but the daemon goes by other trims or sensors: it reads another configuration (give --config \
         what irhorizond is started with), or settings kept from MAVLink parameters overrule it (irhorizond's log names \
         their file)"
    )]
    OtherConfiguration(PathBuf),
}
