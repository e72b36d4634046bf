//! The words of the commands that set a head up and look after it.

use super::cli::DEFAULT_CONFIG;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// Arguments of `doctor`.
#[derive(Clone, Debug, Args)]
pub struct DoctorArgs {
    /// The configuration
    #[arg(default_value = DEFAULT_CONFIG)]
    pub file: PathBuf,
    /// One JSON object
    #[arg(long)]
    pub json: bool,
}

impl DoctorArgs {
    /// What its exit codes mean.
    pub const EXIT_CODES: &str = "Exit codes: 0 no failure, be there warnings or not; 1 a failure.";
}

/// Arguments of `wait-ready`.
#[derive(Clone, Copy, Debug, Args)]
pub struct WaitArgs {
    /// How long to wait; 0: one look
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0, value_parser = patience)]
    pub timeout: f64,
    /// What counts as ready
    #[arg(long, value_enum, default_value_t)]
    pub mode: ReadyMode,
}

impl WaitArgs {
    /// What its exit codes mean.
    pub const EXIT_CODES: &str = "Exit codes: 0 ready; 1 not ready in time; 3 no daemon answered in time.";
}

/// What `wait-ready` waits for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum ReadyMode {
    /// Attitude, and nothing wrong
    #[default]
    Nominal,
    /// Attitude, be it degraded
    Degraded,
}

impl ReadyMode {
    /// Whether a daemon in `mode` is ready.
    pub fn is_met_by(self, mode: &str) -> bool {
        mode == "nominal" || (self == Self::Degraded && mode == "degraded")
    }
}

/// Whose completions are printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Shell {
    /// For bash-completion
    Bash,
    /// For compinit
    Zsh,
    /// For fish
    Fish,
}

impl Shell {
    /// What writes them.
    pub fn generator(self) -> clap_complete::Shell {
        match self {
            Self::Bash => clap_complete::Shell::Bash,
            Self::Zsh => clap_complete::Shell::Zsh,
            Self::Fish => clap_complete::Shell::Fish,
        }
    }
}

fn patience(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(s) if (0.0..=1e9).contains(&s) => Ok(s),
        _ => Err("expected seconds, 0 or more".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patience_is_a_number_of_seconds() {
        assert_eq!((patience("0"), patience("2.5")), (Ok(0.0), Ok(2.5)));
        for bad in ["-1", "nan", "inf", "", "soon"] {
            assert!(patience(bad).is_err(), "{bad}");
        }
    }
}
