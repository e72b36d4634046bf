//! The words of the commands that work on recordings.

use crate::config::settings::Method;
use clap::{Args, Subcommand, ValueEnum};
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
    #[arg(long, value_name = "SECONDS", default_value = "10", value_parser = not_negative, allow_negative_numbers = true)]
    pub skip: f64,
    /// Leave out rows at this ground speed or below, m/s, and those before one is known
    #[arg(long, value_name = "M_S", value_parser = not_negative, allow_negative_numbers = true)]
    pub min_ground_speed: Option<f64>,
    /// How to say it
    #[arg(long, value_enum, default_value_t)]
    pub format: ScoreFormat,
}

/// What `plot` draws.
#[derive(Clone, Debug, Subcommand)]
pub enum PlotCommand {
    /// A flight over time: roll, pitch, contrast, mode, faults
    Flight(PlotArgs),
    /// The errors of roll and pitch against the reference
    Residuals(PlotArgs),
    /// Figures 6 to 9 of the report MECSE-2-2007, from this program's own sky
    Report {
        /// Where figure-6.svg to figure-9.svg go
        #[arg(long, value_name = "FOLDER")]
        output_dir: PathBuf,
    },
}

/// Arguments of `plot flight` and `plot residuals`.
#[derive(Clone, Debug, Args)]
pub struct PlotArgs {
    /// What is drawn.
    #[command(flatten)]
    pub recording: RecordingArgs,
    /// The method; the configured one when not given
    #[arg(long, value_parser = one_method)]
    pub method: Option<Method>,
    /// Where the drawing goes; standard output when not given
    #[arg(long, value_name = "OUT.svg")]
    pub output: Option<PathBuf>,
    /// Begin at this time of the recording, s
    #[arg(long, value_name = "S", value_parser = not_negative, allow_negative_numbers = true)]
    pub from: Option<f64>,
    /// End at this time of the recording, s
    #[arg(long, value_name = "S", value_parser = not_negative, allow_negative_numbers = true)]
    pub to: Option<f64>,
}

fn method(text: &str) -> Result<MethodChoice, String> {
    if text == "all" { Ok(MethodChoice::All) } else { one_method(text).map(MethodChoice::One) }
}

fn one_method(text: &str) -> Result<Method, String> {
    let names: Vec<&str> = Method::NAMED.iter().map(|(name, _)| *name).collect();
    let found = Method::NAMED.iter().find(|(name, _)| *name == text);
    found.map(|(_, m)| *m).ok_or_else(|| format!("expected one of {}", names.join(", ")))
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
