//! `irhorizond`: wiring, threads, signals.
//!
//! - [`cli`], [`logging`]: how it is started, where it speaks;
//! - [`running`]: the parts at work, and how a new configuration gets into them;
//! - [`sampling`], [`ticker`], [`alignment`], [`fault_log`], [`watchdog`]: the sampling loop;
//! - [`alone`]: that loop by itself, for `irhorizonctl record --offline`;
//! - [`source`]: which source of frames a configuration asks for;
//! - [`kept`]: settings changed in operation;
//! - [`control`]: what D-Bus may ask of the daemon.
//!
//! Threads: `main` waits for signals, `sampling` makes frames, `mavlink` and `dbus` publish them, `log` writes what all
//! of them say.

pub mod alignment;
pub mod alone;
pub mod cli;
pub mod control;
pub mod fault_log;
pub mod kept;
pub mod logging;
pub mod running;
pub mod sampling;
pub mod source;
pub mod ticker;
pub mod watchdog;

use clap::Parser;
use cli::Cli;
use kept::Kept;
use running::Running;
use sd_notify::NotifyState;
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::iterator::Signals;
use std::process::ExitCode;

/// The exit status for a configuration that cannot be used (`EX_CONFIG` of sysexits.h): starting
/// again does not help.
const EX_CONFIG: u8 = 78;

/// The exit status for a command line that cannot be understood (`EX_USAGE`): nor does it there.
const EX_USAGE: u8 = 64;

/// The daemon, from its command line to its end.
pub fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(e) => {
            let _ = e.print();
            return if e.use_stderr() { ExitCode::from(EX_USAGE) } else { ExitCode::SUCCESS };
        }
    };
    logging::start("irhorizond", cli.log_level.into());
    let code = run(&cli);
    log::logger().flush();
    code
}

/// The daemon, until it is told to end.
fn run(cli: &Cli) -> ExitCode {
    let kept = Kept::new(&cli.config);
    let loaded = match kept.load() {
        Ok(loaded) => loaded,
        Err(errors) => {
            log::error!("the configuration cannot be used:\n{errors}");
            return ExitCode::from(EX_CONFIG);
        }
    };
    for warning in &loaded.warnings {
        log::warn!("{warning}");
    }
    // Before any thread starts, so that no signal is lost.
    let mut signals = match Signals::new([SIGTERM, SIGINT, SIGHUP]) {
        Ok(signals) => signals,
        Err(e) => {
            log::error!("cannot listen for signals: {e}");
            return ExitCode::FAILURE;
        }
    };
    let started = Running::start(loaded, kept)
        .and_then(|running| running.when_ready(|| notify(&[NotifyState::Ready])).map(|()| running));
    let mut running = match started {
        Ok(running) => running,
        Err(e) => {
            log::error!("{e}");
            return ExitCode::from(if e.is_configuration() { EX_CONFIG } else { 1 });
        }
    };
    for signal in signals.forever() {
        if signal == SIGHUP {
            running.reload();
        } else {
            break;
        }
    }
    notify(&[NotifyState::Stopping]);
    running.stop();
    ExitCode::SUCCESS
}

/// Tells systemd, where it listens.
fn notify(states: &[NotifyState<'_>]) {
    if let Err(e) = sd_notify::notify(states) {
        log::debug!("systemd was not told: {e}");
    }
}
