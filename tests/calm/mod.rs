//! A simulation that leaves nothing to chance.

use irhorizon::config::settings::{FlightName, SimulationSettings, SkyName};

/// Clear, without noise or lag.
pub const CALM: SimulationSettings = SimulationSettings {
    flight: FlightName::Demo,
    sky: SkyName::Namibia,
    noise_c: 0.0,
    lag_s: 0.0,
    seed: 1,
    faults: Vec::new(),
};
