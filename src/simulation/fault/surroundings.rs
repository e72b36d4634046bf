//! What faults do to weather and terrain.

use super::{Fault, Kind, Who};
use crate::simulation::script::Weather;
use crate::simulation::straight::Straight;

/// How a head sees the sky: K for a kelvin of `SkyMax`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// A vertical pair's contrast.
    pub contrast: f64,
    /// How much colder than the ground a sensor that looks straight up is.
    pub up: f64,
}

/// The weather as the faults make it. Hail cools the ground so that what looks straight up sees as
/// much as before.
pub fn weather(faults: &[Fault], mut weather: Weather, seen: Seen) -> Weather {
    for fault in faults {
        let share = fault.share(weather.time_s);
        let before_k = weather.sky_max_k;
        let contrast_k = match fault.kind {
            Kind::Hail => -fault.strength,
            Kind::Fog => fault.strength,
            Kind::Rain => fault.strength / 100.0 * before_k * seen.contrast,
            _ => continue,
        };
        weather.sky_max_k += share * (contrast_k / seen.contrast - before_k);
        if fault.kind == Kind::Hail {
            weather.ground_c -= (before_k - weather.sky_max_k) * seen.up;
        }
    }
    weather
}

/// What stands beside the flight at `time_s`; `heading` gives the yaw at a time, rad.
pub fn beside(faults: &[Fault], time_s: f64, heading: impl Fn(f64) -> f64) -> impl Iterator<Item = Straight> {
    faults.iter().flat_map(move |fault| {
        let share = fault.share(time_s);
        let quarter = std::f64::consts::FRAC_PI_2;
        let azimuth = match fault.who {
            Who::Azimuth(azimuth_deg) => azimuth_deg.to_radians(),
            Who::Left => heading(fault.from_s) - quarter,
            Who::Right => heading(fault.from_s) + quarter,
            Who::World | Who::All | Who::Sensor(_) => 0.0,
        };
        let ridge = |azimuth| Straight::ridge(azimuth, share * fault.strength);
        let made = match fault.kind {
            Kind::Ridge => [Some(ridge(azimuth)), None],
            Kind::Valley => [Some(ridge(azimuth)), Some(ridge(azimuth + 2.0 * quarter))],
            Kind::Cloud => [Some(Straight::cloud(azimuth, fault.strength, share)), None],
            _ => [None, None],
        };
        made.into_iter().flatten().filter(move |_| share > 0.0)
    })
}
