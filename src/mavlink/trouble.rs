//! What can go wrong with an endpoint, and what the user can do about it.

use std::fmt;
use std::io::{Error, ErrorKind};

/// Why an endpoint cannot send.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trouble {
    /// Another program has the port that was to be bound (EADDRINUSE), with that port.
    PortInUse(u16),
    /// The address to bind is not this machine's (EADDRNOTAVAIL): perhaps not yet.
    NotHere,
    /// The receiving host says that nobody listens on that port (ECONNREFUSED).
    Refused,
    /// No way there (ENETUNREACH, EHOSTUNREACH, ENETDOWN): perhaps not yet.
    Unreachable,
    /// The system forbids it (EACCES, EPERM).
    Denied,
    /// The socket's buffer was full (EAGAIN, ENOBUFS).
    Full,
    /// Anything else, with its errno (0 when there is none).
    Other(i32),
}

/// ENOBUFS, which has no `ErrorKind` of its own.
const ENOBUFS: i32 = rustix::io::Errno::NOBUFS.raw_os_error();

impl Trouble {
    /// The trouble behind an error of a socket; `port` is the one it binds.
    pub fn new(error: &Error, port: u16) -> Self {
        match error.kind() {
            ErrorKind::AddrInUse => Self::PortInUse(port),
            ErrorKind::AddrNotAvailable => Self::NotHere,
            ErrorKind::ConnectionRefused => Self::Refused,
            ErrorKind::NetworkUnreachable | ErrorKind::HostUnreachable | ErrorKind::NetworkDown => Self::Unreachable,
            ErrorKind::PermissionDenied => Self::Denied,
            ErrorKind::WouldBlock => Self::Full,
            _ => match error.raw_os_error().unwrap_or(0) {
                ENOBUFS => Self::Full,
                errno => Self::Other(errno),
            },
        }
    }

    /// Whether another socket may help: the old one's route or address is of no use any more.
    pub const fn wants_new_socket(self) -> bool {
        !matches!(self, Self::Refused | Self::Full | Self::Denied)
    }
}

impl fmt::Display for Trouble {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::PortInUse(port) => write!(
                f,
                "the port is in use by another program; choose another port or stop it (ss -lunp 'sport = :{port}')"
            ),
            Self::NotHere => f.write_str("this machine does not have that address; will try again (ip address)"),
            Self::Refused => f.write_str("nobody listens there; start the receiver or correct the address"),
            Self::Unreachable => f.write_str("there is no way to that network; will try again (ip route)"),
            Self::Denied => f.write_str(
                "the system forbids it: another host needs IPAddressAllow= in the unit (systemctl edit irhorizond), \
                 a port below 1024 is root's",
            ),
            Self::Full => f.write_str("the network takes messages more slowly than they come"),
            Self::Other(0) => f.write_str("it failed for an unknown reason"),
            Self::Other(errno) => write!(f, "{}", Error::from_raw_os_error(*errno)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_of_sockets_are_told_apart() {
        // errno(3) numbers of Linux.
        let table = [
            (98, Trouble::PortInUse(14550)),
            (99, Trouble::NotHere),
            (111, Trouble::Refused),
            (100, Trouble::Unreachable),
            (101, Trouble::Unreachable),
            (113, Trouble::Unreachable),
            (1, Trouble::Denied),
            (13, Trouble::Denied),
            (11, Trouble::Full),
            (105, Trouble::Full),
            (22, Trouble::Other(22)),
        ];
        for (errno, trouble) in table {
            assert_eq!(Trouble::new(&Error::from_raw_os_error(errno), 14550), trouble, "errno {errno}");
            assert!(!trouble.to_string().is_empty());
        }
        assert_eq!(Trouble::new(&Error::other("?"), 0), Trouble::Other(0));
    }
}
