//! An address to listen at, and a network to send to, that the machine gets only after the daemon's start, loses and
//! gets back. In a network namespace of its own, where the test itself gives addresses; without the right to make one
//! there is no test.

#[path = "dbus_bus/mod.rs"]
mod dbus_bus;
mod process;
mod wire;

use dbus_bus::Bus;
use irhorizon::ctl::client::Client;
use process::{ATTITUDE, Daemon, Folder, Receiver};
use std::net::{SocketAddr, TcpStream, UdpSocket};
use std::process::Command;
use std::time::{Duration, Instant};
use wire::{await_attitude, config, frames};

/// Set where this program runs itself in the namespace.
const INSIDE: &str = "IRHORIZON_TEST_INSIDE";
/// Addresses of documentation, RFC 5737 and 3849: of no machine, so of this one alone when it has them.
const HERE: [&str; 2] = ["192.0.2.1", "2001:db8::1"];
const THERE: &str = "198.51.100.1";

fn ip(words: &[&str]) {
    let output = Command::new("ip").args(words).output().expect("ip, of iproute2");
    assert!(output.status.success(), "ip {words:?}: {}", String::from_utf8_lossy(&output.stderr));
}

/// Gives this machine an address, or takes it away.
fn address(what: &str, host: &str) {
    match (what, host.contains(':')) {
        (_, false) => ip(&["address", what, &format!("{host}/32"), "dev", "lo"]),
        // Without the second in which it might be somebody else's.
        ("add", true) => ip(&["-6", "address", what, &format!("{host}/128"), "dev", "lo", "nodad"]),
        (_, true) => ip(&["-6", "address", what, &format!("{host}/128"), "dev", "lo"]),
    }
}

fn at(host: &str, port: u16) -> SocketAddr {
    SocketAddr::new(host.parse().unwrap(), port)
}

/// Calls until it gives something.
fn until<T>(what: &str, mut call: impl FnMut() -> Option<T>) -> T {
    let begun = Instant::now();
    loop {
        if let Some(got) = call() {
            println!("{what} after {:.2?}", begun.elapsed());
            return got;
        }
        assert!(begun.elapsed() < Duration::from_secs(20), "{what}: never");
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// A caller that talks to a `udpin` endpoint until it is answered.
fn udp_attitude(to: SocketAddr) {
    let caller = Receiver(UdpSocket::bind(at(&to.ip().to_string(), 0)).unwrap());
    caller.0.set_read_timeout(Some(Duration::from_millis(50))).unwrap();
    until(&format!("attitude of udpin:{to}"), || {
        let _ = caller.0.send_to(&frames(1)[0], to);
        caller.next().filter(|(id, _)| *id == ATTITUDE)
    });
}

fn tcp_attitude(to: SocketAddr) {
    let mut stream = until(&format!("a connection to tcpin:{to}"), || TcpStream::connect(to).ok());
    stream.set_read_timeout(Some(Duration::from_secs(10))).unwrap();
    // It goes on.
    (0..2).for_each(|_| await_attitude(&mut stream));
}

/// A receiver at `to` that a `udpout` endpoint sends to.
fn udp_out_attitude(to: SocketAddr) -> Receiver {
    let there = Receiver(UdpSocket::bind(to).unwrap());
    there.0.set_read_timeout(Some(Duration::from_millis(50))).unwrap();
    until(&format!("attitude of udpout:{to}"), || there.next().filter(|(id, _)| *id == ATTITUDE));
    there
}

#[test]
fn an_address_that_comes_later_is_taken_and_one_that_comes_back_too() {
    if std::env::var_os(INSIDE).is_none() {
        return inside("an_address_that_comes_later_is_taken_and_one_that_comes_back_too");
    }
    ip(&["link", "set", "lo", "up"]);
    let (folder, bus, receiver) = (Folder::new(), Bus::new(), Receiver::new());
    let udp_in = HERE.map(|host| at(host, 14550));
    let tcp_in = HERE.map(|host| at(host, 5760));
    let udp_out = at(THERE, 14551);
    let mut addresses: Vec<String> = udp_in.iter().map(|a| format!("udpin:{a}")).collect();
    addresses.extend(tcp_in.iter().map(|a| format!("tcpin:{a}")));
    addresses.push(format!("udpout:{udp_out}"));
    addresses.push(format!("udpout:127.0.0.1:{}", receiver.port()));
    let _daemon = Daemon::start(&folder, &config(&bus.address(), &addresses));
    receiver.wait(ATTITUDE);
    let errors = || -> Vec<String> {
        let status = Client::connect(&bus.choice()).unwrap().status().unwrap();
        status.endpoints.into_iter().map(|e| e.last_error).collect()
    };
    let said = until("what is missing", || Some(errors()).filter(|e| e.iter().filter(|e| !e.is_empty()).count() == 5));
    println!("{said:#?}");
    assert!(said[..4].iter().all(|e| e.contains("does not have that address")), "{said:?}");
    assert!(said[4].contains("no way to that network"), "{said:?}");

    for round in ["at first", "again"] {
        println!("{round}:");
        HERE.iter().chain([&THERE]).for_each(|host| address("add", host));
        for i in [0, 1] {
            udp_attitude(udp_in[i]);
            tcp_attitude(tcp_in[i]);
        }
        let _there = udp_out_attitude(udp_out);
        until("all is well", || Some(errors()).filter(|e| e.iter().all(String::is_empty)));
        HERE.iter().chain([&THERE]).for_each(|host| address("del", host));
        // The others do not mind.
        receiver.forget();
        (0..10).for_each(|_| drop(receiver.wait(ATTITUDE)));
    }
}

/// Runs the test `name` once more in a network namespace.
fn inside(name: &str) {
    let new = |program: &std::ffi::OsStr, words: &[&str]| {
        let mut command = Command::new("unshare");
        command.args(["--map-root-user", "--net", "--"]).arg(program).args(words);
        command.env(INSIDE, "1").output()
    };
    let can = new("ip".as_ref(), &["link", "set", "lo", "up"]);
    if !can.as_ref().is_ok_and(|output| output.status.success()) {
        eprintln!("SKIPPED: no network namespace can be made here: {can:?}");
        return;
    }
    let program = std::env::current_exe().unwrap();
    let output = new(program.as_os_str(), &["--exact", name, "--nocapture"]).unwrap();
    let [out, err] = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes));
    println!("{out}");
    assert!(output.status.success() && out.contains("1 passed"), "{out}{err}");
}
