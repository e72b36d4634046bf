//! The chip against a fake one in virtual time.

use super::chip::Ads1115Chip;
use super::driver::Channel;
use super::fake::{Course, Failure, Handle, World};
use super::registers::{Conversion, Gain, Rate};
use super::setup::Plan;
use crate::bus::{BusError, WordBus};
use crate::config::settings::AdcInput;
use crate::frame::{Missing, Reading, Value};
use crate::gpio::DataReady;
use crate::sensor::Chip;
use crate::source::Integrity;
use proptest::prelude::*;

const MILLISECOND: u64 = 1_000_000;
/// A conversion at 860 a second, ns.
const NOMINAL: u64 = 1_162_791;

fn chip(world: &Handle, inputs: usize, line: bool) -> Ads1115Chip<Handle> {
    build(world, inputs, Conversion::SingleShot, line)
}

fn build(world: &Handle, inputs: usize, conversion: Conversion, line: bool) -> Ads1115Chip<Handle> {
    // Differential and single-ended inputs in turn.
    let inputs = [AdcInput::Ain0Ain1, AdcInput::Ain2Ain3, AdcInput::Ain0, AdcInput::Ain3][..inputs].iter();
    let channels = inputs.map(|&input| Channel { input, gain: Gain::V2_048, rate: Rate::Sps860 }).collect();
    let plan = Plan { conversion, channels, data_ready: None };
    let (bus, edges) = (world.clone(), world.clone());
    Ads1115Chip::new(
        "fake".into(),
        plan,
        Box::new(move || Ok(Box::new(bus.clone()) as Box<dyn WordBus>)),
        line.then(|| -> super::OpenLine { Box::new(move || Ok(Box::new(edges.clone()) as Box<dyn DataReady>)) }),
        world.clone(),
    )
}

/// The datasheet's MUX codes of the inputs above.
const MUX: [u16; 4] = [0b000, 0b011, 0b100, 0b111];

/// Which input a reading is of and which conversion, as the fake encodes them in the code.
fn origin(reading: Reading) -> (u16, u16) {
    let Value::Volts(volts) = reading.unwrap().value else { panic!("not volts") };
    let code = (volts / 62.5e-6).round() as u16;
    (code / 4000, code % 4000)
}

fn opened(world: &Handle, inputs: usize, line: bool) -> Ads1115Chip<Handle> {
    let mut chip = chip(world, inputs, line);
    chip.open().unwrap();
    chip
}

#[test]
fn four_inputs_are_read_in_turn_by_time_alone() {
    let world = World::new();
    let mut chip = opened(&world, 4, false);
    for scan in 0..3 {
        chip.begin();
        for (slot, mux) in MUX.into_iter().enumerate() {
            assert_eq!(origin(chip.read(slot)), (mux, scan * 4 + slot as u16 + 1));
        }
    }
    let health = chip.health(2);
    assert_eq!((health.counters.reads, health.counters.not_ready), (3, 0));
    assert_eq!(health.integrity, Integrity::SensorWithout);
}

#[test]
fn an_edge_saves_the_margin_and_the_stamp_is_the_end_of_the_result() {
    let world = World::new();
    let mut chip = opened(&world, 2, true);
    world.world().usual = Course { factor: 0.95, ..Course::IDEAL };
    chip.begin();
    let begun = world.world().now;
    let first = chip.read(0);
    // From the middle of the start's transfer: conversion; then the check and the result.
    let expected = begun - 60_000 + NOMINAL * 95 / 100 + 2 * 120_000;
    assert!(first.unwrap().time.as_nanos().abs_diff(expected) < 1_000);
    // The next conversion is under way by then.
    assert_eq!(world.world().now, first.unwrap().time.as_nanos() + 120_000);
    assert_eq!(origin(first).0, MUX[0]);
    assert_eq!(origin(chip.read(1)).0, MUX[1]);
    assert_eq!(chip.health(0).counters.not_ready, 0);
}

#[test]
fn conversions_overlap_with_other_work() {
    let world = World::new();
    let mut chip = opened(&world, 1, false);
    chip.begin();
    let now = world.world().now;
    world.world().advance(now + 2 * MILLISECOND);
    let waited = world.world().waited;
    chip.read(0).unwrap();
    assert_eq!(world.world().waited, waited, "nothing to wait for");
}

#[test]
fn a_silent_line_costs_time_once_and_no_measurement() {
    let world = World::new();
    let mut chip = opened(&world, 1, true);
    world.world().usual = Course::SILENT;
    let mut waits = Vec::new();
    for _ in 0..3 {
        let waited = world.world().waited;
        assert_eq!(origin(chip.read(0)).0, 0);
        waits.push(world.world().waited - waited);
    }
    assert!(waits[0] > 2 * NOMINAL && waits[0] <= 2 * NOMINAL + 2 * MILLISECOND, "{waits:?}");
    assert!(waits[1..].iter().all(|w| *w < NOMINAL * 12 / 10), "{waits:?}");
    assert_eq!(chip.health(0).counters.not_ready, 3);
    // The line comes back: it is used from its first edge on.
    world.world().usual = Course::IDEAL;
    for _ in 0..30 {
        chip.read(0).unwrap();
    }
    assert_eq!(chip.health(0).counters.not_ready, 3);
}

#[test]
fn stray_edges_do_not_end_a_conversion() {
    let world = World::new();
    let mut chip = opened(&world, 2, true);
    for stray_after in [0, NOMINAL / 2, NOMINAL * 95 / 100] {
        for factor in [1.0, 1.09, 1.5] {
            world.world().usual = Course { factor, stray_after: Some(stray_after), ..Course::IDEAL };
            chip.begin();
            assert_eq!(origin(chip.read(0)).0, MUX[0], "{stray_after} {factor}");
            assert_eq!(origin(chip.read(1)).0, MUX[1], "{stray_after} {factor}");
        }
    }
}

#[test]
fn a_conversion_that_does_not_end_in_time_is_not_ready_and_not_mistaken_for_the_next() {
    let world = World::new();
    let mut chip = opened(&world, 2, false);
    world.world().courses.push_back(Course { factor: 8.0, ..Course::IDEAL });
    chip.begin();
    let waited = world.world().waited;
    assert_eq!(chip.read(0), Err(Missing::NotReady));
    assert!(world.world().waited - waited <= 2 * NOMINAL + 2 * MILLISECOND);
    assert_eq!(chip.health(0).counters.not_ready, 1);
    // The first input's conversion ends while the second's is wanted.
    for _ in 0..4 {
        if let Ok(sample) = chip.read(1) {
            assert_eq!(origin(Ok(sample)).0, MUX[1]);
        }
    }
    assert_eq!(origin(chip.read(1)).0, MUX[1]);
}

#[test]
fn both_ends_of_the_range_are_saturation() {
    let world = World::new();
    let mut chip = opened(&world, 1, false);
    for code in [0x7fff, 0x8000] {
        world.world().forced_code = Some(code);
        assert_eq!(chip.read(0), Err(Missing::Saturated));
    }
    assert_eq!(chip.health(0).counters.out_of_range, 2);
    for (code, volts) in [(0x7ffe, 2.047875), (0x8001, -2.0479375), (0xffff, -62.5e-6), (0, 0.0)] {
        world.world().forced_code = Some(code);
        let Value::Volts(read) = chip.read(0).unwrap().value else { panic!("not volts") };
        assert!((read - volts).abs() < 1e-9, "{code:#x}: {read}");
    }
}

#[test]
fn a_supply_that_drops_is_noticed_and_survived() {
    for (inputs, conversion, line) in
        [(2, Conversion::SingleShot, false), (2, Conversion::SingleShot, true), (1, Conversion::Continuous, false)]
    {
        let world = World::new();
        let mut chip = build(&world, inputs, conversion, line);
        chip.open().unwrap();
        // The second input, whose multiplexer setting differs from that after a reset; in continuous
        // mode, any.
        let slot = inputs - 1;
        chip.begin();
        chip.read(slot).unwrap();
        chip.begin();
        if slot == 1 {
            chip.read(0).unwrap();
        }
        world.world().brown_out();
        assert_eq!(chip.read(slot), Err(Missing::Impossible), "{conversion:?} {line}");
        assert_eq!(origin(chip.read(slot)).0, MUX[slot]);
    }
}

#[test]
fn another_chip_at_the_address_gives_no_reading_and_is_seldom_written_to() {
    /// A thermometer that keeps 9 bits.
    struct Thermometer(Handle, [u16; 4]);
    impl WordBus for Thermometer {
        fn read_word(&mut self, command: u8) -> Result<u16, BusError> {
            self.0.world().transfers += 1;
            Ok((self.1[usize::from(command)] & 0xff80).swap_bytes())
        }
        fn write_word(&mut self, command: u8, word: u16) -> Result<(), BusError> {
            self.1[usize::from(command)] = word.swap_bytes();
            Ok(())
        }
    }
    let world = World::new();
    let bus = world.clone();
    let channels = vec![Channel { input: AdcInput::Ain0Ain1, gain: Gain::V2_048, rate: Rate::Sps860 }];
    let plan = Plan { conversion: Conversion::SingleShot, channels, data_ready: None };
    let open = Box::new(move || Ok(Box::new(Thermometer(bus.clone(), [0; 4])) as Box<dyn WordBus>));
    let mut chip = Ads1115Chip::new("fake".into(), plan, open, None, world.clone());
    assert_eq!(chip.open(), Ok(()));
    let transfers = world.world().transfers;
    for _ in 0..50 {
        chip.begin();
        assert_eq!(chip.read(0), Err(Missing::Impossible));
    }
    assert_eq!(world.world().transfers, transfers);
    let now = world.world().now;
    world.world().advance(now + 1_100 * MILLISECOND);
    assert_eq!(chip.read(0), Err(Missing::Impossible));
    assert!(world.world().transfers > transfers);
}

#[test]
fn what_a_former_master_left_running_is_waited_for() {
    for (config, still) in [(0x8103_u16, 138 * MILLISECOND), (0x0003, 138 * MILLISECOND), (0x85e3, 2 * MILLISECOND)] {
        let world = World::new();
        // Slow and single, slow and continuous, fast and single; on another input.
        world.clone().write_word(1, (config | 0x2000).swap_bytes()).unwrap();
        let mut chip = opened(&world, 1, false);
        let begun = world.world().now;
        let reading = loop {
            let reading = chip.read(0);
            if reading.is_ok() || world.world().now > begun + 2 * still {
                break reading;
            }
            let now = world.world().now;
            world.world().advance(now + MILLISECOND);
        };
        assert_eq!(origin(reading).0, 0, "{config:#x}");
    }
}

#[test]
fn plain_memory_is_ready_at_once_but_waited_for_all_the_same() {
    let world = World::new();
    world.world().memory = true;
    world.world().registers = [0x1000, 0x8583, 0, 0];
    let mut chip = opened(&world, 1, false);
    let waited = world.world().waited;
    chip.read(0).unwrap();
    assert!(world.world().waited - waited >= NOMINAL * 11 / 10);
}

#[test]
fn on_plain_memory_only_an_edge_of_the_conversions_own_time_counts() {
    // Before the start, too soon after it, in time: how long the reading takes, ns.
    for (edge, least, most) in
        [(-1_000_i64, 2 * NOMINAL, u64::MAX), (200_000, NOMINAL, 2 * NOMINAL), (1_150_000, 0, NOMINAL)]
    {
        let world = World::new();
        world.world().memory = true;
        let mut chip = opened(&world, 1, true);
        let now = world.world().now;
        world.world().edges.push(now.saturating_add_signed(edge));
        let waited = world.world().waited;
        chip.read(0).unwrap();
        let waited = world.world().waited - waited;
        assert!(waited > least && waited < most, "{edge}: {waited}");
    }
}

#[test]
fn a_result_whose_transfer_failed_is_still_there() {
    let world = World::new();
    let mut chip = opened(&world, 1, true);
    chip.begin();
    world.world().failures.extend([None, Some(Failure::Heard)]);
    assert_eq!(chip.read(0), Err(Missing::NoAnswer));
    assert_eq!(origin(chip.read(0)), (0, 1));
    let counters = chip.health(0).counters;
    assert_eq!((counters.reads, counters.no_answer, counters.not_ready), (1, 1, 0));
}

#[test]
fn a_result_of_long_ago_is_not_shown_as_new() {
    let world = World::new();
    let mut chip = opened(&world, 1, false);
    chip.begin();
    let now = world.world().now;
    world.world().advance(now + 5_000 * MILLISECOND);
    assert_eq!(origin(chip.read(0)), (0, 2));
}

#[test]
fn opening_says_when_nobody_answers_and_counts() {
    let world = World::new();
    let mut chip = chip(&world, 2, false);
    assert_eq!(chip.read(0), Err(Missing::BusGone));
    world.world().failures.push_back(Some(Failure::Unheard));
    assert_eq!(chip.open(), Err(BusError::NoAnswer));
    chip.open().unwrap();
    assert_eq!(chip.health(1).counters.reopened, 0);
    chip.close();
    assert_eq!(chip.read(1), Err(Missing::BusGone));
    chip.open().unwrap();
    assert_eq!(chip.health(1).counters.reopened, 1);
    assert!(chip.read(1).is_ok());
    assert!(chip.read(7).is_err());
}

#[test]
fn a_line_that_cannot_be_had_leaves_polling() {
    let world = World::new();
    let bus = world.clone();
    let channels = vec![Channel { input: AdcInput::Ain0Ain1, gain: Gain::V2_048, rate: Rate::Sps860 }];
    let plan = Plan { conversion: Conversion::SingleShot, channels, data_ready: None };
    let mut chip = Ads1115Chip::new(
        "fake".into(),
        plan,
        Box::new(move || Ok(Box::new(bus.clone()) as Box<dyn WordBus>)),
        Some(Box::new(|| Err(crate::gpio::GpioError::Denied("/dev/gpiochip0".into())))),
        world.clone(),
    );
    chip.open().unwrap();
    assert_eq!(origin(chip.read(0)).0, 0);
    assert_eq!(chip.health(0).counters.not_ready, 0);
}

/// However long it takes: a start beside it would not be heard, and its result would look like the new one's.
#[test]
fn a_conversion_from_before_is_waited_out() {
    let world = World::new();
    let mut before = opened(&world, 2, false);
    world.world().usual = Course { factor: 6.0, ..Course::IDEAL };
    assert_eq!(before.read(1), Err(Missing::NotReady));
    world.world().usual = Course::IDEAL;
    let mut chip = opened(&world, 2, false);
    chip.begin();
    assert_eq!(origin(chip.read(0)).0, MUX[0]);
}

/// Anything at all.
fn wild() -> impl Strategy<Value = Course> {
    let edge = || 0..8 * NOMINAL;
    (0.1..5.0, proptest::option::weighted(0.7, edge()), proptest::option::of(edge()))
        .prop_map(|(factor, edge_after, stray_after)| Course { factor, edge_after, stray_after })
}

/// As the datasheet allows, with edges that the kernel delivers at once or never.
fn sound() -> impl Strategy<Value = Course> {
    (0.9..1.1, proptest::option::weighted(0.7, 0..50_000_u64)).prop_map(|(factor, edge_after)| Course {
        factor,
        edge_after,
        stray_after: None,
    })
}

fn failure() -> impl Strategy<Value = Option<Failure>> {
    prop_oneof![8 => Just(None), 1 => Just(Some(Failure::Heard)), 1 => Just(Some(Failure::Unheard))]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    /// Whatever conversions, edges and transfers do: a reading is of its own input, of a
    /// conversion that was not read before and began lately, and no wait is longer than two
    /// conversions and 2 ms.
    #[test]
    fn no_reading_is_stale(
        inputs in 1..=4_usize,
        line: bool,
        courses in proptest::collection::vec(wild(), 0..80),
        failures in proptest::collection::vec(failure(), 0..200),
        steps in proptest::collection::vec((0..5_usize, prop_oneof![0..5 * MILLISECOND, 0..300 * MILLISECOND]), 1..60),
    ) {
        let world = World::new();
        let mut chip = opened(&world, inputs, line);
        world.world().courses.extend(courses);
        world.world().failures.extend(failures);
        let mut last = 0;
        for (step, idle) in steps {
            let now = world.world().now;
            world.world().advance(now + idle);
            if step == 4 {
                chip.begin();
                continue;
            }
            let slot = step % inputs;
            let waited = world.world().waited;
            let reading = chip.read(slot);
            prop_assert!(world.world().waited - waited <= 2 * NOMINAL + 2 * MILLISECOND + 1_000);
            if let Ok(sample) = reading {
                let (mux, number) = origin(reading);
                prop_assert_eq!(mux, MUX[slot]);
                prop_assert!(number > last, "{} after {}", number, last);
                let age = sample.time.as_nanos() - world.world().began;
                prop_assert!(age < 110 * MILLISECOND, "{} ms", age / MILLISECOND);
                last = number;
            }
        }
    }

    /// In continuous mode no conversion is read twice, with edges, without, and with a line that
    /// comes and goes.
    #[test]
    fn no_conversion_is_read_twice(
        line: bool,
        courses in proptest::collection::vec(sound(), 0..200),
        failures in proptest::collection::vec(failure(), 0..100),
        idles in proptest::collection::vec(0..4 * MILLISECOND, 1..60),
    ) {
        let world = World::new();
        let mut chip = build(&world, 1, Conversion::Continuous, line);
        chip.open().unwrap();
        world.world().courses.extend(courses);
        world.world().failures.extend(failures);
        let mut last = 0;
        for idle in idles {
            let now = world.world().now;
            world.world().advance(now + idle);
            chip.begin();
            let waited = world.world().waited;
            let reading = chip.read(0);
            prop_assert!(world.world().waited - waited <= 2 * NOMINAL + 2 * MILLISECOND + 1_000);
            if reading.is_ok() {
                let (_, number) = origin(reading);
                prop_assert!(number > last, "{} after {}", number, last);
                last = number;
            }
        }
        // Nothing keeps it from giving readings in the end.
        world.world().failures.clear();
        let good = (0..200).filter(|_| chip.read(0).is_ok()).count();
        prop_assert!(good > 0);
    }
}

/// A chip of one input at 128 a second, read as after a reset.
fn as_reset(world: &Handle) -> Ads1115Chip<Handle> {
    let channels = vec![Channel { input: AdcInput::Ain0Ain1, gain: Gain::V2_048, rate: Rate::Sps128 }];
    let plan = Plan { conversion: Conversion::SingleShot, channels, data_ready: None };
    let bus = world.clone();
    let open = Box::new(move || Ok(Box::new(bus.clone()) as Box<dyn WordBus>));
    Ads1115Chip::new("fake".into(), plan, open, None, world.clone())
}

#[test]
fn a_supply_that_drops_is_noticed_where_the_settings_are_those_after_a_reset() {
    let world = World::new();
    let mut chip = as_reset(&world);
    chip.open().unwrap();
    chip.begin();
    assert_eq!(origin(chip.read(0)), (0, 1));
    chip.begin();
    world.world().brown_out();
    assert_eq!(chip.read(0), Err(Missing::Impossible));
    assert_eq!(origin(chip.read(0)), (0, 2));
}

#[test]
fn a_supply_that_drops_between_two_attempts_at_a_result_is_noticed() {
    for line in [false, true] {
        let world = World::new();
        let mut chip = opened(&world, 1, line);
        chip.begin();
        world.world().failures.extend([None, Some(Failure::Unheard)]);
        assert_eq!(chip.read(0), Err(Missing::NoAnswer));
        world.world().brown_out();
        assert_eq!(chip.read(0), Err(Missing::Impossible), "{line}");
        assert_eq!(origin(chip.read(0)), (0, 2));
    }
}

#[test]
fn a_line_that_a_lost_supply_made_silent_speaks_again() {
    let world = World::new();
    let mut chip = opened(&world, 1, true);
    let mut scan = || {
        chip.begin();
        chip.read(0).unwrap();
        let now = world.world().now;
        world.world().advance(now + 10 * MILLISECOND);
        chip.health(0).counters.not_ready
    };
    assert_eq!((0..5).map(|_| scan()).max(), Some(0));
    // Between two scans: the next start writes the settings, but not the thresholds.
    world.world().brown_out();
    assert_eq!((0..50).map(|_| scan()).max(), Some(1));
    assert_eq!(world.world().registers[2..], [0x0000, 0x8000]);
}
