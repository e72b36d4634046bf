//! What is heeded of all that comes in, at whichever endpoint, and in whose name messages go out.

use super::aiding::{Ask, Listener, timesync};
use super::deframe::Packet;
use super::encode::Encoder;
use super::heard::Heard;
use super::messages::Message;
use super::service::{Change, Ids, Order, Replies, Service, Situation, apply};
use super::session::{Seen, Session};
use super::signer::Signer;
use crate::aiding::Inbox;
use crate::config::Settings;
use crate::time::Time;
use std::sync::Arc;

/// The daemon on the network, at all endpoints.
pub struct Station {
    settings: Arc<Settings>,
    /// What was ordered and is not settled yet, and the settings with it.
    pending: Vec<Change>,
    ordered: Option<Settings>,
    /// How many changes were settled since start.
    settled: usize,
    listener: Listener,
    signer: Option<Signer>,
    changes: Vec<Change>,
}

impl Station {
    /// With the first configuration; what is heard of the autopilot goes to `inbox`.
    pub fn new(settings: Arc<Settings>, inbox: Arc<Inbox>) -> Self {
        Self {
            listener: Listener::new(&settings.mavlink, settings.rate_hz, inbox),
            signer: Signer::wanted(&settings.mavlink),
            changes: Vec::new(),
            pending: Vec::new(),
            ordered: None,
            settled: 0,
            settings,
        }
    }

    /// Takes up a new configuration, with the first `settled` of all changes that were ordered since start; gives the one
    /// before, and what was ordered.
    pub fn configure(&mut self, settings: Arc<Settings>, settled: usize) -> (Arc<Settings>, Option<Settings>) {
        // A key that was of no use may have been mended when the configuration is read again.
        let useless = self.silent().is_some() && !Arc::ptr_eq(&settings, &self.settings);
        if useless || settings.mavlink.signing_key != self.settings.mavlink.signing_key {
            self.finish();
            self.signer = Signer::wanted(&settings.mavlink);
        }
        self.listener.configure(&settings.mavlink, settings.rate_hz);
        // What was ordered while this was read comes next.
        self.pending.drain(..settled.saturating_sub(self.settled).min(self.pending.len()));
        self.settled = settled;
        let wanted = apply(&settings, &self.pending).ok().filter(|_| !self.pending.is_empty());
        (std::mem::replace(&mut self.settings, settings), std::mem::replace(&mut self.ordered, wanted))
    }

    /// Why nothing is sent and nothing heeded.
    pub fn silent(&self) -> Option<&str> {
        self.signer.as_ref().and_then(Signer::trouble)
    }

    /// The configuration in force.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The autopilot's yaw, rad, where it is wanted and was heard lately.
    pub fn yaw(&self, now: Time) -> Option<f32> {
        self.listener.yaw(now).filter(|_| self.settings.mavlink.yaw)
    }

    /// The changes of settings asked for since these were taken.
    pub fn changes(&mut self) -> &mut Vec<Change> {
        &mut self.changes
    }

    fn us(&self) -> Ids {
        Ids { system: self.listener.identity().system_id(), component: self.settings.mavlink.component_id }
    }

    /// The frame of a message for endpoint number `index`, signed where there is a key. Nothing goes out unsigned where
    /// a key is wanted and cannot be had: the frame is empty then.
    pub fn encode<'a>(&mut self, encoder: &'a mut Encoder, message: &Message, index: usize) -> &'a [u8] {
        let us = self.us();
        encoder.identify(us.system, us.component);
        match &mut self.signer {
            None => encoder.encode(message),
            Some(signer) => signer.encode(encoder, message, index),
        }
    }

    /// Takes in a message that has come to endpoint number `index`.
    pub fn hear(
        &mut self,
        now: Time,
        index: usize,
        packet: &Packet<'_>,
        seen: &Seen,
        (service, session): (&mut Service, &mut Session),
        replies: &mut Replies,
    ) {
        if self.signer.as_mut().is_some_and(|s| !s.admits(now, packet)) {
            return;
        }
        let heard = Heard::new(packet);
        self.listener.hear(now, index, packet, heard.as_ref());
        let (us, from) = (self.us(), Ids { system: packet.system_id, component: packet.component_id });
        match &heard {
            Some(Heard::Request(request)) => {
                service.heed(from, request, &self.situation(now, us, seen), session, replies);
            }
            Some(Heard::Timesync(question)) => {
                let answer = timesync::reply(packet, question, (us.system, us.component), now);
                replies.messages.extend(answer.map(Message::Timesync));
            }
            _ => {}
        }
        self.obey(replies);
    }

    /// What is due of what goes on with those who ask at an endpoint.
    pub fn tend_service(&mut self, now: Time, seen: &Seen, service: &mut Service, replies: &mut Replies) {
        let us = self.us();
        service.step(&self.situation(now, us, seen), replies);
        self.obey(replies);
    }

    /// What the autopilot is to be asked at endpoint number `index`.
    pub fn ask(&mut self, now: Time, index: usize, replies: &mut Replies) {
        while let Some(ask) = self.listener.ask(now, index) {
            replies.messages.push(match ask {
                Ask::Time(question) => Message::Timesync(question),
                Ask::Interval(command) => Message::Command(command),
            });
        }
    }

    /// What is to be done now and then.
    pub fn tend(&mut self) {
        self.signer.iter_mut().for_each(Signer::tend);
    }

    /// Nothing more will be sent.
    pub fn finish(&mut self) {
        self.signer.take().into_iter().for_each(Signer::finish);
    }

    fn wanted(&self) -> &Settings {
        self.ordered.as_ref().unwrap_or(&self.settings)
    }

    fn situation<'a>(&'a self, now: Time, us: Ids, seen: &'a Seen) -> Situation<'a> {
        let (settings, wanted) = (&*self.settings, self.wanted());
        Situation { now, us, settings, wanted, seen, flying: self.listener.flying(now) }
    }

    fn obey(&mut self, replies: &mut Replies) {
        for Order::Set(changes) in replies.orders.drain(..) {
            // They were judged when they were ordered.
            if let Ok(ordered) = apply(self.wanted(), &changes) {
                self.ordered = Some(ordered);
            }
            self.pending.extend_from_slice(&changes);
            self.changes.extend(changes);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::service::Request;
    use super::super::service::request::What;
    use super::*;
    use crate::config::settings::Streams;

    #[test]
    fn parameters_are_set_against_what_was_ordered_until_that_is_taken_up() {
        let settings = Arc::new(Settings::default());
        let mut station = Station::new(Arc::clone(&settings), Arc::default());
        let mut session = Session::new(Time::default(), 0, &Streams::default());
        let name = std::array::from_fn(|i| b"IRH_ROLL_TRIM".get(i).copied().unwrap_or(0));
        let read = What::ParamRead { index: -1, name };
        let mut ask = |station: &mut Station, what| {
            let (us, seen, mut replies) = (station.us(), Seen::default(), Replies::default());
            let at = station.situation(Time::default(), us, &seen);
            let (from, request) = (Ids { system: 255, component: 190 }, Request { target: us, what });
            Service::default().heed(from, &request, &at, &mut session, &mut replies);
            station.obey(&mut replies);
            let value = |m: &Message| if let Message::Param(p) = m { Some(p.param_value) } else { None };
            let told: Vec<f32> = replies.messages.iter().filter_map(value).collect();
            let orders: Vec<String> = station.changes().drain(..).map(|c| c.value).collect();
            (told, orders.join(" "))
        };
        for (what, value, ordered) in [
            (What::ParamSet { name, value: 5.0 }, 5.0, "5"),
            (read, 5.0, ""),
            (What::ParamSet { name, value: 0.0 }, 0.0, "0"),
            (What::ParamSet { name, value: 7.0 }, 7.0, "7"),
        ] {
            assert_eq!(ask(&mut station, what), (vec![value], ordered.to_owned()), "{what:?}");
        }
        // The first of them was taken up, and the file says otherwise; the last was ordered meanwhile.
        station.configure(Arc::clone(&settings), 2);
        assert_eq!(ask(&mut station, read).0, [7.0]);
        station.configure(settings, 3);
        assert_eq!(ask(&mut station, read).0, [0.0]);
    }
}
