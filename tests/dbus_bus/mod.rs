//! A message bus of the test's own, and the service on it with a state that the test writes.
#![allow(dead_code)]

use irhorizon::attitude::Attitude;
use irhorizon::config::settings::BusAddress;
use irhorizon::ctl::client::{Client, ClientError};
use irhorizon::ctl::view::{Endpoint, Status};
use irhorizon::dbus::{Control, DbusError, SensorInfo, Service, ServiceInfo, run};
use irhorizon::direction::Direction;
use irhorizon::head::{Head, Sensor, SensorKind};
use irhorizon::recording::Taps;
use irhorizon::state::{Shared, Snapshot};
use irhorizon::{clock, frame};
use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, sync_channel};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// A dbus-daemon with its socket in a folder of its own.
pub struct Bus {
    pub dir: PathBuf,
    config: Vec<String>,
    child: Option<Child>,
}

impl Bus {
    pub fn new() -> Self {
        let mut bus = Self::absent();
        bus.start();
        bus
    }

    /// A place for a bus that is not there yet.
    pub fn absent() -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let name = format!("irhorizon-dbus-{}-{}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
        let dir = std::env::temp_dir().join(name);
        std::fs::create_dir_all(&dir).unwrap();
        Self { dir, config: vec!["--session".into()], child: None }
    }

    /// With a configuration of its own in place of the session bus's.
    pub fn configured(config: impl FnOnce(&str) -> String) -> Self {
        let mut bus = Self::absent();
        let file = bus.dir.join("bus.conf");
        std::fs::write(&file, config(&bus.address())).unwrap();
        bus.config = vec![format!("--config-file={}", file.display())];
        bus.start();
        bus
    }

    pub fn start(&mut self) {
        let _ = std::fs::remove_file(self.dir.join("socket"));
        let mut child = Command::new("dbus-daemon")
            .args(&self.config)
            .args(["--nofork", "--nopidfile", "--nosyslog", "--print-address=1"])
            .arg(format!("--address={}", self.address()))
            .stdout(Stdio::piped())
            .stderr(std::fs::File::create(self.dir.join("log")).unwrap())
            .spawn()
            .expect("dbus-daemon starts: apt-get install dbus-daemon (Debian) or dbus (elsewhere)");
        let mut line = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
        assert!(line.starts_with("unix:"), "dbus-daemon did not start: {line:?}");
        self.child = Some(child);
    }

    /// Sends the bus a signal: STOP lets it hang, CONT lets it go on.
    pub fn signal(&self, name: &str) {
        let pid = self.child.as_ref().unwrap().id().to_string();
        assert!(Command::new("kill").args([&format!("-{name}"), &pid]).status().unwrap().success());
    }

    pub fn kill(&mut self) {
        if let Some(mut child) = self.child.take() {
            child.kill().unwrap();
            child.wait().unwrap();
        }
    }

    pub fn address(&self) -> String {
        format!("unix:path={}", self.dir.join("socket").display())
    }

    pub fn choice(&self) -> BusAddress {
        BusAddress::Address(self.address())
    }

    pub fn client(&self) -> Client {
        Client::connect(&self.choice()).unwrap()
    }

    /// A status as soon as the service gives one.
    pub fn status(&self, within: Duration) -> Result<Status, ClientError> {
        let start = Instant::now();
        loop {
            let outcome = Client::connect(&self.choice()).and_then(|mut c| c.status());
            if outcome.is_ok() || start.elapsed() > within {
                return outcome;
            }
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    pub fn busctl_command(&self) -> Command {
        let mut command = Command::new("busctl");
        command.arg(format!("--address={}", self.address()));
        command
    }

    /// What busctl prints; its complaint when it fails.
    pub fn busctl(&self, args: &[&str]) -> Result<String, String> {
        let output = self.busctl_command().args(args).output().expect("busctl runs: apt-get install systemd");
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).trim_end().to_owned();
        if output.status.success() { Ok(text(&output.stdout)) } else { Err(text(&output.stderr)) }
    }

    /// A property of the horizon as busctl prints it.
    pub fn property(&self, name: &str) -> String {
        self.busctl(&["get-property", "org.irhorizon1", "/org/irhorizon1", "org.irhorizon1.Horizon", name]).unwrap()
    }

    /// PropertiesChanged of the horizon from now on.
    pub fn monitor(&self) -> Monitor {
        let rule = "type='signal',member='PropertiesChanged',path='/org/irhorizon1'";
        let mut child = self
            .busctl_command()
            .args(["monitor", "--json=short", &format!("--match={rule}")])
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("busctl runs: apt-get install systemd");
        // It says so on standard error once it listens.
        let mut line = String::new();
        BufReader::new(child.stderr.take().unwrap()).read_line(&mut line).unwrap();
        Monitor { child }
    }
}

impl Drop for Bus {
    fn drop(&mut self) {
        self.kill();
        let _ = std::fs::remove_dir_all(&self.dir);
    }
}

pub struct Monitor {
    child: Child,
}

impl Monitor {
    /// The changed properties of every signal seen.
    pub fn stop(mut self) -> Vec<serde_json::Map<String, serde_json::Value>> {
        std::thread::sleep(Duration::from_millis(300));
        self.child.kill().unwrap();
        let lines = BufReader::new(self.child.stdout.take().unwrap()).lines();
        let signals = lines.map(|l| serde_json::from_str::<serde_json::Value>(&l.unwrap()).unwrap());
        let changed = signals.map(|s| {
            assert_eq!(s["payload"]["data"][0], "org.irhorizon1.Horizon");
            s["payload"]["data"][1].as_object().unwrap().clone()
        });
        let changed = changed.collect();
        self.child.wait().unwrap();
        changed
    }
}

/// The daemon as the service sees it, made up.
pub struct Fake {
    pub info: Mutex<Arc<ServiceInfo>>,
    pub reload: Mutex<Result<(), String>>,
    asked: AtomicU32,
}

impl Control for Fake {
    fn info(&self) -> Arc<ServiceInfo> {
        self.asked.fetch_add(1, Ordering::SeqCst);
        self.info.lock().unwrap().clone()
    }

    fn endpoints(&self) -> Vec<Endpoint> {
        let address = "udpout:127.0.0.1:14550".to_owned();
        let last_error = "connection refused".to_owned();
        vec![Endpoint { address, sent: 42, failed: 1, received: 7, peers: 1, last_error, ..Endpoint::default() }]
    }

    fn reload(&self) -> Receiver<Result<(), String>> {
        let (sender, receiver) = sync_channel(1);
        sender.send(self.reload.lock().unwrap().clone()).unwrap();
        receiver
    }
}

/// A head of three: nose, an ADC pair, and a sensor that does not answer.
pub fn info() -> ServiceInfo {
    let sensor = |name: &str, direction, kind| Sensor { name: name.into(), direction, kind, bus: Some(0) };
    let sensors = vec![
        sensor("nose", Direction::NOSE, SensorKind::ABSOLUTE),
        sensor("long", Direction::TAIL, SensorKind::Pair { neutral_v: 0.0, kelvin_per_v: 40.0 }),
        sensor("down", Direction::DOWN, SensorKind::ABSOLUTE),
    ];
    let info = |name: &str, kind, address| SensorInfo {
        name: name.into(),
        kind,
        bus: "/dev/i2c-1".into(),
        address,
        direction: name.into(),
    };
    ServiceInfo {
        head: Head::new(sensors, vec!["/dev/i2c-1".into()]),
        sensors: vec![info("nose", "mlx90614", 0x5b), info("long", "ads1115", 0x48), info("down", "mlx90614", 0x5a)],
        method: "inverse-sine",
        trim: Attitude::from_degrees(0.5, -2.0),
        update: Duration::from_millis(100),
        overdue: Duration::from_secs(1),
    }
}

/// The service on `bus`, its state, and what came of its first attempt.
pub struct Daemon {
    pub shared: Arc<Shared>,
    pub taps: Arc<Taps>,
    pub control: Arc<Fake>,
    pub first: Option<Result<(), DbusError>>,
    thread: Option<JoinHandle<()>>,
}

impl Daemon {
    pub fn start(bus: &Bus) -> Self {
        Self::telling(bus, info())
    }

    /// Has changes signalled once in `period`, from the first on.
    pub fn signalling_every(bus: &Bus, period: Duration) -> Self {
        Self::telling(bus, ServiceInfo { update: period, ..info() })
    }

    /// One that has not waited for the first outcome.
    pub fn impatient(bus: &Bus) -> Self {
        Self::waiting(bus, info(), Duration::ZERO)
    }

    fn telling(bus: &Bus, info: ServiceInfo) -> Self {
        Self::waiting(bus, info, Duration::from_secs(6))
    }

    fn waiting(bus: &Bus, info: ServiceInfo, patience: Duration) -> Self {
        let shared = Arc::new(Shared::default());
        let taps = Arc::new(Taps::new("time_s,nose_obj_c\n"));
        let (info, reload) = (Mutex::new(Arc::new(info)), Mutex::new(Ok(())));
        let control = Arc::new(Fake { info, reload, asked: AtomicU32::new(0) });
        let service =
            Service { bus: bus.choice(), shared: shared.clone(), taps: taps.clone(), control: control.clone() };
        let (sender, first) = sync_channel(1);
        let thread = std::thread::Builder::new().name("dbus".into()).spawn(move || run(&service, sender)).unwrap();
        let first = first.recv_timeout(patience).ok();
        Self { shared, taps, control, first, thread: Some(thread) }
    }

    /// The next frame, written now; waits until the service has seen it.
    pub fn frame(&self, change: impl FnOnce(&mut Snapshot)) {
        let asked = self.control.asked.load(Ordering::SeqCst);
        self.shared.update(|s| {
            s.sequence += 1;
            // Has the service ask for the information again once it has taken this frame in.
            s.generation += 1;
            s.written = clock::now();
            s.head = Arc::new(info().head);
            s.frame.readings.resize(3, Err(frame::Missing::NotYet));
            s.health.resize(3, Default::default());
            change(s);
        });
        let start = Instant::now();
        while self.control.asked.load(Ordering::SeqCst) == asked && start.elapsed() < Duration::from_secs(3) {
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    /// How long the thread took to end.
    pub fn stop(&mut self) -> Duration {
        let start = Instant::now();
        self.shared.update(|s| s.stopping = true);
        if let Some(thread) = self.thread.take() {
            thread.join().unwrap();
        }
        start.elapsed()
    }
}

impl Drop for Daemon {
    fn drop(&mut self) {
        self.stop();
    }
}
