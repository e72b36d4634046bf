//! The daemon as a process: its folder, what it says, how it ends.
#![allow(dead_code)]

#[path = "../stalls/mod.rs"]
pub mod stalls;

use rustix::process::{Pid, Signal, kill_process};
use stalls::Rate;
use std::fs;
use std::net::UdpSocket;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

pub const DAEMON: &str = env!("CARGO_BIN_EXE_irhorizond");
pub const CTL: &str = env!("CARGO_BIN_EXE_irhorizonctl");

/// A folder that goes away with the test.
pub struct Folder(pub PathBuf);

impl Folder {
    pub fn new() -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let name = format!("irhorizon-{}-{}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
        let path = std::env::temp_dir().join(name);
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    pub fn write(&self, name: &str, text: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path(name);
        fs::write(&path, text).unwrap();
        path
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// A daemon at work.
pub struct Daemon {
    child: Child,
    log: PathBuf,
}

impl Daemon {
    /// With the configuration `text` in `folder`.
    pub fn start(folder: &Folder, text: &str) -> Self {
        let config = folder.write("irhorizon.toml", text);
        let mut command = Command::new(DAEMON);
        command.arg("--config").arg(config);
        Self::spawn(command, folder.path("log"))
    }

    pub fn spawn(command: Command, log: PathBuf) -> Self {
        Self::spawn_into(command, fs::File::create(&log).unwrap().into(), log)
    }

    /// One that speaks into `stderr`.
    pub fn spawn_into(mut command: Command, stderr: Stdio, log: PathBuf) -> Self {
        let child = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(stderr).spawn().unwrap();
        Self { child, log }
    }

    pub fn pid(&self) -> u32 {
        self.child.id()
    }

    /// All that it has said.
    pub fn said(&self) -> String {
        String::from_utf8_lossy(&fs::read(&self.log).unwrap()).into_owned()
    }

    /// Waits until it has said `text`.
    pub fn says(&self, text: &str) -> Duration {
        let start = Instant::now();
        while !self.said().contains(text) {
            assert!(start.elapsed() < Duration::from_secs(20), "never said {text:?}, but:\n{}", self.said());
            std::thread::sleep(Duration::from_millis(2));
        }
        start.elapsed()
    }

    pub fn signal(&self, signal: Signal) {
        let pid = Pid::from_raw(i32::try_from(self.pid()).unwrap()).unwrap();
        kill_process(pid, signal).unwrap();
    }

    pub fn is_running(&mut self) -> bool {
        self.child.try_wait().unwrap().is_none()
    }

    /// How it ended, once it has.
    pub fn ended(&mut self) -> ExitStatus {
        let start = Instant::now();
        loop {
            if let Some(status) = self.child.try_wait().unwrap() {
                return status;
            }
            assert!(start.elapsed() < Duration::from_secs(20), "it goes on:\n{}", self.said());
            std::thread::sleep(Duration::from_millis(1));
        }
    }
}

impl Drop for Daemon {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

pub const HEARTBEAT: u8 = 0;
pub const ATTITUDE: u8 = 30;

/// What listens to MAVLink.
pub struct Receiver(pub UdpSocket);

impl Receiver {
    pub fn new() -> Self {
        let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
        socket.set_read_timeout(Some(Duration::from_secs(10))).unwrap();
        Self(socket)
    }

    pub fn port(&self) -> u16 {
        self.0.local_addr().unwrap().port()
    }

    /// The next message: its number and payload; `None` when none comes within 10 s.
    pub fn next(&self) -> Option<(u8, Vec<u8>)> {
        let mut buffer = [0; 512];
        let length = self.0.recv(&mut buffer).ok()?;
        assert_eq!((buffer[0], usize::from(buffer[1]) + 12), (0xfd, length), "one MAVLink 2 frame a datagram");
        Some((buffer[7], buffer[10..length - 2].to_vec()))
    }

    /// The next message of this number.
    pub fn wait(&self, id: u8) -> Vec<u8> {
        loop {
            let (got, payload) = self.next().expect("a message within 10 s");
            if got == id {
                return payload;
            }
        }
    }

    /// Forgets what has come so far.
    pub fn forget(&self) {
        self.0.set_nonblocking(true).unwrap();
        while self.next().is_some() {}
        self.0.set_nonblocking(false).unwrap();
    }

    /// ATTITUDE messages a second, counted for so many seconds; what came before is not counted.
    pub fn attitude_rate(&self, seconds: f64) -> Rate {
        self.forget();
        Rate::measure(seconds, || usize::from(self.next().expect("a message within 10 s").0 == ATTITUDE))
    }
}

/// The command for a binary that runs without root's rights, from a folder that all may enter.
pub fn without_rights(binary: &str, folder: &Folder) -> Command {
    use std::os::unix::fs::PermissionsExt;
    if !rustix::process::geteuid().is_root() {
        return Command::new(binary);
    }
    fs::set_permissions(&folder.0, fs::Permissions::from_mode(0o755)).unwrap();
    let copy = folder.path(Path::new(binary).file_name().unwrap().to_str().unwrap());
    fs::copy(binary, &copy).unwrap();
    let mut command = Command::new("setpriv");
    command.args(["--reuid=65534", "--regid=65534", "--clear-groups", "--"]).arg(copy);
    command
}
