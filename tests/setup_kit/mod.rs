//! What the commands that set a head up are given by their tests.

pub mod bus;
pub mod daemon;

use bus::{CHIPS, Wire};
use daemon::Fake;
use irhorizon::bus::BusError;
use irhorizon::config::settings::BusAddress;
use irhorizon::ctl::kit::{DaemonError, Kit};
use irhorizon::ctl::run;
use std::cell::{Cell, RefCell};
use std::path::Path;

thread_local! {
    pub static ANSWERS: RefCell<Vec<bool>> = const { RefCell::new(Vec::new()) };
    pub static PROCESS: Cell<Option<u32>> = const { Cell::new(None) };
}

const KIT: Kit = Kit {
    connect: |bus| match bus {
        BusAddress::Address(a) => Ok(Box::new(Fake(a.clone()))),
        _ => Err(DaemonError::Absent("no irhorizond on the system bus: start it".into())),
    },
    open_bus: |bus, address| {
        if bus != Path::new("/dev/i2c-1") {
            return Err(BusError::Gone);
        }
        let claimed = CHIPS.with_borrow(|c| c.iter().any(|c| c.address == address && c.claimed));
        if claimed { Err(BusError::Claimed) } else { Ok(Box::new(Wire { address, checked: false })) }
    },
    daemon_process: || PROCESS.get(),
    ask: |question| {
        if question.contains("power-cycled") {
            CHIPS.with_borrow_mut(|chips| {
                for c in chips.iter_mut().filter(|c| c.mlx) {
                    let cell = c.words.iter().find(|(w, _)| *w == 0x2E).unwrap().1;
                    c.address = (cell & 0x7F) as u8;
                }
            });
        }
        Ok(ANSWERS.with_borrow_mut(|a| if a.is_empty() { false } else { a.remove(0) }))
    },
    pause: |_| {},
    ..Kit::REAL
};

/// Exit code, standard output, standard error.
pub fn ctl(line: &str) -> (u8, String, String) {
    let (mut out, mut err) = (Vec::new(), Vec::new());
    let args = std::iter::once("irhorizonctl").chain(line.split_whitespace());
    let code = run(args, &KIT, &mut out, &mut err);
    (code, String::from_utf8(out).unwrap(), String::from_utf8(err).unwrap())
}
