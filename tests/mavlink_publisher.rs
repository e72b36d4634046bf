//! The publisher over loopback: sends with the thread that samples or with its own, ends when told, keeps its sockets
//! at a reload.

mod stalls;

use irhorizon::attitude::{Attitude, Mode};
use irhorizon::clock;
use irhorizon::config::Settings;
use irhorizon::config::settings::{EndpointAddress, EndpointSettings, MavlinkSettings};
use irhorizon::mavlink::publisher::Publisher;
use irhorizon::mavlink::switchboard::Switchboard;
use irhorizon::state::{Shared, Snapshot};
use irhorizon::time::Time;
use rustix::net::{AddressFamily, SocketType, sockopt};
use rustix::thread::gettid;
use stalls::{Span, Watch};
use std::io::Read;
use std::net::{TcpListener, TcpStream, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::channel;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

struct Rig {
    shared: Arc<Shared>,
    switchboard: Arc<Switchboard>,
    publisher: Arc<Publisher>,
    thread: Option<JoinHandle<()>>,
    tid: i32,
}

impl Rig {
    fn new(endpoints: Vec<EndpointAddress>) -> Self {
        let shared = Arc::new(Shared::default());
        let switchboard = Arc::new(Switchboard::sending(settings(endpoints, 191)));
        let publisher = Arc::new(Publisher::new(&switchboard));
        let (tell, told) = channel();
        let thread = {
            let (shared, switchboard) = (Arc::clone(&shared), Arc::clone(&switchboard));
            let publisher = Arc::clone(&publisher);
            std::thread::spawn(move || {
                tell.send(gettid().as_raw_nonzero().get()).unwrap();
                publisher.run(&shared, &switchboard);
            })
        };
        Self { shared, switchboard, publisher, thread: Some(thread), tid: told.recv().unwrap() }
    }

    /// How often the thread has waited for something and was woken.
    fn wakeups(&self) -> u64 {
        let status = std::fs::read_to_string(format!("/proc/self/task/{}/status", self.tid)).unwrap();
        let line = status.lines().find_map(|l| l.strip_prefix("voluntary_ctxt_switches:")).unwrap();
        line.trim().parse().unwrap()
    }

    /// A frame with a good attitude, stamped now, that the publisher's thread is rung for.
    fn frame(&self) {
        self.shared.update(|s| set(s, clock::now()));
    }

    /// A frame stamped `at` that is told of by the thread that wrote it, as the sampling loop does.
    fn tell(&self, at: Time) {
        self.shared.put(|s| set(s, at));
        if !self.publisher.tell(&self.shared) {
            self.shared.ring();
        }
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
    snapshot.estimate.measured = true;
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
const CRITICAL: u8 = 5;
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
fn without_its_key_an_endpoint_says_why_it_is_silent() {
    let (_, address) = receiver();
    let mut rig = Rig::new(vec![address.clone()]);
    let said = |rig: &Rig| rig.switchboard.endpoints().into_iter().map(|e| e.last_error).next();
    let becomes = |rig: &Rig, right: fn(&str) -> bool| {
        let begun = Instant::now();
        while !said(rig).is_some_and(|s| right(&s)) {
            assert!(begun.elapsed() < Duration::from_secs(10), "{:?}", said(rig));
            std::thread::sleep(Duration::from_millis(5));
        }
    };
    becomes(&rig, str::is_empty);
    let mut unsigned = settings(vec![address.clone()], 191);
    unsigned.mavlink.signing_key = Some("/nonexistent/key".into());
    rig.switchboard.configure(unsigned);
    rig.shared.update(|s| s.generation += 1);
    becomes(&rig, |s| s.starts_with("MAVLink is silent: the signing key /nonexistent/key"));
    rig.switchboard.configure(settings(vec![address], 191));
    rig.shared.update(|s| s.generation += 1);
    becomes(&rig, str::is_empty);
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
        rig.tell(clock::now());
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

/// What the sampling thread tells of is sent by it, heartbeats too; the publisher's own hardly wakes.
#[test]
fn a_frame_that_is_told_of_wakes_nobody() {
    let (socket, address) = receiver();
    let mut rig = Rig::new(vec![address]);
    receive_only(&socket, HEARTBEAT);
    let (begun, before) = (Instant::now(), rig.wakeups());
    let (mut heartbeats, mut attitudes) = (0, 0);
    for i in 1..=1000 {
        rig.tell(clock::now());
        while attitudes < i {
            match receive(&socket).2 {
                HEARTBEAT => heartbeats += 1,
                ATTITUDE => attitudes += 1,
                _ => {}
            }
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    let (took_s, woken) = (begun.elapsed().as_secs_f64(), rig.wakeups() - before);
    rig.stop();
    println!("{woken} wake-ups in {took_s:.2} s, {heartbeats} heartbeats");
    assert!(woken as f64 <= 5.0 * took_s + 5.0, "{woken} in {took_s} s");
    assert!((took_s - 1.5..=took_s + 1.5).contains(&f64::from(heartbeats)), "{heartbeats} in {took_s} s");
}

/// Both threads at once, one of them busy with what comes in: each attitude goes out once, in their order.
#[test]
fn what_finds_the_publisher_at_work_is_sent_all_the_same() {
    const FRAMES: u32 = 1500;
    let (socket, address) = receiver();
    let flooded = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let mut rig = Rig::new(vec![EndpointAddress::UdpIn(flooded), address]);
    receive_only(&socket, HEARTBEAT);
    let end = AtomicBool::new(false);
    let stamps: Vec<u32> = std::thread::scope(|scope| {
        scope.spawn(|| {
            let flood = UdpSocket::bind("127.0.0.1:0").unwrap();
            while !end.load(Ordering::Relaxed) {
                (0..50).for_each(|_| drop(flood.send_to(&[0xfd; 300], flooded)));
                std::thread::sleep(Duration::from_millis(1));
            }
        });
        let told = scope.spawn(|| {
            let begun = clock::now();
            for i in 0..FRAMES {
                rig.tell(begun + Duration::from_millis(20) * i);
                std::thread::sleep(Duration::from_millis(1));
            }
            (begun.as_nanos() / 1_000_000) as u32
        });
        let stamps: Vec<u32> = (0..FRAMES)
            .map(|_| u32::from_le_bytes(receive_only(&socket, ATTITUDE).2[..4].try_into().unwrap()))
            .collect();
        end.store(true, Ordering::Relaxed);
        let begun = told.join().unwrap();
        stamps.into_iter().map(|stamp| stamp.wrapping_sub(begun)).collect()
    });
    rig.stop();
    assert!((0..FRAMES).zip(&stamps).all(|(i, stamp)| stamp.abs_diff(20 * i) <= 1), "{stamps:?}");
}

/// When no more frames are told of, the publisher's thread goes on by itself: heartbeats, critical ones soon.
#[test]
fn when_sampling_hangs_the_publisher_says_so() {
    let (socket, address) = receiver();
    let mut rig = Rig::new(vec![address]);
    receive_only(&socket, HEARTBEAT);
    (0..100).for_each(|_| {
        rig.tell(clock::now());
        std::thread::sleep(Duration::from_millis(10));
    });
    let watch = Watch::start();
    while receive_only(&socket, HEARTBEAT).2[7] != CRITICAL {}
    let took = watch.stop();
    rig.stop();
    // Dead after 1 s, told by the next heartbeat.
    assert!(took.within(Duration::from_millis(2300)), "{took:?}");
}

/// What waits for a client that reads nothing for a while goes out as soon as it does, whoever left it waiting.
#[test]
fn what_waits_is_sent_when_there_is_room_though_nobody_tells() {
    let at = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let mut rig = Rig::new(vec![EndpointAddress::TcpIn(at)]);
    while rig.switchboard.endpoints().is_empty() {
        std::thread::yield_now();
    }
    // With a small buffer it takes little in by itself.
    let client = rustix::net::socket(AddressFamily::INET, SocketType::STREAM, None).unwrap();
    sockopt::set_socket_recv_buffer_size(&client, 4096).unwrap();
    rustix::net::connect(&client, &at).unwrap();
    let mut client = TcpStream::from(client);
    client.set_read_timeout(Some(Duration::from_secs(2))).unwrap();
    let view = || rig.switchboard.endpoints().remove(0);
    let mut sent = 0;
    while sent == 0 || view().sent > sent {
        sent = view().sent;
        (0..20).for_each(|_| {
            rig.tell(clock::now());
            std::thread::sleep(Duration::from_millis(1));
        });
    }
    let (watch, mut buffer) = (Watch::start(), [0; 1 << 16]);
    while view().sent < sent + 10 {
        assert_ne!(client.read(&mut buffer).unwrap(), 0);
    }
    let took = watch.stop();
    rig.stop();
    assert!(took.within(Duration::from_millis(250)), "{took:?}");
}
