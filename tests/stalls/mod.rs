//! How far this machine kept time while something was measured: what it stood still for was nobody's to use.
//!
//! A virtual machine stands still for tenths of a second whenever its host is busy. On each processor a thread that does
//! nothing else asks to be woken 100 times a second; what it is late by is taken off what is asked of the daemon
//! meanwhile. Where nothing stands still nothing is taken off.
#![allow(dead_code)]

use rustix::thread::{CpuSet, sched_getaffinity, sched_setaffinity};
use std::ops::RangeInclusive;
use std::sync::{LazyLock, Mutex};
use std::time::{Duration, Instant};

/// How long the threads ask to sleep.
const NAP: Duration = Duration::from_millis(10);
/// A thread that comes so much later than asked stood still.
const LATE: Duration = Duration::from_millis(10);

/// When a processor stood still: from the last time it did not until it came.
type Stall = (Instant, Instant);

static STALLS: LazyLock<Mutex<Vec<Stall>>> = LazyLock::new(|| {
    let all = sched_getaffinity(None).unwrap();
    for cpu in (0..CpuSet::MAX_CPU).filter(|cpu| all.is_set(*cpu)) {
        std::thread::spawn(move || {
            let mut own = CpuSet::new();
            own.set(cpu);
            sched_setaffinity(None, &own).unwrap();
            let mut before = Instant::now();
            loop {
                std::thread::sleep(NAP);
                let now = Instant::now();
                if now - before > NAP + LATE {
                    STALLS.lock().unwrap().push((before, now));
                }
                before = now;
            }
        });
    }
    Mutex::default()
});

/// A time that is measured, from its making on.
#[derive(Clone, Copy)]
pub struct Watch(Instant);

impl Watch {
    pub fn start() -> Self {
        LazyLock::force(&STALLS);
        Self(Instant::now())
    }

    pub fn stop(self) -> Span {
        let took = self.0.elapsed();
        let (mut still, mut until) = (Duration::ZERO, Duration::ZERO);
        for (from, to) in self.stalls() {
            still += to.min(took).saturating_sub(from.max(until));
            until = until.max(to);
        }
        Span { took, still }
    }

    /// From when to when a processor stood still, after the start.
    pub fn stalls(self) -> Vec<(Duration, Duration)> {
        // Who is standing still tells only afterwards.
        std::thread::sleep(NAP);
        let stalls = STALLS.lock().unwrap();
        let after = stalls.iter().filter(|stall| stall.1 > self.0);
        let mut stalls: Vec<_> =
            after.map(|(from, to)| (from.saturating_duration_since(self.0), *to - self.0)).collect();
        stalls.sort();
        stalls
    }
}

/// A time that was measured.
#[derive(Clone, Copy, Debug)]
pub struct Span {
    pub took: Duration,
    /// How long a processor stood still meanwhile.
    pub still: Duration,
}

impl Span {
    /// It was not longer than `most`, but for when the machine stood still.
    pub fn within(&self, most: Duration) -> bool {
        self.took <= most + self.still
    }

    /// So many came in it.
    pub fn rate(self, count: usize) -> Rate {
        Rate { count, span: self }
    }

    /// `hz` seen in it is in `range`, but for what could not come while the machine stood still.
    pub fn allows(&self, hz: f64, range: RangeInclusive<f64>) -> bool {
        (range.start() * (1.0 - self.lost())..=*range.end()).contains(&hz)
    }

    /// The share of it in which a processor stood still.
    pub fn lost(&self) -> f64 {
        self.still.as_secs_f64() / self.took.as_secs_f64().max(1e-9)
    }
}

impl std::fmt::Display for Span {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:.3?}", self.took)?;
        if self.still.is_zero() {
            Ok(())
        } else {
            write!(f, ", in {:.3?} of which the machine stood still", self.still)
        }
    }
}

/// How often something came.
#[derive(Clone, Copy)]
pub struct Rate {
    count: usize,
    span: Span,
}

impl Rate {
    /// Calls `next`, which gives how many came, for so many seconds from the first on; where the machine stood still for
    /// a quarter of them again, thrice at most, and the calmest counts.
    pub fn measure(seconds: f64, mut next: impl FnMut() -> usize) -> Self {
        while next() == 0 {}
        let mut calmest: Option<Self> = None;
        for _ in 0..3 {
            let (watch, begun) = (Watch::start(), Instant::now());
            let mut count = 0;
            while begun.elapsed().as_secs_f64() < seconds {
                count += next();
            }
            let rate = watch.stop().rate(count);
            let calm = calmest.get_or_insert(rate);
            if rate.span.lost() < calm.span.lost() {
                *calm = rate;
            }
            if rate.span.lost() < 0.25 {
                break;
            }
            println!("not calm: {rate}");
        }
        let rate = calmest.expect("a rate");
        assert!(rate.span.lost() < 0.75, "this machine stands still too much for anything to be measured: {rate}");
        rate
    }

    pub fn hz(&self) -> f64 {
        self.count as f64 / self.span.took.as_secs_f64()
    }

    /// It is in `range` (Hz), but for what could not come while the machine stood still.
    pub fn is(&self, range: RangeInclusive<f64>) -> bool {
        self.span.allows(self.hz(), range)
    }
}

impl std::fmt::Display for Rate {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:.2} Hz in {}", self.hz(), self.span)
    }
}
