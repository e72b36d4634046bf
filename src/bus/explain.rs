//! A bus error in words: what was tried on what, why it failed, and the user's next step.

use super::BusError;
use crate::frame::Missing;
use std::fmt;
use std::fs;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

/// A chip as messages name it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The sensor's name; several joined by commas.
    pub name: String,
    /// What it is: `MLX90614`.
    pub chip: &'static str,
    /// Its bus.
    pub bus: PathBuf,
    /// Its address there.
    pub address: u8,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({} at {:#04x} on {})", self.name, self.chip, self.address, self.bus.display())
    }
}

/// What the system knows of a bus and an address on it, gathered to explain an error.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Facts {
    /// The buses that exist: `/dev/i2c-1`, …
    pub buses: Vec<String>,
    /// The kernel's name of the address: `1-005b`.
    pub device: Option<String>,
    /// The kernel driver that has claimed it.
    pub driver: Option<String>,
    /// The device file's group, and its mode.
    pub group: Option<(String, u32)>,
    /// The user that asked.
    pub user: Option<String>,
}

impl Facts {
    /// Looks at `/dev`, `/sys` and `/etc` under `root` (`/`). What cannot be read stays unknown.
    pub fn gather(root: &Path, bus: &Path, address: u8) -> Self {
        let under = |path: &Path| root.join(path.strip_prefix("/").unwrap_or(path));
        let node = under(bus);
        let number = fs::canonicalize(&node)
            .ok()
            .as_deref()
            .unwrap_or(bus)
            .file_name()
            .and_then(|n| n.to_str())
            .and_then(|n| n.strip_prefix("i2c-"))
            .and_then(|n| n.parse::<u32>().ok());
        let device = number.map(|n| format!("{n}-{address:04x}"));
        let driver = device.as_ref().and_then(|device| {
            let link = fs::read_link(under(Path::new("/sys/bus/i2c/devices")).join(device).join("driver")).ok()?;
            Some(link.file_name()?.to_string_lossy().into_owned())
        });
        let group = fs::metadata(&node).ok().and_then(|meta| {
            let name = name_of(&under(Path::new("/etc/group")), meta.gid())?;
            Some((name, meta.mode() & 0o777))
        });
        let user = name_of(&under(Path::new("/etc/passwd")), rustix::process::geteuid().as_raw());
        Self { buses: buses_under(root), device, driver, group, user }
    }
}

/// The buses that exist under `root` (`/`), by number.
pub fn buses_under(root: &Path) -> Vec<String> {
    let Ok(entries) = fs::read_dir(root.join("dev")) else { return Vec::new() };
    let mut numbers: Vec<u32> =
        entries.filter_map(|e| e.ok()?.file_name().to_str()?.strip_prefix("i2c-")?.parse().ok()).collect();
    numbers.sort_unstable();
    numbers.into_iter().map(|n| format!("/dev/i2c-{n}")).collect()
}

/// The name that `id` has in a file of the form of `/etc/passwd` and `/etc/group`.
pub(crate) fn name_of(file: &Path, id: u32) -> Option<String> {
    let text = fs::read_to_string(file).ok()?;
    text.lines().find_map(|line| {
        let mut fields = line.split(':');
        let name = fields.next()?;
        (fields.nth(1)?.parse() == Ok(id)).then(|| name.to_owned())
    })
}

/// `error` on `place`, and what to do about it.
pub fn explain(place: &Place, error: BusError, facts: &Facts) -> String {
    let bus = place.bus.display();
    match error {
        BusError::NoAnswer => format!(
            "{place}: no answer; is it wired and powered, and is that its address? Look with: i2cdetect -y {}",
            facts.device.as_deref().and_then(|d| d.split('-').next()).unwrap_or("BUS")
        ),
        BusError::Pec => format!(
            "{place}: PEC mismatch: words arrive damaged; check the wiring, the pull-ups and that the bus runs at \
             100 kHz or less. If the part is known to send a wrong PEC, set its pec = \"off\""
        ),
        BusError::Held => format!(
            "{place}: the bus is held; a chip keeps its clock or data line low: power-cycle the sensors, check for a \
             short and the pull-ups"
        ),
        BusError::Claimed => match (&facts.driver, &facts.device) {
            (Some(driver), Some(device)) => format!(
                "{place}: claimed by the kernel driver {driver}; free it with: \
                 echo {device} | sudo tee /sys/bus/i2c/drivers/{driver}/unbind"
            ),
            _ => format!(
                "{place}: claimed by a kernel driver; find it under /sys/bus/i2c/devices/{} and unbind it, or \
                 remove the overlay that binds it",
                facts.device.as_deref().unwrap_or("")
            ),
        },
        BusError::Gone if facts.buses.iter().any(|b| Path::new(b) == place.bus) => {
            format!("{place}: the adapter behind {bus} went away; it is tried again until it is back")
        }
        BusError::Gone => {
            let existing = if facts.buses.is_empty() {
                "there is no I2C bus at all".to_owned()
            } else {
                format!("there are: {}", facts.buses.join(", "))
            };
            format!(
                "{place}: there is no {bus}; {existing}. Plug the adapter in, or enable I2C: dtparam=i2c_arm=on in \
                 config.txt (raspi-config), then sudo modprobe i2c-dev"
            )
        }
        BusError::InUse => format!(
            "{place}: another irhorizond or irhorizonctl is at {bus}; find it with: pgrep -a irhorizon, and end it"
        ),
        BusError::Denied => denied(place, facts),
        BusError::Other(95) => format!(
            "{place}: the adapter of {bus} cannot transfer SMBus words; use another adapter, or the i2c-gpio overlay"
        ),
        BusError::Other(25) => format!("{place}: {bus} is not an I2C bus; it should be one of /dev/i2c-*"),
        BusError::Other(_) => format!("{place}: {error}; see the kernel's log: dmesg | grep -i i2c"),
    }
}

fn denied(place: &Place, facts: &Facts) -> String {
    let bus = place.bus.display();
    let user = facts.user.as_deref().unwrap_or("$USER");
    match &facts.group {
        Some((group, mode)) if group != "root" && mode & 0o060 == 0o060 => format!(
            "{place}: {bus} may not be opened by {user}: it is for group {group} (mode {mode:04o}); join it with: \
             sudo usermod -aG {group} {user}, then log in again or restart the service"
        ),
        _ => format!(
            "{place}: {bus} may not be opened by {user}, and no group may: install the package i2c-tools, whose udev \
             rule gives it to group i2c, then: sudo usermod -aG i2c {user}"
        ),
    }
}

/// Why `place` gives no measurement, and what to do about it.
pub fn explain_missing(place: &Place, missing: Missing, facts: &Facts) -> String {
    let error = match missing {
        Missing::NoAnswer => BusError::NoAnswer,
        Missing::BadPec => BusError::Pec,
        Missing::BusHeld => BusError::Held,
        Missing::Claimed => BusError::Claimed,
        Missing::BusGone => BusError::Gone,
        Missing::BusInUse => BusError::InUse,
        Missing::Denied => BusError::Denied,
        Missing::BusError => BusError::Other(0),
        Missing::ErrorFlag => return format!("{place}: its error bit is set; power-cycle it, then replace it"),
        Missing::Saturated => {
            return format!("{place}: at the end of its range; choose a larger gain-v, check the pair's supply");
        }
        Missing::Impossible => return format!("{place}: a value it cannot measure; is it the chip configured here?"),
        Missing::NotReady => {
            return format!(
                "{place}: conversions do not end in time; is it powered, is data-ready wired as configured?"
            );
        }
        Missing::PoweredOff | Missing::NotYet | Missing::Empty => return format!("{place}: {missing}"),
    };
    explain(place, error, facts)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::fs::symlink;

    fn nose() -> Place {
        Place { name: "nose".into(), chip: "MLX90614", bus: "/dev/i2c-1".into(), address: 0x5b }
    }

    fn root(name: &str) -> PathBuf {
        let root = std::env::temp_dir().join(format!("irhorizon-explain-{}-{name}", std::process::id()));
        let _ = fs::remove_dir_all(&root);
        for folder in ["dev", "etc", "sys/bus/i2c/drivers/mlx90614", "sys/bus/i2c/devices/1-005b"] {
            fs::create_dir_all(root.join(folder)).unwrap();
        }
        root
    }

    #[test]
    fn a_claimed_address_names_the_driver_and_how_to_free_it() {
        let root = root("claimed");
        fs::write(root.join("dev/i2c-1"), "").unwrap();
        symlink("../../drivers/mlx90614", root.join("sys/bus/i2c/devices/1-005b/driver")).unwrap();
        let facts = Facts::gather(&root, Path::new("/dev/i2c-1"), 0x5b);
        assert_eq!(
            explain(&nose(), BusError::Claimed, &facts),
            "nose (MLX90614 at 0x5b on /dev/i2c-1): claimed by the kernel driver mlx90614; free it with: \
             echo 1-005b | sudo tee /sys/bus/i2c/drivers/mlx90614/unbind"
        );
        assert!(explain(&nose(), BusError::NoAnswer, &facts).ends_with("i2cdetect -y 1"));
        fs::remove_dir_all(root).unwrap();
    }

    #[test]
    fn a_missing_bus_names_those_that_exist() {
        let root = root("missing");
        for bus in ["i2c-10", "i2c-2", "i2c", "i2c-x"] {
            fs::write(root.join("dev").join(bus), "").unwrap();
        }
        let facts = Facts::gather(&root, Path::new("/dev/i2c-1"), 0x5b);
        let text = explain(&nose(), BusError::Gone, &facts);
        assert!(text.contains("there is no /dev/i2c-1; there are: /dev/i2c-2, /dev/i2c-10."), "{text}");
        assert!(text.contains("dtparam=i2c_arm=on") && text.contains("modprobe i2c-dev"), "{text}");
        assert!(explain(&nose(), BusError::Gone, &Facts::default()).contains("no I2C bus at all"));
        fs::remove_dir_all(root).unwrap();
    }

    #[test]
    fn a_denied_bus_names_its_group() {
        let facts = Facts { group: Some(("i2c".into(), 0o660)), user: Some("pi".into()), ..Facts::default() };
        assert!(explain(&nose(), BusError::Denied, &facts).contains("sudo usermod -aG i2c pi"));
        let facts = Facts { group: Some(("root".into(), 0o600)), user: Some("pi".into()), ..Facts::default() };
        assert!(explain(&nose(), BusError::Denied, &facts).contains("install the package i2c-tools"));
    }

    #[test]
    fn groups_are_found_by_their_number() {
        let root = root("groups");
        fs::write(root.join("etc/group"), "root:x:0:\ndamaged\ni2c:x:998:pi\n").unwrap();
        assert_eq!(name_of(&root.join("etc/group"), 998), Some("i2c".into()));
        assert_eq!(name_of(&root.join("etc/group"), 7), None);
        fs::remove_dir_all(root).unwrap();
    }

    #[test]
    fn a_linked_bus_is_found_by_its_number() {
        let root = root("linked");
        fs::write(root.join("dev/i2c-1"), "").unwrap();
        symlink("i2c-1", root.join("dev/i2c-head")).unwrap();
        assert_eq!(Facts::gather(&root, Path::new("/dev/i2c-head"), 0x5a).device, Some("1-005a".into()));
        fs::remove_dir_all(root).unwrap();
    }

    #[test]
    fn every_reason_names_the_place() {
        for missing in [
            Missing::NoAnswer,
            Missing::BadPec,
            Missing::ErrorFlag,
            Missing::Saturated,
            Missing::Impossible,
            Missing::NotReady,
            Missing::BusHeld,
            Missing::BusError,
            Missing::Claimed,
            Missing::BusGone,
            Missing::BusInUse,
            Missing::Denied,
            Missing::PoweredOff,
        ] {
            let text = explain_missing(&nose(), missing, &Facts::default());
            assert!(text.starts_with("nose (MLX90614 at 0x5b on /dev/i2c-1): "), "{text}");
        }
    }
}
