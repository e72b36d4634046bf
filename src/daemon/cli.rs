//! The daemon's command line.

use clap::{Parser, ValueEnum};
use log::LevelFilter;
use std::path::PathBuf;

/// Where the configuration is when the command line does not say.
pub const DEFAULT_CONFIG: &str = "/etc/irhorizon/irhorizon.toml";

/// Attitude from the infrared horizon: thermopiles in, MAVLink and D-Bus out.
#[derive(Clone, Debug, Parser)]
#[command(name = "irhorizond", version, about, max_term_width = 100)]
pub struct Cli {
    /// The configuration; drop-ins are read from FILE.d/*.toml
    #[arg(long, short, value_name = "FILE", default_value = DEFAULT_CONFIG)]
    pub config: PathBuf,

    /// How much is logged
    #[arg(long, value_enum, default_value = "info")]
    pub log_level: Level,
}

/// How much is logged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Level {
    /// What must be acted on.
    Error,
    /// And what should be looked at.
    Warn,
    /// And what happened.
    Info,
    /// And how.
    Debug,
}

impl From<Level> for LevelFilter {
    fn from(level: Level) -> Self {
        match level {
            Level::Error => Self::Error,
            Level::Warn => Self::Warn,
            Level::Info => Self::Info,
            Level::Debug => Self::Debug,
        }
    }
}
