//! Asking the autopilot for what it does not send by itself: politely, a few times, and then never again. Pure.

use super::meter::Meter;
use crate::config::settings::EndpointAddress;
use crate::time::Time;
use ::mavlink::MessageData;
use ::mavlink::dialects::common::{
    ATTITUDE_DATA, COMMAND_LONG_DATA, GLOBAL_POSITION_INT_DATA, MavCmd, MavResult, VFR_HUD_DATA,
};

/// So long it is watched what comes unasked, s.
const WATCHED_S: f64 = 3.0;
/// So long an answer is waited for, s.
const ANSWER_S: f64 = 1.5;
/// How often the same is asked.
const TRIES: u8 = 3;
/// What comes at so much of the rate that is wanted is not asked for: 50 Hz are not 100.
const ENOUGH: f64 = 0.7;
/// The rate of what is no body rate, Hz.
const SLOW_HZ: f64 = 5.0;
/// ATTITUDE takes so many bits of a serial line: 40 bytes and what frames them.
const BITS: f64 = 400.0;
/// And may take so much of what the line carries.
const SHARE: f64 = 0.35;

/// A message that is wanted.
#[derive(Clone, Copy, Debug)]
struct Wanted {
    id: u32,
    hz: f64,
    comes: Meter,
}

/// One way to the autopilot.
#[derive(Clone, Copy, Debug)]
struct Way {
    /// ATTITUDE comes no more often than this, Hz.
    most_hz: f64,
    heard: Option<Time>,
    /// Which of the wanted is the next.
    at: usize,
    tries: u8,
    asked: Option<Time>,
}

/// What is wanted, and what has been asked for at each endpoint.
#[derive(Clone, Debug)]
pub struct Intervals {
    wanted: [Wanted; 3],
    ways: Vec<Way>,
}

impl Way {
    fn new(endpoint: &EndpointAddress) -> Self {
        Self::to(match endpoint {
            EndpointAddress::Serial { baud, .. } => (SHARE * f64::from(*baud) / BITS).floor().max(1.0),
            _ => f64::INFINITY,
        })
    }

    fn to(most_hz: f64) -> Self {
        Self { most_hz, heard: None, at: 0, tries: 0, asked: None }
    }
}

impl Intervals {
    /// For ATTITUDE `rates_hz` times a second where the way there is wide enough, with these endpoints. 0: nothing is
    /// asked for.
    pub fn new(rates_hz: f64, endpoints: &[EndpointAddress]) -> Self {
        let wanted = |id, hz| Wanted { id, hz, comes: Meter::default() };
        let rates = wanted(ATTITUDE_DATA::ID, rates_hz);
        let slow = [GLOBAL_POSITION_INT_DATA::ID, VFR_HUD_DATA::ID].map(|id| wanted(id, SLOW_HZ));
        Self { wanted: [rates, slow[0], slow[1]], ways: endpoints.iter().map(Way::new).collect() }
    }

    /// The autopilot was started again: it knows nothing of what it was asked.
    pub fn restart(&mut self) {
        self.ways.iter_mut().for_each(|way| *way = Way::to(way.most_hz));
        self.wanted.iter_mut().for_each(|w| w.comes = Meter::default());
    }

    /// The autopilot has sent message `id`, which came at `endpoint`.
    pub fn heard(&mut self, now: Time, endpoint: usize, id: u32) {
        if let Some(way) = self.ways.get_mut(endpoint) {
            way.heard.get_or_insert(now);
        }
        self.wanted.iter_mut().filter(|w| w.id == id).for_each(|w| w.comes.count(now));
    }

    /// The autopilot has answered at `endpoint`. Whatever it says is taken for its last word, but for "not now".
    pub fn answered(&mut self, endpoint: usize, result: MavResult) {
        let Some(way) = self.ways.get_mut(endpoint).filter(|w| w.asked.is_some()) else { return };
        if result != MavResult::MAV_RESULT_TEMPORARILY_REJECTED {
            (way.at, way.tries, way.asked) = (way.at + 1, 0, None);
        }
    }

    /// What component 1 of `system` is to be asked at `endpoint` now.
    pub fn ask(&mut self, now: Time, endpoint: usize, system: u8) -> Option<COMMAND_LONG_DATA> {
        let way = self.ways.get_mut(endpoint)?;
        if self.wanted[0].hz <= 0.0 {
            return None;
        }
        if now.since(way.heard?) < WATCHED_S {
            return None;
        }
        while let Some(wanted) = self.wanted.get(way.at) {
            if way.asked.is_some_and(|at| (0.0..ANSWER_S).contains(&now.since(at))) {
                return None;
            }
            let hz = wanted.hz.min(way.most_hz);
            if way.tries >= TRIES || wanted.comes.hz(now) >= ENOUGH * hz {
                (way.at, way.tries, way.asked) = (way.at + 1, 0, None);
                continue;
            }
            (way.tries, way.asked) = (way.tries + 1, Some(now));
            return Some(COMMAND_LONG_DATA {
                param1: wanted.id as f32,
                param2: (1e6 / hz) as f32,
                command: MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL,
                target_system: system,
                target_component: 1,
                confirmation: way.tries - 1,
                ..COMMAND_LONG_DATA::DEFAULT
            });
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(ms: u32) -> Time {
        Time::from_secs_f64(20.0 + f64::from(ms) / 1000.0)
    }

    fn ways(of: &[&str]) -> Vec<EndpointAddress> {
        let address = |of: &&str| match of.parse() {
            Ok(baud) => EndpointAddress::Serial { path: "/dev/ttyS0".into(), baud },
            Err(_) => EndpointAddress::UdpIn(of.parse().unwrap()),
        };
        of.iter().map(address).collect()
    }

    /// What is asked in 30 s at endpoint 0 where `comes` of ATTITUDE arrive a second, and `answer` is the answer.
    fn asked(comes: u32, answer: Option<MavResult>) -> Vec<(u32, u32, f32)> {
        let mut intervals = Intervals::new(20.0, &ways(&["[::]:14550"]));
        let mut asked = Vec::new();
        for ms in (0..30_000).step_by(10) {
            if ms % 1000 == 0 {
                intervals.heard(at(ms), 0, 0);
            }
            if comes > 0 && ms % (1000 / comes) == 0 {
                intervals.heard(at(ms), 0, 30);
            }
            if let Some(m) = intervals.ask(at(ms), 0, 7) {
                assert_eq!((m.target_system, m.target_component, m.command as u16), (7, 1, 511));
                asked.push((ms, m.param1 as u32, m.param2));
                answer.into_iter().for_each(|a| intervals.answered(0, a));
            }
        }
        asked
    }

    #[test]
    fn each_is_asked_for_once_where_it_is_answered() {
        let all = [(30, 50_000.0), (33, 200_000.0), (74, 200_000.0)];
        for answer in [MavResult::MAV_RESULT_ACCEPTED, MavResult::MAV_RESULT_UNSUPPORTED] {
            let asked = asked(4, Some(answer));
            assert_eq!(asked.iter().map(|a| (a.1, a.2)).collect::<Vec<_>>(), all);
            assert!(asked[0].0 >= 3000, "not before it has been watched");
        }
    }

    #[test]
    fn three_times_where_there_is_no_answer_and_not_at_all_for_what_comes() {
        for answer in [None, Some(MavResult::MAV_RESULT_TEMPORARILY_REJECTED)] {
            let ids: Vec<u32> = asked(20, answer).iter().map(|a| a.1).collect();
            assert_eq!(ids, [33, 33, 33, 74, 74, 74], "{answer:?}");
        }
    }

    #[test]
    fn an_endpoint_where_it_is_not_heard_is_left_alone_and_a_start_begins_anew() {
        let mut intervals = Intervals::new(50.0, &ways(&["57600", "[::]:14550"]));
        intervals.heard(at(0), 1, 0);
        intervals.heard(at(0), 9, 0);
        assert!(intervals.ask(at(9000), 0, 1).is_none() && intervals.ask(at(9000), 9, 1).is_none());
        assert!(intervals.ask(at(9000), 1, 1).is_some());
        intervals.restart();
        assert!(intervals.ask(at(9900), 1, 1).is_none());
        intervals.answered(1, MavResult::MAV_RESULT_ACCEPTED);
        intervals.heard(at(10_000), 1, 0);
        assert_eq!(intervals.ask(at(13_000), 1, 1).map(|m| m.param1), Some(30.0));
    }

    #[test]
    fn no_more_than_a_third_of_a_serial_line_and_nothing_where_it_is_to_be_nothing() {
        let hz = |hz, way| {
            let mut intervals = Intervals::new(hz, &ways(&[way]));
            intervals.heard(at(0), 0, 0);
            intervals.ask(at(4000), 0, 1).map(|m| (1e6 / m.param2).round())
        };
        assert_eq!([0.0, 5.0, 200.0].map(|asked| hz(asked, "[::]:14550")), [None, Some(5.0), Some(200.0)]);
        let serial = ["9600", "57600", "115200", "921600"].map(|baud| hz(100.0, baud));
        assert_eq!(serial, [Some(8.0), Some(50.0), Some(100.0), Some(100.0)]);
    }
}
