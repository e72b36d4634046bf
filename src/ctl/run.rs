//! Does what the command line says.

use super::cli::{Cli, Command, SensorsFormat, StatusFormat};
use super::error::{CtlError, EXIT_FAILED, EXIT_OK, EXIT_USAGE};
use super::kit::Kit;
use super::view::Status;
use super::{
    calibrate, doctor, plot, prometheus, record, replay, score, sensors, set_address, signals, simulate, status, trim,
    wait, watch,
};
use crate::config::settings::BusAddress;
use crate::sensor::schedule::Schedule;
use clap::error::ErrorKind;
use clap::{CommandFactory, Parser};
use serde::Serialize;
use std::ffi::OsString;
use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;

/// The whole of the binary.
pub fn main(kit: &Kit) -> ExitCode {
    let (mut out, mut err) = (io::stdout(), io::stderr());
    ExitCode::from(run(std::env::args_os(), kit, &mut out, &mut err))
}

/// Runs a command line (its first word is the program's name); gives the exit code.
pub fn run(
    args: impl IntoIterator<Item = impl Into<OsString> + Clone>,
    kit: &Kit,
    out: &mut dyn Write,
    err: &mut dyn Write,
) -> u8 {
    let outcome = match Cli::try_parse_from(args) {
        Ok(cli) => dispatch(&cli, kit, out, err),
        Err(e) if matches!(e.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) => {
            print(out, &e.render().to_string()).map(|()| EXIT_OK)
        }
        Err(e) => {
            let _ = write!(err, "{}", e.render());
            return EXIT_USAGE;
        }
    };
    // What the log has to say about it comes first.
    log::logger().flush();
    match outcome {
        Ok(code) => code,
        Err(e) if e.is_broken_pipe() => EXIT_OK,
        Err(e) => {
            let _ = writeln!(err, "irhorizonctl: {}", e.text());
            e.code()
        }
    }
}

fn dispatch(cli: &Cli, kit: &Kit, out: &mut dyn Write, err: &mut dyn Write) -> Result<u8, CtlError> {
    match &cli.command {
        Command::Status { format } => return show_status(*format, &cli.bus, kit, out),
        Command::Sensors { format } => {
            let status = ask(&cli.bus, kit)?;
            let text = match format {
                SensorsFormat::Plain => sensors::table(&status) + &sensors::remedies(&status),
                SensorsFormat::Json => json(&status.sensors)?,
            };
            print(out, &text)?;
        }
        Command::Watch(args) => watch::command(*args, &cli.bus, kit, &*stop_flag()?, out, err)?,
        Command::Doctor(args) => return doctor::command(args, &cli.bus, kit, out),
        Command::WaitReady(args) => wait::command(args, &cli.bus, kit)?,
        Command::Validate { file, show } => return validate(file, *show, kit, out, err),
        Command::Trim(args) => trim::command(args, ask(&cli.bus, kit)?.trim, out, err)?,
        Command::Calibrate(args) => calibrate::command(args, &cli.bus, kit, out, err)?,
        Command::SetAddress(args) => set_address::command(args, &cli.bus, kit, out)?,
        Command::Record(args) => record::command(args, &cli.bus, kit, &*stop_flag()?, out, err)?,
        Command::Replay(args) => replay::command(args, kit, out, err)?,
        Command::Simulate(args) => simulate::command(args, out, err)?,
        Command::Plot(what) => plot::command(what, kit, out, err)?,
        Command::Score(args) => score::command(args, kit, out, err)?,
        Command::Completions { shell } => {
            let mut text = Vec::new();
            clap_complete::generate(shell.generator(), &mut Cli::command(), "irhorizonctl", &mut text);
            print(out, &String::from_utf8_lossy(&text))?;
        }
    }
    Ok(EXIT_OK)
}

fn ask(bus: &BusAddress, kit: &Kit) -> Result<Status, CtlError> {
    Ok((kit.connect)(bus)?.status()?)
}

fn show_status(format: StatusFormat, bus: &BusAddress, kit: &Kit, out: &mut dyn Write) -> Result<u8, CtlError> {
    let status = match ask(bus, kit) {
        Ok(status) => status,
        Err(e) => {
            if format == StatusFormat::Prometheus {
                print(out, &prometheus::exposition(None))?;
            }
            return Err(e);
        }
    };
    let text = match format {
        StatusFormat::Plain => status::plain(&status),
        StatusFormat::Json => json(&status)?,
        StatusFormat::Prometheus => prometheus::exposition(Some(&status)),
    };
    print(out, &text)?;
    Ok(status::exit_code(&status))
}

fn validate(file: &Path, show: bool, kit: &Kit, out: &mut dyn Write, err: &mut dyn Write) -> Result<u8, CtlError> {
    match (kit.load)(file) {
        Ok(loaded) => {
            for warning in &loaded.warnings {
                let _ = writeln!(err, "warning: {warning}");
            }
            let settings = &loaded.settings;
            let schedule = match settings.simulation {
                Some(_) => None,
                None => match Schedule::plan(&settings.sensors, &settings.head(), settings.rate_hz, settings.quiet) {
                    Ok(schedule) => Some(schedule),
                    Err(e) => {
                        let _ = writeln!(err, "{}: {e}", file.display());
                        return Ok(EXIT_FAILED);
                    }
                },
            };
            if show {
                print(out, &loaded.text)?;
                return Ok(EXIT_OK);
            }
            for file in &loaded.files {
                print(out, &format!("{}: ok\n", file.display()))?;
            }
            if let Some(schedule) = schedule {
                print(out, &format!("{schedule}\n"))?;
            }
            Ok(EXIT_OK)
        }
        // A line for each error: they are many and each names its file and line.
        Err(errors) => {
            let _ = writeln!(err, "{errors}");
            Ok(EXIT_FAILED)
        }
    }
}

/// JSON for people and programs; what is no number is null.
pub(super) fn json(value: &impl Serialize) -> Result<String, CtlError> {
    let mut text = serde_json::to_string_pretty(value).map_err(|e| CtlError::Output(e.into()))?;
    text.push('\n');
    Ok(text)
}

/// Writes `text` and sees it off.
pub(super) fn print(out: &mut dyn Write, text: &str) -> Result<(), CtlError> {
    out.write_all(text.as_bytes()).and_then(|()| out.flush()).map_err(CtlError::Output)
}

fn stop_flag() -> Result<std::sync::Arc<AtomicBool>, CtlError> {
    signals::stop_flag().map_err(CtlError::Terminal)
}
