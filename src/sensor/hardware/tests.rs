use super::*;
use crate::frame::{Sample, Value};
use crate::gpio::{GpioError, Switch};
use crate::sensor::schedule::ChipPlan;
use std::cell::Cell;
use std::sync::{Arc, Mutex};
use std::time::Duration;

thread_local! {
    static NOW: Cell<u64> = const { Cell::new(1_000_000_000) };
}

fn now() -> Time {
    Time::from_nanos(NOW.get())
}

fn pass(us: u64) {
    NOW.set(NOW.get() + us * 1000);
}

fn sleep_until(deadline: Time) {
    NOW.set(NOW.get().max(deadline.as_nanos()));
}

/// What happens to a fake chip, and what it was asked.
#[derive(Default)]
struct Life {
    opening: Option<BusError>,
    reading: Option<Missing>,
    /// Fail this many reads, then answer.
    glitches: u32,
    opens: u32,
    closes: u32,
    reads: u32,
    housekept: u32,
    is_open: bool,
    identity: Option<u64>,
}

#[derive(Clone, Default)]
struct Fake(Arc<Mutex<Life>>);

impl Fake {
    fn set(&self, change: impl FnOnce(&mut Life)) {
        change(&mut self.0.lock().unwrap());
    }

    fn get<T>(&self, look: impl FnOnce(&Life) -> T) -> T {
        look(&self.0.lock().unwrap())
    }
}

impl Chip for Fake {
    fn open(&mut self) -> Result<(), BusError> {
        let mut life = self.0.lock().unwrap();
        life.opens += 1;
        life.is_open = life.opening.is_none();
        pass(if life.opening == Some(BusError::Held) { 30_000 } else { 600 });
        life.opening.map_or(Ok(()), Err)
    }

    fn close(&mut self) {
        self.set(|l| {
            l.closes += 1;
            l.is_open = false;
        });
    }

    fn read(&mut self, _: usize) -> Reading {
        let mut life = self.0.lock().unwrap();
        assert!(life.is_open, "a closed chip is not read");
        life.reads += 1;
        pass(if life.reading == Some(Missing::BusHeld) { 30_000 } else { 570 });
        if life.glitches > 0 {
            life.glitches -= 1;
            return Err(Missing::BadPec);
        }
        match life.reading {
            Some(why) => Err(why),
            None => Ok(Sample { value: Value::Absolute { object_c: 1.0, ambient_c: None }, time: now() }),
        }
    }

    fn housekeep(&mut self) {
        pass(570);
        self.set(|l| l.housekept += 1);
    }

    fn health(&self, _: usize) -> SensorHealth {
        SensorHealth { settling_s: 0.1, identity: self.get(|l| l.identity), ..SensorHealth::default() }
    }
}

#[derive(Clone, Default)]
struct Supply(Arc<Mutex<Vec<(u64, bool)>>>);

impl Switch for Supply {
    fn set(&mut self, on: bool) -> Result<(), GpioError> {
        self.0.lock().unwrap().push((NOW.get() / 1_000_000, on));
        Ok(())
    }
}

struct Rig {
    source: HardwareSource,
    chips: Vec<Fake>,
    absent: Arc<Mutex<Vec<String>>>,
    frame: Frame,
    switch: Supply,
    longest_us: u64,
}

const PERIOD_US: u64 = 20_000;

/// Chips of one sensor each, on the bus that is given for each, on one power line if so wished.
fn rig(buses: &[usize], powered: bool) -> Rig {
    let chips: Vec<Fake> = buses.iter().map(|_| Fake::default()).collect();
    let plans: Vec<ChipPlan> = buses
        .iter()
        .enumerate()
        .map(|(i, bus)| ChipPlan { bus: *bus, address: 0x50 + i as u8, sensors: vec![i] })
        .collect();
    let names: Vec<String> = (0..=buses.iter().copied().max().unwrap_or(0)).map(|b| format!("/fake/i2c-{b}")).collect();
    let fitted = chips
        .iter()
        .zip(&plans)
        .map(|(chip, plan)| Fitted {
            chip: Box::new(chip.clone()),
            place: Place {
                name: format!("s{}", plan.address),
                chip: "MLX90614",
                bus: (&names[plan.bus]).into(),
                address: plan.address,
            },
            power: powered.then_some(0),
        })
        .collect();
    let schedule = Schedule::plain(Duration::from_micros(PERIOD_US), plans, names);
    let absent = Arc::<Mutex<Vec<String>>>::default();
    let unplugged = absent.clone();
    let system = System {
        now,
        sleep_until,
        exists: Box::new(move |node| !unplugged.lock().unwrap().iter().any(|a| a == node)),
        announce: |_| {},
    };
    let switch = Supply::default();
    let lines: Vec<Box<dyn Switch>> = if powered { vec![Box::new(switch.clone())] } else { vec![] };
    let source = HardwareSource::on(system, schedule, fitted, lines);
    Rig { source, frame: Frame::new(chips.len()), chips, absent, switch, longest_us: 0 }
}

impl Rig {
    fn scan(&mut self) {
        let tick = now();
        self.source.scan(tick, &mut self.frame);
        let took_us = (NOW.get() - tick.as_nanos()) / 1000;
        self.longest_us = self.longest_us.max(took_us);
        // No reading is older than its scan.
        for sample in self.frame.readings.iter().flatten() {
            assert!(sample.time > tick && sample.time <= self.frame.time);
        }
        sleep_until(tick + Duration::from_micros(PERIOD_US));
    }

    fn scans(&mut self, n: u32) {
        (0..n).for_each(|_| self.scan());
    }

    /// Scans until sensor `i` is measured; gives the time it took, ms.
    fn until_measured(&mut self, i: usize) -> u64 {
        let start = NOW.get();
        for _ in 0..500 {
            self.scan();
            if self.frame.readings[i].is_ok() {
                return (NOW.get() - start) / 1_000_000;
            }
        }
        panic!("sensor {i} did not come back: {:?}", self.frame.readings[i]);
    }
}

#[test]
fn every_sensor_is_read_at_every_scan() {
    let mut rig = rig(&[0, 0, 1], false);
    rig.scans(50);
    assert!(rig.frame.readings.iter().all(Result::is_ok));
    for chip in &rig.chips {
        assert_eq!(chip.get(|l| (l.opens, l.reads)), (1, 50));
    }
    assert_eq!(rig.source.buses_down(), [None, None]);
    assert_eq!(rig.source.health()[2].settling_s, 0.1);
    assert_eq!(rig.source.health()[2].counters.reopened, 0);
}

#[test]
fn one_chip_that_answers_for_two_is_known_by_its_identity() {
    let twins = |identities: &[Option<u64>], absent: bool| {
        let mut rig = rig(&[0, 1, 1], false);
        rig.chips.iter().zip(identities).for_each(|(chip, id)| chip.set(|l| l.identity = *id));
        rig.chips[0].set(|l| l.opening = absent.then_some(BusError::NoAnswer));
        rig.scans(3);
        [0, 1, 2].map(|i| rig.source.twin(i))
    };
    assert_eq!(twins(&[Some(5), Some(6), Some(5)], false), [Some(2), None, Some(0)]);
    assert_eq!(twins(&[Some(5), Some(6), Some(5)], true), [Some(2), None, None], "one that is not there");
    for none in [None, Some(0), Some(u64::MAX)] {
        assert_eq!(twins(&[none; 3], false), [None; 3]);
    }
}

#[test]
fn housekeeping_is_one_chip_a_scan_and_each_once_a_second() {
    let mut rig = rig(&[0, 0, 0, 0, 0, 0], false);
    rig.scans(500); // 10 s
    for chip in &rig.chips {
        assert!((8..=10).contains(&chip.get(|l| l.housekept)));
    }
    let before: u32 = rig.chips.iter().map(|c| c.get(|l| l.housekept)).sum();
    rig.scan();
    let after: u32 = rig.chips.iter().map(|c| c.get(|l| l.housekept)).sum();
    assert!(after - before <= 1);
}

#[test]
fn one_glitch_is_tried_again_and_two_are_a_missing_reading() {
    let mut rig = rig(&[0, 0], false);
    rig.scan();
    rig.chips[0].set(|l| l.glitches = 1);
    rig.scan();
    assert!(rig.frame.readings[0].is_ok());
    assert_eq!(rig.source.health()[0].counters.retries, 1);
    rig.chips[0].set(|l| l.glitches = 2);
    rig.scan();
    assert_eq!(rig.frame.readings[0], Err(Missing::BadPec));
    assert!(rig.frame.readings[1].is_ok());
    rig.scan();
    assert!(rig.frame.readings[0].is_ok());
}

#[test]
fn a_chip_that_falls_silent_is_missing_at_once_and_back_at_once() {
    let mut rig = rig(&[0, 0], false);
    rig.scans(10);
    for silent_scans in [1, 10, 200] {
        rig.chips[1].set(|l| (l.reading, l.opening) = (Some(Missing::NoAnswer), Some(BusError::NoAnswer)));
        for _ in 0..silent_scans {
            rig.scan();
            assert_eq!(rig.frame.readings[1], Err(Missing::NoAnswer));
            assert!(rig.frame.readings[0].is_ok());
        }
        rig.chips[1].set(|l| (l.reading, l.opening) = (None, None));
        assert!(rig.until_measured(1) <= 20);
    }
    assert_eq!(rig.source.health()[1].counters.reopened, 1, "after the long silence it was prepared again");
    assert_eq!(rig.source.buses_down(), [None]);
}

#[test]
fn a_bus_that_vanishes_is_let_go_of_and_taken_up_again() {
    let mut rig = rig(&[0, 0, 1], false);
    rig.scans(10);
    rig.absent.lock().unwrap().push("/fake/i2c-0".into());
    rig.scans(11); // 0.22 s
    for chip in &rig.chips[..2] {
        assert!(!chip.get(|l| l.is_open), "its file is closed, or the adapter could not go");
    }
    assert_eq!(rig.frame.readings[0], Err(Missing::BusGone));
    assert!(rig.frame.readings[2].is_ok());
    assert_eq!(rig.source.buses_down(), [Some(Missing::BusGone), None]);
    let opens = rig.chips[0].get(|l| l.opens);
    rig.scans(100);
    assert_eq!(rig.chips[0].get(|l| l.opens), opens, "nothing is opened on a bus that is not there");
    rig.absent.lock().unwrap().clear();
    assert!(rig.until_measured(0) < 500);
    assert!(rig.until_measured(1) < 50);
    assert_eq!(rig.source.buses_down(), [None, None]);
    assert_eq!(rig.source.health()[0].counters.reopened, 1);
}

#[test]
fn an_error_makes_it_look_for_the_bus_at_once() {
    let mut rig = rig(&[0, 0], false);
    rig.scans(3);
    rig.absent.lock().unwrap().push("/fake/i2c-0".into());
    rig.chips[0].set(|l| l.reading = Some(Missing::NoAnswer));
    rig.scans(2);
    assert!(rig.chips.iter().all(|c| !c.get(|l| l.is_open)));
}

#[test]
fn a_bus_absent_from_the_start_is_no_hindrance() {
    let mut rig = rig(&[0, 1], false);
    rig.absent.lock().unwrap().push("/fake/i2c-1".into());
    rig.scan();
    assert!(rig.frame.readings[0].is_ok());
    assert_eq!(rig.frame.readings[1], Err(Missing::BusGone));
    assert_eq!(rig.source.buses_down(), [None, Some(Missing::BusGone)]);
    rig.absent.lock().unwrap().clear();
    assert!(rig.until_measured(1) <= 220);
}

#[test]
fn a_held_bus_costs_little_and_stops_no_other() {
    let mut rig = rig(&[0, 0, 0, 1], false);
    rig.scans(5);
    for chip in &rig.chips[..3] {
        chip.set(|l| (l.reading, l.opening) = (Some(Missing::BusHeld), Some(BusError::Held)));
    }
    rig.longest_us = 0;
    rig.scans(4);
    assert_eq!(rig.source.buses_down(), [Some(Missing::BusHeld), None]);
    let start = NOW.get();
    let tries = |rig: &Rig| rig.chips[..3].iter().map(|c| c.get(|l| l.reads + l.opens)).sum::<u32>();
    let before = tries(&rig);
    for _ in 0..200 {
        rig.scan();
        assert!(rig.frame.readings[3].is_ok());
        assert!(rig.frame.readings[..3].iter().all(|r| *r == Err(Missing::BusHeld)));
    }
    let seconds = (NOW.get() - start) as f64 * 1e-9;
    assert!(f64::from(tries(&rig) - before) <= seconds * 10.0 + 1.0);
    assert!(rig.longest_us < 35_000, "{} µs", rig.longest_us);
    rig.chips.iter().for_each(|c| c.set(|l| (l.reading, l.opening) = (None, None)));
    assert!((0..3).all(|i| rig.until_measured(i) < 200));
}

#[test]
fn claimed_denied_and_in_use_are_tried_four_times_a_second() {
    for (error, down) in [
        (BusError::Claimed, None),
        (BusError::Denied, Some(Missing::Denied)),
        (BusError::InUse, Some(Missing::BusInUse)),
    ] {
        let mut rig = rig(&[0], false);
        rig.chips[0].set(|l| l.opening = Some(error));
        rig.scans(250); // 5 s
        assert!((16..=20).contains(&rig.chips[0].get(|l| l.opens)));
        assert_eq!(rig.frame.readings[0], Err(error.missing()));
        assert_eq!(rig.source.buses_down(), [down]);
        rig.chips[0].set(|l| l.opening = None);
        assert!(rig.until_measured(0) <= 280);
        assert_eq!(rig.source.buses_down(), [None]);
    }
}

#[test]
fn a_hung_sensor_is_power_cycled_with_all_on_its_line() {
    let mut rig = rig(&[0, 0], true);
    rig.scans(10);
    let start_ms = NOW.get() / 1_000_000;
    rig.chips[0].set(|l| (l.reading, l.opening) = (Some(Missing::NoAnswer), Some(BusError::NoAnswer)));
    let mut powered_off = 0;
    for _ in 0..150 {
        rig.scan();
        powered_off += u32::from(rig.frame.readings == [Err(Missing::PoweredOff); 2]);
        if !rig.switch.0.lock().unwrap().is_empty() {
            // The power cycle heals it.
            rig.chips[0].set(|l| (l.reading, l.opening) = (None, None));
        }
    }
    let switched: Vec<(u64, bool)> = rig.switch.0.lock().unwrap().iter().map(|(ms, on)| (ms - start_ms, *on)).collect();
    assert_eq!(switched.len(), 2, "{switched:?}");
    assert!((1990..2050).contains(&switched[0].0) && !switched[0].1, "{switched:?}");
    assert!((300..330).contains(&(switched[1].0 - switched[0].0)) && switched[1].1, "{switched:?}");
    assert!((29..=32).contains(&powered_off), "0.6 s of 20 ms: {powered_off}");
    assert!(rig.frame.readings.iter().all(Result::is_ok));
    assert_eq!(rig.source.health().iter().map(|h| h.counters.power_cycles).collect::<Vec<_>>(), [1, 1]);
}

#[test]
fn a_bus_that_is_gone_is_no_reason_for_a_power_cycle() {
    let mut rig = rig(&[0, 0], true);
    rig.scans(10);
    rig.absent.lock().unwrap().push("/fake/i2c-0".into());
    rig.scans(500);
    assert!(rig.switch.0.lock().unwrap().is_empty());
}

#[test]
fn a_scan_is_bounded_however_many_chips_must_be_opened() {
    let mut rig = rig(&[0; 24], false);
    rig.scan();
    // 24 times 1.17 ms would be 28 ms; the opening stops at the period's end.
    assert!(rig.longest_us < PERIOD_US + 2_000, "{} µs", rig.longest_us);
    rig.scans(3);
    assert!(rig.frame.readings.iter().all(Result::is_ok));
}

#[test]
fn slots_wait_for_their_time_only_when_the_bus_is_to_be_quiet() {
    let mut rig = rig(&[0, 0], false);
    rig.source.schedule.quiet = Duration::from_millis(1);
    rig.source.schedule.slots[1].offset = Duration::from_millis(8);
    rig.scans(2);
    let tick = now();
    rig.source.scan(tick, &mut rig.frame);
    let second = rig.frame.readings[1].unwrap().time;
    assert!((0.0085..0.0086).contains(&second.since(tick)), "{}", second.since(tick));
}
