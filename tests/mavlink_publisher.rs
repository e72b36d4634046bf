//! The publisher's thread over loopback: woken by each frame, ends when told, keeps its sockets at a reload.

mod stalls;

use irhorizon::attitude::{Attitude, Mode};
use irhorizon::clock;
use irhorizon::config::Settings;
use irhorizon::config::settings::{EndpointAddress, EndpointSettings, MavlinkSettings};
use irhorizon::mavlink::publisher::run;
use irhorizon::mavlink::switchboard::Switchboard;
use irhorizon::state::{Shared, Snapshot};
use irhorizon::time::Time;
use rustix::thread::gettid;
use stalls::{Span, Watch};
use std::net::UdpSocket;
use std::sync::Arc;
use std::sync::mpsc::channel;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

struct Rig {
    shared: Arc<Shared>,
    switchboard: Arc<Switchboard>,
    thread: Option<JoinHandle<()>>,
    tid: i32,
}

impl Rig {
    fn new(endpoints: Vec<EndpointAddress>) -> Self {
        let shared = Arc::new(Shared::default());
        let switchboard = Arc::new(Switchboard::sending(settings(endpoints, 191)));
        let (tell, told) = channel();
        let thread = {
            let (shared, switchboard) = (Arc::clone(&shared), Arc::clone(&switchboard));
            std::thread::spawn(move || {
                tell.send(gettid().as_raw_nonzero().get()).unwrap();
                run(&shared, &switchboard);
            })
        };
        Self { shared, switchboard, thread: Some(thread), tid: told.recv().unwrap() }
    }

    /// How often the thread has waited for something and was woken.
    fn wakeups(&self) -> u64 {
        let status = std::fs::read_to_string(format!("/proc/self/task/{}/status", self.tid)).unwrap();
        let line = status.lines().find_map(|l| l.strip_prefix("voluntary_ctxt_switches:")).unwrap();
        line.trim().parse().unwrap()
    }

    /// A frame with a good attitude, stamped now.
    fn frame(&self) {
        self.shared.update(|s| set(s, clock::now()));
    }

    fn stop(&mut self) -> Span {
        let asked = Watch::start();
        self.shared.update(|s| s.stopping = true);
        self.thread.take().unwrap().join().unwrap();
        asked.stop()
    }
}

/// The next frame: a good attitude of the moment `at`.
fn set(snapshot: &mut Snapshot, at: Time) {
    snapshot.sequence += 1;
    snapshot.written = clock::now();
    (snapshot.estimate.time, snapshot.estimate.valid_at) = (at, at);
    snapshot.estimate.attitude = Some(Attitude::from_degrees(10.0, -5.0));
    snapshot.estimate.mode = Mode::Nominal;
}

fn settings(endpoints: Vec<EndpointAddress>, component_id: u8) -> Settings {
    let endpoints = endpoints.into_iter().map(EndpointSettings::from).collect();
    let mavlink = MavlinkSettings { system_id: Some(1), component_id, endpoints, ..Settings::default().mavlink };
    Settings { mavlink, ..Settings::default() }
}

fn receiver() -> (UdpSocket, EndpointAddress) {
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    socket.set_read_timeout(Some(Duration::from_secs(5))).unwrap();
    let address = EndpointAddress::UdpOut(socket.local_addr().unwrap());
    (socket, address)
}

/// The next frame: (sequence number, component, message id, payload).
fn receive(socket: &UdpSocket) -> (u8, u8, u8, Vec<u8>) {
    let mut buffer = [0; 512];
    let length = socket.recv(&mut buffer).expect("a message within 5 s");
    let bytes = &buffer[..length];
    assert_eq!((bytes[0], usize::from(bytes[1]) + 12), (0xfd, length), "one frame in one datagram: {bytes:02x?}");
    (bytes[4], bytes[6], bytes[7], bytes[10..length - 2].to_vec())
}

/// The next frame with message `id`.
fn receive_only(socket: &UdpSocket, id: u8) -> (u8, u8, Vec<u8>) {
    loop {
        let (sequence, component, got, payload) = receive(socket);
        if got == id {
            return (sequence, component, payload);
        }
    }
}

const HEARTBEAT: u8 = 0;
const ATTITUDE: u8 = 30;
const POWEROFF: u8 = 7;

#[test]
fn it_ends_when_told_with_a_last_heartbeat() {
    let (socket, address) = receiver();
    let mut rig = Rig::new(vec![address]);
    let (_, component, boot) = receive_only(&socket, HEARTBEAT);
    assert_eq!((component, &boot[4..]), (191, &[18, 8, 0, 1, 3][..]), "type, autopilot, base_mode, BOOT, version");
    rig.frame();
    receive_only(&socket, ATTITUDE);
    let took = rig.stop();
    assert!(took.within(Duration::from_millis(200)), "{took:?}");
    let last = receive_only(&socket, HEARTBEAT).2;
    assert_eq!(last[7], POWEROFF);
    socket.set_nonblocking(true).unwrap();
    assert!(socket.recv(&mut [0; 16]).is_err(), "something came after the last heartbeat");
}

#[test]
fn a_reload_keeps_what_stays_and_changes_the_rest() {
    let (first, first_address) = receiver();
    let (second, second_address) = receiver();
    let mut rig = Rig::new(vec![first_address.clone()]);
    let before = receive(&first).0;
    let source = |rig: &Rig| rig.switchboard.endpoints().into_iter().map(|e| e.sent).collect::<Vec<_>>();
    assert_eq!(source(&rig).len(), 1);
    rig.switchboard.configure(settings(vec![second_address, first_address], 42));
    rig.shared.update(|s| s.generation += 1);
    assert_eq!(receive_only(&second, HEARTBEAT).1, 42);
    let mut sequence = before;
    loop {
        let (next, component, id, _) = receive(&first);
        sequence = sequence.wrapping_add(1);
        assert_eq!(next, sequence, "the count went on");
        if (component, id) == (42, HEARTBEAT) {
            break;
        }
    }
    rig.frame();
    receive_only(&first, ATTITUDE);
    receive_only(&second, ATTITUDE);
    assert_eq!(source(&rig).len(), 2);
    rig.stop();
}

#[test]
fn endpoints_that_cannot_send_do_not_hold_up_the_others() {
    let taken = UdpSocket::bind("127.0.0.1:0").unwrap();
    let (socket, address) = receiver();
    let nobody = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let mut rig = Rig::new(vec![
        EndpointAddress::UdpIn(taken.local_addr().unwrap()),
        EndpointAddress::UdpOut(nobody),
        EndpointAddress::UdpIn("192.0.2.1:14550".parse().unwrap()),
        address,
    ]);
    for _ in 0..50 {
        rig.frame();
        receive_only(&socket, ATTITUDE);
    }
    rig.stop();
    let endpoints = rig.switchboard.endpoints();
    let errors: Vec<&str> = endpoints.iter().map(|e| e.last_error.as_str()).collect();
    assert!(errors[0].contains("in use by another program"), "{errors:?}");
    assert!(errors[1].contains("nobody listens"), "{errors:?}");
    assert!(errors[2].contains("does not have that address"), "{errors:?}");
    assert_eq!(errors[3], "");
    assert_eq!(endpoints[3].failed, 0);
}

/// Frames that come faster than the thread is woken: the last few are all sent, in their order.
#[test]
fn of_several_frames_at_once_the_last_are_sent() {
    let (socket, address) = receiver();
    let mut rig = Rig::new(vec![address]);
    receive_only(&socket, HEARTBEAT);
    let begun = clock::now();
    for burst in 1..=20_u32 {
        let stamp = |i: u32| begun + Duration::from_millis(u64::from(1000 * burst + 20 * i));
        (1..=10).for_each(|i| rig.shared.update(|s| set(s, stamp(i))));
        let stamp_ms = |i| (stamp(i).as_nanos() / 1_000_000) as u32;
        let mut got = Vec::new();
        while got.last() != Some(&stamp_ms(10)) {
            let payload = receive_only(&socket, ATTITUDE).2;
            got.push(u32::from_le_bytes(payload[..4].try_into().unwrap()));
        }
        assert!(got.is_sorted_by(|a, b| a < b), "{got:?}");
        let last: Vec<u32> = (6..=10).map(stamp_ms).collect();
        assert!(got.ends_with(&last), "{got:?} {last:?}");
    }
    rig.stop();
}

/// Each frame wakes the thread by itself, and little else does. How soon it is out is a figure of
/// `cargo bench --bench latency`.
#[test]
fn a_frame_wakes_the_thread_and_nothing_polls() {
    const FRAMES: u64 = 1000;
    /// How often the endpoints are tended, s.
    const TEND_S: f64 = 0.1;
    let (socket, address) = receiver();
    let mut rig = Rig::new(vec![address]);
    receive_only(&socket, HEARTBEAT);
    let (begun, before) = (Instant::now(), rig.wakeups());
    for _ in 0..FRAMES {
        rig.frame();
        receive_only(&socket, ATTITUDE);
    }
    let (took_s, woken) = (begun.elapsed().as_secs_f64(), rig.wakeups() - before);
    let (begun, before) = (Instant::now(), rig.wakeups());
    std::thread::sleep(Duration::from_secs(1));
    let (idle_s, idle) = (begun.elapsed().as_secs_f64(), rig.wakeups() - before);
    rig.stop();
    println!("{woken} wake-ups for {FRAMES} frames in {took_s:.2} s, {idle} in {idle_s:.2} s without any");
    assert!(took_s < FRAMES as f64 * TEND_S / 2.0, "it does not wait to be tended");
    assert!(woken as f64 <= 2.0 * FRAMES as f64 + took_s / TEND_S, "{woken}");
    assert!(idle as f64 <= 2.0 * idle_s / TEND_S, "{idle}");
}
