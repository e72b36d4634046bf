//! What can go wrong with an endpoint, and what the user can do about it.

use rustix::io::Errno;
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
    /// The other side has ended the connection (end of file, EPIPE, ECONNRESET).
    Closed,
    /// The other host does not answer (ETIMEDOUT).
    NoAnswer,
    /// There is no such device (ENOENT, ENODEV, ENXIO): perhaps not yet.
    NoDevice,
    /// The device has gone (end of file, EIO).
    Unplugged,
    /// What is there is no tty (ENOTTY, EISDIR).
    NoTty,
    /// Another program has the device for itself (EBUSY).
    Taken,
    /// The system does not let this user have the device (EACCES, EPERM).
    DeviceDenied,
    /// The device does not do that baud rate.
    Baud(u32),
    /// Anything else, with its errno (0 when there is none).
    Other(i32),
}

/// ENOBUFS, which has no `ErrorKind` of its own.
const ENOBUFS: i32 = Errno::NOBUFS.raw_os_error();

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
            ErrorKind::BrokenPipe | ErrorKind::ConnectionReset => Self::Closed,
            ErrorKind::TimedOut => Self::NoAnswer,
            _ => match error.raw_os_error().unwrap_or(0) {
                ENOBUFS => Self::Full,
                errno => Self::Other(errno),
            },
        }
    }

    /// The trouble behind an error of a device.
    pub fn device(errno: Errno) -> Self {
        match errno {
            Errno::NOENT | Errno::NODEV | Errno::NXIO => Self::NoDevice,
            Errno::IO => Self::Unplugged,
            Errno::NOTTY | Errno::ISDIR | Errno::INVAL => Self::NoTty,
            Errno::BUSY => Self::Taken,
            Errno::ACCESS | Errno::PERM => Self::DeviceDenied,
            other => Self::Other(other.raw_os_error()),
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
                "the port is in use by another program; choose another port or stop it (ss -lutnp 'sport = :{port}')"
            ),
            Self::NotHere => f.write_str("this machine does not have that address; will try again (ip address)"),
            Self::Refused => f.write_str("nobody listens there; start the receiver or correct the address"),
            Self::Unreachable => f.write_str("there is no way to that network; will try again (ip route)"),
            Self::Denied => f.write_str(
                "the system forbids it: another host needs IPAddressAllow= in the unit (systemctl edit irhorizond), \
                 a port below 1024 is root's",
            ),
            Self::Full => f.write_str("the network takes messages more slowly than they come"),
            Self::Closed => f.write_str("the other side ended the connection; will connect again"),
            Self::NoAnswer => f.write_str("the other host does not answer; will try again (ping)"),
            Self::NoDevice => {
                f.write_str("there is no such device; will be taken when it is there (ls -l /dev/serial/by-id)")
            }
            Self::Unplugged => f.write_str("the device has gone; will be taken again when it is back"),
            Self::NoTty => f.write_str("that is no serial port; correct the address (ls -l /dev/serial/by-id)"),
            Self::Taken => f.write_str("another program has that port for itself; stop it (fuser -v, ModemManager)"),
            Self::DeviceDenied => f.write_str(
                "the system forbids it: the daemon's user needs the port's group (ls -l, SupplementaryGroups=dialout), \
                 the unit a DeviceAllow=",
            ),
            Self::Baud(baud) => write!(f, "the port does not do {baud} baud; choose a rate that it does"),
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
            (32, Trouble::Closed),
            (104, Trouble::Closed),
            (110, Trouble::NoAnswer),
        ];
        for (errno, trouble) in table {
            assert_eq!(Trouble::new(&Error::from_raw_os_error(errno), 14550), trouble, "errno {errno}");
            assert!(!trouble.to_string().is_empty());
        }
        assert_eq!(Trouble::new(&Error::other("?"), 0), Trouble::Other(0));
    }

    #[test]
    fn errors_of_devices_are_told_apart() {
        let table = [
            (2, Trouble::NoDevice),
            (19, Trouble::NoDevice),
            (6, Trouble::NoDevice),
            (5, Trouble::Unplugged),
            (25, Trouble::NoTty),
            (16, Trouble::Taken),
            (13, Trouble::DeviceDenied),
            (12, Trouble::Other(12)),
        ];
        for (errno, trouble) in table {
            assert_eq!(Trouble::device(Errno::from_raw_os_error(errno)), trouble, "errno {errno}");
            assert!(!trouble.to_string().is_empty());
        }
    }
}
