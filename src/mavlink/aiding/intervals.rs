//! Asking the autopilot for what it does not send by itself: politely, a few times, and then never again. Pure.

use super::meter::Meter;
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
/// The rates of ATTITUDE (at most; never more than the daemon's own), and of the other two, Hz.
const RATES_HZ: f64 = 50.0;
const SLOW_HZ: f64 = 5.0;

/// A message that is wanted.
#[derive(Clone, Copy, Debug)]
struct Wanted {
    id: u32,
    hz: f64,
    comes: Meter,
}

/// One way to the autopilot.
#[derive(Clone, Copy, Debug, Default)]
struct Way {
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

impl Intervals {
    /// For a daemon of `rate_hz` with so many endpoints.
    pub fn new(rate_hz: f64, endpoints: usize) -> Self {
        let wanted = |id, hz| Wanted { id, hz, comes: Meter::default() };
        let rates = wanted(ATTITUDE_DATA::ID, rate_hz.min(RATES_HZ));
        let slow = [GLOBAL_POSITION_INT_DATA::ID, VFR_HUD_DATA::ID].map(|id| wanted(id, SLOW_HZ));
        Self { wanted: [rates, slow[0], slow[1]], ways: vec![Way::default(); endpoints] }
    }

    /// The autopilot was started again: it knows nothing of what it was asked.
    pub fn restart(&mut self) {
        self.ways.fill(Way::default());
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
        if now.since(way.heard?) < WATCHED_S {
            return None;
        }
        while let Some(wanted) = self.wanted.get(way.at) {
            if way.asked.is_some_and(|at| (0.0..ANSWER_S).contains(&now.since(at))) {
                return None;
            }
            if way.tries >= TRIES || 2.0 * wanted.comes.hz(now) >= wanted.hz {
                (way.at, way.tries, way.asked) = (way.at + 1, 0, None);
                continue;
            }
            (way.tries, way.asked) = (way.tries + 1, Some(now));
            return Some(COMMAND_LONG_DATA {
                param1: wanted.id as f32,
                param2: (1e6 / wanted.hz) as f32,
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

    /// What is asked in 30 s at endpoint 0 where `comes` of ATTITUDE arrive a second, and `answer` is the answer.
    fn asked(comes: u32, answer: Option<MavResult>) -> Vec<(u32, u32, f32)> {
        let mut intervals = Intervals::new(20.0, 1);
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
            let ids: Vec<u32> = asked(10, answer).iter().map(|a| a.1).collect();
            assert_eq!(ids, [33, 33, 33, 74, 74, 74], "{answer:?}");
        }
    }

    #[test]
    fn an_endpoint_where_it_is_not_heard_is_left_alone_and_a_start_begins_anew() {
        let mut intervals = Intervals::new(50.0, 2);
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
}
