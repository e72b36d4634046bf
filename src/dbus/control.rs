//! `org.irhorizon1.Control` changes the daemon, `org.irhorizon1.Stream` gives its frames away.

use super::info::Control;
use crate::recording::Taps;
use std::sync::Arc;
use std::sync::mpsc::TryRecvError;
use std::time::Duration;
use zbus::{DBusError, OwnedFd, interface};

/// As long as a reload may take.
const RELOAD_LIMIT: Duration = Duration::from_secs(10);
/// Between two looks whether it is over.
const RELOAD_POLL: Duration = Duration::from_millis(10);

/// What a method is refused with.
#[derive(Debug, DBusError)]
#[zbus(prefix = "org.irhorizon1.Error")]
pub(super) enum Refusal {
    /// Anything of the bus itself.
    #[zbus(error)]
    ZBus(zbus::Error),
    /// The configuration is not accepted.
    Config(String),
    /// Not now.
    Busy(String),
}

/// The object of `Control`.
pub(super) struct Commands {
    pub control: Arc<dyn Control>,
}

/// What changes the daemon: on the system bus for root and the group irhorizon only.
#[interface(name = "org.irhorizon1.Control")]
impl Commands {
    /// Reads the configuration again and returns when it holds. When it is not accepted, the error
    /// says where and why, and the daemon goes on with what it had.
    async fn reload(&self) -> Result<(), Refusal> {
        let runtime = zruntime::SharedRuntime::current().map_err(zbus::Error::from)?;
        let outcome = self.control.reload();
        for _ in 0..RELOAD_LIMIT.as_millis() / RELOAD_POLL.as_millis() {
            match outcome.try_recv() {
                Ok(Ok(())) => return Ok(()),
                Ok(Err(text)) => return Err(Refusal::Config(text)),
                Err(TryRecvError::Disconnected) => return Err(Refusal::Busy("the daemon is going down".into())),
                Err(TryRecvError::Empty) => runtime.sleep(RELOAD_POLL).await,
            }
        }
        let text = format!("the daemon did not reload within {} s: see its log", RELOAD_LIMIT.as_secs());
        Err(Refusal::Busy(text))
    }
}

/// The object of `Stream`.
pub(super) struct Stream {
    pub taps: Arc<Taps>,
}

/// Frames as they come.
#[interface(name = "org.irhorizon1.Stream")]
impl Stream {
    /// A socket of packets (SOCK_SEQPACKET): the first is the CSV header line, then a CSV line for
    /// each frame. Close it to end the stream; what is not read in time is lost.
    fn frames(&self) -> Result<OwnedFd, Refusal> {
        let fd = self.taps.subscribe().map_err(|e| Refusal::Busy(e.to_string()))?;
        Ok(fd.into())
    }
}
