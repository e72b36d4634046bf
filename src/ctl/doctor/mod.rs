//! `doctor`: what is well with an installation, what is not, and what to do next.
//!
//! - [`facts`]: all that findings are made of, as plain data;
//! - [`finding`]: a finding; `software`, `wiring`, `chips`: the findings that facts lead to;
//! - [`report`]: findings as people and programs read them;
//! - `probe`, `system`: how the facts are come by. While a daemon runs no bus is touched, and without one
//!   sensors are only read.

mod chips;
pub mod facts;
pub mod finding;
mod probe;
pub mod report;
mod software;
mod system;
mod wiring;

pub use facts::Facts;
pub use finding::{Check, Finding, Verdict};
pub(super) use system::daemon_process;

use super::error::{CtlError, EXIT_FAILED, EXIT_OK};
use super::kit::Kit;
use super::run::print;
use super::setup_args::DoctorArgs;
use crate::config::settings::BusAddress;
use std::io::Write;

/// The findings that `facts` lead to, the groundwork first; what several sensors share is told once.
pub fn findings(facts: &Facts) -> Vec<Finding> {
    let mut found = software::groundwork(facts);
    found.extend(wiring::findings(facts));
    found.extend(chips::findings(facts));
    found.extend(software::at_work(facts));
    finding::merged(found)
}

/// Looks, and says what was found; gives the exit code: 1 when anything has failed.
pub fn command(args: &DoctorArgs, bus: &BusAddress, kit: &Kit, out: &mut dyn Write) -> Result<u8, CtlError> {
    let found = findings(&probe::gather(&args.file, bus, kit));
    let text = if args.json { report::json(&found)? } else { report::plain(&found) };
    print(out, &text)?;
    let failed = found.iter().any(|f| f.verdict == Verdict::Fail);
    Ok(if failed { EXIT_FAILED } else { EXIT_OK })
}
