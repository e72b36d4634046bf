//! What a scan does besides reading: buses that come and go, power lines, housekeeping, health.

use super::{HardwareSource, Member};
use crate::bus::BusError;
use crate::bus::explain::{Facts, explain};
use crate::frame::Missing;
use crate::sensor::power::Step;
use crate::time::Time;
use std::path::Path;
use std::time::Duration;

/// How often a bus's device file is looked for.
const LOOK: Duration = Duration::from_millis(200);
/// How often each chip does its housekeeping.
const HOUSEKEEPING: Duration = Duration::from_secs(1);

impl HardwareSource {
    /// Looks for each bus's device file. An adapter can only be removed once nobody holds its file
    /// open, and its file vanishes before: then every chip on it is closed.
    pub(super) fn look_for_buses(&mut self) {
        let now = self.latest;
        for (index, bus) in self.buses.iter_mut().enumerate() {
            if now < bus.next_look {
                continue;
            }
            bus.next_look = now + LOOK;
            let path = self.schedule.buses()[index].as_str();
            let there = (self.system.exists)(path);
            let first = bus.told == Some(Missing::NotYet);
            if !bus.watch.seen(there) && !first {
                continue;
            }
            bus.told = (!there).then_some(Missing::BusGone);
            let chips = self.members.iter_mut().filter(|m| m.bus == index);
            if there {
                if !first {
                    log::info!("{path} is back");
                }
                (self.system.announce)(path);
                chips.for_each(|m| m.link.closed(Missing::NotYet, now));
            } else {
                let mut said = false;
                for m in chips {
                    if !std::mem::replace(&mut said, true) {
                        let facts = Facts::gather(Path::new("/"), &m.fitted.place.bus, m.fitted.place.address);
                        log::warn!("{}", explain(&m.fitted.place, BusError::Gone, &facts));
                    }
                    m.fitted.chip.close();
                    m.link.closed(Missing::BusGone, now);
                    m.told = None;
                }
            }
        }
    }

    /// The chip that answers with the identity of `chip`: behind a multiplexer that is not switched one answers for several.
    pub(super) fn twin(&self, chip: usize) -> Option<usize> {
        let identity = |m: &Member| m.fitted.chip.health(0).identity.filter(|id| ![0, u64::MAX].contains(id));
        let sought = identity(&self.members[chip])?;
        let same = |(i, m): &(usize, &Member)| *i != chip && m.link.is_open() && identity(m) == Some(sought);
        self.members.iter().enumerate().find(same).map(|(i, _)| i)
    }

    /// Power-cycles what has been silent for too long, step by step.
    pub(super) fn step_power(&mut self) {
        let now = self.latest;
        for (index, line) in self.lines.iter_mut().enumerate() {
            let chips = || self.members.iter().filter(|m| m.fitted.power == Some(index));
            let silent_since = chips().filter_map(|m| m.link.silent_since()).min();
            let step = line.cycle.step(now, silent_since);
            if step == Step::Nothing {
                continue;
            }
            let on = match step {
                Step::SwitchOff => {
                    let names: Vec<&str> = chips().map(|m| m.fitted.place.name.as_str()).collect();
                    log::warn!("power-cycling {}: no answer", names.join(", "));
                    Some(false)
                }
                Step::SwitchOn => Some(true),
                _ => None,
            };
            if let Some(on) = on
                && let Err(e) = line.switch.set(on)
            {
                log::error!("switching the sensors' supply {}: {e}", if on { "on" } else { "off" });
            }
            for m in self.members.iter_mut().filter(|m| m.fitted.power == Some(index)) {
                m.fitted.chip.close();
                m.link.closed(Missing::PoweredOff, now);
                m.power_cycles += u64::from(step == Step::SwitchOff);
            }
        }
    }

    /// Lets the chip whose housekeeping is due for the longest time do it.
    pub(super) fn housekeep(&mut self, tick: Time) {
        let Some(offset) = self.schedule.housekeeping else { return };
        let now = self.latest;
        let Some(m) = self.members.iter_mut().min_by_key(|m| if m.link.is_well() { m.housekept } else { now }) else {
            return;
        };
        if now < m.housekept + HOUSEKEEPING || !m.link.is_well() || now > self.deadline {
            return;
        }
        if self.buses[m.bus].watch.admits(m.number, now).is_err() {
            return;
        }
        if !self.schedule.quiet.is_zero() {
            (self.system.sleep_until)(tick + offset);
        }
        m.fitted.chip.housekeep();
        m.housekept = now;
    }

    /// Brings what the source tells of its sensors and buses up to date.
    pub(super) fn refresh_health(&mut self) {
        for slot in &self.schedule.slots {
            let m = &self.members[slot.chip];
            let mut health = m.fitted.chip.health(slot.slot);
            health.counters.retries = self.retries[slot.sensor];
            health.counters.reopened = m.opened.saturating_sub(1);
            health.counters.power_cycles = m.power_cycles;
            self.health[slot.sensor] = health;
        }
        for (down, bus) in self.down.iter_mut().zip(&self.buses) {
            *down = bus.watch.down();
        }
    }
}
