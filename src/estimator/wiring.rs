//! The ways round in which a head may sit or be wired other than configured.

use crate::attitude::Attitude;
use crate::estimator::vector::Vector;

/// A head that shows nose and left, each or both, the other way round or in each other's place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wiring {
    /// Nose shows what left should.
    crossed: bool,
    /// Nose and left show what is on the other side.
    turned: [bool; 2],
}

impl Wiring {
    /// As it is configured, and all others, in the order of how much is changed.
    pub const ALL: [Self; 8] = [
        Self { crossed: false, turned: [false, false] },
        Self { crossed: false, turned: [false, true] },
        Self { crossed: false, turned: [true, false] },
        Self { crossed: false, turned: [true, true] },
        Self { crossed: true, turned: [false, false] },
        Self { crossed: true, turned: [false, true] },
        Self { crossed: true, turned: [true, false] },
        Self { crossed: true, turned: [true, true] },
    ];

    /// 1 or −1: what nose and left are multiplied by.
    fn signs(self) -> [f64; 2] {
        self.turned.map(|turned| if turned { -1.0 } else { 1.0 })
    }

    /// What such a head shows of `[nose, left, up]`.
    fn shown(self, [nose, left, up]: Vector) -> Vector {
        let [by_nose, by_left] = self.signs();
        let [nose, left] = if self.crossed { [left, nose] } else { [nose, left] };
        [by_nose * nose, by_left * left, up]
    }

    /// How it shows the aircraft turn that turns by `rates` about nose, left, up: in a mirror, all turns are the other way
    /// round.
    pub fn rates(self, rates: Vector) -> Vector {
        let mirrors = [self.crossed, self.turned[0], self.turned[1]].into_iter().filter(|m| *m).count() % 2 == 1;
        self.shown(rates).map(|r| if mirrors { -r } else { r })
    }

    /// Whether it shows another roll, and another pitch.
    pub fn angles(self) -> [bool; 2] {
        [self.crossed || self.turned[1], self.crossed || self.turned[0]]
    }

    /// The attitude in which it shows `attitude`.
    pub fn attitude(self, attitude: Attitude) -> Attitude {
        let [nose, left, up] = attitude.vertical();
        let [by_nose, by_left] = self.signs();
        let [nose, left] = [by_nose * nose, by_left * left];
        let [nose, left] = if self.crossed { [left, nose] } else { [nose, left] };
        Attitude::from_vertical([nose, left, up])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimator::vector::{cross, product, rotation};

    /// A head that is wired otherwise shows the vertical turn as it shows the rates.
    #[test]
    fn what_is_shown_turns_by_the_rates_that_are_shown() {
        let turn = [0.02, -0.03, 0.05];
        for wired in Wiring::ALL {
            let before = Attitude::from_degrees(20.0, -10.0).vertical();
            let after = product(&rotation(turn.map(|t| -t)), before);
            let seen = product(&rotation(wired.rates(turn).map(|t| -t)), wired.shown(before));
            for (a, b) in seen.iter().zip(wired.shown(after)) {
                assert!((a - b).abs() < 1e-12, "{wired:?}");
            }
            let seen = Attitude::from_vertical(wired.shown(before));
            let back = wired.attitude(seen);
            assert!((back.roll.to_degrees() - 20.0).abs() < 1e-9 && (back.pitch.to_degrees() + 10.0).abs() < 1e-9);
        }
        let mirrored = Wiring::ALL[1];
        assert_eq!(mirrored.rates([1.0, 2.0, 3.0]), [-1.0, 2.0, -3.0], "left and right: roll and yaw");
        assert_eq!(cross(mirrored.shown([1.0, 0.0, 0.0]), mirrored.shown([0.0, 1.0, 0.0])), [0.0, 0.0, -1.0]);
    }
}
