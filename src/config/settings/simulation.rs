//! `[simulation]`: a flight through a made-up sky.

use crate::simulation::Fault;

/// A sky of the report's figure 6.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SkyName {
    /// Night, 16 °C, a clear and cold sky.
    Namibia,
    /// Afternoon, 5 °C, a humid one.
    Durham,
}

impl SkyName {
    /// Both skies with their names.
    pub const NAMED: [(&'static str, Self); 2] = [("namibia", Self::Namibia), ("durham", Self::Durham)];
}

/// What a simulated aircraft does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlightName {
    /// It flies: turns, climbs and descents in mild turbulence.
    Demo,
    /// It stands level, with a head that is mounted a little askew.
    Parked,
}

impl FlightName {
    /// Both with their names.
    pub const NAMED: [(&'static str, Self); 2] = [("demo", Self::Demo), ("parked", Self::Parked)];
}

/// `[simulation]`, present only while `enabled = true`.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulationSettings {
    /// What the aircraft does.
    pub flight: FlightName,
    /// Which sky.
    pub sky: SkyName,
    /// Noise of each sensor, K rms: 0 to 5.
    pub noise_c: f64,
    /// First-order lag of each sensor, s: 0 to 5.
    pub lag_s: f64,
    /// The seed of the noise: the same seed, the same flight.
    pub seed: u64,
    /// What goes wrong on purpose; the sensors named are there.
    pub faults: Vec<Fault>,
}
