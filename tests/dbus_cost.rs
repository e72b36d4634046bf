//! What the service costs: one thread, and little of a core. Alone in its process, to be measured.

mod dbus_bus;

use dbus_bus::{Bus, Daemon};
use irhorizon::attitude::{Attitude, Mode};
use irhorizon::clock;
use std::time::{Duration, Instant};

/// The names of this process's threads, and the nanoseconds that those called `dbus` have run.
fn threads() -> (Vec<String>, u64) {
    let mut names = Vec::new();
    let mut nanos = 0;
    for task in std::fs::read_dir("/proc/self/task").unwrap() {
        let path = task.unwrap().path();
        let name = std::fs::read_to_string(path.join("comm")).unwrap().trim_end().to_owned();
        if name == "dbus" {
            let stat = std::fs::read_to_string(path.join("schedstat")).unwrap();
            nanos += stat.split(' ').next().unwrap().parse::<u64>().unwrap();
        }
        names.push(name);
    }
    (names, nanos)
}

fn resident_kb() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find(|l| l.starts_with("VmRSS:")).unwrap();
    line.split_whitespace().nth(1).unwrap().parse().unwrap()
}

#[test]
fn the_service_is_one_thread_and_hardly_seen() {
    let mut bus = Bus::new();
    let (before, resident) = (threads().0, resident_kb());
    let daemon = Daemon::start(&bus);
    let fly = |seconds: u32| {
        let (start, (_, nanos)) = (Instant::now(), threads());
        for i in 0..seconds * 50 {
            daemon.shared.update(|s| {
                s.sequence += 1;
                s.written = clock::now();
                s.estimate.time = s.written;
                s.estimate.attitude = Some(Attitude::from_degrees(f64::from(i) * 0.1, f64::from(i) * 0.05));
                s.estimate.contrast_k = Some(30.0 + f64::from(i % 7));
                s.estimate.mode = Mode::Nominal;
            });
            std::thread::sleep(Duration::from_millis(20));
        }
        (threads().1 - nanos) as f64 / start.elapsed().as_nanos() as f64
    };
    let share = fly(3);
    bus.property("RollDeg");
    let one_more = |n: Vec<String>| {
        assert_eq!(n.len(), before.len() + 1, "{n:?}");
    };
    one_more(threads().0);
    println!("{:.3} % of a core, {} KiB more resident than {resident}", share * 100.0, resident_kb() - resident);
    assert!(share < 0.05, "{share}");
    bus.kill();
    let idle = fly(1);
    assert!(idle < 0.05, "without a bus: {idle}");
    bus.start();
    fly(2);
    assert!(bus.property("RollDeg").starts_with("d "));
    one_more(threads().0);
}
