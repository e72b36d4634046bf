//! Faults that are made on purpose: sensors that lie, weather and terrain in the way.
//!
//! - [`kind`]: what can go wrong, with strength, default and pace.
//! - [`parse`]: faults as they are written, `KIND=STRENGTH:WHO@FROM..TO`.
//! - `sensors`: what they do to a sensor.
//! - `surroundings`: what they do to weather and terrain.

pub mod kind;
pub mod parse;
pub(super) mod sensors;
pub(super) mod surroundings;

pub use kind::Kind;
pub use parse::FaultError;

use std::fmt;

/// Whom or what a fault befalls.
#[derive(Clone, Debug, PartialEq)]
pub enum Who {
    /// Everything there is: the weather.
    World,
    /// Every sensor.
    All,
    /// The sensor of this name.
    Sensor(String),
    /// An azimuth, ° clockwise from north.
    Azimuth(f64),
    /// The side of the left wing as the heading is when the fault begins.
    Left,
    /// The side of the right wing then.
    Right,
}

/// Something that goes wrong for a while.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// What.
    pub kind: Kind,
    /// How strong, in the kind's unit; 0 for a kind that has no strength.
    pub strength: f64,
    /// For whom.
    pub who: Who,
    /// When it begins, seconds since the flight began.
    pub from_s: f64,
    /// When it ends; infinite: never.
    pub to_s: f64,
}

impl Fault {
    /// How much of it there is at `time_s`, 0..1: it comes in the kind's pace from its beginning and
    /// goes in the same from its end.
    pub fn share(&self, time_s: f64) -> f64 {
        let pace_s = self.kind.about().pace_s;
        if pace_s <= 0.0 {
            return f64::from((self.from_s..self.to_s).contains(&time_s));
        }
        let come = ((time_s.min(self.to_s) - self.from_s) / pace_s).clamp(0.0, 1.0);
        (come - (time_s - self.to_s).max(0.0) / pace_s).max(0.0)
    }

    /// Whether it befalls the sensor called `name`.
    fn befalls(&self, name: &str) -> bool {
        match &self.who {
            Who::All => true,
            Who::Sensor(who) => who == name,
            // Rain falls on every sensor.
            Who::World => self.kind == Kind::Rain,
            Who::Azimuth(_) | Who::Left | Who::Right => false,
        }
    }
}

/// As it is written; reading that gives the same fault.
impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let about = self.kind.about();
        f.write_str(about.name)?;
        if about.strength.is_some() {
            write!(f, "={}", self.strength)?;
        }
        match &self.who {
            Who::World => {}
            Who::All => f.write_str(":all")?,
            Who::Sensor(name) => write!(f, ":{name}")?,
            Who::Azimuth(azimuth_deg) => write!(f, ":{azimuth_deg}")?,
            Who::Left => f.write_str(":left")?,
            Who::Right => f.write_str(":right")?,
        }
        write!(f, "@{}..", self.from_s)?;
        if self.to_s.is_finite() { write!(f, "{}", self.to_s) } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fault_comes_in_its_pace_and_goes_in_the_same() {
        let wet = |to_s| Fault { kind: Kind::Wet, strength: 90.0, who: Who::All, from_s: 10.0, to_s };
        let at = |to_s, time_s| wet(to_s).share(time_s);
        for (time_s, share) in
            [(9.9, 0.0), (10.0, 0.0), (11.5, 0.5), (13.0, 1.0), (20.0, 1.0), (21.5, 0.5), (23.1, 0.0)]
        {
            assert!((at(20.0, time_s) - share).abs() < 1e-12, "{time_s} s");
        }
        // One that ends before it has come whole goes from where it was.
        assert!((at(11.5, 12.25) - 0.25).abs() < 1e-12 && at(11.5, 13.0) == 0.0);
        assert_eq!(at(f64::INFINITY, 1e9), 1.0);
        let off = Fault { kind: Kind::Off, ..wet(20.0) };
        assert_eq!([9.99, 10.0, 19.99, 20.0].map(|t| off.share(t)), [0.0, 1.0, 1.0, 0.0]);
        assert_eq!(Fault { from_s: f64::NAN, ..wet(20.0) }.share(12.0), 0.0);
    }
}
