//! The head: which sensors there are, where they look, and which pairs they make.

use crate::direction::Direction;
use crate::fault::FaultName;
use crate::frame::{Frame, Missing, Value};
use crate::time::Time;

/// What a sensor that says a temperature can have seen, °C: a part of a scene, averaged over its field of view.
const SEEN_C: std::ops::Range<f64> = -120.0..125.0;

/// What kind of reading a sensor gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SensorKind {
    /// A temperature in one direction.
    Absolute {
        /// How much more it shows than the others of the same scene, K.
        offset_k: f64,
    },
    /// A voltage that is the difference of two opposed thermopiles.
    Pair {
        /// The voltage of a pair that sees no difference, V.
        neutral_v: f64,
        /// Kelvin of difference for a volt above neutral; negative for a pair wired inverted.
        kelvin_per_v: f64,
    },
}

impl SensorKind {
    /// A temperature, as the sensor says it.
    pub const ABSOLUTE: Self = Self::Absolute { offset_k: 0.0 };

    /// Whether it gives a temperature rather than a difference.
    pub fn is_absolute(self) -> bool {
        matches!(self, Self::Absolute { .. })
    }

    /// What `value` means, K or °C; `None` where it is of the other kind, or no number that can be.
    pub fn kelvin(self, value: Value) -> Option<f64> {
        let kelvin = match (value, self) {
            (Value::Absolute { object_c, .. }, Self::Absolute { offset_k }) => object_c - offset_k,
            (Value::Volts(v), Self::Pair { neutral_v, kelvin_per_v }) => (v - neutral_v) * kelvin_per_v,
            _ => return None,
        };
        let possible = if self.is_absolute() { SEEN_C } else { -1000.0..1000.0 };
        possible.contains(&kelvin).then_some(kelvin)
    }
}

/// A sensor as the estimators know it.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensor {
    /// Its name: lower-case letters, digits and `_`.
    pub name: String,
    /// Where it looks; for a pair, the direction whose rising raises the signal.
    pub direction: Direction,
    /// What it gives.
    pub kind: SensorKind,
    /// The bus it is read from, as an index into [`Head::buses`]; `None` in replay and simulation.
    pub bus: Option<usize>,
}

impl Sensor {
    /// Whether it gives a temperature rather than a difference.
    pub fn is_absolute(&self) -> bool {
        self.kind.is_absolute()
    }
}

/// Where a pair's signal comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
enum PairSource {
    /// Two absolute sensors: the signal is `T(low) − T(high)`, `high` looking along the direction.
    Opposed { high: usize, low: usize },
    /// One ADC channel.
    Channel(usize),
}

/// Two opposed thermopiles. Its signal, in kelvin, rises with `direction·u`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// The pair's positive direction.
    pub direction: Direction,
    source: PairSource,
}

impl Pair {
    /// Whether sensor `index` is part of this pair.
    pub fn uses(&self, index: usize) -> bool {
        match self.source {
            PairSource::Opposed { high, low } => index == high || index == low,
            PairSource::Channel(i) => index == i,
        }
    }
}

/// The sensors with the pairs that they make.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Head {
    /// The sensors, in the configuration's order: the order of a frame's readings.
    pub sensors: Vec<Sensor>,
    /// The pairs found among them.
    pub pairs: Vec<Pair>,
    /// The buses they are read from.
    pub buses: Vec<String>,
}

impl Head {
    /// The reading of sensor `i` in `frame`, K or °C, and its stamp.
    pub fn reading_k(&self, i: usize, frame: &Frame) -> Option<(f64, Time)> {
        let sample = frame.readings.get(i)?.ok()?;
        Some((self.sensors.get(i)?.kind.kelvin(sample.value)?, sample.time))
    }

    /// Finds the pairs among `sensors`: every ADC channel is one, and so are every two absolute
    /// sensors that look apart. A pair's positive direction is the one nearer to nose, left or up.
    pub fn new(sensors: Vec<Sensor>, buses: Vec<String>) -> Self {
        let mut pairs = Vec::new();
        for (i, a) in sensors.iter().enumerate() {
            match a.kind {
                SensorKind::Pair { .. } => {
                    pairs.push(Pair { direction: a.direction, source: PairSource::Channel(i) });
                }
                SensorKind::Absolute { .. } => {
                    let partner = sensors
                        .iter()
                        .enumerate()
                        .skip(i + 1)
                        .find(|(_, b)| b.is_absolute() && a.direction.opposes(b.direction));
                    if let Some((j, _)) = partner {
                        let (high, low) = if is_positive(a.direction) { (i, j) } else { (j, i) };
                        let direction = sensors[high].direction;
                        pairs.push(Pair { direction, source: PairSource::Opposed { high, low } });
                    }
                }
            }
        }
        Self { sensors, pairs, buses }
    }

    /// The six absolute sensors of a plain head, named by their directions.
    pub fn six() -> Self {
        let sensors = Direction::NAMED
            .iter()
            .map(|(name, direction)| Sensor {
                name: (*name).to_owned(),
                direction: *direction,
                kind: SensorKind::ABSOLUTE,
                bus: None,
            })
            .collect();
        Self::new(sensors, Vec::new())
    }

    /// The signal of pair `index` in `frame`, K, positive when its direction looks higher; or why
    /// there is none.
    pub fn signal_k(&self, index: usize, frame: &Frame) -> Result<f64, Missing> {
        let kelvin = |i: usize| {
            let sample = frame.readings.get(i).copied().unwrap_or(Err(Missing::Empty))?;
            self.sensors[i].kind.kelvin(sample.value).ok_or(Missing::Impossible)
        };
        match self.pairs[index].source {
            PairSource::Opposed { high, low } => Ok(kelvin(low)? - kelvin(high)?),
            PairSource::Channel(i) => kelvin(i),
        }
    }

    /// The mean of the two sensors of pair `index` in `frame`, K or °C; `None` where one is missing, and of a pair that shows a
    /// difference alone.
    pub fn mean_k(&self, index: usize, frame: &Frame) -> Option<f64> {
        match self.pairs.get(index)?.source {
            PairSource::Opposed { high, low } => {
                Some(0.5 * (self.reading_k(high, frame)?.0 + self.reading_k(low, frame)?.0))
            }
            PairSource::Channel(_) => None,
        }
    }

    /// The pair that looks straight up, if there is one: its index and +1, or −1 when its positive
    /// direction is down.
    pub fn vertical_pair(&self) -> Option<(usize, f64)> {
        self.pairs.iter().enumerate().find_map(|(i, p)| {
            let up = p.direction.dot(Direction::UP.components());
            (up.abs() > 0.999).then_some((i, up.signum()))
        })
    }
}

/// Whether the direction's largest component is positive: nose, left and up are.
fn is_positive(d: Direction) -> bool {
    let c = d.components();
    c.iter().copied().fold(0.0_f64, |m, x| if x.abs() > m.abs() + 1e-9 { x } else { m }) > 0.0
}

impl FaultName for Head {
    fn sensor(&self, index: usize) -> &str {
        self.sensors.get(index).map_or("?", |s| &s.name)
    }

    fn bus(&self, index: usize) -> &str {
        self.buses.get(index).map_or("?", String::as_str)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Sample;

    fn frame(objects_c: [f64; 6]) -> Frame {
        let mut f = Frame::new(6);
        for (r, object_c) in f.readings.iter_mut().zip(objects_c) {
            *r = Ok(Sample { value: Value::Absolute { object_c, ambient_c: None }, time: Time::default() });
        }
        f
    }

    #[test]
    fn what_no_scene_has_is_no_reading() {
        let absolute = |object_c| SensorKind::ABSOLUTE.kelvin(Value::Absolute { object_c, ambient_c: None });
        assert_eq!([absolute(-119.0), absolute(124.0)], [Some(-119.0), Some(124.0)]);
        assert_eq!([absolute(-121.0), absolute(125.0), absolute(300.0), absolute(f64::NAN)], [None; 4]);
    }

    #[test]
    fn six_sensors_make_three_pairs_with_the_signs_of_the_angles() {
        let head = Head::six();
        assert_eq!(head.pairs.len(), 3);
        // Nose up and right wing down: nose and left look at the cold sky.
        let f = frame([-5.0, 10.0, -3.0, 8.0, -20.0, 15.0]);
        assert_eq!(head.signal_k(0, &f), Ok(15.0));
        assert_eq!(head.signal_k(1, &f), Ok(11.0));
        assert_eq!(head.signal_k(2, &f), Ok(35.0));
        assert_eq!(head.vertical_pair(), Some((2, 1.0)));
    }

    #[test]
    fn a_missing_sensor_leaves_its_pair_without_a_signal() {
        let head = Head::six();
        let mut f = frame([0.0; 6]);
        f.readings[1] = Err(Missing::BadPec);
        assert_eq!(head.signal_k(0, &f), Err(Missing::BadPec));
        assert_eq!(head.signal_k(1, &f), Ok(0.0));
        f.readings[2] = Ok(Sample { value: Value::Volts(1.0), time: Time::default() });
        assert_eq!(head.signal_k(1, &f), Err(Missing::Impossible));
    }

    #[test]
    fn what_one_sensor_shows_too_much_is_taken_off() {
        let mut head = Head::six();
        head.sensors[0].kind = SensorKind::Absolute { offset_k: 0.5 };
        head.sensors[1].kind = SensorKind::Absolute { offset_k: -0.25 };
        let f = frame([-5.0, 10.0, -3.0, 8.0, -20.0, 15.0]);
        assert_eq!(head.reading_k(0, &f), Some((-5.5, Time::default())));
        assert_eq!(head.signal_k(0, &f), Ok(15.75));
        assert_eq!(head.signal_k(1, &f), Ok(11.0));
        assert!(head.sensors[0].is_absolute());
    }

    #[test]
    fn a_channel_pair_has_its_neutral_and_gain() {
        let sensor = Sensor {
            name: "vert".into(),
            direction: Direction::DOWN,
            kind: SensorKind::Pair { neutral_v: 1.6, kelvin_per_v: -40.0 },
            bus: None,
        };
        let head = Head::new(vec![sensor], vec![]);
        let mut f = Frame::new(1);
        f.readings[0] = Ok(Sample { value: Value::Volts(2.1), time: Time::default() });
        assert!((head.signal_k(0, &f).unwrap() + 20.0).abs() < 1e-9);
        assert_eq!(head.vertical_pair(), Some((0, -1.0)));
    }
}
