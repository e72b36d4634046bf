//! The thread that sends: waits for a frame, looks at it briefly, tells every endpoint.

use super::encode::Encoder;
use super::endpoint::{Endpoint, EndpointStats};
use super::session::{Seen, Session};
use crate::clock;
use crate::config::settings::MavlinkSettings;
use crate::ctl::view;
use crate::head::Head;
use crate::state::Shared;
use crate::time::Time;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// The longest wait for a frame: how late a heartbeat can be, and a new configuration.
const WAIT: Duration = Duration::from_millis(50);

/// How often what has arrived at an endpoint is taken in: not for every frame, it costs a system call.
const TEND: Duration = Duration::from_millis(100);

/// What the thread is told, and what it tells of its endpoints.
#[derive(Debug)]
pub struct Switchboard {
    wanted: Mutex<Wanted>,
    endpoints: Mutex<Vec<Arc<EndpointStats>>>,
}

/// What the thread is told.
#[derive(Clone, Debug)]
struct Wanted {
    settings: MavlinkSettings,
    head: Arc<Head>,
}

impl Switchboard {
    /// The first configuration; `head` names what faults speak of.
    pub fn new(settings: MavlinkSettings, head: Arc<Head>) -> Self {
        Self { wanted: Mutex::new(Wanted { settings, head }), endpoints: Mutex::default() }
    }

    /// A new configuration. It is taken up when [`Snapshot::generation`](crate::state::Snapshot)
    /// changes: change that afterwards. Endpoints whose address stays keep their socket, peers,
    /// sequence numbers and statistics.
    pub fn configure(&self, settings: MavlinkSettings, head: Arc<Head>) {
        *self.wanted.lock().unwrap_or_else(PoisonError::into_inner) = Wanted { settings, head };
    }

    /// The endpoints as `status` shows them, in the configuration's order; none before
    /// [`run`] has begun.
    pub fn endpoints(&self) -> Vec<view::Endpoint> {
        self.endpoints.lock().unwrap_or_else(PoisonError::into_inner).iter().map(|e| e.view()).collect()
    }

    fn wanted(&self) -> Wanted {
        self.wanted.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

/// An endpoint with its stream.
struct Link {
    endpoint: Endpoint,
    encoder: Encoder,
    session: Session,
    /// When the endpoint is tended next.
    next_tend: Time,
}

impl Link {
    fn step(&mut self, now: Time, seen: &Seen, head: &Head) {
        let Self { endpoint, encoder, session, next_tend } = self;
        let listening = endpoint.listening();
        session.step(now, seen, head, listening, |message| endpoint.send(now, encoder.encode(message)));
        // What is received is not used yet: this is where a command or a time request comes in.
        if now >= *next_tend {
            *next_tend = now + TEND;
            endpoint.tend(now, |_datagram| {});
        }
    }
}

/// The links that `wanted` asks for, for what comes after frame `sequence`; those of `old` whose address stays go on.
fn link(now: Time, sequence: u64, wanted: &Wanted, mut old: Vec<Link>) -> Vec<Link> {
    let MavlinkSettings { system_id, component_id, sys_status, endpoints, .. } = &wanted.settings;
    let system_id = system_id.unwrap_or(1);
    // Sockets that are no longer wanted are closed before others are opened.
    old.retain(|l| endpoints.iter().any(|e| e.address == *l.endpoint.address()));
    let mut links = Vec::with_capacity(endpoints.len());
    for settings in endpoints {
        let session = Session::new(now, sequence, &settings.streams).with_sys_status(*sys_status);
        let kept = old.iter().position(|l| *l.endpoint.address() == settings.address).map(|i| old.swap_remove(i));
        links.push(match kept {
            Some(Link { endpoint, mut encoder, .. }) => {
                encoder.identify(system_id, *component_id);
                Link { endpoint, encoder, session, next_tend: now }
            }
            None => {
                let mut endpoint = Endpoint::new(settings.address.clone());
                endpoint.tend(now, |_datagram| {});
                Link { endpoint, encoder: Encoder::new(system_id, *component_id), session, next_tend: now }
            }
        });
    }
    links
}

/// The thread's body. Returns within 0.1 s of [`Snapshot::stopping`](crate::state::Snapshot), after
/// a last heartbeat that says so. It never waits for a network, and allocates nothing for a frame.
pub fn run(shared: &Shared, switchboard: &Switchboard) {
    let mut links = Vec::new();
    let mut seen = Seen::default();
    let mut wanted = switchboard.wanted();
    let mut generation = None;
    loop {
        let snapshot = shared.wait_beyond(seen.sequence, if generation.is_none() { Duration::ZERO } else { WAIT });
        let sent = seen.sequence;
        seen.copy(&snapshot);
        let (stopping, current) = (snapshot.stopping, snapshot.generation);
        drop(snapshot);
        let now = clock::now();
        if generation != Some(current) {
            generation = Some(current);
            wanted = switchboard.wanted();
            links = link(now, sent, &wanted, links);
            *switchboard.endpoints.lock().unwrap_or_else(PoisonError::into_inner) =
                links.iter().map(|l| Arc::clone(l.endpoint.stats())).collect();
        }
        if stopping {
            for Link { endpoint, encoder, .. } in &mut links {
                endpoint.send(now, encoder.encode(&Session::farewell()));
            }
            return;
        }
        for link in &mut links {
            link.step(now, &seen, &wanted.head);
        }
    }
}
