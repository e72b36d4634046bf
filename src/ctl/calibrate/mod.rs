//! `calibrate`: what the head shows when it is level, and what its sensors show when all sides are the same, measured
//! through the daemon and saved as a drop-in.
//!
//! - `average`: means with their standard errors; pure;
//! - `level`: the trims; `neutral`: neutral voltages and offsets;
//! - `drop_in`: saved whole, checked before, brought back;
//! - `held`: whether the daemon goes by it;
//! - `error`: why nothing was measured or saved.

mod average;
mod drop_in;
mod error;
mod held;
mod level;
mod neutral;

pub use average::{Mean, mean};
pub use error::CalibrateError;
pub use level::Level;

use super::error::CtlError;
use super::kit::{Daemon, DaemonError, Kit};
use super::run::print;
use super::setup_args::{CalibrateArgs, Quantity};
use super::view::Status;
use crate::config::settings::BusAddress;
use crate::save::Undone;
use drop_in::DropIn;
use std::io::Write;
use std::path::Path;
use std::time::Duration;

/// Between two looks at the daemon, s: what it says on D-Bus changes no faster.
const LOOK_S: f64 = 0.1;

/// What was measured: lines for people, and lines of configuration.
struct Measured {
    told: String,
    lines: String,
}

/// Measures, shows, saves and has the daemon take it up; or brings back what was before.
pub fn command(
    args: &CalibrateArgs,
    bus: &BusAddress,
    kit: &Kit,
    out: &mut dyn Write,
    err: &mut dyn Write,
) -> Result<(), CtlError> {
    let drop_in = DropIn::new(&args.config, args.what);
    if args.undo {
        let undone = drop_in.undo()?;
        let path = drop_in.path().display();
        print(
            out,
            &match undone {
                Undone::Restored => format!("{path}: what held before is back\n"),
                Undone::Removed => format!("{path}: taken away, there was none before\n"),
                Undone::Nothing => return Err(CalibrateError::NothingToUndo(drop_in.path().to_owned()).into()),
            },
        )?;
        return match (kit.connect)(bus).and_then(|mut daemon| daemon.reload().map(|()| daemon)) {
            // It reads its configuration when it starts.
            Err(DaemonError::Absent(_)) => print(out, "no daemon runs that could take it up now\n"),
            Err(e) => Err(not_reloaded(e)),
            Ok(mut daemon) => taken_up(&mut *daemon, &args.config, kit, out),
        };
    }
    let loaded = (kit.load)(&args.config).map_err(CtlError::Config)?;
    let mut daemon = (kit.connect)(bus)?;
    // Before anybody takes pains to hold anything level.
    let now = daemon.status()?;
    let instructions = match args.what {
        Quantity::Level => level::ready(&now).map(|()| level::INSTRUCTIONS),
        Quantity::Neutral => neutral::ready(&now, &loaded.settings).map(|()| neutral::INSTRUCTIONS),
    }?;
    if !args.dry_run {
        drop_in.prepare()?;
    }
    let _ = writeln!(err, "{instructions}");
    if !args.yes && !(kit.ask)("Is it so, and will it stay so?").map_err(CalibrateError::Ask)? {
        return Err(CalibrateError::Declined.into());
    }
    let _ = writeln!(err, "averaging for {} s …", args.seconds);
    let looks = watch(&mut *daemon, args.seconds, kit.pause)?;
    let measured = match args.what {
        Quantity::Level => level::measure(&looks)?,
        Quantity::Neutral => neutral::measure(&looks, &loaded.settings)?,
    };
    print(out, &measured.told)?;
    drop_in.check(&loaded, &measured.lines)?;
    if args.dry_run {
        return print(out, &format!("to be saved as {}:\n{}", drop_in.path().display(), measured.lines));
    }
    drop_in.save(&measured.lines)?;
    print(out, &format!("saved as {}; --undo brings back what was before\n", drop_in.path().display()))?;
    daemon.reload().map_err(not_reloaded)?;
    taken_up(&mut *daemon, &args.config, kit, out)
}

fn not_reloaded(error: DaemonError) -> CtlError {
    CalibrateError::NotReloaded(Box::new(error.into())).into()
}

/// Says that a daemon that has reloaded goes by `config`, if it does.
fn taken_up(daemon: &mut dyn Daemon, config: &Path, kit: &Kit, out: &mut dyn Write) -> Result<(), CtlError> {
    held::check(daemon, config, kit)?;
    print(out, "the daemon has taken it up\n")
}

/// The daemon's states over `seconds`, each measurement once.
fn watch(daemon: &mut dyn Daemon, seconds: f64, pause: fn(Duration)) -> Result<Vec<Status>, CtlError> {
    let mut looks: Vec<Status> = Vec::new();
    for _ in 0..(seconds / LOOK_S).round() as usize {
        pause(Duration::from_secs_f64(LOOK_S));
        let status = daemon.status()?;
        if looks.last().is_none_or(|l| l.sample_time_usec != status.sample_time_usec) {
            looks.push(status);
        }
    }
    Ok(looks)
}
