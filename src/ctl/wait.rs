//! `wait-ready`: until the daemon gives attitude.

use super::error::CtlError;
use super::kit::{DaemonError, Kit};
use super::setup_args::WaitArgs;
use super::view::Status;
use crate::config::settings::BusAddress;
use std::time::{Duration, Instant};

/// Between two looks.
const LOOK: Duration = Duration::from_millis(100);

/// The least time that an answer is given, so that a last look can have one.
const LEAST: Duration = Duration::from_millis(500);

/// Waits for the daemon on `bus`. One that is not there, or not yet, is waited for too.
pub fn command(args: &WaitArgs, bus: &BusAddress, kit: &Kit) -> Result<(), CtlError> {
    let begun = Instant::now();
    let mut daemon = None;
    let mut look = || {
        let connected = match daemon.as_mut() {
            Some(connected) => connected,
            None => daemon.insert((kit.connect)(bus)?),
        };
        let left = Duration::from_secs_f64(args.timeout).saturating_sub(begun.elapsed());
        if args.timeout > 0.0 {
            connected.answer_within(left.max(LEAST));
        }
        connected.status()
    };
    until(args, &mut look, &|| begun.elapsed(), &mut std::thread::sleep)
}

/// Looks again and again until what is seen is ready or, by `elapsed`, the time is over.
fn until(
    args: &WaitArgs,
    look: &mut dyn FnMut() -> Result<Status, DaemonError>,
    elapsed: &dyn Fn() -> Duration,
    pause: &mut dyn FnMut(Duration),
) -> Result<(), CtlError> {
    let limit = Duration::from_secs_f64(args.timeout);
    loop {
        let seen = look();
        if seen.as_ref().is_ok_and(|status| status.measured && args.mode.is_met_by(&status.mode)) {
            return Ok(());
        }
        let left = limit.saturating_sub(elapsed());
        if left.is_zero() {
            let Status { mode, faults, .. } = seen?;
            let faults = faults.into_iter().map(|f| f.name).collect();
            return Err(CtlError::NotReady { seconds: args.timeout, mode, faults });
        }
        pause(LOOK.min(left));
    }
}

#[cfg(test)]
mod tests {
    use super::super::setup_args::ReadyMode;
    use super::*;
    use std::cell::Cell;

    /// Looks at a daemon that goes through `modes` (empty: none answers) and stays in the last one;
    /// gives the outcome and how long it took.
    fn wait(modes: &[&str], timeout: f64, mode: ReadyMode) -> (Result<(), CtlError>, Duration) {
        let (now, mut seen) = (Cell::new(Duration::ZERO), 0);
        let mut look = || {
            let mode = modes[seen.min(modes.len() - 1)];
            seen += 1;
            match mode {
                "" => Err(DaemonError::Absent("nobody".into())),
                "held" => Ok(Status { mode: "degraded".into(), ..Status::default() }),
                mode => Ok(Status { mode: mode.into(), measured: true, ..Status::default() }),
            }
        };
        let outcome = until(&WaitArgs { timeout, mode }, &mut look, &|| now.get(), &mut |d| now.set(now.get() + d));
        (outcome, now.get())
    }

    #[test]
    fn it_ends_as_soon_as_the_daemon_is_ready() {
        let (outcome, took) = wait(&["", "starting", "degraded", "nominal"], 60.0, ReadyMode::Nominal);
        assert!(outcome.is_ok() && took < Duration::from_secs(1), "{took:?}");
        assert!(wait(&["", "faulted", "degraded"], 60.0, ReadyMode::Degraded).0.is_ok());
        assert!(wait(&["nominal"], 0.0, ReadyMode::Degraded).0.is_ok());
    }

    #[test]
    fn it_ends_when_the_time_is_over_and_says_why() {
        for (modes, mode, code) in [
            (&["nominal", "degraded"][1..], ReadyMode::Nominal, 1),
            (&["starting"], ReadyMode::Degraded, 1),
            (&["faulted"], ReadyMode::Degraded, 1),
            (&["held"], ReadyMode::Degraded, 1),
            (&["starting", ""], ReadyMode::Degraded, 3),
            (&["", "starting"], ReadyMode::Degraded, 1),
        ] {
            for timeout in [0.25, 5.0] {
                let (outcome, took) = wait(modes, timeout, mode);
                let error = outcome.unwrap_err();
                assert_eq!(error.code(), code, "{modes:?}: {error}");
                assert_eq!(took, Duration::from_secs_f64(timeout));
            }
        }
    }
}
