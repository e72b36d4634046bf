//! What the tests of all kinds of endpoints need.

use super::Endpoint;
use crate::config::settings::EndpointAddress;
use crate::mavlink::encode::Encoder;
use crate::mavlink::messages;
use crate::time::Time;
use ::mavlink::dialects::common::MavState;
use std::time::{Duration, Instant};

/// An instant that all tests count from.
pub fn at(secs: f64) -> Time {
    Time::from_secs_f64(1000.0 + secs)
}

/// Heartbeats, numbered from 0.
pub fn frames(count: usize) -> Vec<Vec<u8>> {
    let mut encoder = Encoder::new(1, 191);
    (0..count).map(|_| encoder.encode(&messages::heartbeat(MavState::MAV_STATE_ACTIVE)).to_vec()).collect()
}

/// An endpoint that has been opened at 0 s.
pub fn open(address: EndpointAddress) -> Endpoint {
    let mut endpoint = Endpoint::new(address);
    endpoint.tend(at(0.0));
    endpoint
}

/// Takes in and tends at `now` until `done`: what happens between processes takes its time.
pub fn until(endpoint: &mut Endpoint, now: Time, mut done: impl FnMut(&mut Endpoint) -> bool) {
    let begun = Instant::now();
    while !done(endpoint) {
        assert!(begun.elapsed() < Duration::from_secs(10), "{:?}", endpoint.stats().view());
        endpoint.receive(now, |_| {});
        endpoint.tend(now);
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// The sequence numbers that come in at `now` until there are `count`.
pub fn hear(endpoint: &mut Endpoint, now: Time, count: usize) -> Vec<u8> {
    let mut heard = Vec::new();
    let begun = Instant::now();
    while heard.len() < count {
        assert!(begun.elapsed() < Duration::from_secs(10), "{} of {count}", heard.len());
        endpoint.receive(now, |packet| heard.push(packet.sequence));
    }
    heard
}
