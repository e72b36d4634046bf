//! What can go wrong in a simulated flight.

/// A kind of fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// No reading.
    Off,
    /// The reading that it gave when the fault began, again and again.
    Stuck,
    /// Anything that the sensor can say.
    Garbage,
    /// A constant offset, K.
    Wrong,
    /// One more first-order lag, s.
    Slow,
    /// Readings that are old, s, and stamped as new.
    Delayed,
    /// Readings that are missing by chance, % of them.
    Intermittent,
    /// A film of water that shows the sensor's own temperature, % of what it sees.
    Wet,
    /// Cold ground: the contrast goes to so many K below zero.
    Hail,
    /// No contrast but so many K.
    Fog,
    /// Less contrast, % of what there was, and drops on every sensor.
    Rain,
    /// A long straight ridge on one side, ° high.
    Ridge,
    /// One on both sides.
    Valley,
    /// A long bank of cloud on one side, from the horizon to so many °.
    Cloud,
}

/// Whom a kind of fault can befall.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// A sensor by its name, or all.
    Sensor,
    /// The whole scene.
    World,
    /// One side of the scene.
    Side,
}

/// How strong a kind of fault can be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strength {
    /// Its unit, as messages have it.
    pub unit: &'static str,
    /// When not said.
    pub usual: f64,
    /// The least.
    pub least: f64,
    /// The most.
    pub most: f64,
}

/// What there is to know of a kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct About {
    /// The kind.
    pub kind: Kind,
    /// How it is written.
    pub name: &'static str,
    /// How strong it can be, if that can be chosen.
    pub strength: Option<Strength>,
    /// Whom it befalls.
    pub target: Target,
    /// How long it takes to come, and to go, s.
    pub pace_s: f64,
    /// What it does, in a line.
    pub does: &'static str,
}

const fn of(unit: &'static str, usual: f64, least: f64, most: f64) -> Option<Strength> {
    Some(Strength { unit, usual, least, most })
}

/// One on a sensor, which is there at once.
const fn sensor(kind: Kind, name: &'static str, strength: Option<Strength>, does: &'static str) -> About {
    About { kind, name, strength, target: Target::Sensor, pace_s: 0.0, does }
}

const fn slowly(pace_s: f64, target: Target, about: About) -> About {
    About { pace_s, target, ..about }
}

impl Kind {
    /// All kinds, in their order.
    pub const ALL: [About; 14] = {
        use Target::{Sensor, Side, World};
        [
            sensor(Self::Off, "off", None, "no reading"),
            sensor(Self::Stuck, "stuck", None, "repeats the reading it gave when the fault began"),
            sensor(Self::Garbage, "garbage", None, "anything within the sensor's range"),
            sensor(Self::Wrong, "wrong", of("K", 8.0, -400.0, 400.0), "a constant offset"),
            sensor(Self::Slow, "slow", of("s", 2.0, 0.0, 60.0), "one more first-order lag"),
            sensor(Self::Delayed, "delayed", of("s", 0.5, 0.0, 10.0), "readings that are old, stamped as new"),
            sensor(Self::Intermittent, "intermittent", of("%", 50.0, 0.0, 100.0), "readings missing by chance"),
            slowly(
                3.0,
                Sensor,
                sensor(Self::Wet, "wet", of("%", 92.0, 0.0, 100.0), "a film of water hides so much of what it sees"),
            ),
            slowly(
                2.0,
                World,
                sensor(Self::Hail, "hail", of("K", 2.0, 0.0, 100.0), "a ground so much colder than the sky"),
            ),
            slowly(
                2.0,
                World,
                sensor(
                    Self::Fog,
                    "fog",
                    of("K", 0.3, 0.0, 100.0),
                    "so much contrast left, the sky as warm as the ground",
                ),
            ),
            slowly(
                3.0,
                World,
                sensor(
                    Self::Rain,
                    "rain",
                    of("%", 60.0, 0.0, 100.0),
                    "so much left of the contrast, and drops on the sensors",
                ),
            ),
            slowly(3.0, Side, sensor(Self::Ridge, "ridge", of("°", 25.0, 0.0, 89.0), "a long straight ridge so high")),
            slowly(
                3.0,
                Side,
                sensor(Self::Valley, "valley", of("°", 35.0, 0.0, 89.0), "such a ridge there and one opposite"),
            ),
            slowly(3.0, Side, sensor(Self::Cloud, "cloud", of("°", 40.0, 0.0, 90.0), "a long bank of cloud so high")),
        ]
    };

    /// What there is to know of it.
    pub fn about(self) -> &'static About {
        const ALL: [About; 14] = Kind::ALL;
        &ALL[self as usize]
    }

    /// What it takes for whom: an example is `off:nose`, `hail`, `ridge:left`.
    pub fn example(self) -> String {
        let About { name, target, .. } = self.about();
        match target {
            Target::Sensor => format!("{name}:nose@10..20"),
            Target::World => format!("{name}@10..20"),
            Target::Side => format!("{name}:left@10..20"),
        }
    }
}

/// A line for each kind: how it is written, and what it does.
pub fn list() -> String {
    let line = |a: About| {
        let strength = a.strength.map_or(String::new(), |s| format!("={}", s.usual));
        let who = match a.target {
            Target::Sensor => ":SENSOR",
            Target::World => "",
            Target::Side => ":SIDE",
        };
        let unit = a.strength.map_or(String::new(), |s| format!(" ({}, {} to {})", s.unit, s.least, s.most));
        format!("{:<25} {}{unit}\n", format!("{}{strength}{who}", a.name), a.does)
    };
    Kind::ALL.map(line).concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_stands_in_its_place_with_a_strength_that_it_may_have() {
        for (i, about) in Kind::ALL.iter().enumerate() {
            assert_eq!(about.kind as usize, i);
            assert_eq!(about.kind.about(), about);
            assert!(about.strength.is_none_or(|s| (s.least..=s.most).contains(&s.usual)), "{about:?}");
        }
        assert_eq!(list().lines().count(), Kind::ALL.len());
    }
}
