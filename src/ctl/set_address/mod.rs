//! `set-address`: another address for the one MLX90614 on a bus, asked for and verified.
//!
//! - `scan`: who is on the bus;
//! - `error`: why nothing was changed.

mod error;
mod scan;

pub use error::SetAddressError;

use super::error::CtlError;
use super::in_use::nobody_reads;
use super::kit::Kit;
use super::run::print;
use super::setup_args::SetAddressArgs;
use crate::bus::{BusError, PecBus, WordBus};
use crate::config::settings::BusAddress;
use crate::sensor::mlx90614::Mlx90614;
use crate::sensor::mlx90614::eeprom::{EepromError, PecOnWrite};
use scan::{Found, Sensor, What, explained, scan};
use std::io::Write;
use std::path::Path;

/// Looks who is there, asks, writes, and says what is to be done.
pub fn command(args: &SetAddressArgs, dbus: &BusAddress, kit: &Kit, out: &mut dyn Write) -> Result<(), CtlError> {
    nobody_reads(&args.i2c_bus, dbus, kit)?;
    let found = scan(&args.i2c_bus, kit)?;
    print(out, &scan::told(&args.i2c_bus, &found))?;
    let (address, sensor) = the_one(args, &found)?;
    let new = args.new;
    if (address, u16::from(new)) == (new, sensor.cell & 0xFF) {
        return print(out, "it has that address already: nothing was written\n");
    }
    if found.iter().any(|f| f.address == new && f.address != address) {
        return Err(SetAddressError::Taken(new).into());
    }
    let question = format!("Change its address from {address:#04x} to {new:#04x}?");
    if !args.yes && !(kit.ask)(&question).map_err(SetAddressError::Ask)? {
        return Err(SetAddressError::Declined.into());
    }
    write(args, address, kit)?;
    print(
        out,
        &format!(
            "cell 0x2e holds {new:#04x} now, read back. Until it is power-cycled the sensor goes on at {address:#04x}: \
             take its supply off and put it on again\n"
        ),
    )?;
    if !args.yes && (kit.ask)("Is it power-cycled? Shall I look?").map_err(SetAddressError::Ask)? {
        let there = look(&args.i2c_bus, new, kit)?;
        print(out, &format!("it answers at {new:#04x}: identity {:016x}\n", there.identity))?;
    }
    Ok(())
}

/// The one MLX90614 among `found`.
fn the_one<'a>(args: &SetAddressArgs, found: &'a [Found]) -> Result<(u8, &'a Sensor), SetAddressError> {
    let sensors: Vec<(u8, &Sensor)> = found
        .iter()
        .filter_map(|f| if let What::Mlx90614(s) = &f.what { Some((f.address, s)) } else { None })
        .collect();
    let bus = args.i2c_bus.clone();
    match sensors[..] {
        [] => Err(SetAddressError::Nobody(bus)),
        [(address, s)] if s.damaged && !args.no_read_pec => Err(SetAddressError::Damaged(address)),
        [one] => Ok(one),
        _ => Err(SetAddressError::Several { bus, addresses: sensors.iter().map(|(a, _)| *a).collect() }),
    }
}

fn write(args: &SetAddressArgs, address: u8, kit: &Kit) -> Result<(), SetAddressError> {
    let failed = |e: BusError| explained(&args.i2c_bus, address, e);
    let mut bus = (kit.open_bus)(&args.i2c_bus, address).map_err(failed)?;
    // The sensor takes no write without PEC. An adapter that has none is told by the cell not changing.
    let bus: Box<dyn WordBus> = if args.no_read_pec {
        Box::new(PecOnWrite(bus))
    } else {
        bus.set_pec(true).map_err(failed)?;
        Box::new(bus)
    };
    match Mlx90614::new(bus).set_address(args.new, &mut |time| (kit.pause)(time)) {
        Ok(_) => Ok(()),
        // Set before, and not power-cycled since.
        Err(EepromError::Unchanged(_)) => Ok(()),
        Err(e) => Err(SetAddressError::Eeprom(e)),
    }
}

/// The sensor at `address`, after its power cycle.
fn look(i2c_bus: &Path, address: u8, kit: &Kit) -> Result<Sensor, SetAddressError> {
    let opened: Result<Box<dyn PecBus>, BusError> = (kit.open_bus)(i2c_bus, address);
    match opened.and_then(|bus| scan::look(bus, address)) {
        Ok(What::Mlx90614(sensor)) => Ok(sensor),
        Ok(_) => Err(SetAddressError::NotBack(address)),
        Err(BusError::NoAnswer) => Err(SetAddressError::NotBack(address)),
        Err(e) => Err(explained(i2c_bus, address, e)),
    }
}
