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

/// Arguments of `set-address`.
#[derive(Clone, Debug, Args)]
pub struct SetAddressArgs {
    /// The address that it is to have, 0x08 to 0x77: I²C reserves the others
    #[arg(value_parser = address)]
    pub new: u8,
    /// The bus that it is on, alone among MLX90614
    #[arg(long, value_name = "DEVICE", default_value = "/dev/i2c-1")]
    pub i2c_bus: PathBuf,
    /// Ask nothing
    #[arg(long)]
    pub yes: bool,
    /// Do not check what is read: for a part that is known to send a wrong PEC
    #[arg(long)]
    pub no_read_pec: bool,
}

/// Arguments of `calibrate`.
#[derive(Clone, Debug, Args)]
pub struct CalibrateArgs {
    /// What is measured
    #[arg(value_enum, default_value_t)]
    pub what: Quantity,
    /// The configuration whose drop-ins it is saved among
    #[arg(long, value_name = "FILE", default_value = DEFAULT_CONFIG)]
    pub config: PathBuf,
    /// How long to average
    #[arg(long, value_name = "SECONDS", default_value_t = 10.0, value_parser = averaged, allow_negative_numbers = true)]
    pub seconds: f64,
    /// Say what would be saved, and save nothing
    #[arg(long)]
    pub dry_run: bool,
    /// Bring back what held before the last one
    #[arg(long, conflicts_with = "dry_run")]
    pub undo: bool,
    /// Ask nothing
    #[arg(long)]
    pub yes: bool,
}

/// What `calibrate` measures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Quantity {
    /// The trims of roll and pitch, with the aircraft level outdoors
    #[default]
    Level,
    /// What each pair, or digital sensor, shows when all sides are the same, with the head covered
    Neutral,
}

/// Arguments of `wait-ready`.
#[derive(Clone, Copy, Debug, Args)]
pub struct WaitArgs {
    /// How long to wait; 0: one look
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0, value_parser = patience, allow_negative_numbers = true)]
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

fn averaged(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(s) if (2.0..=600.0).contains(&s) => Ok(s),
        _ => Err("expected seconds, 2 to 600".to_owned()),
    }
}

fn address(text: &str) -> Result<u8, String> {
    let number = match text.strip_prefix("0x").or_else(|| text.strip_prefix("0X")) {
        Some(digits) => u8::from_str_radix(digits, 16),
        None => text.parse(),
    };
    match number {
        Ok(a @ 0x08..=0x77) => Ok(a),
        _ => Err("expected a 7-bit address such as 0x5b, from 0x08 to 0x77: I²C reserves the others".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_has_seven_bits() {
        assert_eq!((address("0x5b"), address("0X08"), address("119")), (Ok(0x5b), Ok(8), Ok(0x77)));
        for bad in ["0x02", "0x03", "0x07", "0x78", "0", "5b", "-1", "0xfff", "", "0x", "+5x"] {
            assert!(address(bad).is_err(), "{bad}");
        }
        assert_eq!(averaged("2"), Ok(2.0));
        for bad in ["1", "nan", "1e9", ""] {
            assert!(averaged(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn patience_is_a_number_of_seconds() {
        assert_eq!((patience("0"), patience("2.5")), (Ok(0.0), Ok(2.5)));
        for bad in ["-1", "nan", "inf", "", "soon"] {
            assert!(patience(bad).is_err(), "{bad}");
        }
    }
}
