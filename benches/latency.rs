//! From the end of the last sensor read to the datagram handed to the kernel, and on to a receiver's
//! hands, beside a busy second process: `cargo bench --bench latency`.
//!
//! The receiver's own wake-up is in the figure, so it is an upper bound of what is asked for.

use irhorizon::clock;
use irhorizon::config::Settings;
use irhorizon::config::settings::{EndpointAddress, EndpointSettings, SimulationSettings};
use irhorizon::daemon::sampling::Sampling;
use irhorizon::frame::{Frame, Missing};
use irhorizon::horizon::Horizon;
use irhorizon::mavlink::publisher::Publisher;
use irhorizon::mavlink::switchboard::Switchboard;
use irhorizon::recording::Taps;
use irhorizon::simulation::SimulatedSource;
use irhorizon::sky::FieldOfView;
use irhorizon::source::{FrameSource, SensorHealth};
use irhorizon::state::Shared;
use irhorizon::time::Time;
use std::collections::HashMap;
use std::net::UdpSocket;
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// The simulated source, with the end of each scan noted by the stamp that ATTITUDE will carry.
struct Noted {
    source: SimulatedSource,
    ends: Arc<Mutex<HashMap<u32, Time>>>,
}

impl FrameSource for Noted {
    fn scan(&mut self, tick: Time, frame: &mut Frame) {
        self.source.scan(tick, frame);
        if let (Some(stamp), Ok(mut ends)) = (frame.sample_time(), self.ends.lock()) {
            ends.insert(stamp.as_millis() as u32, clock::now());
        }
    }

    fn health(&self) -> &[SensorHealth] {
        self.source.health()
    }

    fn buses_down(&self) -> &[Option<Missing>] {
        self.source.buses_down()
    }
}

fn main() {
    let seconds = 60;
    let receiver = UdpSocket::bind("127.0.0.1:0").expect("a loopback port");
    receiver.set_read_timeout(Some(Duration::from_secs(1))).expect("a timeout");
    let mut settings = Settings { simulation: Some(SimulationSettings::default()), ..Settings::default() };
    let to = EndpointAddress::UdpOut(receiver.local_addr().expect("an address"));
    settings.mavlink.endpoints = vec![EndpointSettings::from(to)];
    let head = settings.head();
    let ends = Arc::new(Mutex::new(HashMap::new()));
    let source = Noted {
        source: SimulatedSource::new(&SimulationSettings::default(), &head, FieldOfView::Gaussian { fwhm_deg: 90.0 }),
        ends: Arc::clone(&ends),
    };
    let shared = Arc::new(Shared::default());
    let mavlink = Arc::new(Switchboard::sending(settings.clone()));
    let stop = Arc::new(AtomicBool::new(false));
    let horizon = Horizon::new(&settings, head.clone());
    let publisher = Arc::new(Publisher::new(&mavlink));
    let sampling = Sampling::new(head, Box::new(source), horizon, Arc::clone(&shared), Arc::new(Taps::default()), None)
        .with_publisher(Arc::clone(&publisher));

    let mut busy = Command::new("sh").args(["-c", "while :; do :; done"]).stdout(Stdio::null()).spawn().expect("sh");
    let mut late = Vec::new();
    std::thread::scope(|scope| {
        scope.spawn(|| sampling.run(50.0, &stop));
        scope.spawn(|| publisher.run(&shared, &mavlink));
        let end = clock::now() + Duration::from_secs(seconds);
        let mut packet = [0; 300];
        while clock::now() < end {
            let Ok(n) = receiver.recv(&mut packet) else { break };
            let now = clock::now();
            // MAVLink 2: ten bytes of header, message id 30 is ATTITUDE, which begins with its stamp.
            if n > 14 && packet[7] == 30 && packet[8] == 0 && packet[9] == 0 {
                let stamp = u32::from_le_bytes([packet[10], packet[11], packet[12], packet[13]]);
                if let Some(done) = ends.lock().ok().and_then(|mut e| e.remove(&stamp)) {
                    late.push(now.since(done) * 1e6);
                }
            }
        }
        stop.store(true, Ordering::Relaxed);
        shared.update(|s| s.stopping = true);
    });
    let _ = busy.kill();
    let _ = busy.wait();
    late.sort_by(f64::total_cmp);
    let percentile = |p: f64| late[((late.len() - 1) as f64 * p) as usize];
    println!(
        "last read to receiver, {} datagrams in {seconds} s beside a busy process: \
         median {:.0} µs, 99 % {:.0} µs, 99.9 % {:.0} µs, worst {:.0} µs",
        late.len(),
        percentile(0.5),
        percentile(0.99),
        percentile(0.999),
        percentile(1.0)
    );
}
