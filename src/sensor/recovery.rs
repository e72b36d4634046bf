//! When a chip is read, when it is opened again, and when it is left alone. Pure: time comes in.

use crate::bus::BusError;
use crate::frame::Missing;
use crate::time::Time;
use std::time::Duration;

/// A chip that has failed for so long is prepared again before it is believed: it may have lost its
/// supply, or be another one.
const LOST_AFTER: Duration = Duration::from_millis(500);
/// Between two attempts to open what will not open for reasons that take time to go away.
const REOPEN: Duration = Duration::from_millis(250);
/// So many timeouts in a row, and the bus (or the chip) counts as held.
const HELD_AFTER: u32 = 3;
/// Between two attempts on a held bus.
const HELD_BUS: Duration = Duration::from_millis(100);
/// Between two attempts at a chip that holds its bus while others answer.
const HELD_CHIP: Duration = Duration::from_secs(1);

/// What to do with a chip in its slot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    /// Read it.
    Read,
    /// Open it, then read it.
    Open,
    /// Leave it alone; this is why it gives no measurement.
    Leave(Missing),
}

/// One chip's way through failure and back.
#[derive(Clone, Copy, Debug)]
pub struct Link {
    open: bool,
    why: Missing,
    next_open: Time,
    failing_since: Option<Time>,
    silent_since: Option<Time>,
    held: u32,
    next_held: Time,
}

impl Default for Link {
    fn default() -> Self {
        let zero = Time::default();
        let (why, failing_since, silent_since) = (Missing::NotYet, None, None);
        Self { open: false, why, next_open: zero, failing_since, silent_since, held: 0, next_held: zero }
    }
}

impl Link {
    /// Whether the chip is open.
    pub fn is_open(&self) -> bool {
        self.open
    }

    /// Whether it is open and its last transfer went well.
    pub fn is_well(&self) -> bool {
        self.open && self.failing_since.is_none()
    }

    /// Why it fails.
    pub fn why(&self) -> Missing {
        self.why
    }

    /// Since when it has not answered at all, for its power line.
    pub fn silent_since(&self) -> Option<Time> {
        self.silent_since
    }

    /// What to do with it at `now`. On a bus that is held as a whole (`bus_held`) it is the bus that
    /// decides who tries.
    pub fn turn(&self, now: Time, bus_held: bool) -> Turn {
        if self.held >= HELD_AFTER && now < self.next_held && !bus_held {
            Turn::Leave(Missing::BusHeld)
        } else if self.open {
            Turn::Read
        } else if now < self.next_open {
            Turn::Leave(self.why)
        } else {
            Turn::Open
        }
    }

    /// It was closed for `why`; it is opened when it is its turn.
    pub fn closed(&mut self, why: Missing, now: Time) {
        *self = Self { why, next_open: now, ..Self::default() };
    }

    /// The bus was held and is free again: perhaps it was not this chip.
    pub fn forgive(&mut self) {
        self.next_held = Time::default();
    }

    /// It was tried to be opened at `now`.
    pub fn opened(&mut self, result: Result<(), BusError>, now: Time) {
        self.open = result.is_ok();
        match result {
            Ok(()) => self.failing_since = None,
            Err(e) => {
                self.fail(e.missing(), now);
                // A chip that does not answer is cheap to ask: at every scan.
                let soon = matches!(e, BusError::NoAnswer | BusError::Held);
                self.next_open = if soon { now } else { now + REOPEN };
            }
        }
    }

    /// It was read at `now`, with this outcome. `true`: it must be closed, to be opened again.
    pub fn read(&mut self, outcome: Result<(), Missing>, now: Time) -> bool {
        let why = match outcome {
            // It answers, and knows how to.
            Ok(()) | Err(Missing::ErrorFlag | Missing::Saturated | Missing::Impossible) => {
                (self.failing_since, self.silent_since, self.held) = (None, None, 0);
                return false;
            }
            Err(why) => why,
        };
        self.fail(why, now);
        let at_once = matches!(why, Missing::Claimed | Missing::BusGone | Missing::Denied);
        let lost = self.failing_since.is_some_and(|since| now >= since + LOST_AFTER);
        if at_once || lost {
            self.open = false;
            self.next_open = if at_once { now + REOPEN } else { now };
        }
        at_once || lost
    }

    fn fail(&mut self, why: Missing, now: Time) {
        self.why = why;
        self.failing_since.get_or_insert(now);
        match why {
            Missing::NoAnswer => {
                self.silent_since.get_or_insert(now);
                self.held = 0;
            }
            Missing::BusHeld => {
                self.silent_since.get_or_insert(now);
                self.held = self.held.saturating_add(1);
                self.next_held = now + HELD_CHIP;
            }
            _ => (self.silent_since, self.held) = (None, 0),
        }
    }
}

/// One bus: whether its node is there and whether it is held.
#[derive(Clone, Copy, Debug, Default)]
pub struct BusWatch {
    absent: bool,
    shut: Option<Missing>,
    held: u32,
    held_in_scan: bool,
    next_try: Time,
    /// The chip whose turn it is to try a held bus.
    probe: usize,
}

impl BusWatch {
    /// Why the bus is down; `None` when it works.
    pub fn down(&self) -> Option<Missing> {
        if self.absent {
            Some(Missing::BusGone)
        } else if self.is_held() {
            Some(Missing::BusHeld)
        } else {
            self.shut
        }
    }

    /// A scan begins.
    pub fn begin_scan(&mut self) {
        self.held_in_scan = false;
    }

    /// Its node was looked for; `true` when it came or went.
    pub fn seen(&mut self, there: bool) -> bool {
        let changed = self.absent == there;
        if changed {
            *self = Self { absent: !there, ..Self::default() };
        }
        changed
    }

    /// Whether it is held.
    pub fn is_held(&self) -> bool {
        self.held >= HELD_AFTER
    }

    /// Whether the bus may be used at `now` by its chip number `member`; if not, why.
    pub fn admits(&self, member: usize, now: Time) -> Result<(), Missing> {
        if self.absent {
            return Err(Missing::BusGone);
        }
        // One timeout is enough in one scan.
        if self.held_in_scan || self.is_held() && (member != self.probe || now < self.next_try) {
            return Err(Missing::BusHeld);
        }
        Ok(())
    }

    /// Its chip number `member` of `members` makes no use of its turn.
    pub fn pass(&mut self, member: usize, members: usize) {
        if member == self.probe {
            self.probe = (member + 1) % members.max(1);
        }
    }

    /// Its chip number `member` of `members` used it at `now`, with this outcome. `true`: the bus
    /// was held and is free again.
    pub fn used(&mut self, member: usize, members: usize, outcome: Result<(), Missing>, now: Time) -> bool {
        match outcome {
            Err(Missing::BusHeld) => {
                self.held = self.held.saturating_add(1);
                self.held_in_scan = true;
                self.next_try = now + HELD_BUS;
                self.probe = (member + 1) % members.max(1);
                false
            }
            // Nothing went over the wires.
            Err(why @ (Missing::Denied | Missing::BusGone | Missing::BusInUse | Missing::Claimed)) => {
                self.shut = Some(why).filter(|w| *w != Missing::Claimed);
                self.pass(member, members);
                false
            }
            _ => {
                let freed = self.is_held();
                (self.held, self.shut) = (0, None);
                freed
            }
        }
    }
}

#[cfg(test)]
mod tests;
