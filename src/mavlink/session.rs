//! Which messages are due when: the state of one endpoint's outgoing stream. Pure; time comes in
//! as an argument.
//!
//! Nothing goes out on the strength of this thread being alive. What is told depends on the age of
//! the newest frame: from 1 s on (2.5 frames, if that is longer) the heartbeat is critical and says so
//! in words, from 3 s on there is silence, and every ground station shows the component as lost.

mod rates;
mod seen;

pub use rates::IntervalError;
pub use seen::Seen;

use super::messages::{self, Message};
use crate::attitude::Mode;
use crate::config::settings::Streams;
use crate::fault::{Evidence, FaultKind, FaultName};
use crate::time::Time;
use ::mavlink::MessageData;
use ::mavlink::dialects::common::{
    ATTITUDE_DATA, ATTITUDE_QUATERNION_COV_DATA, ATTITUDE_QUATERNION_DATA, HEARTBEAT_DATA, MavSeverity, MavState,
    NAMED_VALUE_FLOAT_DATA, STATUSTEXT_DATA, SYS_STATUS_DATA,
};
use rates::{Rate, Rates, SECOND, after, is_new};

/// The age of the newest frame at which sampling counts as dead, s; so many periods of slow frames.
const DEAD_AFTER_S: f64 = 1.0;
const DEAD_AFTER_FRAMES: f64 = 2.5;

/// The age of the newest frame from which on nothing is sent, s.
const SILENT_AFTER_S: f64 = 3.0;

/// STATUSTEXT messages in a second at most. Faults that come and go faster are told less often,
/// and the last word is always the true one.
const TEXTS_PER_S: u32 = 8;

/// A heartbeat that tells of another state goes out at once, so long after the last one at least, s.
const BEATS_APART_S: f64 = 0.1;

/// What has been told to withhold the attitude is not told to do so again within so long, s.
const WITHHELD_AGAIN_S: f64 = 5.0;

/// One form of the attitude, if there is any.
type Form = fn(&Seen) -> Option<Message>;

/// What became of a request for a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Asked {
    /// It was sent.
    Sent,
    /// There is nothing to send at the moment.
    NotNow,
    /// It is none of the session's messages.
    Unknown,
}

/// A fault that was told.
#[derive(Clone, Copy, Debug)]
struct Told {
    kind: FaultKind,
    /// When it was told to withhold the attitude.
    withheld: Option<Time>,
}

/// The state of one endpoint's stream.
#[derive(Clone, Debug)]
pub struct Session {
    started: Time,
    rates: Rates,
    texts_wanted: bool,
    sequence: u64,
    attitude_time: Option<Time>,
    contrast_time: Option<Time>,
    next_second: Time,
    /// The state that the last heartbeat told, and when.
    beat: Option<(MavState, Time)>,
    /// What the last SYS_STATUS said.
    healthy: Option<bool>,
    told: Vec<Told>,
    /// A text has said that the attitude is withheld.
    told_withheld: bool,
    texts: u32,
    texts_since: Time,
}

impl Session {
    /// A stream that begins at `now`, after frame `sequence`, of what `streams` says.
    pub fn new(now: Time, sequence: u64, streams: &Streams) -> Self {
        Self {
            started: now,
            rates: Rates::new(streams, now),
            texts_wanted: streams.texts,
            sequence,
            attitude_time: None,
            contrast_time: None,
            next_second: now,
            beat: None,
            healthy: None,
            told: Vec::with_capacity(16),
            told_withheld: false,
            texts: 0,
            texts_since: now,
        }
    }

    /// With SYS_STATUS as well, if `wanted`.
    pub fn with_sys_status(mut self, wanted: bool) -> Self {
        self.rates.set_sys_status(wanted);
        self
    }

    /// Of a daemon that scans `hz` times a second: nothing goes out more often.
    pub fn with_frame_rate(mut self, hz: f64) -> Self {
        self.rates.set_frame_rate(hz);
        self
    }

    /// Other settings, from `now` on. Intervals that somebody has asked for stay.
    pub fn configure(&mut self, now: Time, streams: &Streams, sys_status: bool, frame_hz: f64) {
        self.rates.configure(streams, now);
        self.rates.set_sys_status(sys_status);
        self.rates.set_frame_rate(frame_hz);
        self.texts_wanted = streams.texts;
    }

    /// Sends message `id` every `interval_us` microseconds, -1 for never, 0 for as configured.
    pub fn set_interval(&mut self, id: u32, interval_us: f32) -> Result<(), IntervalError> {
        self.rates.set(id, interval_us)
    }

    /// The interval of message `id`, µs; -1 while it is not sent, 0 if it is none that goes out at intervals.
    pub fn interval_us(&mut self, id: u32) -> i32 {
        self.rates.interval_us(id)
    }

    /// Sends message `id` once, at `now`, out of turn; but nothing breaks the silence.
    pub fn request(&mut self, id: u32, now: Time, seen: &Seen, mut send: impl FnMut(&Message)) -> Asked {
        let age_s = self.age_s(now, seen);
        let dead = age_s >= self.dead_after_s();
        let message = match id {
            HEARTBEAT_DATA::ID | SYS_STATUS_DATA::ID | STATUSTEXT_DATA::ID | NAMED_VALUE_FLOAT_DATA::ID
                if age_s >= SILENT_AFTER_S =>
            {
                None
            }
            HEARTBEAT_DATA::ID => Some(messages::heartbeat(Self::state(dead, seen))),
            SYS_STATUS_DATA::ID => Some(messages::sys_status(!dead && messages::healthy(&seen.moment))),
            // What is wrong is told by the next step, once more.
            STATUSTEXT_DATA::ID => {
                self.told.clear();
                let well = seen.faults.is_empty() && !dead;
                if well {
                    send(&messages::note(MavSeverity::MAV_SEVERITY_INFO, "no fault"));
                }
                return if well || self.texts_wanted { Asked::Sent } else { Asked::NotNow };
            }
            NAMED_VALUE_FLOAT_DATA::ID => {
                self.contrast_time = None;
                self.values(now, seen, dead, &mut send);
                return Asked::Sent;
            }
            ATTITUDE_DATA::ID if !dead => messages::attitude(seen),
            ATTITUDE_QUATERNION_DATA::ID if !dead => messages::quaternion(seen),
            ATTITUDE_QUATERNION_COV_DATA::ID if !dead => messages::covariance(seen),
            ATTITUDE_DATA::ID | ATTITUDE_QUATERNION_DATA::ID | ATTITUDE_QUATERNION_COV_DATA::ID => None,
            _ => return Asked::Unknown,
        };
        message.map_or(Asked::NotNow, |m| {
            send(&m);
            Asked::Sent
        })
    }

    /// Gives `send` what is due at `now`. While nobody is `listening` no fault is told; all that
    /// are there are told as soon as somebody does.
    pub fn step(
        &mut self,
        now: Time,
        seen: &Seen,
        names: &dyn FaultName,
        listening: bool,
        mut send: impl FnMut(&Message),
    ) {
        let age_s = self.age_s(now, seen);
        if age_s >= SILENT_AFTER_S {
            return;
        }
        let dead = age_s >= self.dead_after_s();
        let (fresh, frame) = (seen.moment.sequence != self.sequence, self.rates.frame());
        if fresh {
            self.sequence = seen.moment.sequence;
            if !dead {
                self.measured(seen, &mut send);
            }
        }
        if listening && self.texts_wanted {
            self.tell(now, seen, dead.then_some(age_s), names, &mut send);
        } else {
            self.told.clear();
            self.told_withheld = false;
        }
        let healthy = !dead && messages::healthy(&seen.moment);
        let changed = self.rates.sys_status.rate() != Rate::Never && self.healthy != Some(healthy);
        if self.rates.sys_status.due(now, fresh, frame) || changed {
            self.healthy = Some(healthy);
            send(&messages::sys_status(healthy));
        }
        let state = Self::state(dead, seen);
        let another = self.beat.is_some_and(|(told, at)| told != state && now.since(at) >= BEATS_APART_S);
        if another || now >= self.next_second {
            self.next_second = if another { now + SECOND } else { after(self.next_second, SECOND, now) };
            self.beat = Some((state, now));
            send(&messages::heartbeat(state));
        }
        if self.rates.values.due(now, fresh, frame) {
            self.values(now, seen, dead, &mut send);
        }
    }

    /// Gives `send` the attitude of a frame that was passed over: a newer one is there already.
    pub fn passed_over(&mut self, now: Time, seen: &Seen, mut send: impl FnMut(&Message)) {
        if seen.moment.sequence > self.sequence && self.age_s(now, seen) < self.dead_after_s() {
            self.sequence = seen.moment.sequence;
            self.measured(seen, &mut send);
        }
    }

    fn age_s(&self, now: Time, seen: &Seen) -> f64 {
        now.since(if seen.moment.sequence == 0 { self.started } else { seen.moment.written })
    }

    fn dead_after_s(&self) -> f64 {
        DEAD_AFTER_S.max(DEAD_AFTER_FRAMES * self.rates.frame().as_secs_f64())
    }

    /// What a heartbeat tells.
    fn state(dead: bool, seen: &Seen) -> MavState {
        match (dead, seen.moment.sequence) {
            (true, _) => MavState::MAV_STATE_CRITICAL,
            (false, 0) => MavState::MAV_STATE_BOOT,
            (false, _) => messages::state(&seen.moment),
        }
    }

    /// One round of named values: each only if there is one to tell.
    fn values(&mut self, now: Time, seen: &Seen, dead: bool, send: &mut impl FnMut(&Message)) {
        send(&messages::quality_value(now, if dead { 0.0 } else { messages::quality(seen) }));
        if let Some(sigma) = messages::sigma(seen).filter(|_| !dead) {
            send(&sigma);
        }
        let contrast = seen.contrast_k.filter(|k| k.is_finite() && self.contrast_time != Some(seen.moment.time));
        if let Some(contrast_k) = contrast {
            self.contrast_time = Some(seen.moment.time);
            send(&messages::contrast(seen.moment.time, contrast_k));
        }
    }

    /// The attitude in its forms, if it is of a moment not sent before, each as often as it is wanted.
    fn measured(&mut self, seen: &Seen, send: &mut impl FnMut(&Message)) {
        if !is_new(seen, self.attitude_time) {
            return;
        }
        let Rates { attitude, quaternion, covariance, .. } = &mut self.rates;
        let time = seen.moment.valid_at;
        let forms: [(_, Form); 3] =
            [(attitude, messages::attitude), (quaternion, messages::quaternion), (covariance, messages::covariance)];
        for (pace, form) in forms {
            if pace.rate() != Rate::Never
                && let Some(message) = form(seen)
                && pace.passes(time)
            {
                self.attitude_time = Some(time);
                send(&message);
            }
        }
    }

    /// STATUSTEXT for each fault that has come or gone; where the attitude is lost without another one (what was held
    /// is too old), for those that are there once more. Dead sampling can not say so itself: it shows as `stale` of
    /// the age `dead_s`.
    fn tell(
        &mut self,
        now: Time,
        seen: &Seen,
        dead_s: Option<f64>,
        names: &dyn FaultName,
        send: &mut impl FnMut(&Message),
    ) {
        if now.since(self.texts_since) >= 1.0 {
            self.texts_since = now;
            self.texts = 0;
        }
        let limit = self.dead_after_s();
        let dead = dead_s.map(|value| (FaultKind::Stale, Evidence::Limit { value, limit, unit: "s" }));
        let active = || seen.faults.iter().map(|f| (f.kind, f.evidence)).chain(dead);
        let Self { told, texts, .. } = self;
        told.retain(|t| {
            let keep = *texts >= TEXTS_PER_S || active().any(|(k, _)| k == t.kind);
            if !keep {
                *texts += 1;
                send(&messages::fault_went(t.kind, names));
            }
            keep
        });
        let withheld = matches!(seen.moment.mode, Mode::Starting | Mode::Faulted) || dead.is_some();
        if withheld && !self.told_withheld && active().all(|(k, _)| told.iter().any(|t| t.kind == k)) {
            told.retain(|t| t.withheld.is_some_and(|at| now.since(at) < WITHHELD_AGAIN_S));
        }
        self.told_withheld &= withheld;
        for (kind, evidence) in active() {
            if *texts < TEXTS_PER_S && !told.iter().any(|t| t.kind == kind) {
                told.push(Told { kind, withheld: withheld.then_some(now) });
                *texts += 1;
                self.told_withheld |= withheld;
                send(&messages::fault_came(kind, evidence, withheld, names));
            }
        }
    }

    /// There are other sensors from now on: what is told of those before, which `names` names, is over.
    pub fn forget(&mut self, names: &dyn FaultName, mut send: impl FnMut(&Message)) {
        for told in self.told.drain(..) {
            if self.texts < TEXTS_PER_S {
                self.texts += 1;
                send(&messages::fault_went(told.kind, names));
            }
        }
    }

    /// The last message of all: a heartbeat that says the component is going down.
    pub fn farewell() -> Message {
        messages::heartbeat(MavState::MAV_STATE_POWEROFF)
    }
}

#[cfg(test)]
mod tests;
