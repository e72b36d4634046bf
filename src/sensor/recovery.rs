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
            Err(why @ (Missing::Denied | Missing::BusGone | Missing::Claimed)) => {
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
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn at(ms: u64) -> Time {
        Time::from_nanos(ms * 1_000_000)
    }

    #[test]
    fn a_silent_chip_is_tried_at_every_scan_and_prepared_before_it_is_believed() {
        let mut link = Link::default();
        assert_eq!(link.turn(at(0), false), Turn::Open);
        link.opened(Ok(()), at(0));
        let mut closed_at = None;
        for ms in (20..2000).step_by(20) {
            match link.turn(at(ms), false) {
                Turn::Read => {
                    if link.read(Err(Missing::NoAnswer), at(ms)) {
                        closed_at = Some(ms);
                    }
                }
                Turn::Open => link.opened(Err(BusError::NoAnswer), at(ms)),
                Turn::Leave(_) => panic!("left alone at {ms} ms"),
            }
        }
        assert_eq!(closed_at, Some(520));
        assert_eq!(link.silent_since(), Some(at(20)));
        assert_eq!(link.turn(at(2000), false), Turn::Open);
        link.opened(Ok(()), at(2000));
        assert_eq!(link.turn(at(2000), false), Turn::Read);
        assert_eq!(link.silent_since(), Some(at(20)), "opening alone is no measurement");
        link.read(Ok(()), at(2000));
        assert_eq!(link.silent_since(), None);
    }

    #[test]
    fn what_will_not_open_is_tried_four_times_a_second() {
        for error in [BusError::Claimed, BusError::Denied, BusError::Gone, BusError::Other(5), BusError::Pec] {
            let mut link = Link::default();
            let mut tries = 0;
            for ms in (0..10_000).step_by(20) {
                match link.turn(at(ms), false) {
                    Turn::Open => {
                        tries += 1;
                        link.opened(Err(error), at(ms));
                    }
                    Turn::Leave(why) => assert_eq!(why, error.missing()),
                    Turn::Read => panic!("it never opened"),
                }
            }
            assert!((36..=40).contains(&tries), "{error}: {tries}");
            assert_eq!(link.silent_since(), None, "{error} is no reason for a power cycle");
        }
    }

    #[test]
    fn a_chip_whose_values_are_wrong_stays_open() {
        let mut link = Link::default();
        link.opened(Ok(()), at(0));
        for ms in (0..5000).step_by(20) {
            for why in [Missing::ErrorFlag, Missing::Saturated, Missing::Impossible] {
                assert!(!link.read(Err(why), at(ms)));
            }
        }
        assert_eq!((link.turn(at(5000), false), link.silent_since()), (Turn::Read, None));
    }

    /// Six chips at 50 scans a second; `held` says whether chip `c` times out at a time (ms).
    /// Gives for each chip how often it was read, and the attempts that timed out.
    fn walk(end_ms: u64, held: impl Fn(usize, u64) -> bool) -> ([u32; 6], u32) {
        let mut bus = BusWatch::default();
        let mut links = [Link::default(); 6];
        links.iter_mut().for_each(|l| l.opened(Ok(()), at(0)));
        let (mut read, mut timeouts) = ([0; 6], 0);
        for ms in (0..end_ms).step_by(20) {
            bus.begin_scan();
            for c in 0..6 {
                // Chip 4 is claimed by a kernel driver for the first five seconds.
                let turn = links[c].turn(at(ms), bus.is_held());
                match if c == 4 && ms < 5_000 { Turn::Leave(Missing::Claimed) } else { turn } {
                    Turn::Leave(_) => {
                        bus.pass(c, 6);
                        continue;
                    }
                    _ if bus.admits(c, at(ms)).is_err() => continue,
                    Turn::Open => links[c].opened(Ok(()), at(ms)),
                    Turn::Read => {}
                }
                let outcome = if held(c, ms) { Err(Missing::BusHeld) } else { Ok(()) };
                timeouts += u32::from(outcome.is_err());
                read[c] += u32::from(outcome.is_ok());
                links[c].read(outcome, at(ms));
                if bus.used(c, 6, outcome, at(ms)) {
                    links.iter_mut().for_each(Link::forgive);
                }
            }
        }
        (read, timeouts)
    }

    #[test]
    fn a_held_bus_is_tried_ten_times_a_second_and_comes_back_at_once() {
        let (read, timeouts) = walk(10_000, |_, _| true);
        assert_eq!(read, [0; 6]);
        assert!((80..=110).contains(&timeouts), "{timeouts}");
        let (read, _) = walk(10_000, |_, ms| ms < 8_000);
        assert!(read.iter().all(|n| *n >= 90), "of the last 100 scans: {read:?}");
    }

    #[test]
    fn one_chip_that_holds_the_bus_does_not_starve_the_others() {
        for culprit in 0..6 {
            let (read, timeouts) = walk(10_000, |c, _| c == culprit);
            for (c, n) in read.iter().enumerate().filter(|(c, _)| *c != culprit) {
                let of = if c == 4 { 250 } else { 500 };
                assert!(*n >= of - 30, "chip {c} beside {culprit}: {n} of {of}");
            }
            assert!(timeouts <= 20, "{timeouts}");
        }
    }

    #[test]
    fn a_bus_is_down_while_absent_held_or_shut() {
        let mut bus = BusWatch::default();
        assert_eq!(bus.down(), None);
        assert!(bus.seen(false));
        assert!(!bus.seen(false));
        assert_eq!((bus.down(), bus.admits(0, at(0))), (Some(Missing::BusGone), Err(Missing::BusGone)));
        assert!(bus.seen(true));
        assert_eq!((bus.down(), bus.admits(0, at(0))), (None, Ok(())));
        bus.used(0, 1, Err(Missing::Denied), at(0));
        assert_eq!(bus.down(), Some(Missing::Denied));
        bus.used(0, 1, Err(Missing::NoAnswer), at(0));
        assert_eq!(bus.down(), None, "a chip that is missing does not take the bus down");
        for _ in 0..3 {
            bus.used(0, 1, Err(Missing::BusHeld), at(0));
        }
        assert_eq!(bus.down(), Some(Missing::BusHeld));
    }

    proptest! {
        #[test]
        fn whatever_happened_a_chip_is_back_a_second_after_it_works(
            past in prop::collection::vec((0_u8..9, 1_u64..400), 0..60),
        ) {
            let mut link = Link::default();
            let mut ms = 0;
            for (what, pause) in past {
                ms += pause;
                let error = [
                    BusError::NoAnswer, BusError::Pec, BusError::Held, BusError::Claimed, BusError::Gone,
                    BusError::Denied, BusError::Other(5),
                ].get(usize::from(what)).copied();
                match (link.turn(at(ms), false), error) {
                    (Turn::Open, e) => link.opened(e.map_or(Ok(()), Err), at(ms)),
                    (Turn::Read, e) => { link.read(e.map_or(Ok(()), |e| Err(e.missing())), at(ms)); }
                    (Turn::Leave(_), _) => {}
                }
            }
            let works_from = ms;
            loop {
                match link.turn(at(ms), false) {
                    Turn::Read => break,
                    Turn::Open => link.opened(Ok(()), at(ms)),
                    Turn::Leave(_) => ms += 20,
                }
            }
            prop_assert!(ms - works_from <= 1020, "{} ms", ms - works_from);
        }
    }
}
