//! A sensor that says the same whatever the attitude does.

use crate::estimator::noise::Noise;
use crate::time::Time;

/// The same reading for so long, s,
const SAME_S: f64 = 0.5;
/// while the attitude alone would have changed it by so much, K, and a step of its readings, within so long, s: quiet sensors
/// repeat themselves honestly, and what is learnt of the sky changes slowly,
const MOVED_K: f64 = 1.0;
const WITHIN_S: f64 = 10.0;
/// but for the time, s, after a filter has begun.
const SETTLES_S: f64 = 5.0;
/// So often, at least: one may come after a gap.
const TIMES: u32 = 3;
/// Or for so long, s, and so many times as long as ever before, of a sensor whose noise is so many of its steps: its
/// readings do not stay the same.
const SURE_S: f64 = 0.25;
const LONGEST: f64 = 3.0;

/// So many sensors that repeat themselves at once are at rest, not stuck.
const AT_REST: usize = 3;

/// What one sensor has said since it last said something else.
#[derive(Clone, Copy, Debug, Default)]
pub struct Stuck {
    /// The reading, and since when.
    same: Option<(f64, Time)>,
    /// Since when what is expected of it is watched, least, most and last of that.
    expected: Option<(Time, [f64; 3])>,
    /// When the filter began.
    begun: Option<Time>,
    /// It would have changed.
    moved: bool,
    /// For how long, s, and how often again.
    same_s: f64,
    times: u32,
    /// Its noise would not let it.
    impossible: bool,
    /// The longest time for which it has said the same honestly, s.
    longest_s: f64,
    noise: Noise,
}

impl Stuck {
    /// Takes in a reading and what the attitude and the sky make of it, K.
    pub fn update(&mut self, reading: f64, expected: f64, now: Time) {
        self.noise.update(reading, now, self.same.map(|(same, _)| same));
        match self.same {
            Some((same, since)) if same == reading => {
                (self.same_s, self.times) = (now.since(since), self.times.saturating_add(1));
                let long = self.times >= TIMES && self.same_s >= SURE_S.max(LONGEST * self.longest_s);
                self.impossible |= long && self.noise.moves_all();
            }
            _ => {
                if !self.is_wrong() {
                    self.longest_s = self.longest_s.max(self.same_s);
                }
                self.same = Some((reading, now));
                (self.same_s, self.times, self.impossible) = (0.0, 0, false);
                (self.expected, self.moved) = (None, false);
            }
        }
        let (since, [least, most, last]) = self.expected.unwrap_or((now, [expected; 3]));
        let over = now.since(since) >= WITHIN_S;
        let (since, least, most) = if over { (now, last, last) } else { (since, least, most) };
        let range = [least.min(expected), most.max(expected), expected];
        self.expected = self.begun.is_none_or(|begun| now.since(begun) > SETTLES_S).then_some((since, range));
        self.moved |= self.expected.is_some_and(|(_, [least, most, _])| most - least >= MOVED_K + self.noise.step_k());
    }

    /// A filter has begun: what it expects changes with what it learns, at first.
    pub fn begin(&mut self, now: Time) {
        (self.expected, self.begun) = (None, Some(now));
    }

    /// Whether it repeats itself.
    fn repeats(&self) -> bool {
        self.impossible || self.times >= TIMES && self.same_s >= SAME_S
    }

    /// Whether it would have changed.
    fn is_wrong(&self) -> bool {
        self.impossible || self.repeats() && self.moved
    }

    /// Whether it may be wrong: with its noise it has never said the same for so long.
    fn is_odd(&self) -> bool {
        self.same_s > self.longest_s && self.noise.moves_all()
    }

    /// Which of `sensors` are stuck.
    pub fn among<const N: usize>(sensors: &[Self; N]) -> [bool; N] {
        few(sensors, Self::is_wrong, Self::repeats)
    }

    /// Which of `sensors` are not to be heard for a moment, as they may be.
    pub fn suspects<const N: usize>(sensors: &[Self; N]) -> [bool; N] {
        few(sensors, Self::is_odd, |s| s.is_odd() || s.repeats())
    }
}

/// Those of `sensors` that are `wrong`, unless so many are still that all are at rest.
fn few<const N: usize>(sensors: &[Stuck; N], wrong: fn(&Stuck) -> bool, still: fn(&Stuck) -> bool) -> [bool; N] {
    let at_rest = sensors.iter().filter(|s| still(s)).count() >= AT_REST;
    sensors.map(|s| !at_rest && wrong(&s))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulation::noise::Noise;

    /// What is seen of a sensor in steps of `step_k`, with this noise, read anew after so many frames of 50 a second:
    /// how often it was thought stuck in `seconds`, and for how long it must say the same after that, s.
    fn noisy(noise_k: f64, step_k: f64, hold: u32, seconds: u32) -> (u32, Option<f64>) {
        let (mut stuck, mut noise, mut shown) = ([Stuck::default(); 1], Noise::new(3), 0.0);
        let (mut wrongly, mut seen) = (0, None);
        for i in 0..50 * (seconds + 30) {
            let goes = i < 50 * seconds;
            if goes && i % hold == 0 {
                // A slow turn and back within six seconds.
                let turn = 4.0 * (f64::from(i) / 50.0).sin();
                shown = ((turn + noise_k * noise.normal()) / step_k).round() * step_k;
            }
            stuck[0].update(shown, 0.0, Time::from_secs_f64(10.0 + 0.02 * f64::from(i)));
            let found = Stuck::among(&stuck)[0];
            wrongly += u32::from(goes && found);
            seen = seen.or((!goes && found).then(|| f64::from(i) / 50.0 - f64::from(seconds)));
        }
        (wrongly, seen)
    }

    #[test]
    fn noise_that_stops_is_stuck_without_anything_having_moved() {
        let (wrongly, seen) = noisy(0.08, 0.02, 1, 600);
        assert!(wrongly == 0 && seen.is_some_and(|s| s < 0.5), "{wrongly} {seen:?}");
    }

    #[test]
    fn what_may_be_stuck_is_not_heard_meanwhile_unless_all_rest() {
        let mut noise = Noise::new(4);
        let mut stuck = [Stuck::default(); 6];
        let mut told = Vec::new();
        for i in 0..520 {
            for (k, s) in stuck.iter_mut().enumerate() {
                // The first rests from 10 s on, the next two from 10.2 s.
                let rests = k == 0 && i >= 500 || k < 3 && i >= 510;
                let shown = if rests { 1.0 } else { (0.08 * noise.normal() / 0.02).round() * 0.02 };
                s.update(shown, 0.0, Time::from_secs_f64(10.0 + 0.02 * f64::from(i)));
            }
            told.push(Stuck::suspects(&stuck)[0]);
        }
        let odd = |from: usize, to: usize| told[from..to].iter().filter(|t| **t).count();
        assert!(odd(300, 500) <= 1 && odd(507, 511) == 4 && odd(518, 520) == 0, "{told:?}");
    }

    #[test]
    fn coarse_steps_and_slow_sensors_are_not_for_that() {
        assert_eq!(noisy(0.08, 0.5, 1, 600), (0, None), "coarse steps");
        assert_eq!(noisy(0.01, 0.02, 1, 600), (0, None), "quiet");
        for noise_k in [0.02, 0.03, 0.04, 0.06] {
            assert_eq!(noisy(noise_k, 0.02, 1, 3600).0, 0, "{noise_k} K");
        }
        for hold in [2, 5, 15, 40] {
            let (wrongly, seen) = noisy(0.08, 0.02, hold, 600);
            assert_eq!(wrongly, 0, "read anew every {hold}");
            assert!(seen.is_none_or(|s| s > 2.0 * 0.02 * f64::from(hold)), "{hold}: {seen:?}");
        }
    }

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
