//! What became of an event in one flight.

use super::event::{BEGINS_S, Due, Event, FLIGHTS};
use super::flown::{AIDING, SKIES, fly, under};
use super::heard::Instant;
use std::collections::BTreeMap;
use std::fmt;

/// What became of an event in one flight, heard in one way.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Which flight.
    pub seed: u64,
    /// The fault, as the simulator was told.
    pub fault: String,
    /// How the instruments were heard: [`AIDING`].
    pub aided: usize,
    /// When it was due to be seen, seconds into the flight; `None` before that is known.
    pub due_s: Option<f64>,
    /// When it was said first, by its right name.
    pub seen_s: Option<f64>,
    /// What else was said: for the first time, and for how long in all, s.
    pub others: BTreeMap<String, (f64, f64)>,
    /// The worst error since it began: how far off, when, roll and pitch truly flown; °, s.
    pub worst: [f64; 4],
    /// The worst before it began, °.
    pub before_deg: f64,
    /// The worst after it was to be seen, °.
    pub after_deg: f64,
    /// Attitudes given since it began, and those within twice their standard deviations.
    pub given: [u32; 2],
    /// Scans after it was to be seen at the latest, and those that gave an attitude.
    pub late: [u32; 2],
    bank_deg: Option<f64>,
}

/// Flies `event` once for every seed from `first` on, a multiple of 6: without aiding, with it.
pub fn run(event: &Event, first: u64) -> [Vec<Outcome>; 2] {
    let mut all = [Vec::new(), Vec::new()];
    for seed in first..first + FLIGHTS {
        for (all, outcome) in all.iter_mut().zip(once(event, seed)) {
            all.push(outcome);
        }
    }
    all
}

fn once(event: &Event, seed: u64) -> [Outcome; 2] {
    let mut scenario = under(seed).lasting(event.seconds);
    if let Some(contrast_k) = event.contrast_k {
        scenario = scenario.with_contrast(contrast_k);
    }
    let fault = format!("{}@{BEGINS_S}..", Event::fill(event.fault, seed));
    let parsed = fault.parse().unwrap_or_else(|e| panic!("{fault}: {e}"));
    let source = scenario.source(1000 + seed).with_faults(vec![parsed]);
    let mut outcomes: [Outcome; 2] = std::array::from_fn(|aided| Outcome::new(seed, &fault, aided));
    fly(source, event.seconds, |aided, instant| outcomes[aided].take(event, instant));
    outcomes
}

impl Outcome {
    fn new(seed: u64, fault: &str, aided: usize) -> Self {
        Self {
            seed,
            fault: fault.to_owned(),
            aided,
            due_s: None,
            seen_s: None,
            others: BTreeMap::new(),
            worst: [0.0; 4],
            before_deg: 0.0,
            after_deg: 0.0,
            given: [0; 2],
            late: [0; 2],
            bank_deg: None,
        }
    }

    fn take(&mut self, event: &Event, now: &Instant) {
        let begun = now.time_s >= BEGINS_S;
        for name in now.names() {
            if begun && event.is_right(&name, self.seed) {
                self.seen_s.get_or_insert(now.time_s);
            } else if !(begun && event.may_be_said(&name)) {
                self.others.entry(name).or_insert((now.time_s, 0.0)).1 += 0.02;
            }
        }
        let [roll_deg, pitch_deg] = [now.truth.roll, now.truth.pitch].map(f64::to_degrees);
        if !begun {
            // A method may begin as it likes.
            if let Some(error) = now.error().filter(|_| now.time_s > 5.0) {
                self.before_deg = self.before_deg.max(error.larger_deg);
            }
            return;
        }
        let begun_deg = *self.bank_deg.get_or_insert(roll_deg);
        let due_s = match event.due {
            Due::After(seconds) => Some(BEGINS_S + seconds),
            Due::Manoeuvre => ((roll_deg - begun_deg).abs() >= 10.0).then_some(now.time_s),
        };
        self.due_s = self.due_s.or(due_s);
        if let Some(error) = now.error() {
            self.given[0] += 1;
            self.given[1] += u32::from(error.covered);
            if error.larger_deg > self.worst[0] {
                self.worst = [error.larger_deg, now.time_s, roll_deg, pitch_deg];
            }
        }
        if self.due_s.is_some_and(|due_s| now.time_s > due_s + event.within_s) {
            self.late[0] += 1;
            self.late[1] += u32::from(now.estimate.attitude.is_some());
            self.after_deg = self.after_deg.max(now.error().map_or(0.0, |e| e.larger_deg));
        }
    }

    /// How long after it was due it was seen, s; less than nothing where it was seen before.
    pub fn delay_s(&self) -> Option<f64> {
        Some(self.seen_s? - self.due_s?)
    }

    /// The share of attitudes given whose errors are within twice their standard deviations, %.
    pub fn covered_percent(&self) -> Option<f64> {
        let [given, covered] = self.given.map(f64::from);
        (given > 0.0).then(|| 100.0 * covered / given)
    }

    /// The share of scans after it was to be seen that gave an attitude, %.
    pub fn late_percent(&self) -> f64 {
        let [scans, given] = self.late.map(f64::from);
        100.0 * given / scans.max(1.0)
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { seed, fault, worst: [worst, at, roll, pitch], before_deg, after_deg, .. } = self;
        let sky = SKIES[*seed as usize % SKIES.len()];
        write!(f, "seed {seed}, {sky}, {fault}, {}: ", AIDING[self.aided])?;
        match self.delay_s() {
            Some(delay_s) => write!(f, "seen after {delay_s:.2} s")?,
            None => write!(f, "not seen")?,
        }
        write!(f, "; worst {worst:.1}° at {at:.1} s (roll {roll:.0}°, pitch {pitch:.0}°)")?;
        write!(f, ", before it began {before_deg:.1}°, after it was to be seen {after_deg:.1}°")?;
        let covered = self.covered_percent().unwrap_or(f64::NAN);
        write!(f, "; in 2σ {covered:.0} %; given afterwards {:.0} %", self.late_percent())?;
        for (name, (first_s, lasts_s)) in &self.others {
            write!(f, "; also {name} at {first_s:.1} s for {lasts_s:.1} s")?;
        }
        Ok(())
    }
}
