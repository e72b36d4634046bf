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
    for error in
        [BusError::Claimed, BusError::Denied, BusError::Gone, BusError::InUse, BusError::Other(5), BusError::Pec]
    {
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
