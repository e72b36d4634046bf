//! Which bus, and how it is reached.

use crate::config::settings::BusAddress;
use std::borrow::Cow;
use zbus::Address;
use zbus::connection::Builder;

/// The bus as messages name it.
pub(crate) fn place(bus: &BusAddress) -> Cow<'static, str> {
    match bus {
        BusAddress::System => "the system bus".into(),
        BusAddress::Session => "the session bus".into(),
        BusAddress::Address(address) => format!("the bus at {address}").into(),
    }
}

/// A connection to be made to `bus`.
///
/// A guid in the address is left out: it is another one after the bus has been restarted, and the
/// connection would be refused for ever.
pub(crate) fn builder(bus: &BusAddress) -> zbus::Result<Builder<'static>> {
    let address = match bus {
        BusAddress::System => Address::system(),
        BusAddress::Session => Address::session(),
        BusAddress::Address(address) => address.parse(),
    }?;
    Ok(Builder::address(Address::new(address.transport().clone())))
}

/// The system's own words for why a bus cannot be had, without the ways that they took.
pub(crate) fn reason(error: &zbus::Error) -> String {
    let mut innermost: &dyn std::error::Error = error;
    while let Some(source) = innermost.source() {
        innermost = source;
    }
    innermost.to_string()
}

/// What to do about a bus that cannot be reached.
pub(crate) fn advice(bus: &BusAddress) -> &'static str {
    match bus {
        BusAddress::System => "is it running? systemctl status dbus",
        _ => "is it running, and is that its address?",
    }
}
