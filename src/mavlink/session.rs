//! Which messages are due when: the state of one endpoint's outgoing stream. Pure; time comes in
//! as an argument.
//!
//! Nothing goes out on the strength of this thread being alive. What is told depends on the age of
//! the newest frame: from 1 s on the heartbeat is critical and says so in words, from 3 s on there
//! is silence, and every ground station shows the component as lost.

use super::decimator::Decimator;
use super::messages::{self, Message};
use crate::attitude::{Attitude, Mode};
use crate::fault::{ActiveFault, Evidence, FaultKind, FaultName};
use crate::state::Snapshot;
use crate::time::Time;
use ::mavlink::dialects::common::MavState;
use std::time::Duration;

/// The age of the newest frame at which sampling counts as dead, s.
const DEAD_AFTER_S: f64 = 1.0;

/// The age of the newest frame from which on nothing is sent, s.
const SILENT_AFTER_S: f64 = 3.0;

/// The period of HEARTBEAT and NAMED_VALUE_FLOAT.
const SECOND: Duration = Duration::from_secs(1);

/// STATUSTEXT messages in a second at most. Faults that come and go faster are told less often,
/// and the last word is always the true one.
const TEXTS_PER_S: u32 = 8;

/// What is told, copied out of the shared state: a few words and the list of faults.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Seen {
    /// Counts frames; 0 before the first.
    pub sequence: u64,
    /// When the newest frame was written.
    pub written: Time,
    /// The newest conversion in the estimate.
    pub time: Time,
    /// The moment that the attitude speaks of.
    pub valid_at: Time,
    /// Roll and pitch, or nothing while they are withheld.
    pub attitude: Option<Attitude>,
    /// Their standard deviations, rad.
    pub sigma: Attitude,
    /// The contrast, K.
    pub contrast_k: Option<f64>,
    /// How far to trust it.
    pub mode: Mode,
    /// What speaks against it.
    pub faults: Vec<ActiveFault>,
}

impl Seen {
    /// Takes in a snapshot; allocates only when there are more faults than ever before.
    pub fn copy(&mut self, snapshot: &Snapshot) {
        let estimate = &snapshot.estimate;
        self.sequence = snapshot.sequence;
        self.written = snapshot.written;
        self.time = estimate.time;
        self.valid_at = estimate.valid_at;
        self.attitude = estimate.attitude;
        self.sigma = estimate.sigma;
        self.contrast_k = estimate.contrast_k;
        self.mode = estimate.mode;
        self.faults.clone_from(&estimate.faults);
    }
}

/// The state of one endpoint's stream.
#[derive(Clone, Debug)]
pub struct Session {
    started: Time,
    decimator: Option<Decimator>,
    sequence: u64,
    attitude_time: Option<Time>,
    contrast_time: Option<Time>,
    next_second: Time,
    /// With SYS_STATUS; what the last one said.
    sys_status: bool,
    healthy: Option<bool>,
    told: Vec<FaultKind>,
    /// A text has said that the attitude is withheld.
    told_withheld: bool,
    texts: u32,
    texts_since: Time,
}

impl Session {
    /// A stream that begins at `now`, after frame `sequence`, with ATTITUDE for every frame or
    /// `attitude_hz` times a second.
    pub fn new(now: Time, sequence: u64, attitude_hz: Option<f64>) -> Self {
        Self {
            started: now,
            decimator: attitude_hz.and_then(Decimator::new),
            sequence,
            attitude_time: None,
            contrast_time: None,
            next_second: now,
            sys_status: false,
            healthy: None,
            told: Vec::with_capacity(16),
            told_withheld: false,
            texts: 0,
            texts_since: now,
        }
    }

    /// With SYS_STATUS as well, if `wanted`.
    pub fn with_sys_status(mut self, wanted: bool) -> Self {
        self.sys_status = wanted;
        self
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
        let newest = if seen.sequence == 0 { self.started } else { seen.written };
        let age_s = now.since(newest);
        if age_s >= SILENT_AFTER_S {
            return;
        }
        let dead = age_s >= DEAD_AFTER_S;
        if seen.sequence != self.sequence {
            self.sequence = seen.sequence;
            if !dead && let Some(message) = self.attitude(seen) {
                send(&message);
            }
        }
        if listening {
            self.tell(now, seen, dead.then_some(age_s), names, &mut send);
        } else {
            self.told.clear();
            self.told_withheld = false;
        }
        let healthy = !dead && messages::healthy(seen.mode);
        let due = now >= self.next_second;
        if self.sys_status && (due || self.healthy != Some(healthy)) {
            self.healthy = Some(healthy);
            send(&messages::sys_status(healthy));
        }
        if due {
            self.next_second = after(self.next_second, SECOND, now);
            send(&messages::heartbeat(match (dead, seen.sequence) {
                (true, _) => MavState::MAV_STATE_CRITICAL,
                (false, 0) => MavState::MAV_STATE_BOOT,
                (false, _) => messages::state(seen.mode),
            }));
            send(&messages::quality_value(now, if dead { 0.0 } else { messages::quality(seen) }));
            let contrast = seen.contrast_k.filter(|k| k.is_finite() && self.contrast_time != Some(seen.time));
            if let Some(contrast_k) = contrast {
                self.contrast_time = Some(seen.time);
                send(&messages::contrast(seen.time, contrast_k));
            }
        }
    }

    /// ATTITUDE, if it is of a moment not sent before and the decimator lets it pass.
    fn attitude(&mut self, seen: &Seen) -> Option<Message> {
        let time = seen.valid_at;
        let message = messages::attitude(time, seen.attitude?)?;
        if self.attitude_time == Some(time) || !self.decimator.as_mut().is_none_or(|d| d.passes(time)) {
            return None;
        }
        self.attitude_time = Some(time);
        Some(message)
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
        let dead = dead_s.map(|value| (FaultKind::Stale, Evidence::Limit { value, limit: DEAD_AFTER_S, unit: "s" }));
        let active = || seen.faults.iter().map(|f| (f.kind, f.evidence)).chain(dead);
        let Self { told, texts, .. } = self;
        told.retain(|kind| {
            let keep = *texts >= TEXTS_PER_S || active().any(|(k, _)| k == *kind);
            if !keep {
                *texts += 1;
                send(&messages::fault_went(*kind, names));
            }
            keep
        });
        let withheld = !messages::healthy(seen.mode) || dead.is_some();
        if withheld && !self.told_withheld && active().all(|(k, _)| told.contains(&k)) {
            told.clear();
        }
        self.told_withheld &= withheld;
        for (kind, evidence) in active() {
            if *texts < TEXTS_PER_S && !told.contains(&kind) {
                told.push(kind);
                *texts += 1;
                self.told_withheld |= withheld;
                send(&messages::fault_came(kind, evidence, withheld, names));
            }
        }
    }

    /// The last message of all: a heartbeat that says the component is going down.
    pub fn farewell() -> Message {
        messages::heartbeat(MavState::MAV_STATE_POWEROFF)
    }
}

/// The next due time on a schedule of `period` that is not left for a late step, only for one that
/// is late by more than a period.
fn after(due: Time, period: Duration, now: Time) -> Time {
    if due + period > now { due + period } else { now + period }
}

#[cfg(test)]
mod tests;
