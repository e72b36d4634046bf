//! Who is on the bus, by reading alone.

use super::SetAddressError;
use crate::bus::explain::{Facts, Place, explain};
use crate::bus::{BusError, PecBus};
use crate::ctl::kit::Kit;
use crate::sensor::mlx90614::{Mlx90614, Object};
use std::fmt::Write as _;
use std::path::Path;

/// An MLX90614.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Sensor {
    /// What the factory called it.
    pub identity: u64,
    /// The cell with its address.
    pub cell: u16,
    /// Its own temperature, °C.
    pub die_c: Option<f64>,
    /// What it sees, °C.
    pub object_c: Option<f64>,
    /// Its packet error code does not match.
    pub damaged: bool,
}

/// What answers at an address.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum What {
    Mlx90614(Sensor),
    Other,
    Claimed,
}

/// Somebody on the bus.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Found {
    pub address: u8,
    pub what: What,
}

/// Asks every address. What a kernel driver has claimed is left alone.
pub(super) fn scan(bus: &Path, kit: &Kit) -> Result<Vec<Found>, SetAddressError> {
    let mut found = Vec::new();
    let mut held = None;
    for address in 0x03..=0x77 {
        let outcome = (kit.open_bus)(bus, address).and_then(|wire| look(wire, address));
        let what = match outcome {
            Ok(what) => what,
            Err(BusError::Claimed) => What::Claimed,
            Err(BusError::NoAnswer | BusError::Pec) => continue,
            // Some adapters tell silence so.
            Err(e @ (BusError::Held | BusError::Other(5 | 11))) => {
                held = Some((address, e));
                continue;
            }
            Err(e) => return Err(explained(bus, address, e)),
        };
        found.push(Found { address, what });
    }
    match held {
        Some((address, e)) if found.is_empty() => Err(explained(bus, address, e)),
        _ => Ok(found),
    }
}

/// What answers on `wire`, which leads to `address`.
pub(super) fn look(wire: Box<dyn PecBus>, address: u8) -> Result<What, BusError> {
    let mut chip = Mlx90614::new(wire);
    let cell = chip.address_cell().or_else(|_| chip.address_cell())?;
    let (Ok(identity), die_c) = (chip.identity(), chip.ambient_c().ok()) else { return Ok(What::Other) };
    let has_its_address = cell & 0xFF == u16::from(address);
    // One whose address was changed and that was not power-cycled yet is known by its other words.
    let speaks_like_one = die_c.is_some() && identity != 0 && identity != u64::MAX;
    if !has_its_address && !speaks_like_one {
        return Ok(What::Other);
    }
    let object_c = chip.object_c(Object::One).ok();
    let checked = chip.bus().pec().is_some();
    chip.bus().set_pec(true)?;
    let again = chip.address_cell().or_else(|_| chip.address_cell());
    let damaged = checked && again != Ok(cell);
    Ok(What::Mlx90614(Sensor { identity, cell, die_c, object_c, damaged }))
}

/// What was found, for people.
pub(super) fn told(bus: &Path, found: &[Found]) -> String {
    let mut text = format!("on {}:\n", bus.display());
    if found.is_empty() {
        text.push_str("  nobody answers\n");
    }
    for Found { address, what } in found {
        let _ = match what {
            What::Mlx90614(s) => {
                let c = |v: Option<f64>| v.map_or_else(|| "?".to_owned(), |v| format!("{v:.1} °C"));
                let next = if s.cell & 0xFF == u16::from(*address) {
                    String::new()
                } else {
                    format!("; {:#04x} from its next power cycle on", s.cell & 0xFF)
                };
                writeln!(
                    text,
                    "  {address:#04x}  MLX90614, identity {:016x}, sees {}, is at {} itself{next}",
                    s.identity,
                    c(s.object_c),
                    c(s.die_c)
                )
            }
            What::Other => writeln!(text, "  {address:#04x}  another chip"),
            What::Claimed => writeln!(text, "  {address:#04x}  claimed by a kernel driver, left alone"),
        };
    }
    text
}

/// An error of the bus with the next step.
pub(super) fn explained(bus: &Path, address: u8, error: BusError) -> SetAddressError {
    let place = Place { name: "the sensor".to_owned(), chip: "MLX90614", bus: bus.to_owned(), address };
    SetAddressError::Bus(explain(&place, error, &Facts::gather(Path::new("/"), bus, address)))
}
