//! The daemon on a kernel's buses: a process with a folder and a D-Bus of its own.

pub use crate::dbus_bus::Bus;

use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;
use std::fs;
use std::os::unix::net::UnixDatagram;
use std::path::PathBuf;
use std::process::{Child, Command, ExitStatus, Output, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

/// The binaries under test: those that `run` names (the release's), else those of the test's own profile.
pub const DAEMON: &str = under_test(option_env!("IRHORIZON_TEST_DAEMON"), env!("CARGO_BIN_EXE_irhorizond"));
pub const CTL: &str = under_test(option_env!("IRHORIZON_TEST_CTL"), env!("CARGO_BIN_EXE_irhorizonctl"));

const fn under_test(named: Option<&'static str>, own: &'static str) -> &'static str {
    match named {
        Some(path) => path,
        None => own,
    }
}

/// Everything is emulated: what takes longer than this hangs.
pub const LIMIT: Duration = Duration::from_secs(30);

/// Refuses to load modules anywhere but where `tests/vm/run` says so.
pub fn require_kernel() {
    let told = std::env::var("IRHORIZON_KERNEL_TESTS");
    assert_eq!(told.as_deref(), Ok("1"), "run these tests by tests/kernel/run");
}

/// A folder that goes away with the test.
pub struct Folder(pub PathBuf);

impl Folder {
    pub fn new() -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let name = format!("irhorizon-kernel-{}-{}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
        let path = std::env::temp_dir().join(name);
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// What `done` gives as soon as it gives something; panics with `what` after [`LIMIT`].
pub fn wait_for<T>(what: &str, mut done: impl FnMut() -> Option<T>) -> T {
    let start = Instant::now();
    loop {
        if let Some(result) = done() {
            return result;
        }
        assert!(start.elapsed() < LIMIT, "within {LIMIT:?}: {what}");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// A daemon at work on a D-Bus of its own.
pub struct Daemon {
    pub bus: Bus,
    pub folder: Folder,
    child: Child,
    notify: UnixDatagram,
}

impl Daemon {
    /// With the configuration `text`, to which the address of its D-Bus is added; waits until it has
    /// said that it is ready.
    pub fn start(text: &str) -> Self {
        let daemon = Self::spawn(text, |_| {});
        daemon.wait_ready();
        daemon
    }

    /// The same without waiting; `prepare` may change the command.
    pub fn spawn(text: &str, prepare: impl FnOnce(&mut Command)) -> Self {
        let (bus, folder) = (Bus::new(), Folder::new());
        let drop_ins = folder.path("irhorizon.toml.d");
        fs::create_dir(&drop_ins).unwrap();
        fs::write(drop_ins.join("bus.toml"), format!("[dbus]\nbus = \"{}\"\n", bus.address())).unwrap();
        fs::write(folder.path("irhorizon.toml"), text).unwrap();
        let notify = UnixDatagram::bind(folder.path("notify")).unwrap();
        notify.set_read_timeout(Some(Duration::from_millis(100))).unwrap();
        let mut command = Command::new(DAEMON);
        command.arg("--config").arg(folder.path("irhorizon.toml"));
        command.env("NOTIFY_SOCKET", folder.path("notify"));
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(fs::File::create(folder.path("log")).unwrap());
        prepare(&mut command);
        let child = command.spawn().unwrap();
        Self { bus, folder, child, notify }
    }

    /// Waits until it tells systemd that it is ready.
    pub fn wait_ready(&self) {
        let mut text = [0; 256];
        wait_for("the daemon is ready", || {
            let length = self.notify.recv(&mut text).ok()?;
            String::from_utf8_lossy(&text[..length]).contains("READY=1").then_some(())
        });
    }

    pub fn pid(&self) -> u32 {
        self.child.id()
    }

    pub fn signal(&self, signal: Signal) {
        kill_process(Pid::from_raw(self.pid().cast_signed()).unwrap(), signal).unwrap();
    }

    /// All that it has logged.
    pub fn said(&self) -> String {
        String::from_utf8_lossy(&fs::read(self.folder.path("log")).unwrap()).into_owned()
    }

    pub fn is_running(&mut self) -> bool {
        self.child.try_wait().unwrap().is_none()
    }

    /// How it ended, once it has.
    pub fn ended(&mut self) -> ExitStatus {
        wait_for("the daemon ends", || self.child.try_wait().unwrap())
    }

    /// `irhorizonctl` on the daemon's bus.
    pub fn ctl(&self, args: &[&str]) -> Output {
        Command::new(CTL).args(["--bus", &self.bus.address()]).args(args).stdin(Stdio::null()).output().unwrap()
    }

    /// What `irhorizonctl status --format json` says.
    pub fn status(&self) -> Value {
        let output = self.ctl(&["status", "--format", "json"]);
        serde_json::from_slice(&output.stdout).unwrap_or_else(|e| panic!("{e}: {output:?}\n{}", self.said()))
    }

    /// The first status in which `done`.
    pub fn until(&self, what: &str, done: impl Fn(&Value) -> bool) -> Value {
        let start = Instant::now();
        loop {
            let status = self.status();
            if done(&status) {
                return status;
            }
            assert!(start.elapsed() < LIMIT, "within {LIMIT:?}: {what}; but: {status}");
        }
    }

    /// A property of the horizon as `busctl get-property` prints it: `d 12.5`.
    pub fn property(&self, name: &str) -> String {
        self.bus.property(name)
    }

    /// All properties of the horizon, of one and the same frame.
    pub fn properties(&self) -> Value {
        let arguments = ["org.freedesktop.DBus.Properties", "GetAll", "s", "org.irhorizon1.Horizon"];
        let call = [&["--json=short", "call", "org.irhorizon1", "/org/irhorizon1"], &arguments[..]].concat();
        let answer: Value = serde_json::from_str(&self.bus.busctl(&call).unwrap()).unwrap();
        let properties = answer["data"][0].as_object().unwrap().iter();
        properties.map(|(name, variant)| (name.clone(), variant["data"].clone())).collect()
    }
}

impl Drop for Daemon {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
        if std::thread::panicking() {
            eprintln!("the daemon said:\n{}", self.said());
        }
    }
}
