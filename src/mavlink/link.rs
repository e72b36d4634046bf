//! An endpoint with its stream, and with those who ask there.

use super::deframe::Packet;
use super::encode::Encoder;
use super::endpoint::Endpoint;
use super::endpoint::queue::Queue;
use super::endpoint::stats::EndpointStats;
use super::messages::Message;
use super::pace::Pace;
use super::service::{Replies, Service};
use super::session::{Seen, Session};
use super::station::Station;
use crate::config::Settings;
use crate::config::settings::{EndpointAddress, EndpointSettings};
use crate::head::Head;
use crate::time::Time;
use std::sync::Arc;
use std::time::Duration;

/// How often an endpoint that is flooded is given a turn.
const TURN: Duration = Duration::from_millis(2);

/// So many turns more at once: what comes in good measure is read when it comes.
const TURNS_AT_ONCE: u32 = 32;

/// An endpoint with its stream.
pub struct Link {
    /// Where it goes.
    pub endpoint: Endpoint,
    encoder: Encoder,
    session: Session,
    /// The sensors that it was last told of.
    head: Arc<Head>,
    service: Service,
    answers: Replies,
    outgoing: Queue,
    turns: Pace,
}

/// The links that `settings` ask for, for what comes after frame `sequence`; those of `old` whose address stays go on.
pub fn all(now: Time, sequence: u64, settings: &Settings, mut old: Vec<Link>) -> Vec<Link> {
    let wanted = &settings.mavlink.endpoints;
    // Sockets that are no longer wanted are closed before others are opened.
    old.retain(|l| wanted.iter().any(|e| e.address == *l.endpoint.address()));
    let one = |e: &EndpointSettings| {
        let kept = old.iter().position(|l| *l.endpoint.address() == e.address).map(|i| old.swap_remove(i));
        let mut link = kept.unwrap_or_else(|| {
            let mut endpoint = Endpoint::new(e.address.clone());
            endpoint.tend(now);
            Link {
                endpoint,
                encoder: Encoder::new(1, settings.mavlink.component_id),
                session: Session::new(now, sequence, &e.streams),
                head: Arc::default(),
                service: Service::default(),
                answers: Replies::default(),
                outgoing: Queue::default(),
                turns: Pace::new(TURN, TURNS_AT_ONCE),
            }
        });
        link.session.configure(now, &e.streams, settings.mavlink.sys_status, settings.rate_hz);
        link.endpoint.log_to(e.tlog.as_deref());
        link
    };
    wanted.iter().map(one).collect()
}

impl Link {
    /// What the endpoint has done.
    pub fn stats(&self) -> Arc<EndpointStats> {
        Arc::clone(self.endpoint.stats())
    }

    /// Whether it goes to a tty.
    pub fn is_serial(&self) -> bool {
        matches!(self.endpoint.address(), EndpointAddress::Serial { .. })
    }

    /// When there is a turn for it.
    pub fn free_at(&self) -> Time {
        self.turns.free_at()
    }

    /// The configuration has changed: whoever listens is told of it.
    pub fn configured(&mut self, now: Time, old: &Settings, new: &Settings) {
        self.service.announce(now, old, new);
    }

    /// Sends one message.
    pub fn say(&mut self, now: Time, index: usize, message: &Message, station: &mut Station) {
        self.endpoint.send(now, station.encode(&mut self.encoder, message, index));
    }

    /// Sends what is due.
    pub fn step(&mut self, now: Time, index: usize, seen: &Seen, station: &mut Station) {
        let Self { endpoint, encoder, session, head, .. } = self;
        let listening = endpoint.listening();
        let mut send = |message: &Message| endpoint.send(now, station.encode(encoder, message, index));
        if !Arc::ptr_eq(head, &seen.head) {
            if **head != *seen.head {
                session.forget(&**head, &mut send);
            }
            *head = Arc::clone(&seen.head);
        }
        session.step(now, seen, &*seen.head, listening, send);
    }

    /// Sends the attitude of a frame that was passed over.
    pub fn passed_over(&mut self, now: Time, index: usize, seen: &Seen, station: &mut Station) {
        let Self { endpoint, encoder, session, .. } = self;
        session.passed_over(now, seen, |message| endpoint.send(now, station.encode(encoder, message, index)));
    }

    /// Takes in what has come, and answers.
    pub fn receive(&mut self, now: Time, index: usize, seen: &Seen, station: &mut Station) {
        let Self { endpoint, encoder, session, service, answers, outgoing, turns, .. } = self;
        turns.take(now);
        let mut dropped = 0;
        endpoint.receive(now, |packet: &Packet<'_>| {
            station.hear(now, index, packet, seen, (service, session), answers);
            for answer in answers.messages.drain(..) {
                dropped += outgoing.push(station.encode(encoder, &answer, index));
            }
        });
        self.flush(now, dropped);
    }

    /// What is to be done now and then: the endpoint's own affairs, what goes on with those who ask, and questions of
    /// ours.
    pub fn tend(&mut self, now: Time, index: usize, seen: &Seen, station: &mut Station) {
        self.endpoint.tend(now);
        station.tend_service(now, seen, &mut self.service, &mut self.answers);
        station.ask(now, index, &mut self.answers);
        let Self { encoder, answers, outgoing, .. } = self;
        let mut dropped = 0;
        for answer in answers.messages.drain(..) {
            dropped += outgoing.push(station.encode(encoder, &answer, index));
        }
        self.flush(now, dropped);
    }

    fn flush(&mut self, now: Time, dropped: u64) {
        self.endpoint.stats().dropped(dropped);
        while let Some(frame) = self.outgoing.front() {
            let length = frame.len();
            self.endpoint.send(now, frame);
            self.outgoing.gone(length);
        }
    }
}
