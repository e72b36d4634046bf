//! TIMESYNC: asking the autopilot for its time, and telling others ours. Pure.

use crate::mavlink::deframe::Packet;
use crate::time::Time;
use ::mavlink::dialects::common::TIMESYNC_DATA;
use std::time::Duration;

/// Between two questions at first, and later.
const OFTEN: Duration = Duration::from_secs(1);
const SELDOM: Duration = Duration::from_secs(10);
/// Questions that are asked often; from so many answers on it is enough.
const AT_FIRST: u32 = 30;
const ENOUGH: u32 = 10;
/// Where the message says for whom it is, where it does: system, component.
const TARGET: (usize, usize) = (16, 17);

/// Who asks the autopilot.
#[derive(Clone, Debug, Default)]
pub struct Asker {
    next: Option<Time>,
    /// The last questions: when they were sent, ns.
    open: [Option<i64>; 4],
    asked: u32,
    answered: u32,
}

/// Our time as the message has it.
fn nanos(now: Time) -> i64 {
    i64::try_from(now.as_nanos()).unwrap_or(i64::MAX)
}

impl Asker {
    /// The question that is due at `now`.
    pub fn ask(&mut self, now: Time) -> Option<TIMESYNC_DATA> {
        if self.next.is_some_and(|next| now < next && next <= now + SELDOM) {
            return None;
        }
        let often = self.answered < ENOUGH && self.asked < AT_FIRST;
        self.next = Some(now + if often { OFTEN } else { SELDOM });
        self.open[self.asked as usize % self.open.len()] = Some(nanos(now));
        self.asked = self.asked.wrapping_add(1);
        Some(TIMESYNC_DATA { tc1: 0, ts1: nanos(now) })
    }

    /// When the question was asked that `message` answers, once; `None` for what answers no question of ours.
    pub fn answer(&mut self, message: &TIMESYNC_DATA) -> Option<Time> {
        let open = self.open.iter_mut().find(|o| **o == Some(message.ts1) && message.tc1 != 0)?;
        *open = None;
        self.answered = self.answered.saturating_add(1);
        u64::try_from(message.ts1).ok().map(Time::from_nanos)
    }
}

/// The answer to a question of others that is for everybody or for component `us.1` of system `us.0`, at `now`.
pub fn reply(packet: &Packet<'_>, message: &TIMESYNC_DATA, us: (u8, u8), now: Time) -> Option<TIMESYNC_DATA> {
    let target = |at: usize| packet.payload.get(at).copied().unwrap_or(0);
    let ours = |to: u8, own: u8| to == 0 || to == own;
    let for_us = ours(target(TARGET.0), us.0) && ours(target(TARGET.1), us.1);
    let own = (packet.system_id, packet.component_id) == us;
    (message.tc1 == 0 && for_us && !own).then(|| TIMESYNC_DATA { tc1: nanos(now), ts1: message.ts1 })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(s: f64) -> Time {
        Time::from_secs_f64(s)
    }

    #[test]
    fn often_at_first_and_seldom_later() {
        let mut asker = Asker::default();
        let mut asked = Vec::new();
        for ds in 0..600 {
            if let Some(m) = asker.ask(at(100.0 + f64::from(ds) / 10.0)) {
                asked.push(ds);
                assert!(asker.answer(&TIMESYNC_DATA { tc1: 7, ts1: m.ts1 + 1 }).is_none(), "another's question");
                assert_eq!(asker.answer(&TIMESYNC_DATA { tc1: 7, ts1: m.ts1 }).unwrap().as_nanos() as i64, m.ts1);
                assert!(asker.answer(&TIMESYNC_DATA { tc1: 7, ts1: m.ts1 }).is_none(), "twice");
            }
        }
        assert_eq!(asked, [0, 10, 20, 30, 40, 50, 60, 70, 80, 90, 100, 200, 300, 400, 500]);
        assert!(asker.ask(at(1.0)).is_some(), "a clock set back");
    }

    #[test]
    fn questions_for_us_or_for_all_are_answered() {
        let packet = |payload: &'static [u8], component_id| Packet {
            bytes: &[],
            v2: true,
            system_id: 1,
            component_id,
            sequence: 0,
            id: 111,
            payload,
            signature: None,
        };
        let question = TIMESYNC_DATA { tc1: 0, ts1: 99 };
        let ask = |payload, component| reply(&packet(payload, component), &question, (1, 191), at(2.0));
        assert_eq!(ask(&[0; 9], 1), Some(TIMESYNC_DATA { tc1: 2_000_000_000, ts1: 99 }));
        assert!(ask(&[0, 0, 0, 0, 0, 0, 0, 0, 9, 0, 0, 0, 0, 0, 0, 0, 1, 191], 1).is_some());
        assert!(ask(&[0, 0, 0, 0, 0, 0, 0, 0, 9, 0, 0, 0, 0, 0, 0, 0, 1, 1], 1).is_none());
        assert!(ask(&[0; 9], 191).is_none(), "our own");
        assert!(reply(&packet(&[], 1), &TIMESYNC_DATA { tc1: 5, ts1: 99 }, (1, 191), at(2.0)).is_none());
    }
}
