//! What a ground station hears: heartbeats and texts, taken apart by the MAVLink library.

use crate::rig::wait_for;
use mavlink::MavlinkVersion;
use mavlink::dialects::common::MavMessage;
use std::net::UdpSocket;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// MAV_STATE of a heartbeat: attitude goes out; it is withheld.
pub const ACTIVE: u8 = 4;
pub const CRITICAL: u8 = 5;
/// MAV_SEVERITY of a text.
pub const SEVERITY_CRITICAL: u8 = 2;
pub const SEVERITY_ERROR: u8 = 3;
pub const SEVERITY_NOTICE: u8 = 5;

/// What was heard, with when.
#[derive(Clone, Debug, Default)]
struct Heard {
    states: Vec<(Instant, u8)>,
    texts: Vec<(u8, String)>,
    attitudes: Vec<Instant>,
}

/// A socket of this machine with someone who listens.
pub struct Radio {
    port: u16,
    heard: Arc<Mutex<Heard>>,
    over: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Radio {
    pub fn new() -> Self {
        let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
        socket.set_read_timeout(Some(Duration::from_millis(100))).unwrap();
        let port = socket.local_addr().unwrap().port();
        let (heard, over) = <(Arc<Mutex<Heard>>, Arc<AtomicBool>)>::default();
        let thread = {
            let (heard, over) = (Arc::clone(&heard), Arc::clone(&over));
            std::thread::spawn(move || listen(&socket, &heard, &over))
        };
        Self { port, heard, over, thread: Some(thread) }
    }

    /// The part of a configuration that sends it MAVLink.
    pub fn config(&self) -> String {
        format!("[[mavlink.endpoint]]\naddress = \"udpout:127.0.0.1:{}\"\n", self.port)
    }

    /// Waits for a text of this severity that begins so, number `times`.
    pub fn text(&self, severity: u8, begins: &str, times: usize) -> String {
        wait_for(&format!("{times} texts of severity {severity} that begin with {begins:?}"), || {
            let heard = self.heard.lock().unwrap();
            let mut texts = heard.texts.iter().filter(|(s, t)| *s == severity && t.starts_with(begins));
            texts.nth(times - 1).map(|(_, text)| text.clone())
        })
    }

    /// All texts so far.
    pub fn texts(&self) -> Vec<(u8, String)> {
        self.heard.lock().unwrap().texts.clone()
    }

    /// The state in the first heartbeat that comes after `moment`.
    pub fn state_after(&self, moment: Instant) -> u8 {
        wait_for("a heartbeat", || {
            let heard = self.heard.lock().unwrap();
            heard.states.iter().find(|(at, _)| *at > moment).map(|(_, state)| *state)
        })
    }

    /// How many attitudes have come since `moment`.
    pub fn attitudes_since(&self, moment: Instant) -> usize {
        self.heard.lock().unwrap().attitudes.iter().filter(|at| **at > moment).count()
    }
}

impl Drop for Radio {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Relaxed);
        let _ = self.thread.take().map(JoinHandle::join);
        if std::thread::panicking() {
            eprintln!("the radio heard {:?}", self.texts());
        }
    }
}

fn listen(socket: &UdpSocket, heard: &Mutex<Heard>, over: &AtomicBool) {
    let mut buffer = [0; 512];
    while !over.load(Ordering::Relaxed) {
        let Ok(length) = socket.recv(&mut buffer) else { continue };
        let message = mavlink::MavlinkReader::new(&buffer[..length]).read_message(MavlinkVersion::V2).unwrap().1;
        let (now, mut heard) = (Instant::now(), heard.lock().unwrap());
        match message {
            MavMessage::HEARTBEAT(h) => heard.states.push((now, h.system_status as u8)),
            MavMessage::STATUSTEXT(t) => heard.texts.push((t.severity as u8, t.text.to_str().unwrap().to_owned())),
            MavMessage::ATTITUDE(_) => heard.attitudes.push(now),
            _ => {}
        }
    }
}
