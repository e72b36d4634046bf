//! A recording through the schemes that others have published:
//! `cargo bench --bench baselines -- FILE [--config C] DIRECTORY` writes `DIRECTORY/NAME.csv` for each,
//! in the columns of `irhorizonctl replay`, for `irhorizonctl score --beside`. `benches/score` does both.
//!
//! The head's trim is taken off as it is off our own; standard deviation and contrast stay empty.

mod replayed;
mod schemes;

use clap::Parser;
use irhorizon::attitude::{Attitude, Estimate};
use irhorizon::config::Settings;
use irhorizon::ctl::error::chain;
use irhorizon::ctl::kit::{Cause, Kit};
use irhorizon::ctl::replay::{Stop, replay};
use irhorizon::frame::Frame;
use irhorizon::recording::Recording;
use schemes::Baseline;
use std::fs::{self, File};
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Runs a recording through the schemes that others have published.
#[derive(Debug, Parser)]
#[command(name = "baselines")]
struct Args {
    /// The recording
    #[arg(requires = "directory")]
    file: Option<PathBuf>,
    /// Where NAME.csv is written for each scheme; made when it is not there
    directory: Option<PathBuf>,
    /// The configuration of the head; without it the recording's own, or the six named sensors
    #[arg(long)]
    config: Option<PathBuf>,
    /// What `cargo bench` adds by itself
    #[arg(long, hide = true)]
    bench: bool,
}

/// The settings that `replay` would go by.
fn settings(file: &Path, config: Option<&Path>) -> Result<Settings, Cause> {
    match (config, Recording::open(file)?.config()) {
        (Some(path), _) => (Kit::REAL.load_for_replay)(path),
        (None, Some(text)) => (Kit::REAL.parse)(text).or_else(|_| (Kit::REAL.defaults)()),
        (None, None) => (Kit::REAL.defaults)(),
    }
}

/// Writes what `baseline` makes of the recording; gives the number of frames.
fn run(baseline: &mut dyn Baseline, file: &Path, settings: &Settings, output: &Path) -> Result<u64, Cause> {
    let head = (!settings.sensors.is_empty()).then(|| settings.head());
    let mut reader = Recording::open(file)?.frames(head)?;
    let head = reader.head().clone();
    let trim = Attitude::from_degrees(settings.head.roll_trim_deg, settings.head.pitch_trim_deg);
    let mut update =
        |frame: &Frame, estimate: &mut Estimate| *estimate = replayed::estimate(baseline, &head, frame, trim);
    let mut out = BufWriter::new(File::create(output)?);
    match replay(&mut reader, false, &mut update, &mut out) {
        Ok(summary) => Ok(summary.frames),
        Err(Stop::Read(e)) => Err(e.into()),
        Err(Stop::Write(e)) => Err(e.into()),
    }
}

fn all(args: &Args) -> Result<(), Cause> {
    let (Some(file), Some(directory)) = (&args.file, &args.directory) else {
        eprintln!("baselines: no recording given: cargo bench --bench baselines -- FILE [--config C] DIRECTORY");
        return Ok(());
    };
    let settings = settings(file, args.config.as_deref())?;
    fs::create_dir_all(directory)?;
    for (name, mut baseline) in schemes::named() {
        let output = directory.join(format!("{name}.csv"));
        let frames = run(baseline.as_mut(), file, &settings, &output)?;
        eprintln!("{}: {frames} frames", output.display());
    }
    Ok(())
}

fn main() -> ExitCode {
    match all(&Args::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(e) => {
            eprintln!("baselines: {}", chain(e.as_ref()));
            ExitCode::FAILURE
        }
    }
}
