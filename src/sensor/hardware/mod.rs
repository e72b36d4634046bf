//! The hardware as a source of frames: one thread walks over the chips along the schedule.
//!
//! - `fit`: the source from the configuration.
//! - `upkeep`: what a scan does besides reading.
//!
//! A scan never waits for a chip longer than its transfers may take: what fails is tried once more
//! in its slot and is missing then. What to do about chips, buses and power lines that go on
//! failing is decided in [`recovery`](super::recovery) and [`power`](super::power); here it is done.

mod fit;
#[cfg(test)]
mod tests;
mod upkeep;

pub use fit::OpenError;

use super::Chip;
use super::power::PowerCycle;
use super::recovery::{BusWatch, Link, Turn};
use super::schedule::{Schedule, Slot};
use crate::bus::BusError;
use crate::bus::explain::{Facts, Place, explain, explain_missing};
use crate::clock;
use crate::frame::{Frame, Missing, Reading};
use crate::gpio::Switch;
use crate::source::{FrameSource, SensorHealth};
use crate::time::Time;
use std::path::Path;

/// A chip with what the source must know of it.
pub struct Fitted {
    /// The chip.
    pub chip: Box<dyn Chip>,
    /// Its name in the log.
    pub place: Place,
    /// Its power line, as an index into the source's lines.
    pub power: Option<usize>,
}

struct Member {
    fitted: Fitted,
    link: Link,
    bus: usize,
    /// Its number among the chips of its bus.
    number: usize,
    opened: u64,
    power_cycles: u64,
    /// The scan in which it was last tried to be opened.
    tried: u64,
    housekept: Time,
    /// What was last said in the log of why it fails.
    told: Option<Missing>,
}

struct Bus {
    watch: BusWatch,
    members: usize,
    next_look: Time,
    told: Option<Missing>,
}

struct Line {
    cycle: PowerCycle,
    switch: Box<dyn Switch>,
}

/// The clock and the file system, so that tests have their own.
struct System {
    now: fn() -> Time,
    sleep_until: fn(Time),
    exists: Box<dyn FnMut(&str) -> bool + Send>,
    announce: fn(&str),
}

impl System {
    fn real() -> Self {
        Self {
            now: clock::now,
            sleep_until: clock::sleep_until,
            exists: Box::new(|node| Path::new(node).exists()),
            announce: |_| {},
        }
    }
}

/// The sensors on their buses.
pub struct HardwareSource {
    schedule: Schedule,
    members: Vec<Member>,
    buses: Vec<Bus>,
    lines: Vec<Line>,
    retries: Vec<u64>,
    health: Vec<SensorHealth>,
    down: Vec<Option<Missing>>,
    /// Counts scans.
    scan: u64,
    /// When this scan has used up its period.
    deadline: Time,
    /// The end of the last transfer of this scan, or its beginning.
    latest: Time,
    system: System,
}

impl HardwareSource {
    /// A source of `chips`, as many and in the same order as the schedule's, on power `lines` that
    /// are switched on already. No chip is opened before the first scan.
    pub fn with_chips(schedule: Schedule, chips: Vec<Fitted>, lines: Vec<Box<dyn Switch>>) -> Self {
        Self::on(System::real(), schedule, chips, lines)
    }

    fn on(system: System, schedule: Schedule, chips: Vec<Fitted>, lines: Vec<Box<dyn Switch>>) -> Self {
        let fresh = |_: &String| Bus {
            watch: BusWatch::default(),
            members: 0,
            next_look: Time::default(),
            told: Some(Missing::NotYet),
        };
        let mut buses: Vec<Bus> = schedule.buses().iter().map(fresh).collect();
        let members = schedule.chips.iter().zip(chips).map(|(plan, fitted)| {
            let number = buses[plan.bus].members;
            buses[plan.bus].members += 1;
            Member {
                fitted,
                link: Link::default(),
                bus: plan.bus,
                number,
                opened: 0,
                power_cycles: 0,
                tried: 0,
                housekept: Time::default(),
                told: None,
            }
        });
        let members = members.collect();
        let lines = lines.into_iter().map(|switch| Line { cycle: PowerCycle::default(), switch }).collect();
        let sensors = schedule.sensors();
        Self {
            members,
            lines,
            retries: vec![0; sensors],
            health: vec![SensorHealth::default(); sensors],
            down: vec![None; buses.len()],
            buses,
            schedule,
            scan: 0,
            deadline: Time::default(),
            latest: Time::default(),
            system,
        }
    }

    fn now(&self) -> Time {
        (self.system.now)()
    }

    fn begin(&mut self) {
        for m in &mut self.members {
            let bus = &self.buses[m.bus].watch;
            if m.link.is_well() && bus.admits(m.number, self.latest).is_ok() {
                m.fitted.chip.begin();
            }
        }
    }

    /// Reads a slot, or says why not.
    fn read(&mut self, slot: Slot, tick: Time) -> Reading {
        let now = self.latest;
        let late = now > self.deadline;
        let m = &mut self.members[slot.chip];
        let bus = &mut self.buses[m.bus];
        let off = m.fitted.power.is_some_and(|l| self.lines[l].cycle.is_off());
        let turn = if off { Turn::Leave(Missing::PoweredOff) } else { m.link.turn(now, bus.watch.is_held()) };
        if let Turn::Leave(why) = turn {
            bus.watch.pass(m.number, bus.members);
            return Err(bus.watch.down().filter(|_| !off).unwrap_or(why));
        }
        bus.watch.admits(m.number, now)?;
        if turn == Turn::Open {
            if late || m.tried == self.scan {
                bus.watch.pass(m.number, bus.members);
                return Err(m.link.why());
            }
            m.tried = self.scan;
            self.open_chip(slot.chip)?;
        }
        if !self.schedule.quiet.is_zero() {
            (self.system.sleep_until)(tick + slot.offset);
        }
        let mut reading = self.members[slot.chip].fitted.chip.read(slot.slot);
        if matches!(reading, Err(Missing::NoAnswer | Missing::BadPec | Missing::BusError))
            && self.now() <= self.deadline
        {
            self.retries[slot.sensor] += 1;
            reading = self.members[slot.chip].fitted.chip.read(slot.slot);
        }
        let outcome = reading.map(|_| ());
        // What succeeded carries the time of its end.
        self.latest = reading.map_or_else(|_| self.now(), |sample| sample.time);
        let now = self.latest;
        let m = &mut self.members[slot.chip];
        if m.link.read(outcome, now) {
            m.fitted.chip.close();
        }
        self.used(slot.chip, outcome, None);
        reading
    }

    fn open_chip(&mut self, chip: usize) -> Result<(), Missing> {
        let result = self.members[chip].fitted.chip.open();
        self.latest = self.now();
        let now = self.latest;
        let m = &mut self.members[chip];
        m.link.opened(result, now);
        m.opened += u64::from(result.is_ok());
        m.housekept = now;
        if let Err(e) = result {
            m.fitted.chip.close();
            self.used(chip, Err(e.missing()), Some(e));
        } else if let Some(twin) = self.twin(chip) {
            let [place, other] = [chip, twin].map(|i| &self.members[i].fitted.place);
            log::warn!("{place}: has the identity of {other}: does each bus lead to chips of its own? i2cdetect -l");
        }
        result.map_err(BusError::missing)
    }

    /// Draws the conclusions of a use of the bus by `chip`: for its neighbours, and for the log.
    fn used(&mut self, chip: usize, outcome: Result<(), Missing>, error: Option<BusError>) {
        let now = self.latest;
        let index = self.members[chip].bus;
        let bus = &mut self.buses[index];
        let freed = bus.watch.used(self.members[chip].number, bus.members, outcome, now);
        if freed {
            self.members.iter_mut().filter(|m| m.bus == index).for_each(|m| m.link.forgive());
        }
        if outcome.is_err_and(|why| why != Missing::NotReady) {
            // Has the adapter gone?
            bus.next_look = now;
        }
        let m = &mut self.members[chip];
        let place = &m.fitted.place;
        let down = bus.watch.down();
        // What is wrong with the PEC, the chip has said itself.
        let said = error == Some(BusError::Pec);
        if bus.told != down {
            match down {
                Some(why) => log::warn!("{}", words(place, why, error)),
                None => log::info!("{} works again", place.bus.display()),
            }
            bus.told = down;
        }
        match outcome {
            Ok(()) if m.told.take().is_some() => log::info!("{place}: answers again"),
            // The bus's fault is not told for each chip.
            Err(why) if !m.link.is_open() && m.told != Some(why) && down.is_none() => {
                if !said {
                    log::warn!("{}", words(place, why, error));
                }
                m.told = Some(why);
            }
            _ => {}
        }
    }
}

fn words(place: &Place, why: Missing, error: Option<BusError>) -> String {
    let facts = Facts::gather(Path::new("/"), &place.bus, place.address);
    match error {
        Some(e) => explain(place, e, &facts),
        None => explain_missing(place, why, &facts),
    }
}

impl FrameSource for HardwareSource {
    fn scan(&mut self, tick: Time, frame: &mut Frame) {
        self.scan += 1;
        self.latest = self.now();
        self.deadline = tick.max(self.latest) + self.schedule.period;
        self.buses.iter_mut().for_each(|b| b.watch.begin_scan());
        self.look_for_buses();
        self.step_power();
        self.begin();
        for index in 0..self.schedule.slots.len() {
            let slot = self.schedule.slots[index];
            let reading = self.read(slot, tick);
            if let Some(place) = frame.readings.get_mut(slot.sensor) {
                *place = reading;
            }
        }
        self.housekeep(tick);
        self.refresh_health();
        frame.time = self.now();
    }

    fn health(&self) -> &[SensorHealth] {
        &self.health
    }

    fn buses_down(&self) -> &[Option<Missing>] {
        &self.down
    }
}
