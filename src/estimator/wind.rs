//! The wind, and how far the airspeed is off: from how the ground speed comes and goes with the course.
//!
//! Over a turn the ground velocities lie on a circle: the wind is its centre, the true airspeed its radius. A filter of
//! three states follows both. Until there have been turns it knows little, and says so.

use super::flying::FLYING_M_S;
use super::linear::gain;
use crate::time::Time;

/// The wind that is expected and its walk in a second, m/s.
const WIND_M_S: (f64, f64) = (6.0, 0.1);
/// The share by which an airspeed is off, its tube and the density of the air; and the walk of that.
const AIRSPEED: (f64, f64) = (0.05, 0.0005);
/// Without an airspeed there is one speed, within this share, that the aircraft holds; and the walk of that.
const CRUISE: (f64, f64) = (0.3, 0.01);
/// How far a single comparison is off, with an airspeed and without, m/s: gusts, a fix that is late in a turn; and how long
/// that lasts, s.
const OFF_M_S: (f64, f64) = (1.0, 2.0);
const LASTS_S: f64 = 3.0;
/// Fixes farther apart are of another flight, s.
const HOLE_S: f64 = 30.0;
/// An airspeed that is off by a larger factor contradicts the ground speed.
const CONTRADICTED: f64 = 1.5;
/// How far a speed comes and goes about what is known of it, as a share: an airspeed's own noise; without one, gusts and what
/// the throttle does.
const PASSING: (f64, f64) = (0.03, 0.08);

/// A speed through the air.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Speed {
    /// m/s.
    pub m_s: f64,
    /// The share by which it may be off (1σ).
    pub share: f64,
    /// An airspeed is measured: what has a tube flies along its nose.
    pub measured: bool,
}

/// How something flies through the air.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThroughAir {
    /// How fast, m/s.
    pub m_s: f64,
    /// Where to, rad: its nose looks there.
    pub heading: f64,
    /// How far that may be off (1σ), rad.
    pub sigma: f64,
}

/// The wind's motion to north and east, m/s, and the true airspeed over the said one (without one, itself, m/s).
#[derive(Clone, Copy, Debug, Default)]
pub struct Wind {
    known: Option<Known>,
}

#[derive(Clone, Copy, Debug)]
struct Known {
    x: [f64; 3],
    p: [[f64; 3]; 3],
    at: Time,
    /// Whether there is an airspeed.
    measured: bool,
}

impl Wind {
    /// Takes in a ground speed (m/s) with a course (rad), with the climb (m/s) and the airspeed (m/s) of that time.
    pub fn hear(&mut self, (ground, course): (f64, f64), climb: f64, airspeed: Option<f64>, now: Time) {
        let measured = airspeed.is_some();
        let (share, walk) = if measured { AIRSPEED } else { (CRUISE.0 * ground, CRUISE.1 * ground) };
        let speed = (if measured { 1.0 } else { ground }, share);
        let mut known = match self.lately(now) {
            Some(known) if known.measured == measured => known,
            before => Known::begin(before, speed, measured, now),
        };
        let dt_s = now.since(known.at);
        for (i, walk) in [WIND_M_S.1, WIND_M_S.1, walk].into_iter().enumerate() {
            known.p[i][i] += walk * walk * dt_s;
        }
        known.at = now;
        known.compare((ground * course.cos(), ground * course.sin()), climb, airspeed.unwrap_or(1.0), dt_s);
        self.known = Some(known).filter(|k| k.x.iter().chain(k.p.as_flattened()).all(|v| v.is_finite()));
    }

    /// What is known of this flight.
    fn lately(&self, now: Time) -> Option<Known> {
        self.known.filter(|k| (0.0..HOLE_S).contains(&now.since(k.at)))
    }

    /// The true airspeed, where an airspeed and a ground speed (m/s) are said; `None` where they contradict each other, or
    /// there are none.
    pub fn speed(&self, airspeed: Option<f64>, ground: Option<f64>, now: Time) -> Option<Speed> {
        let (said, measured) = (airspeed.or(ground)?, airspeed.is_some());
        let known = self.lately(now).filter(|k| k.measured == measured);
        let Some(Known { x: [.., factor], p, .. }) = known else {
            return Some(Speed { m_s: said, share: if measured { AIRSPEED.0 } else { CRUISE.0 }, measured });
        };
        let (m_s, likely, passing) = if measured {
            (said * factor, 1.0 / CONTRADICTED..CONTRADICTED, PASSING.0)
        } else {
            (factor, FLYING_M_S, PASSING.1)
        };
        likely.contains(&factor).then(|| Speed { m_s, share: passing.hypot(p[2][2].sqrt() / factor), measured })
    }

    /// How it flies through the air on a ground speed (m/s) with a course (rad): the same less the wind, as far as that is known.
    pub fn through_air(&self, (ground, course): (f64, f64)) -> ThroughAir {
        let Some(known) = self.known else {
            return ThroughAir { m_s: ground, heading: course, sigma: (WIND_M_S.0 / ground).min(1.0) };
        };
        let (north, east) = (ground * course.cos() - known.x[0], ground * course.sin() - known.x[1]);
        let (speed, heading) = (north.hypot(east), east.atan2(north));
        let across = [-heading.sin(), heading.cos()];
        let variance: f64 = (0..2).map(|i| (0..2).map(|j| across[i] * known.p[i][j] * across[j]).sum::<f64>()).sum();
        ThroughAir { m_s: speed, heading, sigma: (variance.sqrt() / speed.max(1.0)).min(1.0) }
    }
}

impl Known {
    /// With the wind that was known `before`, and a speed or its factor with its σ.
    fn begin(before: Option<Self>, (speed, sigma): (f64, f64), measured: bool, now: Time) -> Self {
        let wind = WIND_M_S.0 * WIND_M_S.0;
        let anything = Self { x: [0.0; 3], p: [[wind, 0.0, 0.0], [0.0, wind, 0.0], [0.0; 3]], at: now, measured };
        let Self { x: [north, east, _], p: [[nn, ne, _], [en, ee, _], _], at, .. } = before.unwrap_or(anything);
        Self { x: [north, east, speed], p: [[nn, ne, 0.0], [en, ee, 0.0], [0.0, 0.0, sigma * sigma]], at, measured }
    }

    fn compare(&mut self, (north, east): (f64, f64), climb: f64, said: f64, dt_s: f64) {
        let (north, east) = (north - self.x[0], east - self.x[1]);
        let speed = north.hypot(east).hypot(climb).max(1.0);
        let h = [north / speed, east / speed, said];
        let ph: [f64; 3] = std::array::from_fn(|i| (0..3).map(|j| self.p[i][j] * h[j]).sum());
        let off = if self.measured { OFF_M_S.0 } else { OFF_M_S.1 };
        let noise = off * off * (2.0 * LASTS_S / dt_s.max(1e-3)).max(1.0);
        let variance = (0..3).map(|i| h[i] * ph[i]).sum::<f64>() + noise;
        let innovation = speed - self.x[2] * said;
        gain(&mut self.x, &mut self.p, 3, &ph, variance, innovation);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const AIRSPEED_M_S: f64 = 18.0;
    const BLOWS_M_S: [f64; 2] = [-4.0, 7.0];

    /// Flown for `seconds` on headings (rad) of the time (s), five fixes a second; of the airspeed `said` is said.
    fn flown(seconds: u32, heading: impl Fn(f64) -> f64, said: Option<f64>) -> (Wind, Time) {
        let (mut wind, mut now) = (Wind::default(), Time::default());
        for i in 0..5 * seconds {
            now = Time::from_secs_f64(100.0 + 0.2 * f64::from(i));
            wind.hear(track(heading(0.2 * f64::from(i))), 0.0, said.map(|share| share * AIRSPEED_M_S), now);
        }
        (wind, now)
    }

    /// The ground speed, m/s, and the course, rad, on a heading.
    fn track(heading: f64) -> (f64, f64) {
        let north = AIRSPEED_M_S * heading.cos() + BLOWS_M_S[0];
        let east = AIRSPEED_M_S * heading.sin() + BLOWS_M_S[1];
        (north.hypot(east), east.atan2(north))
    }

    /// Two turns a minute.
    fn round(time_s: f64) -> f64 {
        0.2 * time_s
    }

    #[test]
    fn turns_tell_the_wind_and_the_airspeed() {
        for said in [Some(1.0), Some(0.8), Some(1.25), None] {
            let (wind, now) = flown(120, round, said);
            let speed = wind.speed(said.map(|s| s * AIRSPEED_M_S), Some(20.0), now).unwrap();
            assert!((speed.m_s / AIRSPEED_M_S - 1.0).abs() < 0.03 && speed.share < 0.1, "{said:?}: {speed:?}");
            let Known { x: [north, east, _], .. } = wind.known.unwrap();
            assert!((north - BLOWS_M_S[0]).hypot(east - BLOWS_M_S[1]) < 0.7, "{said:?}: {north}, {east}");
            for heading in [0.0, 1.0, 2.5, -2.0] {
                let ThroughAir { heading: found, sigma, .. } = wind.through_air(track(heading));
                assert!((found - heading).abs() < 0.04 && sigma < 0.1, "{said:?} on {heading}: {found} +- {sigma}");
            }
        }
    }

    #[test]
    fn straight_on_nothing_is_told_and_nothing_pretended() {
        for said in [Some(1.0), Some(0.93), None] {
            let (wind, now) = flown(120, |_| 1.0, said);
            let speed = wind.speed(said.map(|s| s * AIRSPEED_M_S), Some(20.0), now).unwrap();
            let ThroughAir { heading, sigma, .. } = wind.through_air(track(1.0));
            assert!((heading - 1.0).abs() < 2.0 * sigma && sigma > 0.1, "{said:?}: {heading} +- {sigma}");
            assert!((speed.m_s - AIRSPEED_M_S).abs() < 2.0 * speed.share * AIRSPEED_M_S, "{said:?}: {speed:?}");
        }
    }

    /// In km/h, one or the other: nobody knows which.
    #[test]
    fn where_they_contradict_each_other_none_is_believed() {
        for said in [3.6, 1.0 / 3.6] {
            let (wind, now) = flown(120, round, Some(said));
            assert_eq!(wind.speed(Some(said * AIRSPEED_M_S), Some(20.0), now), None);
        }
    }

    #[test]
    fn before_and_long_after_a_fix_each_stands_for_itself() {
        let (wind, now) = flown(120, round, Some(0.8));
        let later = Time::from_secs_f64(now.as_secs_f64() + 60.0);
        for (wind, now) in [(Wind::default(), now), (wind, later)] {
            assert_eq!(wind.speed(Some(18.0), Some(25.0), now).map(|s| s.m_s), Some(18.0));
            assert_eq!(wind.speed(None, Some(25.0), now).map(|s| s.m_s), Some(25.0));
            assert_eq!(wind.speed(None, None, now), None);
        }
        // An airspeed that goes away leaves what is known of the wind.
        let mut wind = wind;
        wind.hear(track(0.3), 0.0, None, now);
        let Known { x: [north, east, speed], .. } = wind.known.unwrap();
        assert!((north - BLOWS_M_S[0]).hypot(east - BLOWS_M_S[1]) < 0.7 && speed > 15.0);
    }

    proptest! {
        /// Whatever flies: within what the readers let through.
        #[test]
        fn what_is_said_is_a_speed(fixes in proptest::collection::vec(
            (6.0_f64..200.0, -6.3_f64..6.3, -1e3_f64..1e3, proptest::option::of(6.0_f64..200.0), -1.0_f64..40.0), 1..60)) {
            let (mut wind, mut time_s) = (Wind::default(), 1e3);
            for (ground, course, climb, airspeed, dt_s) in fixes {
                time_s += dt_s;
                let now = Time::from_secs_f64(time_s);
                wind.hear((ground, course), climb, airspeed, now);
                let ThroughAir { heading, sigma, .. } = wind.through_air((ground, course));
                prop_assert!(heading.is_finite() && (0.0..=1.0).contains(&sigma));
                if let Some(Speed { m_s, share, .. }) = wind.speed(airspeed, Some(ground), now) {
                    prop_assert!((4.0..=300.0).contains(&m_s) && share > 0.0 && share.is_finite(), "{m_s} +- {share}");
                }
            }
        }
    }
}
