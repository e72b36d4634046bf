//! A flight without aiding and with rates and GPS, under one of six even skies.

use super::heard::{self, Instant};
use irhorizon::attitude::Attitude;
use irhorizon::frame::Aiding;
use irhorizon::simulation::{Scenario, SimulatedSource};

/// The skies, by the names of the scenarios.
pub const SKIES: [&str; 6] = ["clear-dry", "clear-humid", "namibia", "durham", "overcast", "radiance"];
/// How the instruments are heard: not at all, and with rates and GPS.
pub const AIDING: [&str; 2] = ["without aiding", "with rates and GPS"];
/// Scans a second.
const RATE_HZ: f64 = 50.0;

/// The scenario of the sky number `i`.
pub fn under(i: u64) -> Scenario {
    let name = SKIES[i as usize % SKIES.len()];
    Scenario::named(name).unwrap_or_else(|| panic!("no scenario {name}"))
}

/// How far off an attitude is.
#[derive(Clone, Copy, Debug)]
pub struct Error {
    /// The larger of those of roll and pitch, °.
    pub larger_deg: f64,
    /// Whether both are within twice their standard deviations.
    pub covered: bool,
}

/// Flies for `seconds` at 50 Hz; `look` is called with 0 for what is said without aiding, 1 with rates and GPS.
pub fn fly(source: SimulatedSource, seconds: f64, look: impl FnMut(usize, &Instant)) {
    heard::fly(source, (seconds, RATE_HZ), [|_| Aiding::default(), |all| all], look);
}

impl Instant<'_> {
    /// What is wrong with the attitude, if a new one is given.
    pub fn error(&self) -> Option<Error> {
        self.given.map(|(said, truth)| Error::new(said, self.estimate.sigma, truth))
    }
}

impl Error {
    fn new(said: Attitude, sigma: Attitude, truth: Attitude) -> Self {
        let turned = |a: f64| (a + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI;
        let [roll, pitch] = [turned(said.roll - truth.roll).abs(), (said.pitch - truth.pitch).abs()];
        let covered = roll <= 2.0 * sigma.roll && pitch <= 2.0 * sigma.pitch;
        Self { larger_deg: roll.max(pitch).to_degrees(), covered }
    }
}
