//! What systemd is told, and what the unit lets the daemon do.

mod process;

use process::{DAEMON, Daemon, Folder};
use rustix::process::Signal;
use std::os::unix::net::UnixDatagram;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

/// In place of systemd: a socket that a daemon with this configuration speaks to.
fn watched(folder: &Folder, text: &str) -> (Daemon, UnixDatagram) {
    let systemd = UnixDatagram::bind(folder.path("notify")).unwrap();
    systemd.set_read_timeout(Some(Duration::from_millis(1500))).unwrap();
    let mut command = Command::new(DAEMON);
    command.arg("--config").arg(folder.write("irhorizon.toml", format!("{text}[dbus]\nbus = \"none\"\n")));
    command.env("NOTIFY_SOCKET", folder.path("notify")).env("WATCHDOG_USEC", "2000000").env_remove("WATCHDOG_PID");
    (Daemon::spawn(command, folder.path("log")), systemd)
}

/// The next words; `None` when there are none for 1.5 s.
fn word(systemd: &UnixDatagram) -> Option<String> {
    let mut buffer = [0; 256];
    let length = systemd.recv(&mut buffer).ok()?;
    Some(String::from_utf8_lossy(&buffer[..length]).trim_end().to_owned())
}

fn until(systemd: &UnixDatagram, wanted: &str) -> usize {
    let start = Instant::now();
    let mut before = 0;
    while word(systemd).as_deref() != Some(wanted) {
        before += 1;
        assert!(start.elapsed() < Duration::from_secs(20), "no {wanted}");
    }
    before
}

#[test]
fn it_is_fed_by_measurements_and_by_faults_and_not_by_a_daemon_that_stands_still() {
    for text in [
        "[simulation]\nenabled = true\n",
        &["nose", "tail", "left", "right", "up", "down"]
            .iter()
            .zip(0x50..)
            .map(|(name, address)| {
                format!(
                    "[[sensor]]\nname = \"{name}\"\nkind = \"mlx90614\"\nbus = \"/dev/i2c-250\"\naddress = {address}\n"
                )
            })
            .collect::<String>(),
    ] {
        let folder = Folder::new();
        let (daemon, systemd) = watched(&folder, text);
        until(&systemd, "READY=1");
        let start = Instant::now();
        for _ in 0..4 {
            until(&systemd, "WATCHDOG=1");
        }
        let took = start.elapsed();
        assert!(took > Duration::from_millis(1000), "four meals in {took:?} of a limit of 2 s");

        daemon.signal(Signal::STOP);
        // What was under way may still come.
        while word(&systemd).is_some() {}
        assert_eq!(word(&systemd), None);
        daemon.signal(Signal::CONT);
        until(&systemd, "WATCHDOG=1");
        daemon.signal(Signal::TERM);
        until(&systemd, "STOPPING=1");
    }
}

/// Debian 12's systemd 252 gives 1.3; 0 is best, and what a plain service has is 9.6.
#[test]
fn the_unit_lets_the_daemon_do_little() {
    let unit = Path::new(env!("CARGO_MANIFEST_DIR")).join("systemd/irhorizond.service");
    let output = Command::new("systemd-analyze")
        .args(["security", "--offline=true", "--no-pager", "--threshold=15"])
        .arg(&unit)
        .output()
        .expect("systemd-analyze runs: apt-get install systemd");
    let said = String::from_utf8_lossy(&output.stdout);
    println!("{}", said.lines().last().unwrap_or_default());
    assert!(
        output.status.success(),
        "an exposure of more than 1.5:\n{said}{}",
        String::from_utf8_lossy(&output.stderr)
    );
}
