//! The service's thread: connects, serves, signals changes, and connects again when the bus died.
//!
//! One thread does all of it: zbus's own runtime runs inside it and only there.

use super::bus::{builder, place, reason};
use super::control::{Commands, Stream};
use super::error::DbusError;
use super::horizon::{Horizon, SharedLive, lock};
use super::info::{Control, ServiceInfo};
use super::live::Live;
use super::sensor::Sensor;
use super::signal::Signalled;
use super::{NAME, PATH};
use crate::clock;
use crate::config::settings::BusAddress;
use crate::recording::Taps;
use crate::state::Shared;
use crate::time::Time;
use std::future::{Future, poll_fn};
use std::pin::pin;
use std::sync::mpsc::SyncSender;
use std::sync::{Arc, Mutex};
use std::task::Poll;
use std::time::{Duration, Instant};
use zbus::Connection;
use zbus::fdo::{ObjectManager, RequestNameFlags};
use zruntime::SharedRuntime;

/// Between two looks at the shared state at most: so old what a client reads may be. A change of the mode or the faults
/// is seen at once.
const LOOK: Duration = Duration::from_millis(100);
/// Between two looks at least: so late a change of the mode that follows another may be seen.
const PAUSE: Duration = Duration::from_millis(10);
/// So long after a frame was written the others have done with it, and nobody has to be woken for a look alone.
const SETTLED: Duration = Duration::from_millis(2);
/// How long an orderly end may take.
const END: Duration = Duration::from_millis(100);
/// The pause before the first new attempt to connect; doubled after each failure.
const BACKOFF_FIRST: Duration = Duration::from_millis(200);
/// The longest pause: after any absence of the bus the service is back on it within 2 s, all told.
const BACKOFF_LAST: Duration = Duration::from_secs(1);
/// A bus that takes longer to answer a connection counts as unreachable.
const CONNECT_LIMIT: Duration = Duration::from_secs(5);

/// What the service is made of.
#[derive(Clone)]
pub struct Service {
    /// Where.
    pub bus: BusAddress,
    /// What is served.
    pub shared: Arc<Shared>,
    /// Where streams of frames are subscribed.
    pub taps: Arc<Taps>,
    /// The daemon.
    pub control: Arc<dyn Control>,
}

/// The thread's body; ends within 0.2 s after the daemon is stopping.
///
/// The outcome of the first attempt goes to `first`; after a fatal one ([`DbusError::fatal`]) that was heard there the
/// thread ends, after any other it goes on trying, as it does whenever the bus goes away.
pub fn run(service: &Service, first: SyncSender<Result<(), DbusError>>) {
    zbus::block_on(async {
        match SharedRuntime::current() {
            Ok(runtime) => {
                let serving = Serving { service, runtime };
                race(serving.serve(first), serving.stopped()).await;
            }
            Err(e) => {
                let error = DbusError::Unreachable { bus: service.bus.clone(), reason: e.to_string() };
                let _ = first.try_send(Err(error));
            }
        }
    });
}

/// Ends with the first of the two.
async fn race(a: impl Future<Output = ()>, b: impl Future<Output = ()>) {
    let (mut a, mut b) = (pin!(a), pin!(b));
    poll_fn(|cx| {
        if a.as_mut().poll(cx).is_ready() || b.as_mut().poll(cx).is_ready() { Poll::Ready(()) } else { Poll::Pending }
    })
    .await;
}

struct Serving<'a> {
    service: &'a Service,
    runtime: SharedRuntime,
}

impl Serving<'_> {
    fn stopping(&self) -> bool {
        self.service.shared.lock().stopping
    }

    /// Ends a little after the daemon began to stop, in case the bus holds up an orderly end.
    async fn stopped(&self) {
        loop {
            let rung = self.service.shared.alarm.rung();
            if self.stopping() {
                return self.runtime.sleep(END).await;
            }
            self.service.shared.alarm.beyond(rung).await;
        }
    }

    async fn serve(&self, first: SyncSender<Result<(), DbusError>>) {
        let mut first = Some(first);
        // Whether it was heard: whoever waited for the outcome may have gone on without it.
        let mut report = move |outcome| first.take().is_some_and(|first| first.try_send(outcome).is_ok());
        let mut backoff = BACKOFF_FIRST;
        let mut told = None;
        let mut attempts = 0_u32;
        while !self.stopping() {
            // Read before the information: a reload from here on is not missed.
            let generation = self.service.shared.lock().generation;
            let live = Arc::new(Mutex::new(Live::new(self.service.control.info(), clock::now())));
            attempts = attempts.saturating_add(1);
            match self.connect(&live).await {
                Ok(connection) => {
                    if attempts > 1 {
                        log::info!("D-Bus: {NAME} is on {}", place(&self.service.bus));
                    }
                    // Sampling may wait for the first connection.
                    lock(&live).since = clock::now();
                    report(Ok(()));
                    (backoff, told) = (BACKOFF_FIRST, None);
                    self.publish(&connection, &live, generation).await;
                    if self.stopping() {
                        let _ = connection.close().await;
                        return;
                    }
                    log::warn!("D-Bus: {} went away; connecting again", place(&self.service.bus));
                }
                Err(error) => {
                    if report(Err(error.clone())) && error.fatal() {
                        return;
                    }
                    if told.as_ref() != Some(&error) {
                        log::warn!("D-Bus: {error}; trying again");
                        told = Some(error);
                    }
                }
            }
            self.runtime.sleep(backoff).await;
            backoff = (backoff * 2).min(BACKOFF_LAST);
        }
    }

    /// Everything registered, the name owned.
    async fn connect(&self, live: &SharedLive) -> Result<Connection, DbusError> {
        let service = self.service;
        let bus = || service.bus.clone();
        let unreachable = |why: String| DbusError::Unreachable { bus: bus(), reason: why };
        let horizon = Horizon { live: live.clone(), control: service.control.clone() };
        let stream = Stream { taps: service.taps.clone() };
        let mut builder = builder(&service.bus)
            .map_err(|e| unreachable(reason(&e)))?
            .serve_at(PATH, horizon)
            .serve_at(PATH, stream)
            .serve_at(PATH, Commands { control: service.control.clone() })
            .serve_at(PATH, ObjectManager);
        lock(live).look(&service.shared.lock(), clock::now());
        let info = lock(live).info.clone();
        for (path, sensor) in sensors(&info, live) {
            builder = builder.serve_at(path, sensor);
        }
        let attempt = async {
            let connection = builder.build().await.map_err(|e| unreachable(reason(&e)))?;
            // Neither may anybody take the name from us, nor do we take it from anybody or wait in line.
            match connection.request_name_with_flags(NAME, RequestNameFlags::DO_NOT_QUEUE).await {
                Ok(_) => Ok(connection),
                Err(zbus::Error::NameTaken) => {
                    Err(DbusError::NameOwned { bus: bus(), owner: owner(&connection).await })
                }
                Err(zbus::Error::FDO(e)) if matches!(*e, zbus::fdo::Error::AccessDenied(_)) => {
                    Err(DbusError::NotAllowed { bus: bus(), reason: e.to_string() })
                }
                Err(e) => Err(unreachable(reason(&e))),
            }
        };
        match self.runtime.timeout(CONNECT_LIMIT, attempt).await {
            Ok(outcome) => outcome,
            Err(_) => Err(unreachable(format!("no answer within {} s", CONNECT_LIMIT.as_secs()))),
        }
    }

    /// Signals what changes, until the bus is gone or the daemon stops.
    async fn publish(&self, connection: &Connection, live: &SharedLive, mut generation: u64) {
        let horizon = Horizon { live: live.clone(), control: self.service.control.clone() };
        let mut sent = Signalled::default();
        let shared = &self.service.shared;
        while !connection.is_closed() {
            // Read before the state: what changes from here on rings once more.
            let rung = shared.alarm.rung();
            let (now, pause) = (clock::now(), Instant::now() + PAUSE);
            let (stopping, newest, written, every) = {
                let newest = shared.lock();
                let mut live = lock(live);
                live.look(&newest, now);
                (newest.stopping, newest.generation, newest.written, live.info.update.min(LOOK))
            };
            if stopping {
                return;
            }
            let outcome = async {
                if generation != newest {
                    generation = newest;
                    self.reloaded(connection, live).await?;
                }
                sent.signal(connection, &horizon, every / 2).await
            };
            if let Err(e) = outcome.await {
                log::debug!("D-Bus: {e}");
                return;
            }
            race(self.runtime.sleep(until(now, written, every)), shared.alarm.beyond(rung)).await;
            self.runtime.sleep_until(pause).await;
        }
    }

    /// Takes in what a reload has changed.
    async fn reloaded(&self, connection: &Connection, live: &SharedLive) -> zbus::Result<()> {
        let new = self.service.control.info();
        let old = std::mem::replace(&mut lock(live).info, new.clone());
        if old.sensors != new.sensors {
            let server = connection.object_server();
            for (path, _) in sensors(&old, live) {
                server.remove::<Sensor, _>(path).await?;
            }
            for (path, sensor) in sensors(&new, live) {
                server.at(path, sensor).await?;
            }
        }
        Ok(())
    }
}

/// The time until the next look, at `now`: they come `every` so often, each a little after a frame like the one that was
/// `written` then.
fn until(now: Time, written: Time, every: Duration) -> Duration {
    let every = every.as_secs_f64();
    Duration::from_secs_f64(every - now.since(written + SETTLED).rem_euclid(every))
}

/// The sensors' objects and where they are.
fn sensors(info: &ServiceInfo, live: &SharedLive) -> Vec<(String, Sensor)> {
    let one = |(index, s): (usize, &super::SensorInfo)| {
        (format!("{PATH}/sensor/{}", s.name), Sensor { live: live.clone(), index })
    };
    info.sensors.iter().enumerate().map(one).collect()
}

/// Who owns the name: the process, and what it is called.
async fn owner(connection: &Connection) -> Option<(u32, Option<String>)> {
    const BUS: &str = "org.freedesktop.DBus";
    let reply =
        connection.call_method(Some(BUS), "/org/freedesktop/DBus", Some(BUS), "GetConnectionUnixProcessID", &NAME);
    let pid: u32 = reply.await.ok()?.body().deserialize().ok()?;
    let name = std::fs::read_to_string(format!("/proc/{pid}/comm")).ok();
    Some((pid, name.map(|n| n.trim_end().to_owned())))
}
