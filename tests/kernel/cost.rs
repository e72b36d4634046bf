//! What a scan costs: the daemon's own way from six words to a datagram against the least that a C
//! program could do, `scan.c`, in turn in one run. `tests/kernel/cost` runs it in a machine whose time
//! counts instructions: the figures are thousands of them, and the same each time.
//!
//! Counted is all that the processor does for the thread, in the kernel and out of it: reading,
//! estimating, faults, the shared state, MAVLink encoding and sending, and every fifth scan a look for
//! what has arrived. Not counted is what comes with the clock, not with the scan: waiting for the next
//! one, the quiet before each read, the publisher's thread waking up. The whole daemon's share of the
//! machine, with all of that and D-Bus, is told beside it.
#![allow(dead_code)]

mod adapter;
#[path = "../dbus_bus/mod.rs"]
mod dbus_bus;
mod rig;

use adapter::Adapter;
use irhorizon::clock;
use irhorizon::config::settings::Streams;
use irhorizon::config::{self, settings::Method};
use irhorizon::daemon::sampling::Sampling;
use irhorizon::daemon::source;
use irhorizon::horizon::Horizon;
use irhorizon::mavlink::encode::Encoder;
use irhorizon::mavlink::endpoint::Endpoint;
use irhorizon::mavlink::session::{Seen, Session};
use irhorizon::recording::Taps;
use irhorizon::state::Shared;
use rig::{Daemon, Folder};
use rustix::time::{ClockId, clock_gettime};
use std::fs;
use std::net::UdpSocket;
use std::path::Path;
use std::process::Command;
use std::sync::Arc;
use std::time::{Duration, Instant};

const SCANS: u64 = 4_000;
const ROUNDS: usize = 3;
/// The daemon may cost this much more than C.
const AT_MOST: f64 = 1.5;

fn thread_cpu_ns() -> f64 {
    let t = clock_gettime(ClockId::ThreadCPUTime);
    t.tv_sec as f64 * 1e9 + t.tv_nsec as f64
}

fn text(bus: &str, port: u16, quiet_ms: f64) -> String {
    let sensors: String = ["nose", "tail", "left", "right", "up", "down"]
        .iter()
        .zip(0x5b..)
        .map(|(name, address)| {
            format!("[[sensor]]\nname = \"{name}\"\nkind = \"mlx90614\"\nbus = \"{bus}\"\naddress = {address:#04x}\n")
        })
        .collect();
    let endpoint = format!("[[mavlink.endpoint]]\naddress = \"udpout:127.0.0.1:{port}\"\n");
    format!("[daemon]\nquiet-ms = {quiet_ms:.1}\n{endpoint}{sensors}")
}

/// The daemon's own parts in one thread.
struct Ours {
    sampling: Sampling,
    shared: Arc<Shared>,
    seen: Seen,
    session: Session,
    encoder: Encoder,
    endpoint: Endpoint,
    head: irhorizon::head::Head,
    scans: u64,
}

impl Ours {
    fn new(bus: &str, port: u16) -> Self {
        let mut settings = config::parse(&[("irhorizon.toml".into(), text(bus, port, 0.0))]).unwrap().settings;
        // The scan is what is compared; what each method costs is for `benches/instructions` to say.
        settings.estimator.method = Some(Method::InverseSine);
        let head = settings.head();
        let shared = Arc::new(Shared::default());
        let source = source::open(&settings, &head).unwrap();
        let horizon = Horizon::new(&settings, head.clone());
        let taps = Arc::new(Taps::default());
        let sampling = Sampling::new(head.clone(), source, horizon, Arc::clone(&shared), taps, None);
        let session = Session::new(clock::now(), 0, &Streams::default());
        let endpoint = Endpoint::new(settings.mavlink.endpoints[0].address.clone());
        Self {
            sampling,
            shared,
            seen: Seen::default(),
            session,
            encoder: Encoder::new(1, 191),
            endpoint,
            head,
            scans: 0,
        }
    }

    fn scan(&mut self) {
        self.sampling.step(clock::now());
        self.seen.copy(&self.shared.lock());
        let now = clock::now();
        let Self { session, seen, head, endpoint, encoder, .. } = self;
        let listening = endpoint.listening();
        session.step(now, seen, head, listening, |message| endpoint.send(now, encoder.encode(message)));
        // The publisher does this every 100 ms.
        self.scans += 1;
        if self.scans.is_multiple_of(5) {
            endpoint.tend(now);
        }
    }

    fn reads(&self) -> u64 {
        self.shared.lock().health.iter().map(|h| h.counters.reads).sum()
    }

    /// Processor time of a scan, ns, and the datagrams sent in [`SCANS`].
    fn round(&mut self) -> (f64, u64) {
        let (reads, sent) = (self.reads(), self.endpoint.stats().view().sent);
        let begun = thread_cpu_ns();
        for _ in 0..SCANS {
            self.scan();
        }
        let took = (thread_cpu_ns() - begun) / SCANS as f64;
        assert_eq!(self.reads() - reads, 6 * SCANS, "six words in each scan");
        assert_eq!(self.shared.lock().estimate.mode.as_str(), "nominal");
        (took, self.endpoint.stats().view().sent - sent)
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn main() {
    let bus = Adapter::stub(&[0x5b, 0x5c, 0x5d, 0x5e, 0x5f, 0x60]);
    for (address, object_c) in [(0x5b, 3.0), (0x5c, 3.0), (0x5d, 3.0), (0x5e, 3.0), (0x5f, -20.0), (0x60, 20.0)] {
        let mut chip = bus.chip(address);
        let word = |c: f64| ((c + 273.15) * 50.0) as u16;
        for (register, value) in [(0x06, word(25.0)), (0x07, word(object_c)), (0x24, 0xffff), (0x25, 0x9fb4)] {
            chip.write(register, value);
        }
    }
    // Nobody reads what is sent: the system drops it, from both alike.
    let receiver = UdpSocket::bind("127.0.0.1:0").unwrap();
    let port = receiver.local_addr().unwrap().port();

    let folder = Folder::new();
    let scan = folder.path("scan");
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/kernel/scan.c");
    let output = Command::new("cc").args(["-O2", "-Wall", "-Werror", "-o"]).arg(&scan).arg(source).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let c = || {
        let output = Command::new(&scan).args([&bus.path, &port.to_string(), &SCANS.to_string()]).output().unwrap();
        assert!(output.status.success(), "{output:?}");
        let text = String::from_utf8(output.stdout).unwrap();
        let (took, sent) = text.trim().split_once(' ').unwrap();
        assert_eq!(sent.parse(), Ok(SCANS));
        took.parse::<f64>().unwrap()
    };

    let mut ours = Ours::new(&bus.path, port);
    for _ in 0..500 {
        ours.scan();
    }
    let (mut rust_ns, mut c_ns, mut sent) = (Vec::new(), Vec::new(), 0);
    for _ in 0..ROUNDS {
        c_ns.push(c());
        let (took, datagrams) = ours.round();
        rust_ns.push(took);
        sent += datagrams;
    }
    drop(ours);
    let datagrams = sent as f64 / (SCANS as usize * ROUNDS) as f64;
    assert!((1.0..1.1).contains(&datagrams), "{datagrams} datagrams a scan");
    println!("C    {c_ns:.0?} a scan: 6 words, 1 datagram");
    println!("Rust {rust_ns:.0?} a scan: 6 words, {datagrams:.3} datagrams");
    let ratio = median(rust_ns) / median(c_ns);
    println!("{ratio:.3} times what it costs in C, at most {AT_MOST} allowed");

    let daemon = Daemon::start(&text(&bus.path, port, 1.0));
    let begun = (Instant::now(), ran_s(daemon.pid()));
    std::thread::sleep(Duration::from_secs(20));
    let share = (ran_s(daemon.pid()) - begun.1) / begun.0.elapsed().as_secs_f64();
    let per_scan = share * 1e9 / 50.0;
    println!(
        "the whole daemon at 50 Hz, with D-Bus and 1 ms quiet: {per_scan:.0} a scan, {:.2} % of the time",
        100.0 * share
    );
    assert!(ratio <= AT_MOST, "{ratio:.3} times");
}

/// How long a process's threads have run, s.
fn ran_s(pid: u32) -> f64 {
    let threads = fs::read_dir(format!("/proc/{pid}/task")).unwrap();
    let ran = threads.map(|t| fs::read_to_string(t.unwrap().path().join("schedstat")).unwrap());
    ran.map(|text| text.split_whitespace().next().unwrap().parse::<f64>().unwrap()).sum::<f64>() / 1e9
}
