//! What GPS and airspeed say of the attitude: the bank of a coordinated turn, the angle of climb, the heading.

use crate::estimator::flying::{Flight, G_M_S2, Held, fresh, keep, speed, wrapped};
use crate::estimator::wind::{Speed, ThroughAir, Wind};
use crate::frame::Aiding;
use crate::time::Time;
use std::f64::consts::PI;

/// The shortest and longest time over which a change of course is a rate; the longest from one climb
/// rate to the next, too. s.
const SHORTEST_S: f64 = 0.5;
const LONGEST_S: f64 = 2.5;
/// The steepest bank that is compared: beyond it turns are seldom level or steady, rad.
pub const STEEPEST: f64 = PI / 4.0;
/// What turns faster than a bank of this does is no turn but a course that jumps, rad (75°).
const JUMPS: f64 = PI / 2.4;

/// How far a single bank is off: sideslip, gusts, a turn that begins or ends (rad), and, as a share of
/// it, wind that is not known, which lets a turn look wider.
const BANK_SIGMA: f64 = 8_f64.to_radians();
const BANK_SHARE: f64 = 0.2;
/// How far a single angle of climb is off: the angle of attack that comes and goes (rad), and air that
/// rises and sinks (m/s).
const ATTACK_SIGMA: f64 = 2_f64.to_radians();
const UPDRAUGHT_M_S: f64 = 1.0;

/// The share of a climb that may be the air's own rising: a glider circles in it for minutes.
pub const AIR_SHARE: f64 = 0.5;

/// A reference's error lasts so long, s: within it, more of them say no more.
pub const CORRELATION_S: f64 = 2.0;
/// Where they are weighed one by one, what stays counts as another error after so long, s: longer, and less is learnt of a
/// horizon that leans.
const STAYS_S: f64 = 5.0;

/// An angle that a reference gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Angle {
    /// The angle, rad.
    pub angle: f64,
    /// How far it may be off by itself (1σ), rad.
    pub sigma: f64,
    /// How far beside that for as long as the same is flown, rad.
    pub stays: f64,
    /// The time for which it stands, s.
    pub span_s: f64,
}

impl Angle {
    /// What it weighs beside others that are flown otherwise, 1/rad².
    pub fn weight(&self) -> f64 {
        self.span_s / (CORRELATION_S * self.sigma.powi(2))
    }

    /// What it weighs where the same is flown for long, 1/rad².
    pub fn weight_of_same(&self) -> f64 {
        self.span_s / (CORRELATION_S * self.sigma_by(CORRELATION_S).powi(2))
    }

    /// How far it would be off (1σ, rad) were all of its error another one after `lasts_s`, to say as little.
    pub fn sigma_by(&self, lasts_s: f64) -> f64 {
        self.sigma.hypot(self.stays * (STAYS_S / lasts_s).sqrt())
    }
}

/// What came with a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Heard {
    /// The bank of a coordinated turn, and the mean of the estimated roll over the time of that turn, rad.
    pub bank: Option<(Angle, f64)>,
    /// The angle of climb now.
    pub climb: Option<Angle>,
    /// The course, rad; `None` while there is none.
    pub course: Option<f64>,
    /// How it flies through the air by a new fix.
    pub air: Option<ThroughAir>,
    /// The true airspeed of something that flies; `None` while nothing tells it.
    pub speed: Option<Speed>,
}

impl Heard {
    /// The bank and the estimated roll where neither is steep.
    pub fn gentle_bank(&self) -> Option<(Angle, f64)> {
        self.bank.filter(|(bank, roll)| bank.angle.abs().max(roll.abs()) < STEEPEST)
    }
}

/// From one fix to the next, with the estimated roll in between.
#[derive(Clone, Copy, Debug)]
struct Leg {
    /// Ground speed, m/s, and course, rad.
    fix: (f64, f64),
    began: Time,
    roll: (f64, Time),
    /// The integral of roll, rad·s.
    area: f64,
}

/// The references, as they come.
#[derive(Clone, Debug, Default)]
pub struct References {
    airspeed: Held,
    ground_speed: Held,
    flight: Flight,
    course: Held,
    wind: Wind,
    climbed: Option<Time>,
    leg: Option<Leg>,
}

impl References {
    /// Takes in what came with a frame for which `roll` (rad) was estimated. Values that cannot be are
    /// not heard.
    pub fn hear(&mut self, aiding: &Aiding, roll: f64, now: Time) -> Heard {
        let course = aiding.course_deg.filter(|c| c.abs() <= 360.0).map(f64::to_radians);
        keep(&mut self.airspeed, speed(aiding.airspeed_m_s), now);
        keep(&mut self.ground_speed, speed(aiding.ground_speed_m_s), now);
        keep(&mut self.course, course, now);
        let [airspeed, ground_speed] = self.flight.speeds([self.airspeed, self.ground_speed], now);
        if let Some(fix) = ground_speed.zip(course) {
            self.wind.hear(fix, aiding.climb_m_s.unwrap_or(0.0), airspeed, now);
        }
        let speed = self.wind.speed(airspeed, ground_speed, now);
        // A ground speed that the airspeed contradicts is none.
        let ground_speed = ground_speed.filter(|_| speed.is_some());
        Heard {
            bank: self.bank(ground_speed, course, roll, now),
            climb: self.climb(aiding.climb_m_s, speed, now),
            course: fresh(self.course, now),
            air: ground_speed.zip(course).map(|fix| self.wind.through_air(fix)),
            speed,
        }
    }

    fn climb(&mut self, climb_m_s: Option<f64>, speed: Option<Speed>, now: Time) -> Option<Angle> {
        let (climb, Speed { m_s: speed, share, .. }) = (climb_m_s?, speed?);
        let span_s = now.since(self.climbed.replace(now)?);
        // Steeper than 30° is no flight over minutes.
        let usable = climb.abs() <= 0.5 * speed && span_s > 0.0 && span_s <= LONGEST_S;
        let angle = (climb / speed).asin();
        let sigma = ATTACK_SIGMA.hypot(UPDRAUGHT_M_S / speed).hypot(share * angle);
        usable.then_some(Angle { angle, sigma, stays: AIR_SHARE * angle.abs(), span_s })
    }

    /// What turns through the air is banked: over ground, against the wind, a turn looks tighter than it is and slower.
    fn bank(&mut self, ground: Option<f64>, course: Option<f64>, roll: f64, now: Time) -> Option<(Angle, f64)> {
        let Some(ground) = ground else {
            self.leg = None;
            return None;
        };
        if let Some(leg) = &mut self.leg {
            let (before, at) = leg.roll;
            // On the back roll goes on past ±180°: the mean of 170° and −170° is no level flight.
            let roll = before + wrapped(roll - before);
            leg.area += 0.5 * (before + roll) * now.since(at);
            leg.roll = (roll, now);
        }
        let span_s = self.leg.map_or(0.0, |leg| now.since(leg.began));
        if !(0.0..=LONGEST_S).contains(&span_s) {
            self.leg = None;
        }
        let fix = (ground, course?);
        let leg = self.leg.filter(|_| span_s >= SHORTEST_S);
        if leg.is_some() || self.leg.is_none() {
            self.leg = Some(Leg { fix, began: now, roll: (roll, now), area: 0.0 });
        }
        let leg = leg?;
        // Both by what is known of the wind now: what is learnt of it meanwhile is no turn.
        let [from, to] = [leg.fix, fix].map(|fix| self.wind.through_air(fix));
        let turned = 0.5 * (from.m_s + to.m_s) * wrapped(to.heading - from.heading);
        let bank = (turned / span_s / G_M_S2).atan();
        let share = BANK_SHARE.hypot(1.0 - to.sigma.cos());
        let angle = Angle { angle: bank, sigma: BANK_SIGMA.hypot(share * bank), stays: 0.0, span_s };
        let roll = leg.area / span_s;
        (bank.abs() < JUMPS).then_some((angle, roll))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each fix a second after the last: course, ground speed, climb.
    fn heard(fixes: &[(f64, f64, f64)]) -> Vec<Heard> {
        let mut references = References::default();
        let hear = |(i, fix): (usize, &(f64, f64, f64))| {
            let aiding = Aiding {
                course_deg: Some(fix.0),
                ground_speed_m_s: Some(fix.1),
                climb_m_s: Some(fix.2),
                ..Aiding::default()
            };
            references.hear(&aiding, 0.1 * i as f64, Time::from_secs_f64(10.0 + i as f64))
        };
        fixes.iter().enumerate().map(hear).collect()
    }

    #[test]
    fn a_turn_through_north_has_its_bank_and_the_roll_of_the_same_time() {
        let said = heard(&[(350.0, 18.0, 0.0), (0.0, 18.0, 0.0), (10.0, 18.0, 0.0)]);
        assert_eq!(said[0].bank, None);
        for (h, roll) in said[1..].iter().zip([0.05, 0.15]) {
            let (bank, mean) = h.bank.unwrap();
            // tan φ = V·ω/g.
            assert!((bank.angle.tan() - 18.0 * 10_f64.to_radians() / 9.80665).abs() < 1e-9);
            assert!((mean - roll).abs() < 1e-9 && bank.span_s == 1.0);
        }
        let left = heard(&[(10.0, 18.0, 0.0), (355.0, 18.0, 0.0)]);
        assert!(left[1].bank.unwrap().0.angle < 0.0);
    }

    /// Over ground the circles of a thermal are no circles: with ground speed and course alone 35° were 29.5°, and were learnt as
    /// the head's trim.
    #[test]
    fn a_bank_in_wind_is_that_through_the_air() {
        let (speed, bank, wind): (f64, f64, [f64; 2]) = (12.0, 35_f64.to_radians(), [6.0, -8.0]);
        let rate = G_M_S2 * bank.tan() / speed;
        for airspeed_m_s in [None, Some(speed)] {
            let (mut references, mut said) = (References::default(), Vec::new());
            for i in 0..5 * 120 {
                let time_s = 0.2 * f64::from(i);
                let heading = rate * time_s;
                let (north, east) = (speed * heading.cos() + wind[0], speed * heading.sin() + wind[1]);
                let aiding = Aiding {
                    course_deg: Some(east.atan2(north).to_degrees()),
                    ground_speed_m_s: Some(north.hypot(east)),
                    airspeed_m_s,
                    ..Aiding::default()
                };
                let heard = references.hear(&aiding, bank, Time::from_secs_f64(10.0 + time_s));
                said.extend(heard.bank.filter(|_| time_s > 30.0).map(|(bank, _)| bank.angle.to_degrees()));
            }
            let mean = said.iter().sum::<f64>() / said.len() as f64;
            assert!(said.len() > 50 && (mean - 35.0).abs() < 1.0, "{airspeed_m_s:?}: {mean} of {}", said.len());
        }
    }

    #[test]
    fn the_climb_is_on_the_airspeed_where_there_is_one() {
        let mut references = References::default();
        let mut aiding = Aiding { ground_speed_m_s: Some(10.0), climb_m_s: Some(2.0), ..Aiding::default() };
        for s in 0..5 {
            let said = references.hear(&aiding, 0.0, Time::from_secs_f64(f64::from(s)));
            assert_eq!(said.climb.is_some(), s == 4, "{s} s: it may be taxiing, then stands for no time");
        }
        let on = references.hear(&aiding, 0.0, Time::from_secs_f64(5.0)).climb.unwrap();
        assert!((on.angle.sin() - 0.2).abs() < 1e-9 && on.span_s == 1.0);
        aiding.airspeed_m_s = Some(20.0);
        let on = references.hear(&aiding, 0.0, Time::from_secs_f64(6.0)).climb.unwrap();
        assert!((on.angle.sin() - 0.1).abs() < 1e-9 && (on.stays - 0.5 * on.angle).abs() < 1e-9);
        assert!((3.0..5.0).contains(&on.sigma.to_degrees()));
    }

    #[test]
    fn what_cannot_be_says_nothing() {
        let nothing = [(f64::NAN, 18.0, f64::NAN), (1e300, 18.0, f64::INFINITY), (0.0, f64::NAN, 1e300)];
        assert!(heard(&nothing).iter().all(|h| h.bank.is_none() && h.climb.is_none()));
        // On the ground; a course that jumps; a climb that no aircraft has.
        for fixes in [[(0.0, 2.0, 1.0); 2], [(0.0, 18.0, 12.0), (170.0, 18.0, 12.0)]].map(|f| heard(&f)) {
            assert!(fixes.iter().all(|h| h.bank.is_none() && h.climb.is_none()), "{fixes:?}");
        }
    }

    #[test]
    fn a_hole_or_a_step_of_time_begins_anew() {
        let aiding =
            Aiding { course_deg: Some(5.0), ground_speed_m_s: Some(18.0), climb_m_s: Some(0.0), ..Aiding::default() };
        let mut references = References::default();
        for (now_s, speaks) in [(10.0, false), (11.0, true), (15.0, false), (16.0, true), (3.0, false), (4.0, true)] {
            let heard = references.hear(&aiding, 0.0, Time::from_secs_f64(now_s));
            assert_eq!((heard.bank.is_some(), heard.climb.is_some()), (speaks, speaks), "{now_s}");
        }
    }

    /// Straight on, rolling to and fro about the back.
    #[test]
    fn on_the_back_the_mean_of_roll_is_not_level() {
        let mut references = References::default();
        let mut means = 0;
        for i in 0..1000 {
            let t = 0.02 * f64::from(i);
            let fix = |v: f64| (i % 50 == 0).then_some(v);
            let aiding = Aiding { course_deg: fix(90.0), ground_speed_m_s: fix(18.0), ..Aiding::default() };
            let roll = wrapped(PI + 0.1 * (2.0 * t).sin());
            let Some((_, mean)) = references.hear(&aiding, roll, Time::from_secs_f64(10.0 + t)).bank else { continue };
            means += 1;
            assert!((mean.abs() - PI).abs() < 0.11, "{t} s: {}°", mean.to_degrees());
        }
        assert!(means > 15, "{means}");
    }
}
