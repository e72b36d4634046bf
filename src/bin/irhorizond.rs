//! The irhorizond binary: a shim over the library.

use std::process::ExitCode;

fn main() -> ExitCode {
    irhorizon::daemon::main()
}
