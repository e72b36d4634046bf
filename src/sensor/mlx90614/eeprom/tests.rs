use super::*;
use proptest::prelude::*;
use std::sync::{Arc, Mutex};

/// The sensor's EEPROM as the datasheet tells it: erasing sets a cell to 0, writing only sets bits,
/// each takes 5 ms in which the chip does not answer.
#[derive(Debug, Default)]
struct Eeprom {
    cells: [u16; 32],
    busy: Duration,
    writes: usize,
    /// Which of the writes are acknowledged and lost, by their number from 0.
    lost: Vec<usize>,
    /// Which are not acknowledged.
    refused: Vec<usize>,
    /// The cells written to.
    touched: Vec<u8>,
    dead: bool,
}

#[derive(Clone, Debug, Default)]
struct Fake(Arc<Mutex<Eeprom>>);

impl Fake {
    fn with(cell: u8, word: u16) -> Self {
        let fake = Self::default();
        fake.0.lock().unwrap().cells[usize::from(cell - 0x20)] = word;
        fake
    }

    fn holds(&self, cell: u8) -> u16 {
        self.0.lock().unwrap().cells[usize::from(cell - 0x20)]
    }

    fn chip(&self) -> Mlx90614<Self> {
        Mlx90614::new(self.clone())
    }

    /// A pause that lets the EEPROM finish.
    fn pause(&self) -> impl FnMut(Duration) + use<> {
        let fake = self.clone();
        move |time| {
            let mut e = fake.0.lock().unwrap();
            e.busy = e.busy.saturating_sub(time);
        }
    }
}

impl WordBus for Fake {
    fn read_word(&mut self, command: u8) -> Result<u16, BusError> {
        let e = self.0.lock().unwrap();
        if e.dead || e.busy > Duration::ZERO {
            return Err(BusError::NoAnswer);
        }
        Ok(e.cells[usize::from(command - 0x20)])
    }

    fn write_word(&mut self, command: u8, word: u16) -> Result<(), BusError> {
        let mut e = self.0.lock().unwrap();
        let number = e.writes;
        e.writes += 1;
        e.touched.push(command);
        if e.dead || e.busy > Duration::ZERO || e.refused.contains(&number) {
            return Err(BusError::NoAnswer);
        }
        if !e.lost.contains(&number) {
            let cell = &mut e.cells[usize::from(command - 0x20)];
            *cell = if word == 0 { 0 } else { *cell | word };
            e.busy = Duration::from_millis(5);
        }
        Ok(())
    }
}

#[test]
fn the_address_changes_and_the_cells_high_byte_stays() {
    let fake = Fake::with(0x2E, 0xBE5A);
    let change = fake.chip().set_address(0x5B, &mut fake.pause());
    assert_eq!(change, Ok(Change { from: 0xBE5A, to: 0xBE5B }));
    assert_eq!(fake.holds(0x2E), 0xBE5B);
}

#[test]
fn a_bad_address_and_an_unchanged_one_write_nothing() {
    let fake = Fake::with(0x2E, 0xBE5A);
    for bad in [0x00, 0x02, 0x78, 0x7F, 0xFF] {
        assert_eq!(fake.chip().set_address(bad, &mut fake.pause()), Err(EepromError::BadAddress(bad)));
    }
    assert_eq!(fake.chip().set_address(0x5A, &mut fake.pause()), Err(EepromError::Unchanged(0xBE5A)));
    assert_eq!(fake.0.lock().unwrap().writes, 0);
}

#[test]
fn without_the_erase_the_write_would_not_take() {
    // The model has teeth: the new address lacks bits that the old one has.
    let fake = Fake::with(0x2E, 0xBE5B);
    fake.clone().write_word(0x2E, 0xBE54).unwrap();
    assert_ne!(fake.holds(0x2E), 0xBE54);
    let fake = Fake::with(0x2E, 0xBE5B);
    let mut no_pause = |_: Duration| {};
    assert!(fake.chip().set_address(0x54, &mut no_pause).is_err(), "and it needs its pauses");
}

#[test]
fn what_cannot_be_read_is_not_written() {
    let fake = Fake::default();
    fake.0.lock().unwrap().dead = true;
    let error = fake.chip().set_address(0x5B, &mut fake.pause()).unwrap_err();
    assert_eq!(error, EepromError::Unread { cell: 0x2E, error: Some(BusError::NoAnswer) });
    assert_eq!(fake.0.lock().unwrap().writes, 0);
}

#[test]
fn a_refused_erase_leaves_the_cell_as_it_was() {
    let fake = Fake::with(0x2E, 0xBE5A);
    fake.0.lock().unwrap().refused = vec![0];
    let error = fake.chip().set_address(0x5B, &mut fake.pause()).unwrap_err();
    assert_eq!(error, EepromError::Refused { cell: 0x2E, holds: 0xBE5A, error: Some(BusError::NoAnswer) });
    assert_eq!(fake.holds(0x2E), 0xBE5A);
}

#[test]
fn ignored_writes_are_noticed() {
    // An adapter without PEC: acknowledged, and nothing happens.
    let fake = Fake::with(0x2E, 0xBE5A);
    fake.0.lock().unwrap().lost = (0..100).collect();
    let error = fake.chip().set_address(0x5B, &mut fake.pause()).unwrap_err();
    assert_eq!(error, EepromError::Refused { cell: 0x2E, holds: 0xBE5A, error: None });
}

#[test]
fn a_write_that_fails_after_the_erase_is_undone() {
    for (lost, refused) in [(vec![1], vec![]), (vec![], vec![1]), (vec![], vec![1, 2]), (vec![1, 3], vec![4])] {
        let fake = Fake::with(0x2E, 0xBE5A);
        (fake.0.lock().unwrap().lost, fake.0.lock().unwrap().refused) = (lost, refused);
        let error = fake.chip().set_address(0x5B, &mut fake.pause()).unwrap_err();
        assert_eq!(error, EepromError::Restored { cell: 0x2E, holds: 0xBE5A, asked: 0xBE5B });
        assert_eq!(fake.holds(0x2E), 0xBE5A);
    }
}

#[test]
fn what_cannot_be_undone_is_told() {
    let fake = Fake::with(0x2E, 0xBE5A);
    fake.0.lock().unwrap().refused = (1..100).collect();
    let error = fake.chip().set_address(0x5B, &mut fake.pause()).unwrap_err();
    assert_eq!(error, EepromError::Damaged { cell: 0x2E, held: 0xBE5A, holds: Some(0), asked: 0xBE5B });
    assert!(error.to_string().contains("holds 0x0000 now and held 0xbe5a"), "{error}");
}

proptest! {
    #[test]
    fn factory_bits_never_change_and_no_other_cell_is_touched(
        held: u16, asked: u16, lost in prop::collection::vec(0_usize..10, 0..4),
        refused in prop::collection::vec(0_usize..10, 0..4),
    ) {
        // Bits 14, 13, 12, 11, 7 and 3.
        let factory = 1 << 14 | 1 << 13 | 1 << 12 | 1 << 11 | 1 << 7 | 1 << 3;
        let fake = Fake::with(0x25, held);
        (fake.0.lock().unwrap().lost, fake.0.lock().unwrap().refused) = (lost, refused);
        let result = fake.chip().set_configuration(Configuration(asked), &mut fake.pause());
        let now = fake.holds(0x25);
        prop_assert!(fake.0.lock().unwrap().touched.iter().all(|c| *c == 0x25));
        if held & factory != asked & factory {
            prop_assert_eq!(result, Err(EepromError::FactoryBits { holds: held, asked }));
            prop_assert_eq!(fake.0.lock().unwrap().writes, 0);
        }
        // Whatever went wrong, what is said of the cell is true.
        let said = match result {
            Ok(change) => Some(change.to),
            Err(EepromError::Damaged { holds, .. }) => holds,
            Err(EepromError::Unchanged(holds)
                | EepromError::FactoryBits { holds, .. }
                | EepromError::Refused { holds, .. }
                | EepromError::Restored { holds, .. }) => Some(holds),
            Err(other) => panic!("{other}"),
        };
        prop_assert_eq!(said, Some(now));
    }

    #[test]
    fn filters_can_always_be_changed(held: u16, iir in 0_u16..8, fir in 0_u16..8) {
        let fake = Fake::with(0x25, held);
        let new = Configuration(held).with_filters(iir, fir);
        let result = fake.chip().set_configuration(new, &mut fake.pause());
        if new.0 == held {
            prop_assert_eq!(result, Err(EepromError::Unchanged(held)));
        } else {
            prop_assert_eq!(result, Ok(Change { from: held, to: new.0 }));
        }
        prop_assert_eq!(fake.holds(0x25), new.0);
    }
}
