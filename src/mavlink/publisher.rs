//! The thread that sends and hears: waits for a frame and for all endpoints at once, tells every endpoint, heeds
//! what has come in. Of several frames at once it sends each attitude, the last few at most.

use super::endpoint::watch::{Ready, Watch};
use super::link::{self, Link};
use super::session::{Seen, Session};
use super::station::Station;
use super::switchboard::Switchboard;
use crate::clock;
use crate::config::settings::EndpointAddress;
use crate::state::{Bell, Shared};
use crate::time::Time;
use std::os::fd::AsFd;
use std::sync::Arc;
use std::time::Duration;

/// How often the endpoints are tended.
const TEND: Duration = Duration::from_millis(100);

/// How late that may be, and a heartbeat: mostly it is done along with a frame, and wakes nobody.
const GRACE: Duration = Duration::from_millis(25);

/// How long the last heartbeat may take on its way out of a serial port, which is then closed.
const LAST_WORD: Duration = Duration::from_millis(30);

/// How long the tlogs may take to be written when the daemon ends.
const LAST_LOG: Duration = Duration::from_millis(150);

/// How long to wait for a bell when the system has none (no file descriptors).
const NO_BELL: Duration = Duration::from_secs(1);

/// Waits until the bell rings, something has come to an endpoint or can go out there, or `until`. An endpoint that is
/// flooded is left alone for a moment.
fn wait(bell: &Bell, links: &[Link], mut until: Time) -> Ready {
    let mut watch = Watch::new(bell.as_fd());
    let now = clock::now();
    for (i, link) in links.iter().enumerate() {
        let free_at = link.free_at();
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
fn end(now: Time, links: &mut [Link], station: &mut Station) {
    for (i, link) in links.iter_mut().enumerate() {
        link.say(now, i, &Session::farewell(), station);
    }
    for link in &mut *links {
        link.endpoint.finish(now + LAST_LOG);
    }
    if links.iter().any(|l| matches!(l.endpoint.address(), EndpointAddress::Serial { .. })) {
        clock::sleep_until(now + LAST_WORD);
    }
    station.finish();
}

/// The thread's body. Returns at once when [`Snapshot::stopping`](crate::state::Snapshot) is set, after a last
/// heartbeat that says so. It never waits for a network, and allocates nothing for a frame.
pub fn run(shared: &Shared, switchboard: &Switchboard) {
    let Some(bell) = bell(shared) else { return };
    let mut links = Vec::new();
    let mut seen = Seen::default();
    let mut station = Station::new(switchboard.settings(), Arc::clone(switchboard.inbox()));
    let mut generation = None;
    let mut tend = Time::default();
    loop {
        let ready = wait(&bell, &links, tend + GRACE);
        let now = clock::now();
        if ready.bell {
            bell.hush();
        }
        let sent = seen.moment.sequence;
        let (stopping, current, before) = {
            let snapshot = shared.lock();
            seen.copy(&snapshot);
            (snapshot.stopping, snapshot.generation, snapshot.before)
        };
        seen.yaw = station.yaw(now);
        if generation != Some(current) {
            let old = station.configure(switchboard.settings());
            links = link::all(now, sent, station.settings(), links);
            links.iter_mut().for_each(|l| l.configured(now, &old, station.settings()));
            switchboard.tell(links.iter().map(Link::stats).collect());
            generation = Some(current);
        }
        if stopping {
            end(now, &mut links, &mut station);
            return;
        }
        // A thread that is woken late has a few frames to tell of; of those before them nobody asks any more.
        let newest = seen.moment;
        for moment in before.into_iter().rev().filter(|moment| moment.sequence > sent) {
            seen.moment = moment;
            for (i, link) in links.iter_mut().enumerate() {
                link.passed_over(now, i, &seen, &mut station);
            }
        }
        seen.moment = newest;
        // What goes out does not wait for what has come in.
        for (i, link) in links.iter_mut().enumerate() {
            link.step(now, i, &seen, &mut station);
        }
        for (i, link) in links.iter_mut().enumerate().filter(|(i, _)| ready.at(*i)) {
            link.receive(now, i, &seen, &mut station);
        }
        if now >= tend {
            tend = now + TEND;
            for (i, link) in links.iter_mut().enumerate() {
                link.tend(now, i, &seen, &mut station);
            }
            station.tend();
        }
        switchboard.change(station.changes());
    }
}
