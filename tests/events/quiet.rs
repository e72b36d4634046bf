//! Flights in which nothing goes wrong: nothing may be said.

use super::flown::{AIDING, SKIES, fly, under};
use irhorizon::simulation::aerobatics::{aerobatics, rolls};
use irhorizon::simulation::aircraft::Aircraft;
use irhorizon::simulation::manoeuvre::{Random, Style};
use irhorizon::simulation::trajectory::Trajectory;
use irhorizon::simulation::{Flight, SimulatedSource};
use std::collections::BTreeMap;

/// What was said without a cause.
#[derive(Clone, Debug)]
pub struct Alarm {
    /// In which flight, heard how.
    pub flight: String,
    /// What.
    pub name: String,
    /// First, and for how long in all, s.
    pub first_s: f64,
    /// For how long in all, s.
    pub lasts_s: f64,
    /// Roll and pitch truly flown then, °.
    pub flown_deg: [f64; 2],
}

/// 30 flights of 120 s: under each of the six skies three in turbulence with turns of 60°, one with loops and rolls of
/// all kinds, one with rolls and inverted flight. `first`, a multiple of 6, chooses chance.
pub fn lively(first: u64) -> (u32, Vec<Alarm>) {
    let mut alarms = Vec::new();
    for flight in first..first + 30 {
        let (name, style) = match (flight - first) / 6 {
            0 => ("aerobatics", Style::Scripted(aerobatics())),
            1 => ("rolls", Style::Scripted(rolls())),
            _ => ("turns", Style::Random(Random { bank_deg: 60.0, ..Random::default() })),
        };
        let source = flown(flight, &style, Aircraft::default(), 120.0, 0.08);
        alarms.extend(listen(&format!("{name} {flight}, {}", sky(flight)), source, 120.0));
    }
    (30, alarms)
}

/// Ten minutes straight ahead in calm air under each of the six skies, every other with so little noise that a
/// reading's step of 0.02 K shows.
pub fn straight(first: u64) -> (u32, Vec<Alarm>) {
    let calm = Aircraft { airspeed_rms_m_s: 0.0, updraught_m_s: 0.0, ..Aircraft::default() };
    let mut alarms = Vec::new();
    for flight in first..first + 6 {
        let noise_k = if flight % 2 == 0 { 0.08 } else { 0.005 };
        let style = Style::Scripted(Flight::steady(0.0, 2.5).with_turbulence(0.3, 0.1, flight));
        let source = flown(flight, &style, calm, 600.0, noise_k);
        alarms.extend(listen(&format!("straight {flight}, {}, noise {noise_k} K", sky(flight)), source, 600.0));
    }
    (6, alarms)
}

fn sky(flight: u64) -> &'static str {
    SKIES[flight as usize % SKIES.len()]
}

fn flown(flight: u64, style: &Style, aircraft: Aircraft, seconds: f64, noise_k: f64) -> SimulatedSource {
    let trajectory = Trajectory::fly(&aircraft, style, seconds + 1.0, 2000 + flight);
    under(flight).lasting(1.0).with_noise(noise_k).source(3000 + flight).with_trajectory(trajectory)
}

fn listen(flight: &str, source: SimulatedSource, seconds: f64) -> Vec<Alarm> {
    let mut said: BTreeMap<(usize, String), Alarm> = BTreeMap::new();
    fly(source, seconds, |aided, now| {
        for name in now.names() {
            let alarm = said.entry((aided, name.clone())).or_insert_with(|| Alarm {
                flight: format!("{flight}, {}", AIDING[aided]),
                name,
                first_s: now.time_s,
                lasts_s: 0.0,
                flown_deg: [now.truth.roll, now.truth.pitch].map(|a| a.to_degrees().round() + 0.0),
            });
            alarm.lasts_s += 0.02;
        }
    });
    said.into_values().collect()
}

impl std::fmt::Display for Alarm {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { flight, name, first_s, lasts_s, flown_deg: [roll, pitch] } = self;
        write!(f, "{flight}: {name} at {first_s:.1} s for {lasts_s:.1} s (roll {roll}°, pitch {pitch}°)")
    }
}
