//! The irhorizonctl binary: a shim over the library.

use irhorizon::ctl::{kit::Kit, main as run};
use std::process::ExitCode;

fn main() -> ExitCode {
    run(&Kit::REAL)
}
