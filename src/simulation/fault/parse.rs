//! Faults as they are written: `KIND=STRENGTH:WHO@FROM..TO`.

use super::kind::{About, Kind, Strength, Target};
use super::{Fault, Who};
use crate::config::{nearest, quoted};
use std::str::FromStr;
use thiserror::Error;

/// The latest that a fault can begin or end, s.
const LATEST_S: f64 = 1e9;

/// What is wrong with a fault, and what would be right.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum FaultError {
    /// There is no `@`.
    #[error("\"{0}\" does not say when: append @FROM..TO in seconds, as in off:nose@10..20 (TO left out: to the end)")]
    NoTime(String),
    /// What follows `@` is no stretch of time.
    #[error(
        "\"{said}\" is no stretch of time: FROM..TO in seconds since the flight began, FROM 0 or more and TO later, as \
         in {example}"
    )]
    Time {
        /// What was said.
        said: String,
        /// What was probably meant.
        example: String,
    },
    /// It begins when all is over.
    #[error("{fault} begins when the flight of {seconds} s is over: let it begin earlier, or fly longer (--seconds)")]
    TooLate {
        /// The fault.
        fault: String,
        /// How long the flight is, s.
        seconds: f64,
    },
    /// There is no such kind.
    #[error("{kind} is no kind of fault; {advice}")]
    Kind {
        /// What was said.
        kind: String,
        /// What was probably meant, or what there is.
        advice: String,
    },
    /// A strength for a kind that has none.
    #[error("{0} has no strength: leave out the = and what follows it")]
    NoStrength(&'static str),
    /// A strength that cannot be.
    #[error("{strength} is no strength of {kind}: {range}")]
    Strength {
        /// What was said.
        strength: String,
        /// Of which kind.
        kind: &'static str,
        /// What it can be.
        range: String,
    },
    /// Nobody is named, or somebody for a kind that befalls everyone, or no side of the sky.
    #[error("{kind} befalls {whom}, as in {example}{said}")]
    Who {
        /// Of which kind.
        kind: &'static str,
        /// Whom it can befall.
        whom: &'static str,
        /// One that would be right.
        example: String,
        /// What was said instead.
        said: String,
    },
    /// There is no such sensor.
    #[error("there is no sensor {name}; {advice}")]
    Sensor {
        /// What was said.
        name: String,
        /// What was probably meant, or what there is.
        advice: String,
    },
}

impl FromStr for Fault {
    type Err = FaultError;

    fn from_str(text: &str) -> Result<Self, FaultError> {
        let (what, when) = text.split_once('@').ok_or_else(|| FaultError::NoTime(quoted(text)))?;
        let (what, who) = what.split_once(':').map_or((what, None), |(what, who)| (what, Some(who)));
        let (name, strength) = what.split_once('=').map_or((what, None), |(name, value)| (name, Some(value)));
        let about = Kind::ALL.into_iter().find(|a| a.name == name).ok_or_else(|| FaultError::Kind {
            kind: if name.is_empty() { "nothing".into() } else { quoted(name) },
            advice: advice(name, &Kind::ALL.map(|a| a.name)),
        })?;
        let strength = read_strength(strength, &about)?;
        let who = read_who(who, &about)?;
        let (from_s, to_s) = stretch(when).ok_or_else(|| no_stretch(when))?;
        Ok(Self { kind: about.kind, strength, who, from_s, to_s })
    }
}

impl Fault {
    /// Whether the sensor that it befalls is one of those `names`.
    pub fn check(&self, names: &[&str]) -> Result<(), FaultError> {
        match &self.who {
            Who::Sensor(name) if !names.contains(&name.as_str()) => {
                Err(FaultError::Sensor { name: quoted(name), advice: advice(name, names) })
            }
            _ => Ok(()),
        }
    }

    /// Whether it begins within a flight of so many `seconds`.
    pub fn check_time(&self, seconds: f64) -> Result<(), FaultError> {
        if self.from_s < seconds { Ok(()) } else { Err(FaultError::TooLate { fault: self.to_string(), seconds }) }
    }
}

fn advice(word: &str, words: &[&str]) -> String {
    match nearest(word, words.iter().copied()) {
        Some(near) => format!("did you mean {near}?"),
        None => format!("there are {}", words.join(", ")),
    }
}

fn read_strength(text: Option<&str>, about: &About) -> Result<f64, FaultError> {
    match (text, about.strength) {
        (None, strength) => Ok(strength.map_or(0.0, |s| s.usual)),
        (Some(_), None) => Err(FaultError::NoStrength(about.name)),
        (Some(text), Some(Strength { unit, least, most, .. })) => {
            text.parse().ok().filter(|v| (least..=most).contains(v)).ok_or_else(|| FaultError::Strength {
                strength: quoted(text),
                kind: about.name,
                range: format!("{least} to {most} {unit}, as a number alone"),
            })
        }
    }
}

fn read_who(text: Option<&str>, about: &About) -> Result<Who, FaultError> {
    let who = match (about.target, text) {
        (Target::World, None) => Some(Who::World),
        (Target::Sensor, Some("all")) => Some(Who::All),
        (Target::Sensor, Some(name)) if !name.is_empty() => Some(Who::Sensor(name.to_owned())),
        (Target::Side, Some("left")) => Some(Who::Left),
        (Target::Side, Some("right")) => Some(Who::Right),
        (Target::Side, Some(text)) => text.parse().ok().filter(|deg| (-360.0..=360.0).contains(deg)).map(Who::Azimuth),
        _ => None,
    };
    who.ok_or_else(|| FaultError::Who {
        kind: about.name,
        whom: match about.target {
            Target::World => "the whole scene and takes no name",
            Target::Sensor => "a sensor by its name, or all",
            Target::Side => "a side: left, right, or ° clockwise from north",
        },
        example: about.kind.example(),
        said: text.map_or(String::new(), |text| format!("; {} is none", quoted(text))),
    })
}

/// A moment alone was probably meant to go on to the end.
fn no_stretch(text: &str) -> FaultError {
    let example = if seconds(text).is_some() { format!("{text}..") } else { "10..20".to_owned() };
    FaultError::Time { said: quoted(text), example }
}

fn seconds(text: &str) -> Option<f64> {
    text.parse().ok().filter(|s| (0.0..=LATEST_S).contains(s))
}

fn stretch(text: &str) -> Option<(f64, f64)> {
    let (from, to) = text.split_once("..")?;
    let from_s = seconds(from)?;
    let to_s = if to.is_empty() { f64::INFINITY } else { seconds(to)? };
    (from_s < to_s).then_some((from_s, to_s))
}
