//! What can go wrong with the service, with the user's next step.

use super::NAME;
use super::bus::{advice, place};
use crate::config::settings::BusAddress;
use std::fmt;

/// Why the service is not on the bus.
#[derive(Clone, Debug, PartialEq)]
pub enum DbusError {
    /// Another process owns the name.
    NameOwned {
        /// Where.
        bus: BusAddress,
        /// The other process, where the bus tells: its id, and its name where `/proc` tells.
        owner: Option<(u32, Option<String>)>,
    },
    /// The bus's policy does not let this user own the name.
    NotAllowed {
        /// Where.
        bus: BusAddress,
        /// What the bus said.
        reason: String,
    },
    /// The bus cannot be reached, or went away.
    Unreachable {
        /// Where.
        bus: BusAddress,
        /// Why.
        reason: String,
    },
}

impl DbusError {
    /// Whether trying again cannot help as long as the user does nothing: at start the daemon ends
    /// with this. A bus that is not there yet may come.
    pub fn fatal(&self) -> bool {
        matches!(self, Self::NameOwned { .. })
    }
}

impl fmt::Display for DbusError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NameOwned { bus, owner } => {
                write!(f, "{NAME} is owned already on {}", place(bus))?;
                match owner {
                    Some((pid, Some(name))) => write!(f, " (pid {pid}, {name})")?,
                    Some((pid, None)) => write!(f, " (pid {pid})")?,
                    None => {}
                }
                f.write_str(": is another irhorizond running? systemctl status irhorizond")
            }
            Self::NotAllowed { bus, reason } => write!(
                f,
                "this user may not own {NAME} on {} ({reason}): run as irhorizon or root, and see that \
                 org.irhorizon1.conf is in /usr/share/dbus-1/system.d; or choose [dbus] bus = \"session\"",
                place(bus)
            ),
            Self::Unreachable { bus, reason } => {
                write!(f, "{} cannot be reached ({reason}): {}", place(bus), advice(bus))
            }
        }
    }
}

impl std::error::Error for DbusError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_owned_name_tells_the_owner_and_the_next_step() {
        let e = DbusError::NameOwned { bus: BusAddress::System, owner: Some((1234, Some("irhorizond".into()))) };
        assert_eq!(
            e.to_string(),
            "org.irhorizon1 is owned already on the system bus (pid 1234, irhorizond): is another irhorizond \
             running? systemctl status irhorizond"
        );
        assert!(e.fatal());
    }
}
