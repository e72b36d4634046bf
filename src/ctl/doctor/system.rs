//! What the system tells, under a root that tests choose.

use super::facts::{Node, Service};
use crate::bus::explain::name_of;
use rustix::fs::{Access, access};
use std::fs;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Where a policy of the system bus may be.
const POLICIES: [&str; 2] =
    ["usr/share/dbus-1/system.d/org.irhorizon1.conf", "etc/dbus-1/system.d/org.irhorizon1.conf"];

/// The process of a daemon that runs, but not ourselves.
pub fn daemon_process(root: &Path) -> Option<u32> {
    let entries = fs::read_dir(root.join("proc")).ok()?;
    let pids = entries.filter_map(|e| e.ok()?.file_name().to_str()?.parse::<u32>().ok());
    pids.filter(|pid| {
        let comm = fs::read_to_string(root.join(format!("proc/{pid}/comm")));
        comm.is_ok_and(|name| name.trim_end() == "irhorizond")
    })
    .min()
}

/// Where the bus's policy for the daemon is installed.
pub fn policy(root: &Path) -> Option<PathBuf> {
    POLICIES.iter().find(|p| root.join(p).exists()).map(|p| Path::new("/").join(p))
}

/// What systemd says of the unit, where it runs.
pub fn service(root: &Path) -> Option<Service> {
    if !root.join("run/systemd/system").is_dir() {
        return None;
    }
    let asked = ["show", "irhorizond", "--property=LoadState,ActiveState,Result,NRestarts"];
    let output = Command::new("systemctl").args(asked).output().ok()?;
    Some(parse_service(&String::from_utf8_lossy(&output.stdout)))
}

fn parse_service(text: &str) -> Service {
    let of =
        |key: &str| text.lines().find_map(|l| l.strip_prefix(key)?.strip_prefix('=')).unwrap_or_default().to_owned();
    Service {
        load: of("LoadState"),
        active: of("ActiveState"),
        result: of("Result"),
        restarts: of("NRestarts").parse().unwrap_or(0),
    }
}

/// The serial ports of the MAVLink endpoints in a configuration that was written out, a key a line:
/// `address = "serial:/dev/ttyAMA0:57600"`.
pub fn serial_ports(written: &str) -> Vec<String> {
    let addresses = written.lines().filter_map(|l| l.strip_prefix("address = \"serial:")?.strip_suffix('"'));
    addresses.map(|a| a.rsplit_once(':').map_or(a, |(path, _)| path).to_owned()).collect()
}

/// A device file, and whether this user may use it.
pub fn node(root: &Path, path: &str) -> Node {
    let at = root.join(path.trim_start_matches('/'));
    let user =
        name_of(&root.join("etc/passwd"), rustix::process::geteuid().as_raw()).unwrap_or_else(|| "$USER".to_owned());
    let Ok(meta) = fs::metadata(&at) else {
        return Node { path: path.to_owned(), user, ..Node::default() };
    };
    let groups = root.join("etc/group");
    let group = name_of(&groups, meta.gid());
    let member = group.as_ref().is_some_and(|g| is_member(&groups, g, &user));
    Node {
        path: path.to_owned(),
        present: true,
        allowed: access(&at, Access::READ_OK | Access::WRITE_OK).is_ok(),
        group: group.map(|g| (g, meta.mode() & 0o777)),
        member,
        user,
    }
}

/// Whether a file of the form of /etc/group has `user` in `group`.
fn is_member(file: &Path, group: &str, user: &str) -> bool {
    let text = fs::read_to_string(file).unwrap_or_default();
    let fields = text.lines().map(|l| l.split(':').collect::<Vec<_>>()).find(|f| f.first() == Some(&group));
    fields.is_some_and(|f| f.get(3).is_some_and(|members| members.split(',').any(|m| m == user)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_systemd_says() {
        let text = "LoadState=loaded\nActiveState=failed\nResult=exit-code\nNRestarts=3\n";
        let said = Service { load: "loaded".into(), active: "failed".into(), result: "exit-code".into(), restarts: 3 };
        assert_eq!(parse_service(text), said);
        assert_eq!(parse_service("nonsense"), Service::default());
    }

    #[test]
    fn serial_ports_are_those_of_the_endpoints() {
        let text = "[mavlink]\n[[mavlink.endpoint]]\naddress = \"serial:/dev/ttyAMA0:57600\"\n\
                    [[mavlink.endpoint]]\naddress = \"udpout:127.0.0.1:14550\"\n";
        assert_eq!(serial_ports(text), ["/dev/ttyAMA0"]);
        assert_eq!(serial_ports("address = 0x5a"), [""; 0]);
    }

    #[test]
    fn a_small_system() {
        let root = std::env::temp_dir().join(format!("irhorizon-doctor-{}", std::process::id()));
        for folder in ["dev", "etc/dbus-1/system.d", "proc/77", "proc/9", "proc/self"] {
            fs::create_dir_all(root.join(folder)).unwrap();
        }
        assert_eq!((policy(&root), service(&root), daemon_process(&root)), (None, None, None));
        let me = rustix::process::geteuid().as_raw();
        for (file, text) in [
            ("dev/i2c-1", String::new()),
            ("proc/9/comm", "irhorizonctl\n".into()),
            ("proc/77/comm", "irhorizond\n".into()),
            ("etc/dbus-1/system.d/org.irhorizon1.conf", String::new()),
            ("etc/passwd", format!("pilot:x:{me}:100::/:/bin/sh\n")),
            ("etc/group", format!("i2c:x:{}:radio,pilot\nother:x:77777:\n", rustix::process::getegid().as_raw())),
        ] {
            fs::write(root.join(file), text).unwrap();
        }
        assert_eq!(policy(&root), Some("/etc/dbus-1/system.d/org.irhorizon1.conf".into()));
        assert_eq!(daemon_process(&root), Some(77));
        let there = node(&root, "/dev/i2c-1");
        assert!(there.present && there.allowed && there.member, "{there:?}");
        assert_eq!((there.user.as_str(), there.group.map(|g| g.0).as_deref()), ("pilot", Some("i2c")));
        let absent = node(&root, "/dev/i2c-2");
        assert!(!absent.present && !absent.allowed && absent.group.is_none());
        assert!(!is_member(&root.join("etc/group"), "other", "pilot"));
        fs::remove_dir_all(root).unwrap();
    }
}
