//! Which heads each method works with.

use super::contrast_vector::spans_space;
use super::field::MAX_SENSORS;
use super::normal::Normal;
use crate::head::{Head, SensorKind};

/// `inverse-sine`: a pair along the vertical, and pairs that span space.
pub fn inverse_sine(head: &Head) -> bool {
    head.vertical_pair().is_some() && profile(head)
}

/// `profile`: pairs that span space.
pub fn profile(head: &Head) -> bool {
    spans_space(head)
}

/// Why `field` cannot work with a head.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FieldLack {
    /// There are fewer sensors than unknowns.
    TooFew {
        /// As many are needed.
        needed: usize,
    },
    /// There are more sensors than the filter takes.
    TooMany {
        /// As many may be.
        most: usize,
    },
    /// A direction is seen by no sensor, or all absolute ones stand at the same angle to an axis: a
    /// tilt looks like a warmer ground.
    Flat,
}

/// `field`: as many sensors as its filter takes, and as it has unknowns: attitude, contrast and, with
/// absolute sensors, the ground and something of the sky's shape.
pub fn field(head: &Head) -> Result<(), FieldLack> {
    let absolute = || head.sensors.iter().filter(|s| s.is_absolute());
    let count = absolute().count();
    let needed = if count > 0 { 5 } else { 3 };
    match head.sensors.len() {
        n if n < needed => return Err(FieldLack::TooFew { needed }),
        n if n > MAX_SENSORS => return Err(FieldLack::TooMany { most: MAX_SENSORS }),
        _ => {}
    }
    // Absolute sensors share one unknown temperature: only how their directions differ tells of a tilt.
    let sum = absolute().fold([0.0; 3], |sum: [f64; 3], s| {
        let b = s.direction.components();
        std::array::from_fn(|i| sum[i] + b[i])
    });
    let mut normal = Normal::default();
    for sensor in &head.sensors {
        let b = sensor.direction.components();
        normal.add_vector(match sensor.kind {
            SensorKind::Absolute { .. } => std::array::from_fn(|i| b[i] - sum[i] / count as f64),
            SensorKind::Pair { .. } => b,
        });
    }
    normal.inverse().map(|_| ()).ok_or(FieldLack::Flat)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::direction::Direction;
    use crate::head::Sensor;

    const PAIR: SensorKind = SensorKind::Pair { neutral_v: 0.0, kelvin_per_v: 1.0 };

    fn head(kind: SensorKind, angles: &[(f64, f64)]) -> Head {
        let sensors = angles.iter().enumerate().map(|(i, (azimuth, elevation))| {
            let direction = Direction::from_angles(*azimuth, *elevation).unwrap();
            Sensor { name: format!("s{i}"), direction, kind, bus: None }
        });
        Head::new(sensors.collect(), Vec::new())
    }

    fn ring(count: usize, elevation: f64) -> Vec<(f64, f64)> {
        (0..count).map(|i| (360.0 * i as f64 / count as f64, elevation)).collect()
    }

    #[test]
    fn six_along_the_axes_suit_every_method() {
        let six = Head::six();
        assert!(inverse_sine(&six) && profile(&six) && field(&six).is_ok());
    }

    #[test]
    fn any_one_of_six_may_be_left_out_for_field_alone() {
        for left_out in 0..6 {
            let mut sensors = Head::six().sensors;
            sensors.remove(left_out);
            let five = Head::new(sensors, Vec::new());
            assert!(field(&five).is_ok() && !profile(&five) && !inverse_sine(&five), "without {left_out}");
        }
    }

    #[test]
    fn field_needs_as_many_as_it_has_unknowns_and_takes_no_more_than_eight() {
        let ways = [(0.0, 0.0), (90.0, 0.0), (180.0, 0.0), (270.0, 0.0), (0.0, 90.0), (0.0, -90.0)];
        assert_eq!(field(&head(SensorKind::ABSOLUTE, &ways[..4])), Err(FieldLack::TooFew { needed: 5 }));
        assert_eq!(field(&head(PAIR, &ways[..2])), Err(FieldLack::TooFew { needed: 3 }));
        assert_eq!(field(&Head::default()), Err(FieldLack::TooFew { needed: 3 }));
        let many: Vec<_> = ways.iter().chain(&ring(3, 45.0)).copied().collect();
        assert!(field(&head(SensorKind::ABSOLUTE, &many[..8])).is_ok());
        assert_eq!(field(&head(SensorKind::ABSOLUTE, &many)), Err(FieldLack::TooMany { most: 8 }));
    }

    #[test]
    fn absolute_sensors_on_a_cone_cannot_tell_a_tilt_from_the_ground() {
        for elevation in [0.0, 30.0, 60.0] {
            assert_eq!(field(&head(SensorKind::ABSOLUTE, &ring(6, elevation))), Err(FieldLack::Flat), "{elevation}");
        }
        // Pairs can: theirs is a difference.
        assert!(field(&head(PAIR, &ring(3, 45.0))).is_ok());
        assert_eq!(field(&head(PAIR, &ring(3, 0.0))), Err(FieldLack::Flat));
        // And one that looks another way is enough.
        let mut angles = ring(5, 30.0);
        angles.push((0.0, 90.0));
        assert!(field(&head(SensorKind::ABSOLUTE, &angles)).is_ok());
    }

    #[test]
    fn a_mixed_head_is_good_when_it_spans() {
        let mut mixed = head(SensorKind::ABSOLUTE, &ring(4, 0.0)).sensors;
        mixed.extend(head(PAIR, &[(0.0, 90.0)]).sensors);
        let mixed = Head::new(mixed, Vec::new());
        assert!(field(&mixed).is_ok() && profile(&mixed) && inverse_sine(&mixed));
    }
}
