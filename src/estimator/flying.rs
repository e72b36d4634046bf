//! What every reader of slow references shares: what flies, what was heard lately, angles the short way round.

use crate::time::Time;
use std::f64::consts::{PI, TAU};

/// Standard gravity, m/s².
pub const G_M_S2: f64 = 9.806_65;
/// What flies is faster than this, and nothing is faster than that, m/s.
pub const FLYING_M_S: std::ops::Range<f64> = 6.0..200.0;
/// What takes off is faster than the first in all that is heard, and faster than the second in some of it, or for so long, s: a
/// taxiing aircraft is not, nor is a parked one in the wind.
const TAKES_OFF_M_S: (f64, f64) = (8.0, 12.0);
const TAKES_OFF_S: f64 = 3.0;
/// What is slower than anything that flies for so long has landed, s.
const LANDED_S: f64 = 3.0;
/// A speed or course older than this is none, s.
const FRESH_S: f64 = 3.0;

/// The last value that was heard, and when.
pub type Held = Option<(f64, Time)>;

/// Takes in what is new, if anything is.
pub fn keep(held: &mut Held, new: Option<f64>, now: Time) {
    if let Some(v) = new {
        *held = Some((v, now));
    }
}

/// What was heard lately.
pub fn fresh(held: Held, now: Time) -> Option<f64> {
    held.filter(|(_, at)| (0.0..FRESH_S).contains(&now.since(*at))).map(|(v, _)| v)
}

/// Whether it flies, by its speeds: on the ground it turns without a bank.
#[derive(Clone, Copy, Debug, Default)]
pub struct Flight {
    flies: bool,
    /// Since when they have said otherwise.
    otherwise: Option<Time>,
}

impl Flight {
    /// The speeds of something that flies, m/s, of those that were heard lately: through the air and over ground.
    pub fn speeds(&mut self, heard: [Held; 2], now: Time) -> [Option<f64>; 2] {
        let heard = heard.map(|held| fresh(held, now));
        let all = || heard.into_iter().flatten();
        let (least, most) = (all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max));
        let (otherwise, lasts_s) = if self.flies {
            (most < FLYING_M_S.start && least.is_finite(), LANDED_S)
        } else {
            let fast = (TAKES_OFF_M_S.0..FLYING_M_S.end).contains(&least);
            (fast, if most > TAKES_OFF_M_S.1 { 0.0 } else { TAKES_OFF_S })
        };
        let since = *self.otherwise.get_or_insert(now);
        if !otherwise || now < since {
            self.otherwise = None;
        } else if now.since(since) >= lasts_s {
            *self = Self { flies: !self.flies, otherwise: None };
        }
        heard.map(|speed| speed.filter(|v| self.flies && FLYING_M_S.contains(v)))
    }
}

/// A speed that can be, m/s.
pub fn speed(new: Option<f64>) -> Option<f64> {
    new.filter(|v| (0.0..FLYING_M_S.end).contains(v))
}

/// An angle, rad, into (−π, π].
pub fn wrapped(angle: f64) -> f64 {
    PI - (PI - angle).rem_euclid(TAU)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// For how many of the next `seconds` what says these speeds, a second each, flies.
    fn flies(flight: &mut Flight, from_s: f64, seconds: u32, air_m_s: Option<f64>, ground_m_s: Option<f64>) -> u32 {
        let at = |s: u32| Time::from_secs_f64(from_s + f64::from(s));
        let heard = |s: u32| [air_m_s, ground_m_s].map(|v| v.map(|v| (v, at(s))));
        (0..seconds).map(|s| u32::from(flight.speeds(heard(s), at(s)).iter().any(Option::is_some))).sum()
    }

    #[test]
    fn a_taxi_and_a_parked_aircraft_in_the_wind_do_not_fly() {
        let mut flight = Flight::default();
        for (air, ground) in
            [(Some(7.9), Some(5.0)), (Some(5.0), None), (Some(14.0), Some(5.0)), (Some(11.0), Some(0.0))]
        {
            assert_eq!(flies(&mut flight, 0.0, 60, air, ground), 0, "{air:?} {ground:?}");
        }
        // Gusts of a moment.
        for s in 0..60 {
            let speed = if s % 3 == 0 { 5.0 } else { 9.0 };
            assert_eq!(flies(&mut flight, f64::from(s), 1, Some(speed), Some(speed)), 0);
        }
    }

    #[test]
    fn what_is_fast_flies_until_it_has_been_slow() {
        let mut flight = Flight::default();
        assert_eq!(flies(&mut flight, 0.0, 10, Some(9.0), None), 7, "three seconds");
        // Slow against the wind, and unheard for a while.
        assert_eq!(flies(&mut flight, 10.0, 10, Some(9.0), Some(1.0)), 10);
        assert_eq!(flies(&mut flight, 20.0, 10, None, None), 0);
        assert_eq!(flies(&mut flight, 30.0, 2, Some(7.0), None), 2);
        assert_eq!(flies(&mut flight, 32.0, 10, Some(4.0), Some(3.0)), 0);
        assert_eq!(flies(&mut flight, 42.0, 10, Some(7.0), Some(7.0)), 0, "it has landed");
        assert_eq!(flies(&mut flight, 52.0, 2, Some(18.0), Some(12.0)), 2, "at once");
        assert_eq!(flies(&mut Flight::default(), 0.0, 9, Some(300.0), Some(f64::NAN)), 0);
    }
}
