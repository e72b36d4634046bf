//! MAV_CMD and its acknowledgement.
//!
//! A command that is sent once more is done once more where that changes nothing (an interval, a message). A
//! calibration is not: while it goes on, its sender is told how far it is, and just after its end how it ended.

use super::calibration::{self, Calibration, Progress};
use super::change::apply;
use super::parameters::trims;
use super::request::Command;
use super::{For, Ids, Order, Replies, Service, Situation};
use crate::attitude::Attitude;
use crate::config::settings::Method;
use crate::mavlink::messages::{self, CommandAck, Message};
use crate::mavlink::session::{Asked, IntervalError, Session};
use crate::time::Time;
use ::mavlink::MessageData;
use ::mavlink::dialects::common::{
    AUTOPILOT_VERSION_DATA, COMPONENT_INFORMATION_BASIC_DATA, MESSAGE_INTERVAL_DATA, MavResult, MavSeverity,
};

/// MAV_CMD_PREFLIGHT_CALIBRATION.
const CALIBRATION: u16 = 241;
/// MAV_CMD_GET_MESSAGE_INTERVAL.
const GET_INTERVAL: u16 = 510;
/// MAV_CMD_SET_MESSAGE_INTERVAL.
const SET_INTERVAL: u16 = 511;
/// MAV_CMD_REQUEST_MESSAGE.
const REQUEST_MESSAGE: u16 = 512;
/// MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES, of old.
const REQUEST_CAPABILITIES: u16 = 520;

/// The time for which a calibration's end answers a command that is sent once more, s.
const REMEMBERED_S: f64 = 5.0;

/// How often a calibration says how far it is, s.
const REPORT_S: f64 = 1.0;

/// The progress of what has none.
const NO_PROGRESS: u8 = 255;

/// A level calibration that somebody has asked for.
#[derive(Clone, Debug)]
pub struct Level {
    from: Ids,
    calibration: Calibration,
    /// The configured trim, under which all of the mean is to be seen.
    trim: Attitude,
    percent: u8,
    reported: Time,
}

/// How the last calibration ended.
#[derive(Clone, Copy, Debug)]
pub struct Recent {
    from: Ids,
    result: MavResult,
    at: Time,
}

/// A message's number as a command's parameter holds it.
fn message_id(param: f32) -> Option<u32> {
    // Up to 2^24 a float holds each whole number.
    (param.fract() == 0.0 && (0.0..16_777_216.0).contains(&param)).then_some(param as u32)
}

fn ack(command: u16, result: MavResult, progress: u8, to: Ids) -> Message {
    let Ids { system: target_system, component: target_component } = to;
    Message::Ack(CommandAck { command, result, progress, target_system, target_component })
}

impl Service {
    pub(super) fn command(
        &mut self,
        from: Ids,
        whom: For,
        command: &Command,
        at: &Situation<'_>,
        session: &mut Session,
        replies: &mut Replies,
    ) {
        use MavResult::{MAV_RESULT_DENIED as DENIED, MAV_RESULT_UNSUPPORTED as UNSUPPORTED};
        let Command { number, params, .. } = *command;
        let before = replies.messages.len();
        let result = match number {
            SET_INTERVAL => set_interval(&params, session, replies),
            GET_INTERVAL => match message_id(params[0]) {
                Some(id) => interval(id, session, replies),
                None => DENIED,
            },
            REQUEST_MESSAGE => request(&params, at, session, replies),
            REQUEST_CAPABILITIES => {
                replies.send(messages::autopilot_version());
                MavResult::MAV_RESULT_ACCEPTED
            }
            CALIBRATION => self.calibrate(from, command, at, replies),
            _ => UNSUPPORTED,
        };
        if whom == For::Everybody && matches!(result, DENIED | UNSUPPORTED) {
            // Meant for another one, then.
            replies.messages.truncate(before);
            return;
        }
        let progress = match (&self.level, number) {
            (Some(level), CALIBRATION) => level.percent,
            _ => NO_PROGRESS,
        };
        replies.messages.insert(before, ack(number, result, progress, from));
    }

    fn calibrate(&mut self, from: Ids, command: &Command, at: &Situation<'_>, replies: &mut Replies) -> MavResult {
        use MavResult::{
            MAV_RESULT_ACCEPTED as ACCEPTED, MAV_RESULT_CANCELLED as CANCELLED, MAV_RESULT_DENIED as DENIED,
            MAV_RESULT_IN_PROGRESS as IN_PROGRESS, MAV_RESULT_TEMPORARILY_REJECTED as REJECTED,
            MAV_RESULT_UNSUPPORTED as UNSUPPORTED,
        };
        let Command { params: [gyro, mag, pressure, rc, level, airspeed, temperature], confirmation, .. } = *command;
        let others = [gyro, mag, pressure, rc, airspeed, temperature].iter().any(|p| *p != 0.0 && !p.is_nan());
        if others {
            // None of these sensors is here.
            return UNSUPPORTED;
        }
        if level == 0.0 {
            return match self.level.take() {
                Some(Level { from, .. }) => {
                    self.recent = Some(Recent { from, result: CANCELLED, at: at.now });
                    replies.send(ack(CALIBRATION, CANCELLED, NO_PROGRESS, from));
                    ACCEPTED
                }
                None => ACCEPTED,
            };
        }
        if level != 1.0 && level != 2.0 {
            return DENIED;
        }
        if let Some(level) = &self.level {
            return if level.from == from { IN_PROGRESS } else { REJECTED };
        }
        let told = |r: &Recent| r.from == from && (0.0..REMEMBERED_S).contains(&at.now.since(r.at));
        if confirmation > 0
            && let Some(recent) = self.recent.filter(told)
        {
            return recent.result;
        }
        match Calibration::begin(at.now, at.seen, at.flying) {
            Ok(calibration) => {
                self.level = Some(Level { from, calibration, trim: configured(at), percent: 0, reported: at.now });
                replies.say(MavSeverity::MAV_SEVERITY_INFO, "level calibration: keep still");
                IN_PROGRESS
            }
            Err(reason) => {
                replies.say(MavSeverity::MAV_SEVERITY_WARNING, reason);
                REJECTED
            }
        }
    }

    /// The next word on a calibration.
    pub(super) fn level_step(&mut self, at: &Situation<'_>, replies: &mut Replies) {
        let Some(level) = &mut self.level else { return };
        let from = level.from;
        let progress = if level.trim == configured(at) {
            level.calibration.step(at.now, at.seen, at.flying)
        } else {
            Progress::Failed("level calibration failed: trim changed")
        };
        let outcome = match progress {
            Progress::Going(percent) => {
                level.percent = percent;
                if at.now.since(level.reported) >= REPORT_S {
                    level.reported = at.now;
                    replies.send(ack(CALIBRATION, MavResult::MAV_RESULT_IN_PROGRESS, percent, from));
                }
                return;
            }
            Progress::Done(mean) => save(mean, at, replies),
            Progress::Failed(reason) => Err(reason),
        };
        let result = match outcome {
            Ok(()) => MavResult::MAV_RESULT_ACCEPTED,
            Err(reason) => {
                replies.say(MavSeverity::MAV_SEVERITY_WARNING, reason);
                MavResult::MAV_RESULT_FAILED
            }
        };
        self.level = None;
        self.recent = Some(Recent { from, result, at: at.now });
        replies.send(ack(CALIBRATION, result, NO_PROGRESS, from));
    }
}

/// The trim that is configured.
fn configured(at: &Situation<'_>) -> Attitude {
    Attitude::from_degrees(at.settings.head.roll_trim_deg, at.settings.head.pitch_trim_deg)
}

/// Orders the trim with which `mean` would have been level.
fn save(mean: Attitude, at: &Situation<'_>, replies: &mut Replies) -> Result<(), &'static str> {
    let (configured, learnt) = (configured(at), at.seen.trim);
    let old = Attitude { roll: configured.roll + learnt.roll, pitch: configured.pitch + learnt.pitch };
    let new = calibration::trim(mean, old, at.settings.method() != Method::InverseSine);
    let changes = trims(new.roll.to_degrees(), new.pitch.to_degrees());
    apply(at.settings, &changes).map_err(|_| "level calibration failed: trim too large")?;
    let what = format!("trim roll {:.1}, pitch {:.1} deg", new.roll.to_degrees(), new.pitch.to_degrees());
    replies.say(MavSeverity::MAV_SEVERITY_NOTICE, &what);
    replies.orders.push(Order::Set(changes.into()));
    Ok(())
}

fn set_interval(params: &[f32; 7], session: &mut Session, replies: &mut Replies) -> MavResult {
    let Some(id) = message_id(params[0]) else { return MavResult::MAV_RESULT_DENIED };
    match session.set_interval(id, params[1]) {
        Ok(()) => MavResult::MAV_RESULT_ACCEPTED,
        Err(error) => {
            if error == IntervalError::Heartbeat {
                replies.say(MavSeverity::MAV_SEVERITY_INFO, "HEARTBEAT stays at 1 Hz");
            }
            MavResult::MAV_RESULT_DENIED
        }
    }
}

fn interval(id: u32, session: &mut Session, replies: &mut Replies) -> MavResult {
    // The answer has room for 16 bits of the message's number.
    let Ok(message_id) = u16::try_from(id) else { return MavResult::MAV_RESULT_DENIED };
    let interval_us = session.interval_us(id);
    replies.send(Message::Interval(MESSAGE_INTERVAL_DATA { interval_us, message_id }));
    MavResult::MAV_RESULT_ACCEPTED
}

fn request(params: &[f32; 7], at: &Situation<'_>, session: &mut Session, replies: &mut Replies) -> MavResult {
    let Some(id) = message_id(params[0]) else { return MavResult::MAV_RESULT_DENIED };
    match id {
        AUTOPILOT_VERSION_DATA::ID => replies.send(messages::autopilot_version()),
        COMPONENT_INFORMATION_BASIC_DATA::ID => replies.send(messages::component_information(at.now)),
        MESSAGE_INTERVAL_DATA::ID => {
            return match message_id(params[1]) {
                Some(id) => interval(id, session, replies),
                None => MavResult::MAV_RESULT_DENIED,
            };
        }
        _ => {
            return match session.request(id, at.now, at.seen, |m| replies.send(m.clone())) {
                Asked::Sent => MavResult::MAV_RESULT_ACCEPTED,
                Asked::NotNow => MavResult::MAV_RESULT_TEMPORARILY_REJECTED,
                Asked::Unknown => MavResult::MAV_RESULT_DENIED,
            };
        }
    }
    MavResult::MAV_RESULT_ACCEPTED
}
