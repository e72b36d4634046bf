//! What is answered to those who ask: commands and parameters. One [`Service`] for each endpoint; pure.
//!
//! - [`request`]: what is asked, out of the payloads.
//! - `commands`: MAV_CMD and its acknowledgement.
//! - `list`: the parameter protocol.
//! - [`parameters`]: which settings are parameters; [`change`]: one of them changed; [`drop_in`]: kept in a file.
//! - [`calibration`]: the trim out of a few seconds on level ground.
//!
//! What is addressed to this component is always answered. What is addressed to every component is answered where it is
//! something that is done here; whoever asks everybody is not told what each cannot do. Who may ask is settled
//! before: with a signing key, only messages signed with it come here at all.

pub mod calibration;
pub mod change;
mod commands;
pub mod drop_in;
mod list;
pub mod parameters;
pub mod request;

pub use change::{Change, Section, apply};
pub use request::Request;

use super::messages::{self, Message};
use super::session::{Seen, Session};
use crate::config::{self, Settings};
use crate::time::Time;
use ::mavlink::dialects::common::MavSeverity;
use commands::{Level, Recent};
use list::List;
use request::What;

/// A component of a system.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Ids {
    /// The system; as a target 0 is every one.
    pub system: u8,
    /// The component; as a target 0 is every one.
    pub component: u8,
}

/// How things stand when something is asked.
#[derive(Clone, Copy, Debug)]
pub struct Situation<'a> {
    /// Now.
    pub now: Time,
    /// This component.
    pub us: Ids,
    /// The settings in force.
    pub settings: &'a Settings,
    /// Those with what was ordered since: what parameters tell and are set against.
    pub wanted: &'a Settings,
    /// What is told of the attitude.
    pub seen: &'a Seen,
    /// The aircraft flies, or may.
    pub flying: bool,
}

/// What the rest of the daemon is to do.
#[derive(Clone, Debug, PartialEq)]
pub enum Order {
    /// Take up these settings, which are good, and keep them.
    Set(Vec<Change>),
}

/// What came of a request: to be sent to the endpoint, and to be done.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Replies {
    /// To be sent, in this order.
    pub messages: Vec<Message>,
    /// To be done, in this order.
    pub orders: Vec<Order>,
}

impl Replies {
    /// Forgets all, to be used again.
    pub fn clear(&mut self) {
        self.messages.clear();
        self.orders.clear();
    }

    fn send(&mut self, message: Message) {
        self.messages.push(message);
    }

    fn say(&mut self, severity: MavSeverity, what: &str) {
        self.send(messages::note(severity, what));
    }
}

/// Whom a request is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum For {
    /// This component: everything is answered.
    Us,
    /// Everybody: what is not done here is not answered.
    Everybody,
}

/// What is going on with those who ask at one endpoint.
#[derive(Clone, Debug, Default)]
pub struct Service {
    list: List,
    level: Option<Level>,
    recent: Option<Recent>,
}

impl Service {
    /// Takes in a request of `from`, and adds what comes of it to `replies`. `session` is the endpoint's.
    pub fn heed(
        &mut self,
        from: Ids,
        request: &Request,
        at: &Situation<'_>,
        session: &mut Session,
        replies: &mut Replies,
    ) {
        let Request { target, what } = *request;
        let meant = |target: u8, ours: u8| target == 0 || target == ours;
        if from == at.us || !meant(target.system, at.us.system) || !meant(target.component, at.us.component) {
            return;
        }
        let whom = if target == at.us { For::Us } else { For::Everybody };
        match what {
            What::Command(command) => self.command(from, whom, &command, at, session, replies),
            What::ParamList => self.list.begin(at.now),
            What::ParamRead { index, name } => self.list.read(from, whom, index, &name, at, replies),
            What::ParamSet { name, value } => self.list.set(from, whom, &name, value, at, replies),
        }
    }

    /// What is due at `situation.now`: the next parameter of a list, the next word on a calibration. To be called with
    /// each frame, or a few times a second.
    pub fn step(&mut self, at: &Situation<'_>, replies: &mut Replies) {
        self.list.step(at, replies);
        self.level_step(at, replies);
    }

    /// The settings have changed, whoever did it: whoever listens is told the parameters that did.
    pub fn announce(&mut self, now: Time, old: &Settings, new: &Settings) {
        self.list.announce(now, old, new);
    }
}

/// What taking up new settings means for the attitude, in a few words.
fn effect(old: &Settings, new: &Settings) -> &'static str {
    let changes = config::changes(old, new);
    if changes.iter().any(|c| c.needs_restart()) {
        "set; needs a restart"
    } else if changes.iter().any(|c| c.begins_anew()) {
        "set; attitude begins anew"
    } else {
        "set"
    }
}

#[cfg(test)]
mod tests;
