//! The policy of the system bus, enforced by a real bus: anyone reads, few change, few own the name.
//!
//! Other users are played by `setpriv`, which needs root; without root the one thing seen is that
//! this user may not own the name.

mod dbus_bus;

use dbus_bus::{Bus, Daemon};
use irhorizon::dbus::DbusError;
use std::process::Command;

/// A bus with the defaults of the system bus and the shipped policy, whose user and group are
/// played by ones that every system has.
fn system_like() -> Bus {
    let policy = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/packaging/org.irhorizon1.conf"));
    let policy = policy.unwrap().replace("=\"irhorizon\"", "=\"daemon\"");
    let start = policy.find("<busconfig>").unwrap() + "<busconfig>".len();
    let ours = policy[start..].replace("</busconfig>", "");
    Bus::configured(|address| {
        format!(
            r#"<!DOCTYPE busconfig PUBLIC "-//freedesktop//DTD D-BUS Bus Configuration 1.0//EN"
 "http://www.freedesktop.org/standards/dbus/1.0/busconfig.dtd">
<busconfig>
  <type>system</type>
  <listen>{address}</listen>
  <auth>EXTERNAL</auth>
  <policy context="default">
    <allow user="*"/>
    <deny own="*"/>
    <deny send_type="method_call"/>
    <allow send_type="signal"/>
    <allow send_requested_reply="true" send_type="method_return"/>
    <allow send_requested_reply="true" send_type="error"/>
    <allow receive_type="method_call"/>
    <allow receive_type="method_return"/>
    <allow receive_type="error"/>
    <allow receive_type="signal"/>
    <allow send_destination="org.freedesktop.DBus" send_interface="org.freedesktop.DBus"/>
  </policy>
  {ours}
</busconfig>"#
        )
    })
}

/// What busctl says as another user.
fn busctl_as(bus: &Bus, ids: &[&str], args: &[&str]) -> Result<String, String> {
    let output = Command::new("setpriv")
        .args(ids)
        .args(["--clear-groups", "busctl", &format!("--address={}", bus.address())])
        .args(args)
        .output()
        .expect("setpriv runs: apt-get install util-linux");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).trim_end().to_owned();
    if output.status.success() { Ok(text(&output.stdout)) } else { Err(text(&output.stderr)) }
}

const NOBODY: [&str; 2] = ["--reuid=nobody", "--regid=nogroup"];
const MEMBER: [&str; 2] = ["--reuid=nobody", "--regid=daemon"];
const OURS: [&str; 2] = ["--reuid=daemon", "--regid=nogroup"];

#[test]
fn anyone_reads_and_only_root_and_the_group_change() {
    let bus = system_like();
    let daemon = Daemon::start(&bus);
    if !rustix::process::geteuid().is_root() {
        let Some(Err(error @ DbusError::NotAllowed { .. })) = &daemon.first else { panic!("{:?}", daemon.first) };
        assert!(error.to_string().contains("run as irhorizon or root"), "{error}");
        eprintln!("not root: other users cannot be played");
        return;
    }
    assert_eq!(daemon.first, Some(Ok(())));
    let path = "/org/irhorizon1";
    let roll = ["get-property", "org.irhorizon1", path, "org.irhorizon1.Horizon", "RollDeg"];
    let name = ["get-property", "org.irhorizon1", "/org/irhorizon1/sensor/nose", "org.irhorizon1.Sensor", "Name"];
    let frames = ["call", "org.irhorizon1", path, "org.irhorizon1.Stream", "Frames"];
    let reload = ["call", "org.irhorizon1", path, "org.irhorizon1.Control", "Reload"];
    let managed = ["call", "org.irhorizon1", path, "org.freedesktop.DBus.ObjectManager", "GetManagedObjects"];
    for who in [NOBODY, MEMBER, OURS] {
        assert_eq!(busctl_as(&bus, &who, &roll).unwrap(), "d nan");
        assert_eq!(busctl_as(&bus, &who, &name).unwrap(), "s \"nose\"");
        assert!(busctl_as(&bus, &who, &frames).unwrap().starts_with('h'));
        assert!(busctl_as(&bus, &who, &managed).unwrap().contains("/org/irhorizon1/sensor/down"));
        assert!(busctl_as(&bus, &who, &["introspect", "org.irhorizon1", path]).unwrap().contains("RollDeg"));
    }
    assert!(busctl_as(&bus, &NOBODY, &reload).unwrap_err().contains("denied"));
    busctl_as(&bus, &MEMBER, &reload).unwrap();
    bus.busctl(&reload).unwrap();
    drop(daemon);

    let dbus = "org.freedesktop.DBus";
    let own = ["call", dbus, "/org/freedesktop/DBus", dbus, "RequestName", "su", "org.irhorizon1", "4"];
    for who in [NOBODY, MEMBER] {
        assert!(busctl_as(&bus, &who, &own).unwrap_err().contains("denied"));
    }
    assert_eq!(busctl_as(&bus, &OURS, &own).unwrap(), "u 1");
}
