//! The daemon asked over D-Bus. Every call blocks, for 3 s at most; a reload for 12 s.

use super::answer;
use super::view::Status;
use crate::clock;
use crate::config::settings::BusAddress;
use crate::dbus::bus::{builder, place, reason};
use crate::dbus::{CONTROL, ERROR_BUSY, ERROR_CONFIG, HORIZON, NAME, PATH, STREAM};
use rustix::net::{RecvFlags, recv};
use std::collections::HashMap;
use std::fmt;
use std::future::Future;
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};
use std::time::Duration;
use zbus::fdo::ManagedObjects;
use zbus::message::Message;
use zbus::names::OwnedUniqueName;
use zbus::{Connection, DynamicType, OwnedVariant};
use zruntime::SharedRuntime;

/// As long as the bus may take to let us in, and the daemon to answer.
const ANSWER_LIMIT: Duration = Duration::from_secs(3);
/// As long as a reload may take: the daemon's own limit, and some more.
const RELOAD_LIMIT: Duration = Duration::from_secs(12);
const BUS: &str = "org.freedesktop.DBus";

/// Why the daemon gave no answer, with the user's next step.
#[derive(Clone, Debug, PartialEq)]
pub enum ClientError {
    /// Nobody owns the daemon's name.
    NoDaemon(BusAddress),
    /// The bus cannot be reached: where, and why.
    NoBus(BusAddress, String),
    /// The bus does not let this user ask that: what.
    Denied(&'static str),
    /// The daemon does not accept its configuration: where and why.
    Config(String),
    /// The daemon cannot do that now: why.
    Busy(String),
    /// The daemon does not answer in time: what, and how long it was given.
    Silent(&'static str, String),
    /// The daemon answers otherwise than expected: to what, and how.
    Answer(&'static str, String),
}

impl ClientError {
    /// Whether there is no daemon to ask (exit code 3 of `status`).
    pub fn no_daemon(&self) -> bool {
        matches!(self, Self::NoDaemon(_) | Self::NoBus(..))
    }
}

impl fmt::Display for ClientError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoDaemon(BusAddress::System) => f.write_str(
                "no irhorizond on the system bus: start it with `systemctl start irhorizond`, or give --bus session",
            ),
            Self::NoDaemon(bus) => write!(
                f,
                "no irhorizond on {}: start one there ([dbus] bus in its configuration), or leave out --bus for the \
                 system bus",
                place(bus)
            ),
            Self::NoBus(bus @ BusAddress::System, why) => {
                write!(f, "{} cannot be reached ({why}): is it running? systemctl status dbus", place(bus))
            }
            Self::NoBus(bus, why) => {
                write!(f, "{} cannot be reached ({why}): is it running? Leave out --bus for the system bus", place(bus))
            }
            Self::Denied(what) => write!(
                f,
                "{what}: permission denied: only root and members of the group irhorizon may (sudo, or usermod -aG \
                 irhorizon and log in again)"
            ),
            Self::Config(text) => f.write_str(text),
            Self::Busy(why) => f.write_str(why),
            Self::Silent(what, how) | Self::Answer(what, how) => {
                write!(f, "{what}: {how}; is irhorizond of this version, and well? journalctl -u irhorizond")
            }
        }
    }
}

impl std::error::Error for ClientError {}

/// A connection to the daemon, made when first needed and again after the bus went away.
pub struct Client {
    bus: BusAddress,
    connection: Option<Connection>,
    /// As long as the daemon may take to answer.
    limit: Duration,
}

impl Client {
    /// Connects to the bus; whether the daemon is there shows when it is asked.
    pub fn connect(bus: &BusAddress) -> Result<Self, ClientError> {
        let mut client = Self { bus: bus.clone(), connection: None, limit: ANSWER_LIMIT };
        let _ = zbus::block_on(client.connection())?;
        Ok(client)
    }

    /// From now on gives the daemon no longer than `limit` to answer, and never longer than usual.
    pub fn answer_within(&mut self, limit: Duration) {
        self.limit = limit.min(ANSWER_LIMIT);
    }

    /// The daemon's state now.
    pub fn status(&mut self) -> Result<Status, ClientError> {
        const WHAT: &str = "asking for the state";
        let (horizon, objects) = zbus::block_on(async {
            let horizon = self.call(WHAT, "org.freedesktop.DBus.Properties", "GetAll", &HORIZON).await?;
            let objects = self.call(WHAT, "org.freedesktop.DBus.ObjectManager", "GetManagedObjects", &()).await?;
            Ok((horizon, objects))
        })?;
        let wrong = |e: zbus::Error| ClientError::Answer(WHAT, e.to_string());
        let horizon: HashMap<String, OwnedVariant> = horizon.body().deserialize().map_err(wrong)?;
        let objects: ManagedObjects = objects.body().deserialize().map_err(wrong)?;
        answer::status(WHAT, horizon, objects, clock::now())
    }

    /// The state again and again, a `period` apart; errors do not end it, a daemon that comes back
    /// is seen again.
    pub fn watch(mut self, period: Duration) -> impl Iterator<Item = Result<Status, ClientError>> {
        let mut due = clock::now();
        std::iter::repeat_with(move || {
            clock::sleep_until(due);
            due = (due + period).max(clock::now());
            self.status()
        })
    }

    /// Has the daemon read its configuration again; returns when it holds.
    pub fn reload(&mut self) -> Result<(), ClientError> {
        zbus::block_on(self.call_within(RELOAD_LIMIT, "reloading the configuration", CONTROL, "Reload", &())).map(drop)
    }

    /// Frames as they come.
    pub fn frames(&mut self) -> Result<Frames, ClientError> {
        const WHAT: &str = "asking for frames";
        let reply = zbus::block_on(self.call(WHAT, STREAM, "Frames", &()))?;
        let fd: zbus::OwnedFd =
            reply.body().deserialize().map_err(|e: zbus::Error| ClientError::Answer(WHAT, e.to_string()))?;
        Ok(Frames { fd: fd.into(), packet: vec![0; 64 * 1024] })
    }

    async fn connection(&mut self) -> Result<Connection, ClientError> {
        if let Some(connection) = self.connection.as_ref().filter(|c| !c.is_closed()) {
            return Ok(connection.clone());
        }
        let attempt = within(ANSWER_LIMIT, async { builder(&self.bus)?.build().await }).await;
        let connection = attempt.map_err(|e| ClientError::NoBus(self.bus.clone(), reason(&e)))?;
        self.connection = Some(connection.clone());
        Ok(connection)
    }

    async fn call<B>(
        &mut self,
        what: &'static str,
        interface: &str,
        method: &str,
        body: &B,
    ) -> Result<Message, ClientError>
    where
        B: serde::Serialize + DynamicType,
    {
        self.call_within(self.limit, what, interface, method, body).await
    }

    /// Calls a method of the daemon's object. Its owner is asked for first: a call by name would
    /// have the bus start a daemon that is not running.
    async fn call_within<B>(
        &mut self,
        limit: Duration,
        what: &'static str,
        interface: &str,
        method: &str,
        body: &B,
    ) -> Result<Message, ClientError>
    where
        B: serde::Serialize + DynamicType,
    {
        let connection = self.connection().await?;
        let answer = within(limit, async {
            let owner = connection.call_method(Some(BUS), "/org/freedesktop/DBus", Some(BUS), "GetNameOwner", &NAME);
            let owner: OwnedUniqueName = owner.await?.body().deserialize()?;
            connection.call_method(Some(&*owner), PATH, Some(interface), method, body).await
        });
        answer.await.map_err(|e| explain(what, &self.bus, e))
    }
}

/// What `ask` gives, or an error of the kind `TimedOut` after `limit`.
async fn within<T>(limit: Duration, ask: impl Future<Output = zbus::Result<T>>) -> zbus::Result<T> {
    match SharedRuntime::current()?.timeout(limit, ask).await {
        Ok(outcome) => outcome,
        Err(_) => {
            let text = format!("no answer within {} s", limit.as_secs_f64());
            Err(std::io::Error::new(std::io::ErrorKind::TimedOut, text).into())
        }
    }
}

/// What an error of the bus means to the user.
fn explain(what: &'static str, bus: &BusAddress, error: zbus::Error) -> ClientError {
    use zbus::fdo::Error as Fdo;
    match &error {
        zbus::Error::MethodError(name, text, _) => {
            let text = text.clone().unwrap_or_default();
            match name.as_str() {
                ERROR_CONFIG => ClientError::Config(text),
                ERROR_BUSY => ClientError::Busy(text),
                name => ClientError::Answer(what, format!("{name}: {text}")),
            }
        }
        zbus::Error::FDO(e) => match &**e {
            Fdo::NameHasNoOwner(_) | Fdo::ServiceUnknown(_) | Fdo::Disconnected(_) | Fdo::NoReply(_) => {
                ClientError::NoDaemon(bus.clone())
            }
            Fdo::AccessDenied(_) => ClientError::Denied(what),
            e => ClientError::Answer(what, e.to_string()),
        },
        zbus::Error::InputOutput(e) if e.kind() == std::io::ErrorKind::TimedOut => {
            ClientError::Silent(what, e.to_string())
        }
        zbus::Error::InputOutput(e) => ClientError::NoBus(bus.clone(), e.to_string()),
        e => ClientError::Answer(what, e.to_string()),
    }
}

/// A stream of frames: a header line, then a CSV line for each frame.
pub struct Frames {
    fd: OwnedFd,
    packet: Vec<u8>,
}

impl Frames {
    /// Waits for the next line, with its newline; `None` when the daemon has ended the stream.
    pub fn next_line(&mut self) -> std::io::Result<Option<String>> {
        loop {
            match recv(&self.fd, &mut self.packet[..], RecvFlags::empty()) {
                Ok((0, _)) => return Ok(None),
                Ok((n, _)) => return Ok(Some(String::from_utf8_lossy(&self.packet[..n]).into_owned())),
                Err(rustix::io::Errno::INTR) => {}
                Err(e) => return Err(e.into()),
            }
        }
    }
}

impl AsFd for Frames {
    fn as_fd(&self) -> BorrowedFd<'_> {
        self.fd.as_fd()
    }
}
