//! What is sent where, and what is heard there. Of several frames at once each attitude is sent, the last few at most.
//!
//! Two threads do it, and neither waits for the other. The one that samples sends what is due after a frame, as it is
//! awake anyway. The publisher's own waits for all endpoints at once and heeds what comes in; it opens what is closed,
//! and it sends when the other does not: because that found it at work, or has no frames any more.

use super::endpoint::stats::About;
use super::endpoint::watch::{Ready, Watch};
use super::link::{self, Link};
use super::messages;
use super::session::{Seen, Session};
use super::station::Station;
use super::switchboard::Switchboard;
use crate::clock;
use crate::state::{BEFORE, Bell, Moment, Shared, Snapshot};
use crate::time::Time;
use ::mavlink::dialects::common::MavSeverity;
use std::os::fd::AsFd;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// How often the endpoints are tended.
const TEND: Duration = Duration::from_millis(100);

/// How late that may be, and a heartbeat, where no frame takes it along.
const GRACE: Duration = Duration::from_millis(25);

/// How late while frames come: they do it, and wake nobody.
const LEISURE: Duration = Duration::from_millis(400);

/// Frames come if the last was told of no longer ago, s.
const LATELY_S: f64 = 0.2;

/// How long the last heartbeat may take on its way out of a serial port, which is then closed.
const LAST_WORD: Duration = Duration::from_millis(30);

/// How long the tlogs may take to be written when the daemon ends.
const LAST_LOG: Duration = Duration::from_millis(150);

/// How long to wait for a bell when the system has none (no file descriptors).
const NO_BELL: Duration = Duration::from_secs(1);

/// All endpoints, with what goes on there.
pub struct Publisher(Mutex<Work>);

/// The frames before the newest, and the last that was told of.
struct Unsent {
    after: u64,
    before: [Moment; BEFORE],
}

struct Work {
    links: Vec<Link>,
    seen: Seen,
    station: Station,
    /// Of the settings that are in force.
    generation: Option<u64>,
    tend: Time,
    /// When the sampling thread was last here.
    told: Time,
}

impl Publisher {
    /// With the switchboard's settings, whose signing key is read here. No endpoint is opened before [`run`](Self::run).
    pub fn new(switchboard: &Switchboard) -> Self {
        Self(Mutex::new(Work {
            links: Vec::new(),
            seen: Seen::default(),
            station: Station::new(switchboard.settings(), Arc::clone(switchboard.inbox())),
            generation: None,
            tend: Time::default(),
            told: Time::default(),
        }))
    }

    /// Sends what is due after the newest frame; for the thread that wrote it, which waits for nothing here. False if
    /// the publisher's own thread must be rung for: it is at work and does it then, or there is more to be done.
    pub fn tell(&self, shared: &Shared) -> bool {
        let Ok(mut work) = self.0.try_lock() else { return false };
        let now = clock::now();
        let sent = {
            let newest = shared.lock();
            if newest.stopping || work.generation != Some(newest.generation) {
                return false;
            }
            work.look(now, &newest)
        };
        work.told = now;
        work.send(now, sent);
        if now >= work.tend && work.is_open() {
            work.tend(now);
        }
        !work.links.iter().any(|l| l.endpoint.watch_anew()) && work.station.changes().is_empty()
    }

    /// The publisher's thread. Returns at once when [`Snapshot::stopping`] is set, after a last heartbeat that says so.
    /// It never waits for a network, and allocates nothing for a frame.
    pub fn run(&self, shared: &Shared, switchboard: &Switchboard) {
        let Some(bell) = bell(shared) else { return };
        let mut watch = Watch::default();
        loop {
            let until = self.lock().watch(&mut watch);
            let ready = watch.wait(bell.as_fd(), until);
            if ready.bell {
                bell.hush();
            }
            let mut work = self.lock();
            if !work.round(ready, shared, switchboard) {
                return;
            }
            switchboard.change(work.station.changes());
        }
    }

    fn lock(&self) -> MutexGuard<'_, Work> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Work {
    /// All that is to be done now; false when the daemon stops.
    fn round(&mut self, ready: Ready, shared: &Shared, switchboard: &Switchboard) -> bool {
        let now = clock::now();
        let (sent, stopping, generation) = {
            let newest = shared.lock();
            (self.look(now, &newest), newest.stopping, newest.generation)
        };
        if self.generation != Some(generation) {
            // In this order: what is settled meanwhile is in the settings, too.
            let (settled, trouble) = switchboard.settled();
            let (old, ordered) = self.station.configure(switchboard.settings(), settled);
            self.links = link::all(now, sent.after, self.station.settings(), std::mem::take(&mut self.links));
            // What was ordered and is not so has been answered as if it were.
            for old in ordered.iter().chain([&*old]) {
                self.links.iter_mut().for_each(|l| l.configured(now, old, self.station.settings()));
            }
            if let Some(trouble) = trouble {
                let note = messages::note(MavSeverity::MAV_SEVERITY_WARNING, trouble);
                self.links.iter_mut().enumerate().for_each(|(i, l)| l.say(now, i, &note, &mut self.station));
            }
            let silent = self.station.silent().unwrap_or_default();
            self.links.iter().for_each(|l| l.endpoint.stats().set_error(About::Key, silent.into()));
            switchboard.tell(self.links.iter().map(Link::stats).collect());
            self.generation = Some(generation);
        }
        if stopping {
            self.end(now);
            return false;
        }
        // What goes out does not wait for what has come in.
        self.send(now, sent);
        let Self { links, seen, station, .. } = self;
        for (i, link) in links.iter_mut().enumerate().filter(|(i, _)| ready.at(*i)) {
            link.receive(now, i, seen, station);
        }
        if now >= self.tend {
            self.tend(now);
        }
        true
    }

    /// Takes in the newest frame.
    fn look(&mut self, now: Time, newest: &Snapshot) -> Unsent {
        let after = self.seen.moment.sequence;
        self.seen.copy(newest);
        self.seen.yaw = self.station.yaw(now);
        Unsent { after, before: newest.before }
    }

    /// Sends what is due.
    fn send(&mut self, now: Time, unsent: Unsent) {
        let Self { links, seen, station, .. } = self;
        let newest = seen.moment;
        // Who is late has a few frames to tell of; of those before them nobody asks any more.
        for moment in unsent.before.into_iter().rev().filter(|moment| moment.sequence > unsent.after) {
            seen.moment = moment;
            for (i, link) in links.iter_mut().enumerate() {
                link.passed_over(now, i, seen, station);
            }
        }
        seen.moment = newest;
        // Serial ports first: what a write starts there goes on while the others are served.
        for serial in [true, false] {
            for (i, link) in links.iter_mut().enumerate().filter(|(_, l)| l.is_serial() == serial) {
                link.step(now, i, seen, station);
            }
        }
    }

    /// What is to be done now and then.
    fn tend(&mut self, now: Time) {
        let Self { links, seen, station, .. } = self;
        self.tend = now + TEND;
        for (i, link) in links.iter_mut().enumerate() {
            link.tend(now, i, seen, station);
        }
        station.tend();
    }

    /// Whether all endpoints are open: to open one may take its time.
    fn is_open(&self) -> bool {
        self.links.iter().all(|l| l.endpoint.is_open())
    }

    /// Adds what must be watched; gives the time until which that may be waited for. An endpoint that is flooded is left
    /// alone for a moment.
    fn watch(&self, watch: &mut Watch) -> Time {
        let now = clock::now();
        let leisure = now.since(self.told) < LATELY_S && self.is_open();
        let mut until = self.tend + if leisure { LEISURE } else { GRACE };
        for (i, link) in self.links.iter().enumerate() {
            let free_at = link.free_at();
            if free_at <= now {
                watch.of(i);
                link.endpoint.watch(watch);
            } else {
                until = until.min(free_at);
            }
        }
        until
    }

    /// The last heartbeat, and the end of the tlogs.
    fn end(&mut self, now: Time) {
        let Self { links, station, .. } = self;
        for (i, link) in links.iter_mut().enumerate() {
            link.say(now, i, &Session::farewell(), station);
        }
        for link in &mut *links {
            link.endpoint.finish(now + LAST_LOG);
        }
        if links.iter().any(Link::is_serial) {
            clock::sleep_until(now + LAST_WORD);
        }
        station.finish();
    }
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
