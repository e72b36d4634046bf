//! Both ends of endpoints of all kinds.
#![allow(dead_code)]

use super::process::ATTITUDE;
use super::process::stalls::Rate;
use irhorizon::mavlink::deframe::Deframer;
use irhorizon::mavlink::encode::Encoder;
use irhorizon::mavlink::messages;
use mavlink::dialects::common::MavState;
use rustix::pty::{OpenptFlags, openpt, ptsname, unlockpt};
use std::fs::File;
use std::io::Read;
use std::net::{SocketAddr, TcpListener, TcpStream, UdpSocket};
use std::os::unix::fs::symlink;
use std::path::Path;
use std::time::Duration;

/// A daemon at 50 Hz on its simulated source with these endpoints; text may be added to the last.
pub fn config(bus: &str, addresses: &[String]) -> String {
    let endpoints: String = addresses.iter().map(|a| format!("[[mavlink.endpoint]]\naddress = \"{a}\"\n")).collect();
    format!("[daemon]\nrate-hz = 50\n[simulation]\nenabled = true\n[dbus]\nbus = \"{bus}\"\n{endpoints}")
}

/// A port that nobody has.
pub fn free_udp(host: &str) -> SocketAddr {
    UdpSocket::bind(format!("{host}:0")).unwrap().local_addr().unwrap()
}

/// A port that nobody has.
pub fn free_tcp(host: &str) -> SocketAddr {
    TcpListener::bind(format!("{host}:0")).unwrap().local_addr().unwrap()
}

/// Heartbeats of system 1, component 1, numbered from 0.
pub fn frames(count: usize) -> Vec<Vec<u8>> {
    let mut encoder = Encoder::new(1, 1);
    (0..count).map(|_| encoder.encode(&messages::heartbeat(MavState::MAV_STATE_ACTIVE)).to_vec()).collect()
}

/// Noise, forged lengths, damaged messages, empty datagrams.
pub fn hostile() -> Vec<Vec<u8>> {
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    let mut random = move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state
    };
    let mut damaged = frames(1).remove(0);
    damaged[12] ^= 0x10;
    (0..257)
        .map(|i| match i % 8 {
            0 => Vec::new(),
            1 => vec![0xfd, 0xff, 0x00],
            2 => damaged.clone(),
            3 => [&[0xfd, 0xff, 0, 0, 0, 1, 1, 0, 0, 0][..], &[0x55; 100]].concat(),
            _ => (0..8 + random() % 100).map(|_| random() as u8).collect(),
        })
        .collect()
}

/// A serial adapter that is plugged in at `path`: its far end.
pub fn plug(path: &Path) -> File {
    let far = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC).unwrap();
    unlockpt(&far).unwrap();
    let name = ptsname(&far, Vec::new()).unwrap().into_string().unwrap();
    let _ = std::fs::remove_file(path);
    symlink(name, path).unwrap();
    File::from(far)
}

/// Reads a stream whose reads end: how many ATTITUDE came with each.
fn attitudes(stream: &mut impl Read) -> impl FnMut() -> usize {
    let mut deframer = Deframer::default();
    let mut buffer = [0; 4096];
    move || {
        let mut count = 0;
        // A far end whose port nobody has open yet says EIO.
        match stream.read(&mut buffer) {
            Ok(bytes) => {
                deframer.take(&buffer[..bytes], |packet| count += usize::from(packet.id == u32::from(ATTITUDE)));
            }
            Err(_) => std::thread::sleep(Duration::from_millis(1)),
        }
        count
    }
}

/// Waits until ATTITUDE comes.
pub fn await_attitude(stream: &mut impl Read) {
    let mut next = attitudes(stream);
    while next() == 0 {}
}

/// ATTITUDE a second over TCP.
pub fn stream_rate(stream: &mut TcpStream, seconds: f64) -> Rate {
    stream.set_read_timeout(Some(Duration::from_secs(10))).unwrap();
    Rate::measure(seconds, attitudes(stream))
}

/// ATTITUDE a second over a serial line.
pub fn tty_rate(far: &mut File, seconds: f64) -> Rate {
    Rate::measure(seconds, attitudes(far))
}

/// The resident memory of a process.
pub fn resident_kb(pid: u32) -> u64 {
    let status = std::fs::read_to_string(format!("/proc/{pid}/status")).unwrap();
    let line = status.lines().find(|l| l.starts_with("VmRSS:")).unwrap();
    line.split_whitespace().nth(1).unwrap().parse().unwrap()
}
