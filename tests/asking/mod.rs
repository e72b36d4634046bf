//! A daemon that is asked over MAVLink by pymavlink.
#![allow(dead_code)]

use super::process::{DAEMON, Daemon, Folder, Receiver};
use super::wire::{frames, free_udp};
use serde_json::Value;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::process::Command;

/// The daemon's system in these tests; another one than any client's.
pub const SYSTEM: u8 = 42;

pub const STATUSTEXT: u8 = 253;

/// A daemon on its simulated source with a `udpin` endpoint, where it is asked, and a `udpout` one beside it.
pub struct Asked {
    pub daemon: Daemon,
    pub folder: Folder,
    pub at: SocketAddr,
    /// A second one at the endpoint where it is asked.
    pub peer: Receiver,
    /// At the other endpoint.
    pub beside: Receiver,
    bus: String,
}

fn clients() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/clients")
}

impl Asked {
    /// With `mavlink` in that table of its configuration, and these files in its folder.
    pub fn new(bus: &str, mavlink: &str, files: impl FnOnce(&Folder)) -> Self {
        let (folder, at, beside) = (Folder::new(), free_udp("127.0.0.1"), Receiver::new());
        files(&folder);
        let mavlink = mavlink.replace("FOLDER", &folder.0.display().to_string());
        let peer = Receiver::new();
        let two = [format!("udpin:{at}"), format!("udpout:127.0.0.1:{}", beside.port())];
        let daemon = Self::daemon(&folder, bus, &mavlink, &two);
        Self { daemon, folder, at, peer, beside, bus: bus.into() }
    }

    fn daemon(folder: &Folder, bus: &str, mavlink: &str, endpoints: &[String]) -> Daemon {
        let mut text = format!("[simulation]\nenabled = true\n[dbus]\nbus = \"{bus}\"\n");
        text += &format!("[mavlink]\nsystem-id = {SYSTEM}\n{mavlink}\n");
        text.extend(endpoints.iter().map(|e| format!("[[mavlink.endpoint]]\naddress = \"{e}\"\n")));
        let mut command = Command::new(DAEMON);
        command.arg("--config").arg(folder.write("irhorizon.toml", text)).env_remove("STATE_DIRECTORY");
        Daemon::spawn(command, folder.path("log"))
    }

    /// Ends it, and starts it again; without `beside` there is one endpoint less.
    pub fn restart(&mut self, mavlink: &str, beside: bool, signal: rustix::process::Signal) {
        self.daemon.signal(signal);
        self.daemon.ended();
        let mavlink = mavlink.replace("FOLDER", &self.folder.0.display().to_string());
        let endpoints = [format!("udpin:{}", self.at), format!("udpout:127.0.0.1:{}", self.beside.port())];
        let endpoints = &endpoints[..1 + usize::from(beside)];
        self.daemon = Self::daemon(&self.folder, &self.bus, &mavlink, endpoints);
    }

    /// What ask.py reports, asked with these words.
    pub fn report(&self, words: &[&str]) -> Value {
        let setup = Command::new(clients().join("setup")).output().expect("tests/clients/setup runs");
        assert!(setup.status.success(), "no clients, no test: {}", String::from_utf8_lossy(&setup.stderr));
        let mut command = Command::new(String::from_utf8(setup.stdout).unwrap().trim());
        command.arg(clients().join("ask.py")).args(["--connect", &self.at.to_string()]);
        let output = command.args(["--system", &SYSTEM.to_string()]).args(words).output().unwrap();
        let report = serde_json::from_slice(&output.stdout).unwrap_or_else(|e| panic!("{e}: {output:?}"));
        println!("{report}");
        report
    }

    /// The answer, of a daemon that is there; null without one.
    pub fn answer(&self, words: &[&str]) -> Value {
        let report = self.report(words);
        assert_eq!(report["met"], true, "{report}\n{}", self.daemon.said());
        report["answer"].clone()
    }

    /// The value of a parameter.
    pub fn parameter(&self, name: &str) -> f64 {
        self.answer(&["param-read", name])["param_value"].as_f64().unwrap()
    }

    /// The peer says that it is there.
    pub fn call(&self) {
        self.peer.0.send_to(&frames(1)[0], self.at).unwrap();
    }

    /// Whether a text with these words comes to the peer.
    pub fn is_told(&self, words: &str) -> bool {
        let begun = std::time::Instant::now();
        while begun.elapsed().as_secs() < 5 {
            if let Some((STATUSTEXT, payload)) = self.peer.next()
                && String::from_utf8_lossy(&payload).contains(words)
            {
                return true;
            }
        }
        false
    }

    pub fn kept(&self) -> String {
        std::fs::read_to_string(self.folder.path("irhorizon.toml.parameters")).unwrap_or_default()
    }
}
