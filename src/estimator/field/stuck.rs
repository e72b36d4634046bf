//! A sensor that says the same whatever the attitude does.

use crate::time::Time;

/// The same reading for so long, s,
const SAME_S: f64 = 0.5;
/// while the attitude alone would have changed it by so much, K: quiet sensors repeat themselves honestly.
const MOVED_K: f64 = 1.0;

/// So many sensors that repeat themselves at once are at rest, not stuck.
const AT_REST: usize = 3;

/// What one sensor has said since it last said something else.
#[derive(Clone, Copy, Debug, Default)]
pub struct Stuck {
    /// The reading, since when, and the least and most that was expected of it meanwhile.
    same: Option<(f64, Time, f64, f64)>,
    repeats: bool,
}

impl Stuck {
    /// Takes in a reading and what the attitude and the sky make of it, K.
    pub fn update(&mut self, reading: f64, expected: f64, now: Time) {
        match &mut self.same {
            Some((same, since, least, most)) if *same == reading => {
                (*least, *most) = (least.min(expected), most.max(expected));
                self.repeats = now.since(*since) >= SAME_S;
            }
            _ => {
                self.same = Some((reading, now, expected, expected));
                self.repeats = false;
            }
        }
    }

    /// Whether it has been expected to change.
    fn moved(&self) -> bool {
        self.same.is_some_and(|(_, _, least, most)| most - least >= MOVED_K)
    }

    /// Which of `sensors` are stuck.
    pub fn among<const N: usize>(sensors: &[Self; N]) -> [bool; N] {
        let at_rest = sensors.iter().filter(|s| s.repeats).count() >= AT_REST;
        sensors.map(|s| !at_rest && s.repeats && s.moved())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equality_alone_is_not_stuck() {
        let at = |s: f64| Time::from_secs_f64(s);
        let mut s = [Stuck::default(); 2];
        for i in 0..500 {
            s[0].update(3.0, 3.0 + 0.001 * f64::from(i), at(0.02 * f64::from(i)));
            assert_eq!(Stuck::among(&s), [false; 2]);
        }
        s[0].update(3.0, 4.5, at(10.0));
        assert_eq!(Stuck::among(&s), [true, false], "the attitude has changed");
        s[0].update(3.0, 3.0, at(10.5));
        assert_eq!(Stuck::among(&s), [true, false], "and that is not forgotten");
        s[0].update(3.02, 9.0, at(11.0));
        s[0].update(3.02, 3.0, at(11.3));
        assert_eq!(Stuck::among(&s), [false; 2], "another reading, not yet for long");
        s[0].update(3.02, 3.0, at(12.0));
        assert_eq!(Stuck::among(&[s[0]; 3]), [false; 3], "a head at rest");
    }
}
