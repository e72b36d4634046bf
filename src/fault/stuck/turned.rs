//! How far a gyro says that the aircraft has rolled.

use crate::time::Time;

/// A roll rate is taken for so long, s.
const HELD_S: f64 = 0.5;
/// A gyro's bias adds up over this time at most, s.
const WITHIN_S: f64 = 10.0;
/// What no bias adds up to in that, °.
const FAR_DEG: f64 = 30.0;

/// The roll since all sensors are still. Pitch and yaw rates turn a steady bank as well, which leaves readings as they are.
#[derive(Clone, Copy, Debug, Default)]
pub struct Turned {
    since: Option<Time>,
    rolled_deg: f64,
    last: Option<Time>,
    rate: Option<(f64, Time)>,
}

impl Turned {
    /// Takes in a roll rate, °/s, where one came, and whether all sensors are `still`; whether it has rolled far since they are.
    pub fn rolls(&mut self, rate_deg_s: Option<f64>, still: bool, now: Time) -> bool {
        let dt_s = self.last.replace(now).map_or(0.0, |last| now.since(last).clamp(0.0, HELD_S));
        self.rate = rate_deg_s.map(|rate| (rate, now)).or(self.rate);
        if !still || self.since.is_none_or(|since| !(0.0..WITHIN_S).contains(&now.since(since))) {
            (self.since, self.rolled_deg) = (still.then_some(now), 0.0);
            return false;
        }
        if let Some((rate, _)) = self.rate.filter(|(_, at)| now.since(*at) <= HELD_S) {
            self.rolled_deg += rate * dt_s;
        }
        self.rolled_deg.abs() > FAR_DEG
    }
}
