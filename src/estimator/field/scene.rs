//! How strong the sensors' own scenes are, learnt from what no attitude, ground or contrast explains.

use super::directions::{Directions, Pattern, dot, unit};

/// How long the doubt of the beginning lasts, s.
const FIRST_S: f64 = 3.0;
/// Over this time innovations are averaged to see what no state explains, s.
const LEFT_S: f64 = 1.0;
/// An innovation beyond this is a glitch and no scene, K.
pub const GLITCH_K: f64 = 1.0;
/// The largest scene, K.
const LARGEST_K: f64 = 4.0;
/// How far it turns until a scene that was unlike is no longer thought to be, rad: some two minutes of turns. Straight on
/// nothing shows what is there still; for so long, s.
const LATELY_RAD: f64 = 24.0;
const LATELY_S: f64 = 1200.0;
/// After this time, s, a sky is even where scenes are usually weaker than so many K.
const EVEN: (f64, f64) = (10.0, 0.02);
/// Over this time it is seen how strong scenes usually are, s; what is no stronger than so many times that is nothing new.
const USUAL_S: f64 = 60.0;
const NEW: f64 = 1.5;
/// What is new may be a wall, and hides so many times as much as what has been there all along, such as errors of the
/// sensors.
const NEW_HIDES: f64 = 2.5;
/// How long it has to be unlike to have been so for long, s.
const LONG_S: f64 = 30.0;
/// Noise leaves so much in that average, K, where it is as small as it should be, at 50 Hz: of more, so many times its
/// variance is no scene.
const EXPECTED_K: f64 = 0.0085;
const SAFELY: f64 = 4.0;
/// In fewer dimensions a scene of its own is not seen: all may be the sky's depth.
const LEAST_DIMENSIONS: f64 = 0.25;
/// A misfit no larger than the first is noise; one of the second is a scene, K.
pub const UNLIKE_K: (f64, f64) = (0.015, 0.04);

/// Learns how strong the sensors' own scenes are from what no attitude, ground or contrast explains.
#[derive(Clone, Debug)]
pub struct SceneStrength {
    least: f64,
    learning_s: (f64, f64),
    left: Pattern,
    /// For how long that has been averaged, s.
    averaged_s: f64,
    /// The mean square of what is seen, K²: all, and what is surely not the sky's shape.
    seen: [f64; 2],
    first: f64,
    /// How surely it has lately been seen to be unlike.
    lately: f64,
    /// How surely it has been so for long.
    long: f64,
    /// The size of what has usually been seen of scenes, K.
    usual_k: f64,
}

impl SceneStrength {
    /// Never less than `least_k`; learnt with time constants of `learning_s` up and down.
    pub fn new(least_k: f64, learning_s: (f64, f64)) -> Self {
        let least = least_k * least_k;
        Self {
            least,
            learning_s,
            left: Pattern::default(),
            averaged_s: 0.0,
            seen: [1e-4; 2],
            first: 0.0,
            lately: 0.0,
            long: 0.0,
            usual_k: 0.0,
        }
    }

    /// Begins with scenes of `first_k`, and what has `lately` been seen to be unlike: it is there still, and a filter that
    /// begins anew takes it for a part of the sky.
    pub fn begin(&mut self, first_k: f64, lately: f64) {
        (self.first, self.lately) = (first_k * first_k, lately);
    }

    /// Takes in each sensor's innovation and what its scene is taken to add, K; `variance_of` a pattern of scenes,
    /// K², is how well they are known; `noise_k2` is the variance of a reading, K²; `turn`: how far it has turned, rad.
    pub fn update(
        &mut self,
        (innovations, scenes): (&Pattern, &Pattern),
        directions: &Directions,
        variance_of: impl Fn(&Pattern) -> f64,
        (noise_k2, dt_s, turn): (f64, f64, f64),
    ) {
        let share = -(-dt_s / LEFT_S).exp_m1();
        for (left, innovation) in self.left.iter_mut().zip(innovations) {
            *left += share * (innovation.clamp(-GLITCH_K, GLITCH_K) - *left);
        }
        let (rests, dimensions) = directions.rests(&std::array::from_fn(|i| self.left[i] + scenes[i]));
        let noise_k2 = SAFELY * (share / (2.0 - share) * noise_k2 - EXPECTED_K * EXPECTED_K).max(0.0);
        self.averaged_s += dt_s;
        if dimensions > LEAST_DIMENSIONS {
            // What the filter begins with is one frame's noise, and shows at first.
            let sure = if self.averaged_s > LEFT_S { 2 } else { 1 };
            for (known, rest) in self.seen.iter_mut().zip(&rests).take(sure) {
                // What chance alone would show is no scene.
                let seen = ((dot(rest, rest) - variance_of(&unit(*rest))) / dimensions - noise_k2).max(0.0);
                let time_s = if seen > *known { self.learning_s.0 } else { self.learning_s.1 };
                *known += -(-dt_s / time_s).exp_m1() * (seen - *known);
                *known = known.min(LARGEST_K * LARGEST_K);
            }
        }
        self.usual_k += dt_s / self.averaged_s.clamp(dt_s, USUAL_S) * (self.seen_k() - self.usual_k);
        self.first *= (-dt_s / FIRST_S).exp();
        self.lately = self.unlike().max(self.lately * (-dt_s / LATELY_S - turn.abs() / LATELY_RAD).exp());
        self.long += -(-dt_s / LONG_S).exp_m1() * (self.unlike() - self.long);
    }

    /// The variance of a scene, K².
    pub fn variance(&self) -> f64 {
        self.seen[0].max(self.least).max(self.first)
    }

    /// How surely what is seen is no sky that is alike all around, 0..1.
    pub fn unlike(&self) -> f64 {
        unlike(self.seen[0])
    }

    /// The same of what is not the sky's shape either, which is still being found.
    pub fn surely_unlike(&self) -> f64 {
        unlike(self.seen[1])
    }

    /// The same, remembered: what made the scene unlike is still there while nothing shows it.
    pub fn lately_unlike(&self) -> f64 {
        self.lately
    }

    /// The same, averaged: what is new is not yet there.
    pub fn long_unlike(&self) -> f64 {
        self.long
    }

    /// The size of what is seen of scenes, K.
    pub fn seen_k(&self) -> f64 {
        self.seen[0].sqrt()
    }

    /// What was new was no scene but one sensor, `i`, that is not heard any more.
    pub fn blame(&mut self, i: usize) {
        self.left[i] = 0.0;
        self.seen = self.seen.map(|seen| seen.min(self.usual_k * self.usual_k));
    }

    /// Nothing that was seen was a scene.
    pub fn forget(&mut self) {
        *self = Self::new(self.least.sqrt(), self.learning_s);
    }

    /// The size of what has usually been seen of them, K.
    pub fn usual_k(&self) -> f64 {
        self.usual_k
    }

    /// Whether it has been looked at for long enough, and hardly any has been seen.
    pub fn is_even(&self) -> bool {
        self.averaged_s > EVEN.0 && self.usual_k < EVEN.1
    }

    /// The size of what has lately been seen of them, K: what is usual is there still while nothing shows it.
    pub fn lately_k(&self) -> f64 {
        self.seen_k().max(self.usual_k)
    }

    /// How much stronger than usual they are, K.
    pub fn new_k(&self) -> f64 {
        (self.seen_k() - NEW * self.usual_k).max(0.0)
    }

    /// As large a scene as that which has been there all along would be to hide as much as what is new, K.
    pub fn new_hides_k(&self) -> f64 {
        NEW_HIDES * self.new_k()
    }

    /// What sensor `i` has lately shown beyond its prediction, K.
    pub fn left_k(&self, i: usize) -> f64 {
        self.left[i]
    }
}

/// How surely a misfit of this mean square, K², is no noise.
fn unlike(seen: f64) -> f64 {
    let x = ((seen.sqrt() - UNLIKE_K.0) / (UNLIKE_K.1 - UNLIKE_K.0)).clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seeing(seen_k: f64, usual_k: f64) -> SceneStrength {
        SceneStrength { seen: [seen_k * seen_k; 2], usual_k, ..SceneStrength::new(0.02, (1.0, 10.0)) }
    }

    #[test]
    fn a_sky_is_even_once_it_has_been_looked_at_and_nothing_was_there() {
        let after = |averaged_s, usual_k| SceneStrength { averaged_s, ..seeing(0.01, usual_k) }.is_even();
        assert!(after(11.0, 0.015) && !after(9.0, 0.015), "not known at first");
        assert!(!after(11.0, 0.03));
    }

    #[test]
    fn what_was_seen_lately_is_there_still() {
        assert_eq!([seeing(0.2, 0.5).lately_k(), seeing(0.5, 0.2).lately_k()], [0.5; 2]);
    }

    #[test]
    fn what_is_new_hides_more_than_what_was_always_there() {
        assert_eq!(seeing(0.2, 0.0).new_hides_k(), 0.5);
        for usual_k in [0.15, 0.2, 0.5] {
            assert_eq!(seeing(0.2, usual_k).new_hides_k(), 0.0, "{usual_k}");
        }
    }
}
