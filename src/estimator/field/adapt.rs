//! How much the world moves, learnt from the innovations.

use super::model::Seen;
use super::state::MAX_SENSORS;

/// One number a sensor.
pub type Pattern = [f64; MAX_SENSORS];

/// How long the doubt of the beginning lasts, s.
const FIRST_S: f64 = 3.0;
/// Over this time innovations are averaged to see what no state explains, s.
const LEFT_S: f64 = 1.0;
/// An innovation beyond this is a glitch and no scene, K.
const GLITCH_K: f64 = 1.0;
/// The largest scene, K.
const LARGEST_K: f64 = 4.0;
/// How long a scene that was unlike is thought to be so still, s.
const LATELY_S: f64 = 120.0;
/// How long it has to be unlike to have been so for long, s.
const LONG_S: f64 = 30.0;
/// In fewer dimensions a scene of its own is not seen: all may be the sky's depth.
const LEAST_DIMENSIONS: f64 = 0.25;
/// A misfit no larger than the first is noise; one of the second is a scene, K.
const UNLIKE_K: (f64, f64) = (0.015, 0.04);

/// Directions among the sensors' readings: what a turn, a contrast and a ground would change.
#[derive(Clone, Copy, Debug)]
pub struct Directions {
    /// About the nose; about the left wing, less what the first explains.
    pub turn: [Pattern; 2],
    /// The length of each turn's pattern before it was made one, K/rad.
    slope: [f64; 2],
    /// The contrast, less what the turns explain.
    pub contrast: Pattern,
    /// The ground, less what all these explain; zero for pairs.
    ground: Pattern,
    /// The sky's depth, less what all these explain; zero where that is nothing.
    depth: Pattern,
    /// What the depth, as uncertain as it is, may leave unexplained, of all of it: 0..1.
    unsure: f64,
    /// How many sensors gave a reading.
    count: usize,
}

impl Directions {
    /// Of the sensors that gave a reading, under a sky whose depth's logarithm has this variance.
    pub fn new(seen: &[Option<Seen>; MAX_SENSORS], depth_variance: f64) -> Self {
        let pattern = |f: fn(&Seen) -> f64| -> Pattern { std::array::from_fn(|i| seen[i].as_ref().map_or(0.0, f)) };
        let roll = pattern(|s| s.by_turn[0]);
        let slope = dot(&roll, &roll).sqrt();
        let roll = unit(roll);
        let pitch = without(pattern(|s| s.by_turn[1]), &[roll]);
        let slope = [slope, dot(&pitch, &pitch).sqrt()];
        let pitch = unit(pitch);
        let contrast = unit(without(pattern(|s| s.by_contrast), &[roll, pitch]));
        let ground = unit(without(pattern(|s| s.by_ground), &[roll, pitch, contrast]));
        let depth = without(pattern(|s| s.by_depth), &[roll, pitch, contrast, ground]);
        let unsure = dot(&depth, &depth) * depth_variance;
        let unsure = unsure / (unsure + UNLIKE_K.0 * UNLIKE_K.0);
        let count = seen.iter().flatten().count();
        Self { turn: [roll, pitch], slope, contrast, ground, depth: unit(depth), unsure, count }
    }

    /// The turn that a pattern looks like, rad; none where the sensors see no turn.
    pub fn turned(&self, pattern: &Pattern) -> [f64; 2] {
        std::array::from_fn(|k| if self.slope[k] > 1.0 { dot(pattern, &self.turn[k]) / self.slope[k] } else { 0.0 })
    }

    /// What of a pattern none of them explains, and in how many dimensions that is seen: the only one left by
    /// five sensors is the sky's depth's, until that is known.
    fn rest(&self, pattern: Pattern) -> (Pattern, f64) {
        let known = [self.turn[0], self.turn[1], self.contrast, self.ground];
        let dimensions = self.count.saturating_sub(known.iter().filter(|k| dot(k, k) > 0.5).count());
        let mut rest = without(pattern, &known);
        if dimensions > 1 {
            return (rest, dimensions as f64);
        }
        let share = self.unsure * dot(&rest, &self.depth);
        rest.iter_mut().zip(&self.depth).for_each(|(r, d)| *r -= share * d);
        (rest, dimensions as f64 - self.unsure)
    }
}

/// Learns how strong the sensors' own scenes are from what no attitude, ground or contrast explains.
#[derive(Clone, Debug)]
pub struct SceneStrength {
    least: f64,
    learning_s: (f64, f64),
    left: Pattern,
    /// For how long that has been averaged, s.
    averaged_s: f64,
    seen: f64,
    first: f64,
    /// How surely it has lately been seen to be unlike.
    lately: f64,
    /// How surely it has been so for long.
    long: f64,
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
            seen: 1e-4,
            first: 0.0,
            lately: 0.0,
            long: 0.0,
        }
    }

    /// Begins with scenes of `first_k`, and what has `lately` been seen to be unlike: it is there still, and a filter that
    /// begins anew takes it for a part of the sky.
    pub fn begin(&mut self, first_k: f64, lately: f64) {
        (self.first, self.lately) = (first_k * first_k, lately);
    }

    /// Takes in each sensor's innovation and what its scene is taken to add, K; `variance_of` a pattern of scenes,
    /// K², is how well they are known.
    pub fn update(
        &mut self,
        (innovations, scenes): (&Pattern, &Pattern),
        directions: &Directions,
        variance_of: impl Fn(&Pattern) -> f64,
        dt_s: f64,
    ) {
        let share = -(-dt_s / LEFT_S).exp_m1();
        for (left, innovation) in self.left.iter_mut().zip(innovations) {
            *left += share * (innovation.clamp(-GLITCH_K, GLITCH_K) - *left);
        }
        let (rest, dimensions) = directions.rest(std::array::from_fn(|i| self.left[i] + scenes[i]));
        // What the filter begins with is one frame's noise, and shows at first.
        self.averaged_s += dt_s;
        if dimensions > LEAST_DIMENSIONS && self.averaged_s > LEFT_S {
            // What chance alone would show is no scene.
            let seen = (dot(&rest, &rest) - variance_of(&unit(rest))).max(0.0) / dimensions;
            let time_s = if seen > self.seen { self.learning_s.0 } else { self.learning_s.1 };
            self.seen += -(-dt_s / time_s).exp_m1() * (seen - self.seen);
            self.seen = self.seen.min(LARGEST_K * LARGEST_K);
        }
        self.first *= (-dt_s / FIRST_S).exp();
        self.lately = self.unlike().max(self.lately * (-dt_s / LATELY_S).exp());
        self.long += -(-dt_s / LONG_S).exp_m1() * (self.unlike() - self.long);
    }

    /// The variance of a scene, K².
    pub fn variance(&self) -> f64 {
        self.seen.max(self.least).max(self.first)
    }

    /// How surely what is seen is no sky that is alike all around, 0..1.
    pub fn unlike(&self) -> f64 {
        let x = ((self.seen.sqrt() - UNLIKE_K.0) / (UNLIKE_K.1 - UNLIKE_K.0)).clamp(0.0, 1.0);
        x * x * (3.0 - 2.0 * x)
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
        self.seen.sqrt()
    }

    /// What sensor `i` has lately shown beyond its prediction, K.
    pub fn left_k(&self, i: usize) -> f64 {
        self.left[i]
    }
}

/// The scalar product of two patterns.
pub fn dot(a: &Pattern, b: &Pattern) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Length 1, or zero where there is no length.
fn unit(a: Pattern) -> Pattern {
    let length = dot(&a, &a).sqrt();
    if length > 1e-6 { a.map(|c| c / length) } else { Pattern::default() }
}

/// Less its shares along `known`, which are at right angles to each other.
fn without(mut a: Pattern, known: &[Pattern]) -> Pattern {
    for k in known {
        let share = dot(&a, k);
        a.iter_mut().zip(k).for_each(|(a, k)| *a -= share * k);
    }
    a
}
