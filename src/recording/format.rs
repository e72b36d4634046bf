//! What a recording's columns are called and what they mean.
//!
//! `time_s` in seconds, monotonic; for an absolute sensor `<name>_obj_c` and, if read,
//! `<name>_amb_c`; for a pair's ADC channel `<name>_v`; then aiding, and `ref_…` columns that no
//! estimator sees.

use crate::direction::Direction;
use crate::frame::Aiding;
use crate::head::{Head, Sensor, SensorKind};

/// The column that every recording has.
pub const TIME: &str = "time_s";
/// Ends the column of what an absolute sensor looks at, °C.
pub const OBJECT: &str = "_obj_c";
/// Ends the column of an absolute sensor's own die, °C.
pub const AMBIENT: &str = "_amb_c";
/// Ends the column of a pair's voltage, V.
pub const VOLTS: &str = "_v";
/// The aiding columns, in the order of [`aiding`].
pub const AIDING: [&str; 8] = [
    "gyro_x_deg_s",
    "gyro_y_deg_s",
    "gyro_z_deg_s",
    "airspeed_m_s",
    "ground_speed_m_s",
    "course_deg",
    "climb_m_s",
    "altitude_m",
];
/// The reference columns: roll, pitch, yaw, °.
pub const REFERENCE: [&str; 3] = ["ref_roll_deg", "ref_pitch_deg", "ref_yaw_deg"];

/// What a column holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    /// Seconds.
    Time,
    /// What the head's sensor of this index looks at, °C.
    Object(usize),
    /// That sensor's own die, °C.
    Ambient(usize),
    /// That sensor's voltage, V.
    Volts(usize),
    /// The aiding value of this index.
    Aiding(usize),
    /// The reference angle of this index, °.
    Reference(usize),
    /// Nothing known: ignored.
    Unknown,
}

impl Column {
    /// The column called `name` in a recording of `head`.
    pub fn named(name: &str, head: &Head) -> Self {
        let place = |list: &[&str]| list.iter().position(|n| *n == name);
        let sensor = |end: &str, absolute: bool| {
            let stem = name.strip_suffix(end)?;
            head.sensors.iter().position(|s| s.name == stem && absolute == s.is_absolute())
        };
        if name == TIME {
            return Self::Time;
        }
        None.or_else(|| sensor(OBJECT, true).map(Self::Object))
            .or_else(|| sensor(AMBIENT, true).map(Self::Ambient))
            .or_else(|| sensor(VOLTS, false).map(Self::Volts))
            .or_else(|| place(&AIDING).map(Self::Aiding))
            .or_else(|| place(&REFERENCE).map(Self::Reference))
            .unwrap_or(Self::Unknown)
    }
}

/// The absolute head that a header describes by itself: the sensors that are named by the six
/// directions. `None` when there is none of them.
pub fn head_of<'a>(header: impl Iterator<Item = &'a str>) -> Option<Head> {
    let sensors: Vec<_> = header
        .filter_map(|name| {
            let name = name.strip_suffix(OBJECT)?;
            let direction = Direction::named(name)?;
            Some(Sensor { name: name.to_owned(), direction, kind: SensorKind::ABSOLUTE, bus: None })
        })
        .collect();
    if sensors.is_empty() { None } else { Some(Head::new(sensors, Vec::new())) }
}

/// The aiding values in the order of [`AIDING`].
pub fn aiding(a: &Aiding) -> [Option<f64>; 8] {
    let [x, y, z] = a.gyro_deg_s;
    [x, y, z, a.airspeed_m_s, a.ground_speed_m_s, a.course_deg, a.climb_m_s, a.altitude_m]
}

/// The inverse of [`aiding`].
pub fn to_aiding(values: [Option<f64>; 8]) -> Aiding {
    let [x, y, z, airspeed_m_s, ground_speed_m_s, course_deg, climb_m_s, altitude_m] = values;
    Aiding { gyro_deg_s: [x, y, z], airspeed_m_s, ground_speed_m_s, course_deg, climb_m_s, altitude_m }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_known_by_name_and_kind() {
        let head = Head::six();
        assert_eq!(Column::named("time_s", &head), Column::Time);
        assert_eq!(Column::named("nose_obj_c", &head), Column::Object(0));
        assert_eq!(Column::named("down_amb_c", &head), Column::Ambient(5));
        assert_eq!(Column::named("airspeed_m_s", &head), Column::Aiding(3));
        assert_eq!(Column::named("ref_pitch_deg", &head), Column::Reference(1));
        for unknown in ["nose_v", "battery_v", "nose", "Time_s", ""] {
            assert_eq!(Column::named(unknown, &head), Column::Unknown, "{unknown}");
        }
    }

    #[test]
    fn a_header_with_directions_is_a_head() {
        let head = head_of(["time_s", "left_obj_c", "right_obj_c", "battery_v"].into_iter()).unwrap();
        assert_eq!(head.sensors.len(), 2);
        assert_eq!(head.pairs.len(), 1);
        assert!(head_of(["time_s", "long_v", "belly_obj_c", "up_amb_c"].into_iter()).is_none());
    }
}
