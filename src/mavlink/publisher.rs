//! The thread that sends and hears: waits for a frame and for all endpoints at once, tells every endpoint, heeds
//! what has come in.

use super::deframe::Packet;
use super::encode::Encoder;
use super::endpoint::Endpoint;
use super::endpoint::queue::Queue;
use super::endpoint::stats::EndpointStats;
use super::endpoint::watch::{Ready, Watch};
use super::messages::Message;
use super::pace::Pace;
use super::session::{Seen, Session};
use crate::clock;
use crate::config::settings::{EndpointAddress, MavlinkSettings};
use crate::ctl::view;
use crate::head::Head;
use crate::state::{Bell, Shared};
use crate::time::Time;
use std::os::fd::AsFd;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// How often the endpoints are tended.
const TEND: Duration = Duration::from_millis(100);

/// How late that may be, and a heartbeat: mostly it is done along with a frame, and wakes nobody.
const GRACE: Duration = Duration::from_millis(25);

/// How often an endpoint that is flooded is given a turn.
const TURN: Duration = Duration::from_millis(2);

/// So many turns more at once: what comes in good measure is read when it comes.
const TURNS_AT_ONCE: u32 = 32;

/// How long the last heartbeat may take on its way out of a serial port, which is then closed.
const LAST_WORD: Duration = Duration::from_millis(30);

/// How long the tlogs may take to be written when the daemon ends.
const LAST_LOG: Duration = Duration::from_millis(150);

/// How long to wait for a bell when the system has none (no file descriptors).
const NO_BELL: Duration = Duration::from_secs(1);

/// What heeds a message that has come in: when, at the endpoint with which index, the message, and how to reply. A
/// reply goes out right after it, to all who listen at that endpoint.
pub type Heed<'a> = dyn FnMut(Time, usize, &Packet<'_>, &mut dyn FnMut(&Message)) + 'a;

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
    replies: Queue,
    turns: Pace,
}

impl Link {
    fn new(endpoint: Endpoint, encoder: Encoder, session: Session) -> Self {
        let turns = Pace::new(TURN, TURNS_AT_ONCE);
        Self { endpoint, encoder, session, replies: Queue::default(), turns }
    }

    /// Sends what is due.
    fn step(&mut self, now: Time, seen: &Seen, head: &Head) {
        let Self { endpoint, encoder, session, .. } = self;
        let listening = endpoint.listening();
        session.step(now, seen, head, listening, |message| endpoint.send(now, encoder.encode(message)));
    }

    /// Takes in what has come to the endpoint, which is the one with this index.
    fn receive(&mut self, now: Time, index: usize, heed: &mut Heed<'_>) {
        let Self { endpoint, encoder, replies, turns, .. } = self;
        turns.take(now);
        let mut dropped = 0;
        endpoint.receive(now, |packet| {
            heed(now, index, packet, &mut |message| dropped += replies.push(encoder.encode(message)));
        });
        endpoint.stats().dropped(dropped);
        while let Some(reply) = replies.front() {
            let length = reply.len();
            endpoint.send(now, reply);
            replies.gone(length);
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
        let mut link = match kept {
            Some(Link { endpoint, mut encoder, .. }) => {
                encoder.identify(system_id, *component_id);
                Link::new(endpoint, encoder, session)
            }
            None => {
                let mut endpoint = Endpoint::new(settings.address.clone());
                endpoint.tend(now);
                Link::new(endpoint, Encoder::new(system_id, *component_id), session)
            }
        };
        link.endpoint.log_to(settings.tlog.as_deref());
        links.push(link);
    }
    links
}

/// Waits until the bell rings, something has come to an endpoint or can go out there, or `until`. An endpoint that is
/// flooded is left alone for a moment.
fn wait(bell: &Bell, links: &[Link], mut until: Time) -> Ready {
    let mut watch = Watch::new(bell.as_fd());
    let now = clock::now();
    for (i, link) in links.iter().enumerate() {
        let free_at = link.turns.free_at();
        if free_at <= now {
            watch.of(i);
            link.endpoint.watch(&mut watch);
        } else {
            until = until.min(free_at);
        }
    }
    watch.wait(until)
}

/// The bell, as soon as there is one; `None`: the daemon stops.
fn bell(shared: &Shared) -> Option<Bell> {
    let mut told = false;
    loop {
        match shared.bell() {
            Ok(bell) => return Some(bell),
            Err(e) if !told => log::error!("MAVLink: nothing to wait with: {e}; will try again (ulimit -n)"),
            Err(_) => {}
        }
        told = true;
        if shared.wait_beyond(u64::MAX, NO_BELL).stopping {
            return None;
        }
    }
}

/// The last heartbeat, and the end of the tlogs.
fn end(now: Time, links: &mut [Link]) {
    for Link { endpoint, encoder, .. } in &mut *links {
        endpoint.send(now, encoder.encode(&Session::farewell()));
    }
    for link in &mut *links {
        link.endpoint.finish(now + LAST_LOG);
    }
    if links.iter().any(|l| matches!(l.endpoint.address(), EndpointAddress::Serial { .. })) {
        clock::sleep_until(now + LAST_WORD);
    }
}

/// The thread's body. Returns at once when [`Snapshot::stopping`](crate::state::Snapshot) is set, after a last
/// heartbeat that says so. It never waits for a network, and allocates nothing for a frame.
pub fn run(shared: &Shared, switchboard: &Switchboard) {
    run_heeding(shared, switchboard, &mut |_, _, _, _| {});
}

/// The same, with something that heeds what comes in.
pub fn run_heeding(shared: &Shared, switchboard: &Switchboard, heed: &mut Heed<'_>) {
    let Some(bell) = bell(shared) else { return };
    let mut links = Vec::new();
    let mut seen = Seen::default();
    let mut wanted = switchboard.wanted();
    let mut generation = None;
    let mut tend = Time::default();
    loop {
        let ready = wait(&bell, &links, tend + GRACE);
        let now = clock::now();
        if ready.bell {
            bell.hush();
        }
        let sent = seen.sequence;
        let (stopping, current) = {
            let snapshot = shared.lock();
            seen.copy(&snapshot);
            (snapshot.stopping, snapshot.generation)
        };
        if generation != Some(current) {
            generation = Some(current);
            wanted = switchboard.wanted();
            links = link(now, sent, &wanted, links);
            *switchboard.endpoints.lock().unwrap_or_else(PoisonError::into_inner) =
                links.iter().map(|l| Arc::clone(l.endpoint.stats())).collect();
        }
        if stopping {
            return end(now, &mut links);
        }
        // What goes out does not wait for what has come in.
        for link in &mut links {
            link.step(now, &seen, &wanted.head);
        }
        for (i, link) in links.iter_mut().enumerate().filter(|(i, _)| ready.at(*i)) {
            link.receive(now, i, heed);
        }
        if now >= tend {
            tend = now + TEND;
            links.iter_mut().for_each(|l| l.endpoint.tend(now));
        }
    }
}
