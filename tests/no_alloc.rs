//! The sampling loop, every method's update by itself, and the thread of MAVLink allocate nothing once their first
//! rounds are over: an allocator that counts what a thread asks for.
//!
//! Faults come and go meanwhile, and a recording listens; what the log does with its lines is the
//! logger's affair, so the one here formats them into nothing.

mod methods;

use irhorizon::aiding::{Inbox, Link, Said, What};
use irhorizon::attitude::{Attitude, Mode};
use irhorizon::clock;
use irhorizon::config::Settings;
use irhorizon::config::settings::{EndpointAddress, EndpointSettings, MavlinkSettings, Method, SimulationSettings};
use irhorizon::daemon::sampling::Sampling;
use irhorizon::frame::{Aiding, Frame, Missing};
use irhorizon::head::Head;
use irhorizon::horizon::Horizon;
use irhorizon::mavlink::encode::Encoder;
use irhorizon::mavlink::messages;
use irhorizon::mavlink::publisher::Publisher;
use irhorizon::mavlink::switchboard::Switchboard;
use irhorizon::recording::Taps;
use irhorizon::simulation::fault::Kind;
use irhorizon::simulation::{Fault, Flight, Outage, SimulatedSource};
use irhorizon::sky::FieldOfView;
use irhorizon::source::FrameSource;
use irhorizon::state::Shared;
use irhorizon::time::Time;
use mavlink::dialects::common::MavState;
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::fmt::Write;
use std::io::Write as _;
use std::net::{TcpListener, TcpStream, UdpSocket};
use std::os::fd::AsFd;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
    static WATCHED: Cell<bool> = const { Cell::new(false) };
}

/// Those of the threads that are watched from another one.
static WATCHED_ALLOCATIONS: AtomicU64 = AtomicU64::new(0);

fn count() {
    // A thread that ends has no counter any more.
    let _ = ALLOCATIONS.try_with(|n| n.set(n.get() + 1));
    if WATCHED.try_with(Cell::get).unwrap_or(false) {
        WATCHED_ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
    }
}

// SAFETY: everything is passed on to the system's allocator; counting allocates nothing.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Formats every line, into nothing.
struct Nowhere;

struct Void(usize);

impl Write for Void {
    fn write_str(&mut self, text: &str) -> std::fmt::Result {
        self.0 += text.len();
        Ok(())
    }
}

impl log::Log for Nowhere {
    fn enabled(&self, _: &log::Metadata<'_>) -> bool {
        true
    }

    fn log(&self, record: &log::Record<'_>) {
        let mut void = Void(0);
        assert!(write!(void, "{}", record.args()).is_ok() && void.0 > 0);
    }

    fn flush(&self) {}
}

/// Allocations in `rounds` rounds at 50 Hz after `warm` rounds.
fn allocations(outages: Vec<Outage>, listener: bool, warm: u64, rounds: u64) -> u64 {
    let _ = log::set_logger(&Nowhere);
    log::set_max_level(log::LevelFilter::Debug);
    let settings = Settings { simulation: Some(SimulationSettings::default()), ..Settings::default() };
    let head = Head::six();
    let field = FieldOfView::Gaussian { fwhm_deg: 90.0 };
    let source = SimulatedSource::new(&SimulationSettings::default(), &head, field).with_outages(outages);
    let (shared, taps) = (Arc::new(Shared::default()), Arc::new(Taps::new("time_s\n")));
    let tap = listener.then(|| taps.subscribe().unwrap());
    let horizon = Horizon::new(&settings, head.clone());
    let mut sampling = Sampling::new(head, Box::new(source), horizon, Arc::clone(&shared), taps, None);
    let mut packet = [0; 4096];
    let mut before = 0;
    for i in 0..warm + rounds {
        if i == warm {
            before = ALLOCATIONS.get();
        }
        sampling.step(Time::from_nanos(1_000_000_000 + i * 20_000_000));
        if let Some(tap) = &tap {
            let (length, _) =
                rustix::net::recv(tap.as_fd(), &mut packet[..], rustix::net::RecvFlags::DONTWAIT).unwrap();
            assert!(length > 0);
        }
    }
    assert_eq!(shared.lock().sequence, warm + rounds);
    ALLOCATIONS.get() - before
}

#[test]
fn the_counter_counts() {
    let before = ALLOCATIONS.get();
    drop(std::hint::black_box(vec![1_u8; 100]));
    assert_eq!(ALLOCATIONS.get(), before + 1);
}

/// Body rates 40 ms late, one in five lost, and a fix now and then: frames wait, and are carried on.
#[test]
fn an_autopilot_is_heard() {
    let settings = Settings { simulation: Some(SimulationSettings::default()), ..Settings::default() };
    let head = Head::six();
    let source = SimulatedSource::new(&SimulationSettings::default(), &head, FieldOfView::Gaussian { fwhm_deg: 90.0 });
    let flight = Flight::demo(SimulationSettings::default().seed);
    let (shared, inbox) = (Arc::new(Shared::default()), Arc::new(Inbox::default()));
    let horizon = Horizon::new(&settings, head.clone());
    let mut sampling =
        Sampling::new(head, Box::new(source), horizon, Arc::clone(&shared), Arc::new(Taps::default()), None)
            .with_inbox(Arc::clone(&inbox));
    let mut before = 0;
    for i in 0..5050_u64 {
        if i == 50 {
            before = ALLOCATIONS.get();
        }
        let at = |i: u64| Time::from_nanos(1_000_000_000 + i * 20_000_000);
        let say = |what| inbox.push(Said { time: at(i.saturating_sub(2)), arrived: at(i), what });
        inbox.tell(Link { system: Some(1), heard: at(i), aids: true, ..Link::default() });
        if i % 5 != 0 {
            let angles = |more: f64| flight.angles(0.02 * i.saturating_sub(2) as f64 + more);
            let (before, after, (sin, cos)) = (angles(-0.01), angles(0.01), angles(0.0)[0].sin_cos());
            let [roll, pitch] = [0, 1].map(|k| (after[k] - before[k]).to_degrees() / 0.02);
            say(What::Rates([roll, pitch * cos, -pitch * sin]));
            say(What::Attitude(Attitude::default(), 0.0));
        }
        if i % 10 == 0 {
            say(What::Slow(Aiding { airspeed_m_s: Some(15.0), ..Aiding::default() }));
        }
        sampling.step(at(i));
    }
    assert_eq!(ALLOCATIONS.get() - before, 0);
    assert!(shared.lock().autopilot.used);
}

#[test]
fn all_is_well() {
    assert_eq!(allocations(Vec::new(), false, 50, 5_000), 0);
    assert_eq!(allocations(Vec::new(), true, 50, 5_000), 0, "with a recording");
}

/// Every sensor fails for half a second again and again, each with another reason, for the first
/// time long after the start.
#[test]
fn faults_come_and_go() {
    let reasons = [
        Missing::NoAnswer,
        Missing::BadPec,
        Missing::ErrorFlag,
        Missing::Saturated,
        Missing::NotReady,
        Missing::Impossible,
    ];
    let mut outages = Vec::new();
    for round in 0..40 {
        for (sensor, reason) in reasons.into_iter().enumerate() {
            let from_s = 5.0 + f64::from(round) * 2.0 + sensor as f64 * 0.2;
            outages.push(Outage { sensor, from_s, to_s: from_s + 0.5, reason });
        }
    }
    // All of them at once: nothing is fresh.
    outages.extend((0..6).map(|sensor| Outage { sensor, from_s: 90.0, to_s: 92.0, reason: Missing::NoAnswer }));
    assert_eq!(allocations(outages, true, 50, 5_000), 0);
}

/// Frames go out, by either thread, and messages come in, are heeded, answered and logged; one client takes nothing.
#[test]
fn endpoints_of_all_kinds() {
    let receiver = UdpSocket::bind("127.0.0.1:0").unwrap();
    let [udp_in, tcp_in] = [0, 0].map(|_| TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap());
    let tlog = std::env::temp_dir().join(format!("irhorizon-no-alloc-{}.tlog", std::process::id()));
    let mut endpoints = [
        EndpointAddress::UdpOut(receiver.local_addr().unwrap()),
        EndpointAddress::UdpIn(udp_in),
        EndpointAddress::TcpIn(tcp_in),
    ]
    .map(EndpointSettings::from);
    endpoints[1].tlog = Some(tlog.clone());
    let settings = MavlinkSettings { endpoints: endpoints.into(), ..Settings::default().mavlink };
    let switchboard = Switchboard::sending(Settings { mavlink: settings, ..Settings::default() });
    let (publisher, shared) = (Publisher::new(&switchboard), Shared::default());
    let allocations = || WATCHED_ALLOCATIONS.load(Ordering::Relaxed);
    let mut first = 0;
    std::thread::scope(|scope| {
        scope.spawn(|| {
            WATCHED.set(true);
            publisher.run(&shared, &switchboard);
        });
        while switchboard.endpoints().len() < 3 {
            std::thread::yield_now();
        }
        let clients = [0; 2].map(|_| TcpStream::connect(tcp_in).unwrap());
        receiver.send_to(b"hello", udp_in).unwrap();
        let frame = Encoder::new(1, 1).encode(&messages::heartbeat(MavState::MAV_STATE_ACTIVE)).to_vec();
        for i in 0..3000_u32 {
            WATCHED.set(true);
            shared.put(|s| {
                s.sequence += 1;
                s.written = clock::now();
                s.estimate.valid_at = s.written;
                s.estimate.attitude = Some(Attitude::from_degrees(f64::from(i) * 0.01, 1.0));
                s.estimate.mode = Mode::Nominal;
            });
            // Each of the two threads in turn.
            if i % 100 < 50 || !publisher.tell(&shared) {
                shared.ring();
            }
            WATCHED.set(false);
            if i == 400 {
                first = allocations();
            }
            if i >= 200 && i % 10 == 0 {
                receiver.send_to(&frame, udp_in).unwrap();
                (&clients[0]).write_all(&frame).unwrap();
            }
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        let allocated = allocations() - first;
        shared.update(|s| s.stopping = true);
        assert_eq!(allocated, 0);
    });
    let shown = switchboard.endpoints();
    let _ = std::fs::remove_file(tlog);
    println!("{shown:?}");
    let heeded: u64 = shown.iter().map(|e| e.received).sum();
    assert!(heeded > 300 && shown[1].sent > 2000 && shown[2].sent > 4000, "{shown:?}");
}

/// Every kind of fault on purpose, at the highest rate.
#[test]
fn faults_on_purpose_come_and_go() {
    let faults = Kind::ALL.map(|a| a.kind.example().replace("10..20", "1..8").parse::<Fault>().unwrap());
    let settings = SimulationSettings { faults: faults.into(), ..SimulationSettings::default() };
    let mut source = SimulatedSource::new(&settings, &Head::six(), FieldOfView::Gaussian { fwhm_deg: 90.0 });
    let mut frame = Frame::new(6);
    let mut before = 0;
    for i in 0..3000_u64 {
        if i == 1 {
            before = ALLOCATIONS.get();
        }
        source.scan(Time::from_nanos(i * 5_000_000), &mut frame);
    }
    assert_eq!(ALLOCATIONS.get() - before, 0);
}

/// Each method by itself, with body rates and without, while sensors come and go.
#[test]
fn an_update_of_any_method() {
    let head = Head::six();
    let field = FieldOfView::Gaussian { fwhm_deg: 90.0 };
    let outage = |sensor, from_s| Outage { sensor, from_s, to_s: from_s + 1.0, reason: Missing::NoAnswer };
    let mut outages: Vec<Outage> = (0..6).map(|sensor| outage(sensor, 5.0 + 2.0 * sensor as f64)).collect();
    outages.extend((0..6).map(|sensor| outage(sensor, 20.0)));
    for (name, method) in Method::NAMED {
        for rates in [false, true] {
            let mut source =
                SimulatedSource::new(&SimulationSettings::default(), &head, field).with_outages(outages.clone());
            let mut estimator = methods::estimator(method, &head);
            let mut frame = Frame::new(6);
            let mut before = 0;
            for i in 0..1500_u64 {
                source.scan(Time::from_nanos(i * 20_000_000), &mut frame);
                if rates {
                    frame.aiding.gyro_deg_s = [Some(1.0 + (i % 2) as f64), Some(-2.0), Some(3.0)];
                }
                if i == 50 {
                    before = ALLOCATIONS.get();
                }
                estimator.update(&frame);
            }
            assert_eq!(ALLOCATIONS.get() - before, 0, "{name}, body rates {rates}");
        }
    }
}
