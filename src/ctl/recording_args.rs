//! The words of the commands that work on recordings.

use crate::config::settings::Method;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// A recording on its way through the daemon's pipeline.
#[derive(Clone, Debug, Args)]
pub struct RecordingArgs {
    /// The recording
    pub file: PathBuf,
    /// The configuration; the recording's own when not given, or else the six directions
    #[arg(long)]
    pub config: Option<PathBuf>,
    /// Use the thermopiles alone
    #[arg(long)]
    pub no_aiding: bool,
}

/// Which method of estimation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MethodChoice {
    /// Every one that the head allows.
    All,
    /// This one.
    One(Method),
}

/// Another program's estimates.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Beside {
    /// What they are called.
    pub name: String,
    /// A file with the columns that `replay` writes.
    pub path: PathBuf,
}

/// How `score` speaks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum ScoreFormat {
    /// A table
    #[default]
    Plain,
    /// One JSON object
    Json,
}

/// Arguments of `score`.
#[derive(Clone, Debug, Args)]
pub struct ScoreArgs {
    /// What is scored.
    #[command(flatten)]
    pub recording: RecordingArgs,
    /// A method, or all that the head allows; may be given again; the configured one when not given
    #[arg(long = "method", value_name = "METHOD", value_parser = method)]
    pub methods: Vec<MethodChoice>,
    /// Estimates of another program to score beside, with replay's columns; may be given again
    #[arg(long, value_name = "NAME=OUT.csv", value_parser = beside)]
    pub beside: Vec<Beside>,
    /// Leave out the first seconds
    #[arg(long, value_name = "SECONDS", default_value = "10", value_parser = not_negative)]
    pub skip: f64,
    /// Leave out rows at this ground speed or below, m/s, and those before one is known
    #[arg(long, value_name = "M_S", value_parser = not_negative)]
    pub min_ground_speed: Option<f64>,
    /// How to say it
    #[arg(long, value_enum, default_value_t)]
    pub format: ScoreFormat,
}

fn method(text: &str) -> Result<MethodChoice, String> {
    if text == "all" {
        return Ok(MethodChoice::All);
    }
    let names: Vec<&str> = Method::NAMED.iter().map(|(name, _)| *name).collect();
    let found = Method::NAMED.iter().find(|(name, _)| *name == text);
    found.map(|(_, m)| MethodChoice::One(*m)).ok_or_else(|| format!("expected all or one of {}", names.join(", ")))
}

fn beside(text: &str) -> Result<Beside, String> {
    match text.split_once('=') {
        Some((name, path)) if !name.is_empty() && !path.is_empty() => {
            Ok(Beside { name: name.to_owned(), path: path.into() })
        }
        _ => Err("expected a name and a file such as other=out.csv".to_owned()),
    }
}

fn not_negative(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(v) if (0.0..=1e9).contains(&v) => Ok(v),
        _ => Err("expected a number, 0 or more".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_checked() {
        assert_eq!(method("all"), Ok(MethodChoice::All));
        for (name, m) in Method::NAMED {
            assert_eq!(method(name), Ok(MethodChoice::One(m)));
        }
        assert!(method("sine").unwrap_err().contains("inverse-sine"));
        assert_eq!(beside("a=b=c.csv"), Ok(Beside { name: "a".into(), path: "b=c.csv".into() }));
        for bad in ["a", "=b", "a="] {
            assert!(beside(bad).is_err(), "{bad}");
        }
        assert_eq!(not_negative("0"), Ok(0.0));
        for bad in ["-1", "nan", "inf", "1e99", "x", ""] {
            assert!(not_negative(bad).is_err(), "{bad}");
        }
    }
}
