//! What can go wrong with a line, with the user's next step.

use std::fmt;
use std::path::{Path, PathBuf};

/// Why a line cannot be had or used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum GpioError {
    /// No chip has that label, name or path.
    NoChip {
        /// What was asked for.
        wanted: String,
        /// Those that exist: "label (name)".
        present: Vec<String>,
    },
    /// Several chips have that label.
    Ambiguous {
        /// What was asked for.
        wanted: String,
        /// Their paths.
        paths: Vec<PathBuf>,
    },
    /// The chip has no line with that offset.
    NoLine {
        /// The chip's label.
        chip: String,
        /// The offset asked for.
        line: u32,
        /// How many lines it has.
        lines: u32,
    },
    /// Another program or the kernel holds the line.
    Busy {
        /// The chip's label.
        chip: String,
        /// The line's offset.
        line: u32,
        /// Who holds it, as it calls itself.
        consumer: String,
    },
    /// The chip may not be opened.
    Denied(PathBuf),
    /// Anything else.
    Failed {
        /// What was tried.
        tried: &'static str,
        /// On what.
        on: String,
        /// What the system said.
        cause: String,
    },
}

impl GpioError {
    pub(super) fn failed(tried: &'static str, on: impl fmt::Display, cause: impl fmt::Display) -> Self {
        Self::Failed { tried, on: on.to_string(), cause: cause.to_string() }
    }

    /// A chip at `path` that could not be opened.
    pub(super) fn opening(path: &Path, cause: &gpio_cdev::Error) -> Self {
        use std::error::Error;
        let kind = cause.source().and_then(|s| s.downcast_ref::<std::io::Error>()).map(std::io::Error::kind);
        match kind {
            Some(std::io::ErrorKind::PermissionDenied) => Self::Denied(path.to_owned()),
            Some(std::io::ErrorKind::NotFound) => {
                Self::NoChip { wanted: path.display().to_string(), present: Vec::new() }
            }
            _ => Self::failed("opening", path.display(), cause),
        }
    }
}

impl fmt::Display for GpioError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoChip { wanted, present } if present.is_empty() => {
                write!(f, "no GPIO chip {wanted:?}: there is none that can be seen; see gpiodetect")
            }
            Self::NoChip { wanted, present } => {
                write!(f, "no GPIO chip {wanted:?}: there are {}", present.join(", "))
            }
            Self::Ambiguous { wanted, paths } => {
                let paths: Vec<_> = paths.iter().map(|p| p.display().to_string()).collect();
                write!(f, "several GPIO chips are {wanted:?}: name one of {}", paths.join(", "))
            }
            Self::NoLine { chip, line, lines: 0 } => write!(f, "GPIO chip {chip:?} has no line {line}: it has none"),
            Self::NoLine { chip, line, lines } => {
                write!(f, "GPIO chip {chip:?} has no line {line}: its lines are 0 to {}", lines - 1)
            }
            Self::Busy { chip, line, consumer } => {
                write!(f, "line {line} of GPIO chip {chip:?} is in use by {consumer:?}: see gpioinfo")
            }
            Self::Denied(path) => write!(
                f,
                "{} may not be opened: give its group to the user, for one by the udev rule that ships with irhorizon",
                path.display()
            ),
            Self::Failed { tried, on, cause } => write!(f, "{tried} {on}: {cause}"),
        }
    }
}

impl std::error::Error for GpioError {}
