//! The airframe's axes in the world.

use crate::attitude::Attitude;

/// Roll, pitch and yaw as a rotation from the axes (nose, left, up) to the world's (north, east, up).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orientation([[f64; 3]; 3]);

impl Orientation {
    /// Of an airframe at `attitude` whose nose points to `yaw`, rad clockwise from north.
    pub fn new(attitude: Attitude, yaw: f64) -> Self {
        let (sr, cr) = attitude.roll.sin_cos();
        let (sp, cp) = attitude.pitch.sin_cos();
        let (sy, cy) = yaw.sin_cos();
        Self([
            [cp * cy, cr * sy - sr * sp * cy, -(cr * sp * cy + sr * sy)],
            [cp * sy, -(sr * sp * sy + cr * cy), sr * cy - cr * sp * sy],
            attitude.vertical(),
        ])
    }

    /// The upward vertical on the axes (nose, left, up).
    pub fn vertical(&self) -> [f64; 3] {
        self.0[2]
    }

    /// The north, east and up of a vector that is given on the airframe's axes.
    pub fn to_world(&self, body: [f64; 3]) -> [f64; 3] {
        self.0.map(|row| row[0] * body[0] + row[1] * body[1] + row[2] * body[2])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_axes_point_where_yaw_pitch_and_roll_put_them() {
        let close = |a: [f64; 3], b: [f64; 3]| a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-12);
        let (nose, left, up) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
        let east = 90.0_f64.to_radians();
        let level = Orientation::new(Attitude::default(), east);
        assert!(close(level.to_world(nose), [0.0, 1.0, 0.0]));
        assert!(close(level.to_world(left), [1.0, 0.0, 0.0]));
        // Right wing down: the left one up, the roof to the right, which is south.
        let banked = Orientation::new(Attitude::from_degrees(90.0, 0.0), east);
        assert!(close(banked.to_world(left), [0.0, 0.0, 1.0]));
        assert!(close(banked.to_world(up), [-1.0, 0.0, 0.0]));
        let any = Orientation::new(Attitude::from_degrees(31.0, -17.0), 2.0);
        let [n, l, u] = [nose, left, up].map(|b| any.to_world(b));
        let cross = [n[1] * l[2] - n[2] * l[1], n[2] * l[0] - n[0] * l[2], n[0] * l[1] - n[1] * l[0]];
        // North, east, up is left-handed: the product of two axes is the third one's opposite.
        assert!(close(cross, u.map(|c| -c)));
        assert!(close([n[2], l[2], u[2]], any.vertical()));
    }
}
