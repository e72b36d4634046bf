//! The words of the command line.

use super::recording_args::{PlotCommand, RecordingArgs, ScoreArgs};
use super::setup_args::{CalibrateArgs, DoctorArgs, SetAddressArgs, Shell, WaitArgs};
use crate::config::settings::BusAddress;
use crate::simulation::Fault;
use crate::simulation::scenario::{self, LIST};
use clap::builder::PossibleValuesParser;
use clap::{Args, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;

/// Where the daemon's configuration is unless said otherwise.
pub const DEFAULT_CONFIG: &str = "/etc/irhorizon/irhorizon.toml";

const EXIT_CODES: &str = "Exit codes: 0 done; 1 failed; 3 no daemon answers; 64 wrong usage.\n\
                          Of status: 0 nominal; 1 degraded; 2 attitude withheld (faulted or starting); 3 no daemon.";

/// Asks irhorizond questions, and works on recordings without it.
#[derive(Debug, Parser)]
#[command(name = "irhorizonctl", version, after_help = EXIT_CODES)]
pub struct Cli {
    /// The D-Bus bus the daemon is on: system, session, or an address such as unix:path=/run/bus
    #[arg(long, global = true, default_value = "system", value_parser = bus)]
    pub bus: BusAddress,
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Say what the daemon says: attitude, mode, faults with their evidence
    #[command(after_help = EXIT_CODES)]
    Status {
        /// How to say it
        #[arg(long, value_enum, default_value_t)]
        format: StatusFormat,
    },
    /// Show the live horizon in the terminal (q to quit)
    Watch(WatchArgs),
    /// List the sensors: readings, states, checks, errors
    Sensors {
        /// How to say it
        #[arg(long, value_enum, default_value_t)]
        format: SensorsFormat,
    },
    /// Find out what is wrong with an installation, and what to do next
    #[command(after_help = DoctorArgs::EXIT_CODES)]
    Doctor(DoctorArgs),
    /// Wait until the daemon gives attitude
    #[command(after_help = WaitArgs::EXIT_CODES)]
    WaitReady(WaitArgs),
    /// Check a configuration file and its drop-ins
    Validate {
        /// The file
        #[arg(default_value = DEFAULT_CONFIG)]
        file: PathBuf,
        /// Print the configuration that results
        #[arg(long)]
        show: bool,
    },
    /// Say the head's trim, with what was learnt in flight, as lines of configuration
    Trim(TrimArgs),
    /// Measure what the head shows when level, or a pair when it sees no difference, and save it
    Calibrate(CalibrateArgs),
    /// Give the one MLX90614 on a bus another address
    SetAddress(SetAddressArgs),
    /// Record the daemon's frames, or the sensors' without it, as CSV, until Ctrl-C
    Record(RecordArgs),
    /// Run a recording through the daemon's own estimator
    Replay(ReplayArgs),
    /// Make up a recording: a flight under a scene, with its true attitude
    Simulate(SimulateArgs),
    /// Score methods of estimation against a recording's reference
    Score(ScoreArgs),
    /// Draw a recording, its errors, or the report's figures as SVG
    #[command(subcommand)]
    Plot(PlotCommand),
    /// Print a shell's completions of this command line
    Completions {
        /// The shell
        #[arg(value_enum)]
        shell: Shell,
    },
}

/// How `status` speaks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum StatusFormat {
    /// For people
    #[default]
    Plain,
    /// One JSON object
    Json,
    /// Prometheus text exposition
    Prometheus,
}

/// How `sensors` speaks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum SensorsFormat {
    /// A table
    #[default]
    Plain,
    /// A JSON array
    Json,
}

/// Arguments of `watch`.
#[derive(Clone, Copy, Debug, Args)]
pub struct WatchArgs {
    /// Print a line of JSON for each update instead
    #[arg(long)]
    pub json: bool,
    /// Print one picture (or line of JSON) and end
    #[arg(long)]
    pub once: bool,
    /// The picture's size in cells, WxH; the terminal's when not given
    #[arg(long, value_parser = size, requires = "once", conflicts_with = "json")]
    pub size: Option<(u16, u16)>,
}

/// Arguments of `trim`.
#[derive(Clone, Debug, Args)]
pub struct TrimArgs {
    /// Write the lines to a file, such as /etc/irhorizon/irhorizon.toml.d/50-trim.toml
    #[arg(long, value_name = "FILE")]
    pub save: Option<PathBuf>,
    /// Overwrite the file when it is there already
    #[arg(long, requires = "save")]
    pub force: bool,
}

/// Arguments of `record`.
#[derive(Clone, Debug, Args)]
pub struct RecordArgs {
    /// The file, - for standard output; irhorizon-DATE-TIME.csv when not given
    pub file: Option<PathBuf>,
    /// End after this many seconds
    #[arg(long, value_parser = seconds, allow_negative_numbers = true)]
    pub seconds: Option<f64>,
    /// Overwrite the file when it is there already
    #[arg(long)]
    pub force: bool,
    /// Read the sensors without the daemon, which must not be reading them
    #[arg(long)]
    pub offline: bool,
    /// The configuration that --offline goes by
    #[arg(long, value_name = "FILE", default_value = DEFAULT_CONFIG, requires = "offline")]
    pub config: PathBuf,
}

/// Arguments of `replay`.
#[derive(Clone, Debug, Args)]
pub struct ReplayArgs {
    /// What is replayed.
    #[command(flatten)]
    pub recording: RecordingArgs,
    /// Where the estimates go; standard output when not given
    #[arg(long)]
    pub output: Option<PathBuf>,
}

/// Arguments of `simulate`.
#[derive(Clone, Debug, Args)]
pub struct SimulateArgs {
    /// Which flight and scene
    #[arg(value_parser = PossibleValuesParser::new(LIST.map(|s| s.0)), required_unless_present = "list")]
    pub scenario: Option<String>,
    /// Say what the scenarios are
    #[arg(long)]
    pub list: bool,
    /// What chance decides: the same seed, the same recording
    #[arg(long, default_value_t = 1, allow_negative_numbers = true)]
    pub seed: u64,
    /// How long, up to 7200
    #[arg(long, default_value_t = scenario::SECONDS, value_parser = flight_seconds, allow_negative_numbers = true)]
    pub seconds: f64,
    /// Scans a second, 1 to 200
    #[arg(long, default_value_t = 50.0, value_parser = rate, allow_negative_numbers = true)]
    pub rate: f64,
    /// Fly the demonstration's script instead of turns by chance; inverted and aerobatics fly their own anyway
    #[arg(long)]
    pub scripted: bool,
    /// Leave out gyro, GPS and airspeed
    #[arg(long)]
    pub no_aiding: bool,
    /// Three pairs in volts instead of six temperatures
    #[arg(long)]
    pub differential: bool,
    /// What goes wrong, such as wet:nose@10..40 (s); again for more; the kinds are with --list
    #[arg(long = "fault", value_name = "KIND[=STRENGTH][:WHO]@FROM..TO")]
    pub faults: Vec<Fault>,
    /// Where the recording goes; standard output when not given
    #[arg(long)]
    pub output: Option<PathBuf>,
}

fn bus(text: &str) -> Result<BusAddress, String> {
    match text {
        "system" => Ok(BusAddress::System),
        "session" => Ok(BusAddress::Session),
        address if address.contains(':') => Ok(BusAddress::Address(address.to_owned())),
        device if device.starts_with("/dev/") => {
            Err("this is the D-Bus bus: system, session, or an address; an I2C bus is --i2c-bus".to_owned())
        }
        _ => Err("expected system, session, or an address such as unix:path=/run/bus".to_owned()),
    }
}

fn size(text: &str) -> Result<(u16, u16), String> {
    let parsed = text.split_once('x').and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    match parsed {
        Some((w @ 1..=1000, h @ 1..=1000)) => Ok((w, h)),
        _ => Err("expected columns and rows such as 80x24, each 1 to 1000".to_owned()),
    }
}

pub(super) fn seconds(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(s) if s > 0.0 && s <= 1e9 => Ok(s),
        _ => Err("expected seconds, more than 0".to_owned()),
    }
}

fn flight_seconds(text: &str) -> Result<f64, String> {
    seconds(text).ok().filter(|s| *s <= 7200.0).ok_or_else(|| "expected seconds, more than 0 up to 7200".to_owned())
}

fn rate(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(hz) if (1.0..=200.0).contains(&hz) => Ok(hz),
        _ => Err("expected scans a second, 1 to 200".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn a_negative_number_is_told_its_range() {
        for line in [
            "simulate clear-dry --seed -1",
            "simulate clear-dry --seconds -1",
            "simulate clear-dry --rate -1",
            "record --seconds -1",
            "score a.csv --skip -1",
            "score a.csv --min-ground-speed -0.5",
            "plot flight a.csv --from -5",
            "plot flight a.csv --to -5",
            "calibrate --seconds -1",
            "wait-ready --timeout -1",
        ] {
            let words = ["irhorizonctl"].into_iter().chain(line.split_whitespace());
            let error = Cli::try_parse_from(words).unwrap_err();
            assert_eq!(error.kind(), clap::error::ErrorKind::ValueValidation, "{line}: {error}");
        }
    }

    #[test]
    fn values_are_checked() {
        assert_eq!(bus("unix:path=/tmp/b"), Ok(BusAddress::Address("unix:path=/tmp/b".into())));
        assert!(bus("sytem").is_err());
        assert_eq!(size("80x24"), Ok((80, 24)));
        for bad in ["80", "0x24", "80x", "-1x3", "70000x1"] {
            assert!(size(bad).is_err(), "{bad}");
        }
        for bad in ["0", "-1", "nan", "inf", "x"] {
            assert!(seconds(bad).is_err(), "{bad}");
        }
    }
}
