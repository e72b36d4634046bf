//! The parameter protocol: reading, setting, and the list, which goes out slowly.

use super::change::apply;
use super::parameters::{self, MOST};
use super::request::ParamId;
use super::{For, Ids, Order, Replies, Situation, effect};
use crate::config::Settings;
use crate::mavlink::messages::Message;
use crate::time::Time;
use ::mavlink::dialects::common::{MavParamError, MavParamType, MavSeverity, PARAM_ERROR_DATA, PARAM_VALUE_DATA};
use ::mavlink::types::CharArray;
use std::time::Duration;

/// The time between two parameters of a list.
const PACE: Duration = Duration::from_millis(50);

/// Parameters that are set in a second at most: each is judged by the configuration's rules, which takes its time. One
/// too many is not answered, and is asked again by whoever knows the protocol.
const SETS_PER_S: u32 = 20;

// One bit of a u128 for each parameter.
const _: () = assert!(MOST <= 128);

/// What is still to be told, and how fast.
#[derive(Clone, Debug, Default)]
pub struct List {
    pending: u128,
    next: Time,
    sets: u32,
    sets_since: Time,
}

fn all(count: usize) -> u128 {
    // `count` is at most 128.
    u128::MAX.checked_shr(128_u32.saturating_sub(count as u32)).unwrap_or(0)
}

fn param_value(settings: &Settings, index: usize) -> Option<Message> {
    Some(Message::Param(PARAM_VALUE_DATA {
        param_value: parameters::value(settings, index)?,
        param_count: parameters::count(settings) as u16,
        param_index: index as u16,
        param_id: parameters::name(settings, index)?.as_str().into(),
        param_type: MavParamType::MAV_PARAM_TYPE_REAL32,
    }))
}

fn no_such(from: Ids, index: i16, name: &ParamId) -> Message {
    Message::ParamError(PARAM_ERROR_DATA {
        param_index: index,
        target_system: from.system,
        target_component: from.component,
        param_id: CharArray::new(*name),
        error: MavParamError::MAV_PARAM_ERROR_DOES_NOT_EXIST,
    })
}

impl List {
    /// Begins the list, anew if it has begun.
    pub fn begin(&mut self, now: Time) {
        self.pending = u128::MAX;
        self.next = self.next.min(now + PACE);
    }

    /// Sends the next one if it is its time.
    pub fn step(&mut self, at: &Situation<'_>, replies: &mut Replies) {
        // A clock set back does not stop the list.
        let due = at.now >= self.next || self.next.since(at.now) > PACE.as_secs_f64();
        self.pending &= all(parameters::count(at.wanted));
        if self.pending == 0 || !due {
            return;
        }
        let index = self.pending.trailing_zeros();
        self.pending &= self.pending - 1;
        self.next = at.now + PACE;
        if let Some(message) = param_value(at.wanted, index as usize) {
            replies.send(message);
        }
    }

    /// Those that differ are told, at the list's pace.
    pub fn announce(&mut self, now: Time, old: &Settings, new: &Settings) {
        for i in 0..parameters::count(new) {
            if parameters::value(old, i) != parameters::value(new, i) {
                self.pending |= 1 << i;
            }
        }
        self.next = self.next.min(now + PACE);
    }

    /// PARAM_REQUEST_READ.
    pub fn read(
        &mut self,
        from: Ids,
        whom: For,
        index: i16,
        name: &ParamId,
        at: &Situation<'_>,
        replies: &mut Replies,
    ) {
        let found = match usize::try_from(index) {
            Ok(index) => Some(index),
            Err(_) => parameters::find(at.wanted, name),
        };
        match found.and_then(|i| param_value(at.wanted, i)) {
            Some(message) => replies.send(message),
            None if whom == For::Us => replies.send(no_such(from, index, name)),
            None => {}
        }
    }

    /// PARAM_SET. A value that is not good is answered with the one that stays, and the reason in words.
    pub fn set(&mut self, from: Ids, whom: For, name: &ParamId, value: f32, at: &Situation<'_>, replies: &mut Replies) {
        if !(0.0..1.0).contains(&at.now.since(self.sets_since)) {
            (self.sets, self.sets_since) = (0, at.now);
        }
        if self.sets >= SETS_PER_S {
            return;
        }
        self.sets += 1;
        let Some(index) = parameters::find(at.wanted, name) else {
            if whom == For::Us {
                replies.send(no_such(from, -1, name));
            }
            return;
        };
        if parameters::value(at.wanted, index) == Some(value) {
            param_value(at.wanted, index).into_iter().for_each(|m| replies.send(m));
            return;
        }
        let name = parameters::name(at.wanted, index).unwrap_or_default();
        let wanted = parameters::change(at.wanted, index, value);
        let outcome = wanted.and_then(|c| Ok((apply(at.wanted, std::slice::from_ref(&c)).map_err(reason)?, c)));
        match outcome {
            Ok((new, change)) => {
                param_value(&new, index).into_iter().for_each(|m| replies.send(m));
                let effect = effect(at.wanted, &new);
                replies.say(MavSeverity::MAV_SEVERITY_INFO, &format!("{name} {effect}"));
                replies.orders.push(Order::Set(vec![change]));
            }
            Err(wanted) => {
                param_value(at.wanted, index).into_iter().for_each(|m| replies.send(m));
                replies.say(MavSeverity::MAV_SEVERITY_WARNING, &format!("{name} needs {wanted}"));
            }
        }
    }
}

/// What the configuration wants instead, in the last part of its error: there is little room in a STATUSTEXT.
fn reason(error: String) -> String {
    match error.split_once("is out of range: ") {
        Some((_, wanted)) => wanted.to_owned(),
        None => error,
    }
}
