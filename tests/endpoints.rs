//! Endpoints of all kinds at the daemon on its simulated source: each works, none hurts another.

#[path = "dbus_bus/mod.rs"]
mod dbus_bus;
mod process;
mod wire;

use dbus_bus::Bus;
use irhorizon::ctl::client::Client;
use irhorizon::ctl::view::Endpoint;
use process::stalls::{Rate, Watch};
use process::{ATTITUDE, Daemon, Folder, Receiver};
use std::net::{TcpListener, TcpStream, UdpSocket};
use std::process::Command;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use wire::{await_attitude, config, frames, free_tcp, free_udp, plug, stream_rate, tty_rate};

/// How long a rate is measured, s.
const WINDOW_S: f64 = 4.0;

/// Rates are measured in one test at a time: the others' floods and clients are no part of what is measured.
static ALONE: Mutex<()> = Mutex::new(());

fn alone() -> MutexGuard<'static, ()> {
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// 50 Hz, give or take 5 %.
fn assert_50_hz(what: &str, rate: Rate) {
    println!("{what}: {rate}");
    assert!(rate.is(47.5..=52.5), "{what}: {rate}");
}

/// The endpoints as `status` shows them.
fn shown(bus: &Bus) -> Vec<Endpoint> {
    Client::connect(&bus.choice()).unwrap().status().unwrap().endpoints
}

#[test]
fn every_kind_works_on_both_internets_at_once() {
    let _alone = alone();
    let folder = Folder::new();
    for host in ["127.0.0.1", "[::1]"] {
        let bus = Bus::new();
        let out = Receiver(UdpSocket::bind(format!("{host}:0")).unwrap());
        out.0.set_read_timeout(Some(Duration::from_secs(10))).unwrap();
        let server = TcpListener::bind(format!("{host}:0")).unwrap();
        let (udp_in, tcp_in) = (free_udp(host), free_tcp(host));
        let mut far = plug(&folder.path("tty"));
        let addresses = [
            format!("udpout:{}", out.0.local_addr().unwrap()),
            format!("udpin:{udp_in}"),
            format!("tcpout:{}", server.local_addr().unwrap()),
            format!("tcpin:{tcp_in}"),
            format!("serial:{}:115200", folder.path("tty").display()),
        ];
        let daemon = Daemon::start(&folder, &config(&bus.address(), &addresses));
        let (mut served, _) = server.accept().unwrap();
        out.wait(ATTITUDE);
        let caller = Receiver(UdpSocket::bind(format!("{host}:0")).unwrap());
        caller.0.set_read_timeout(Some(Duration::from_secs(10))).unwrap();
        caller.0.send_to(&frames(1)[0], udp_in).unwrap();
        let mut client = TcpStream::connect(tcp_in).unwrap();
        std::thread::scope(|scope| {
            scope.spawn(|| assert_50_hz("udpout", out.attitude_rate(WINDOW_S)));
            scope.spawn(|| assert_50_hz("udpin", caller.attitude_rate(WINDOW_S)));
            scope.spawn(|| assert_50_hz("tcpout", stream_rate(&mut served, WINDOW_S)));
            scope.spawn(|| assert_50_hz("tcpin", stream_rate(&mut client, WINDOW_S)));
            scope.spawn(|| assert_50_hz("serial", tty_rate(&mut far, WINDOW_S)));
        });
        let shown = shown(&bus);
        println!("{shown:#?}");
        for (endpoint, address) in shown.iter().zip(&addresses) {
            assert_eq!(&endpoint.address, address);
            assert!(endpoint.sent > 150 && endpoint.peers == 1 && endpoint.last_error.is_empty(), "{endpoint:?}");
        }
        assert_eq!((shown[1].received, shown[1].skipped_bytes), (1, 0));
        drop(daemon);
    }
}

#[test]
fn a_serial_port_put_back_is_regained_within_a_second() {
    let _alone = alone();
    let (folder, bus) = (Folder::new(), Bus::new());
    let path = folder.path("tty");
    let _daemon = Daemon::start(&folder, &config(&bus.address(), &[format!("serial:{}:57600", path.display())]));
    let mut took = Vec::new();
    for away_ms in [100, 2500, 1300] {
        std::thread::sleep(Duration::from_millis(away_ms));
        let mut far = plug(&path);
        let plugged = Watch::start();
        await_attitude(&mut far);
        took.push(plugged.stop());
        assert_50_hz("serial", tty_rate(&mut far, WINDOW_S));
        std::fs::remove_file(&path).unwrap();
    }
    println!("regained after {took:?}");
    assert!(took.iter().any(|t| t.within(Duration::from_secs(1))), "{took:?}");
    assert!(took.iter().all(|t| t.within(Duration::from_millis(1500))), "{took:?}");
}

#[test]
fn a_client_that_never_reads_and_what_cannot_be_had_cost_nobody() {
    let _alone = alone();
    let (folder, bus, receiver) = (Folder::new(), Bus::new(), Receiver::new());
    let at = free_tcp("127.0.0.1");
    let taken = UdpSocket::bind("127.0.0.1:0").unwrap();
    let addresses = [
        format!("tcpin:{at}"),
        "udpin:192.0.2.1:14550".to_owned(),
        "tcpin:192.0.2.1:5760".to_owned(),
        format!("udpin:{}", taken.local_addr().unwrap()),
        "serial:/nonexistent/tty:57600".to_owned(),
        format!("tcpout:{}", free_tcp("127.0.0.1")),
        format!("udpout:127.0.0.1:{}", receiver.port()),
    ];
    let _daemon = Daemon::start(&folder, &config(&bus.address(), &addresses));
    receiver.wait(ATTITUDE);
    let _never_reads: Vec<TcpStream> = (0..3).map(|_| TcpStream::connect(at).unwrap()).collect();
    let mut reads = TcpStream::connect(at).unwrap();
    std::thread::scope(|scope| {
        scope.spawn(|| assert_50_hz("beside them", receiver.attitude_rate(WINDOW_S)));
        scope.spawn(|| assert_50_hz("among them", stream_rate(&mut reads, WINDOW_S)));
    });
    let shown = shown(&bus);
    for (i, why) in [(1, "does not have that address"), (2, "does not have that address"), (3, "in use")] {
        assert!(shown[i].last_error.contains(why), "{:?}", shown[i]);
    }
    for (i, why) in [(4, "no such device"), (5, "nobody listens")] {
        assert!(shown[i].last_error.contains(why) && shown[i].failed > 100, "{:?}", shown[i]);
    }
    assert_eq!((shown[0].peers, shown[0].failed), (4, 0));
    // What could not be had is had as soon as it can be.
    let address = taken.local_addr().unwrap();
    drop(taken);
    let caller = Receiver::new();
    let begun = Instant::now();
    caller.0.set_read_timeout(Some(Duration::from_millis(100))).unwrap();
    while caller.next().is_none() {
        caller.0.send_to(b"hello", address).unwrap();
        assert!(begun.elapsed() < Duration::from_secs(5));
    }
    println!("had after {:?}", begun.elapsed());
}

#[test]
fn a_server_that_comes_and_goes_is_regained() {
    let _alone = alone();
    let (folder, bus, receiver) = (Folder::new(), Bus::new(), Receiver::new());
    let at = free_tcp("127.0.0.1");
    let addresses = [format!("tcpout:{at}"), format!("udpout:127.0.0.1:{}", receiver.port())];
    let _daemon = Daemon::start(&folder, &config(&bus.address(), &addresses));
    receiver.wait(ATTITUDE);
    for _ in 0..2 {
        let server = TcpListener::bind(at).unwrap();
        let up = Watch::start();
        let (mut stream, _) = server.accept().unwrap();
        let regained = up.stop();
        println!("regained after {regained:?}");
        assert!(regained.within(Duration::from_secs(3)), "{regained:?}");
        assert_50_hz("tcpout", stream_rate(&mut stream, WINDOW_S));
        drop((server, stream));
        assert_50_hz("beside it", receiver.attitude_rate(WINDOW_S));
    }
}

/// Sends batches of `datagrams` to `to`, `per_s` a second if it can, until `done`; counts them.
fn flood(to: std::net::SocketAddr, datagrams: &[Vec<u8>], per_s: u32, count: &AtomicU64, done: &AtomicBool) {
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    let begun = Instant::now();
    while !done.load(Ordering::Relaxed) {
        let due = u64::from(per_s) * begun.elapsed().as_millis() as u64 / 1000;
        // What was missed on a busy machine is not made up for at once.
        let now = count.load(Ordering::Relaxed);
        for i in now..due.min(now + 100) {
            if socket.send_to(&datagrams[i as usize % datagrams.len()], to).is_ok() {
                count.fetch_add(1, Ordering::Relaxed);
            }
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}

#[test]
fn a_flood_at_one_endpoint_is_not_felt_at_another() {
    let _alone = alone();
    let (folder, bus, receiver) = (Folder::new(), Bus::new(), Receiver::new());
    let at = free_udp("127.0.0.1");
    let addresses = [format!("udpin:{at}"), format!("udpout:127.0.0.1:{}", receiver.port())];
    let daemon = Daemon::start(&folder, &config(&bus.address(), &addresses));
    receiver.wait(ATTITUDE);
    std::thread::sleep(Duration::from_secs(2));
    let resident = || wire::resident_kb(daemon.pid());
    let (valid, hostile) = (frames(256), wire::hostile());
    let (good, bad, done) = (AtomicU64::new(0), AtomicU64::new(0), AtomicBool::new(false));
    std::thread::scope(|scope| {
        scope.spawn(|| flood(at, &valid, 20_000, &good, &done));
        scope.spawn(|| flood(at, &hostile, 20_000, &bad, &done));
        std::thread::sleep(Duration::from_secs(1));
        let (before, sent) = (resident(), good.load(Ordering::Relaxed) + bad.load(Ordering::Relaxed));
        let begun = Instant::now();
        let rate = receiver.attitude_rate(WINDOW_S);
        let reached = good.load(Ordering::Relaxed) + bad.load(Ordering::Relaxed) - sent;
        let grown = resident().saturating_sub(before);
        done.store(true, Ordering::Relaxed);
        println!(
            "{:.0} a second in the flood, {grown} kB more resident",
            reached as f64 / begun.elapsed().as_secs_f64()
        );
        assert_50_hz("beside the flood", rate);
        assert!(grown < 2048, "{grown} kB");
    });
    let shown = shown(&bus);
    println!("{:?} of {} good and {} bad", shown[0], good.load(Ordering::Relaxed), bad.load(Ordering::Relaxed));
    assert!(shown[0].received > 10_000 && shown[0].skipped_bytes > 100_000);
}

#[test]
fn a_tlog_is_what_pymavlink_reads() {
    let (folder, receiver) = (Folder::new(), Receiver::new());
    let (at, tlog) = (free_udp("127.0.0.1"), folder.path("flight.tlog"));
    let addresses = [format!("udpout:127.0.0.1:{}", receiver.port()), format!("udpin:{at}")];
    let text = config("none", &addresses);
    let mut daemon = Daemon::start(&folder, &format!("{text}tlog = \"{}\"\n", tlog.display()));
    receiver.wait(ATTITUDE);
    let caller = Receiver::new();
    for frame in frames(10) {
        caller.0.send_to(&frame, at).unwrap();
        std::thread::sleep(Duration::from_millis(100));
    }
    daemon.signal(rustix::process::Signal::TERM);
    assert!(daemon.ended().success(), "{}", daemon.said());
    let sent = std::iter::from_fn(|| caller.next()).take_while(|(id, p)| *id != 0 || p[7] != 7).count();
    let clients = std::path::PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/clients");
    let setup = Command::new(clients.join("setup")).output().unwrap();
    assert!(setup.status.success(), "{}", String::from_utf8_lossy(&setup.stderr));
    let python = String::from_utf8(setup.stdout).unwrap().trim().to_owned();
    let read = Command::new(python).arg(clients.join("tlog.py")).arg(&tlog).output().unwrap();
    assert!(read.status.success(), "{}", String::from_utf8_lossy(&read.stderr));
    let report: serde_json::Value = serde_json::from_slice(&read.stdout).unwrap();
    println!("{report}, {sent} sent before the farewell");
    assert_eq!(report["bad"], 0);
    // Component 1 is the caller, 191 the daemon; its farewell is in the tlog too.
    assert_eq!(report["from"]["1"]["HEARTBEAT"], 10);
    let own: u64 = report["from"]["191"].as_object().unwrap().values().map(|n| n.as_u64().unwrap()).sum();
    assert_eq!(own, sent as u64 + 1);
    assert!(report["span_s"].as_f64().unwrap() > 0.8 && report["age_s"].as_f64().unwrap() < 60.0);
}
