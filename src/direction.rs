//! Where a thermopile looks: a unit vector on the axes nose, left, up.

use std::fmt;

/// A unit vector on the aircraft's axes (nose, left, up).
///
/// The upward vertical expressed on these axes, `u`, is what every estimator looks for;
/// a pair whose positive direction is `b` sees a signal that rises with `b·u`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Direction([f64; 3]);

impl Direction {
    /// Forward along the fuselage.
    pub const NOSE: Self = Self([1.0, 0.0, 0.0]);
    /// Backward along the fuselage.
    pub const TAIL: Self = Self([-1.0, 0.0, 0.0]);
    /// Along the left wing.
    pub const LEFT: Self = Self([0.0, 1.0, 0.0]);
    /// Along the right wing.
    pub const RIGHT: Self = Self([0.0, -1.0, 0.0]);
    /// Through the roof.
    pub const UP: Self = Self([0.0, 0.0, 1.0]);
    /// Through the floor.
    pub const DOWN: Self = Self([0.0, 0.0, -1.0]);

    /// The six named directions with their names, as configuration and recordings spell them.
    pub const NAMED: [(&'static str, Self); 6] = [
        ("nose", Self::NOSE),
        ("tail", Self::TAIL),
        ("left", Self::LEFT),
        ("right", Self::RIGHT),
        ("up", Self::UP),
        ("down", Self::DOWN),
    ];

    /// The direction called `name`: nose, tail, left, right, up or down.
    pub fn named(name: &str) -> Option<Self> {
        Self::NAMED.iter().find(|(n, _)| *n == name).map(|(_, d)| *d)
    }

    /// From azimuth (degrees clockwise from the nose, seen from above) and elevation (degrees,
    /// up positive). `None` when either is not finite or the elevation lies outside ±90.
    pub fn from_angles(azimuth_deg: f64, elevation_deg: f64) -> Option<Self> {
        if !azimuth_deg.is_finite() || !(-90.0..=90.0).contains(&elevation_deg) {
            return None;
        }
        let (sa, ca) = azimuth_deg.to_radians().sin_cos();
        let (se, ce) = elevation_deg.to_radians().sin_cos();
        Some(Self([ce * ca, -ce * sa, se]))
    }

    /// The vector's components on (nose, left, up).
    pub const fn components(self) -> [f64; 3] {
        self.0
    }

    /// The opposite direction.
    pub fn opposite(self) -> Self {
        Self(self.0.map(|c| -c))
    }

    /// The cosine of the angle to `other`, a vector on the same axes.
    pub fn dot(self, other: [f64; 3]) -> f64 {
        self.0[0] * other[0] + self.0[1] * other[1] + self.0[2] * other[2]
    }

    /// Whether `self` and `other` point apart by more than 179°: two sensors that make a pair.
    pub fn opposes(self, other: Self) -> bool {
        self.dot(other.0) < -0.999_847
    }
}

impl fmt::Display for Direction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some((name, _)) = Self::NAMED.iter().find(|(_, d)| d.dot(self.0) > 0.999_999_9) {
            return f.write_str(name);
        }
        let [n, l, u] = self.0;
        let azimuth = (-l).atan2(n).to_degrees().rem_euclid(360.0);
        write!(f, "azimuth {azimuth:.1}° elevation {:.1}°", u.clamp(-1.0, 1.0).asin().to_degrees())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: Direction, b: Direction) -> bool {
        a.dot(b.components()) > 0.999_999_999
    }

    #[test]
    fn azimuth_runs_clockwise_from_the_nose() {
        for (azimuth, name) in [(0.0, "nose"), (90.0, "right"), (180.0, "tail"), (270.0, "left")] {
            let d = Direction::from_angles(azimuth, 0.0).unwrap();
            assert!(close(d, Direction::named(name).unwrap()), "{azimuth} is {name}");
            assert_eq!(d.to_string(), name);
        }
        assert!(close(Direction::from_angles(17.0, 90.0).unwrap(), Direction::UP));
    }

    #[test]
    fn angles_out_of_range_are_refused() {
        assert!(Direction::from_angles(0.0, 90.1).is_none());
        assert!(Direction::from_angles(f64::NAN, 0.0).is_none());
        assert!(Direction::from_angles(0.0, f64::NAN).is_none());
    }

    #[test]
    fn opposites_oppose() {
        for (_, d) in Direction::NAMED {
            assert!(d.opposes(d.opposite()));
            assert!(!d.opposes(d));
        }
        assert!(!Direction::NOSE.opposes(Direction::LEFT));
    }

    #[test]
    fn a_skew_direction_prints_its_angles() {
        let d = Direction::from_angles(45.0, 10.0).unwrap();
        assert_eq!(d.to_string(), "azimuth 45.0° elevation 10.0°");
    }
}
