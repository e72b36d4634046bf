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
pub const GLITCH_K: f64 = 1.0;
/// The largest scene, K.
const LARGEST_K: f64 = 4.0;
/// How long a scene that was unlike is thought to be so still, s.
const LATELY_S: f64 = 120.0;
/// Over this time it is seen how strong scenes usually are, s; what is no stronger than so many times that is nothing new.
const USUAL_S: f64 = 60.0;
const NEW: f64 = 1.5;
/// How long it has to be unlike to have been so for long, s.
const LONG_S: f64 = 30.0;
/// Noise leaves so much in that average, K, where it is as small as it should be, at 50 Hz: of more, so many times its
/// variance is no scene.
const EXPECTED_K: f64 = 0.0085;
const SAFELY: f64 = 4.0;
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
    contrast: Pattern,
    /// All that another contrast would change.
    weather: Pattern,
    /// The ground, less what all these explain; zero for pairs.
    ground: Pattern,
    /// The sky's shape, less what all these explain: its depth, and the spread of the field of view.
    shape: [Pattern; 2],
    /// How much of each a pattern is taken to be, as uncertain as they are, for its products with both.
    gain: [[f64; 2]; 2],
    /// In how many dimensions the shape, as uncertain as it is, explains what is seen: 0..2.
    unsure: f64,
    /// The turns, less what another contrast or ground would explain.
    weatherless: [Pattern; 2],
    /// How many sensors gave a reading.
    count: usize,
}

impl Directions {
    /// Of the sensors that gave a reading, under a sky whose shape, depth's logarithm and spread, has this covariance.
    pub fn new(seen: &[Option<Seen>; MAX_SENSORS], covariance: [[f64; 2]; 2]) -> Self {
        let pattern = |f: fn(&Seen) -> f64| -> Pattern { std::array::from_fn(|i| seen[i].as_ref().map_or(0.0, f)) };
        let roll = pattern(|s| s.by_turn[0]);
        let slope = dot(&roll, &roll).sqrt();
        let roll = unit(roll);
        let pitch = without(pattern(|s| s.by_turn[1]), &[roll]);
        let slope = [slope, dot(&pitch, &pitch).sqrt()];
        let pitch = unit(pitch);
        let contrast = unit(without(pattern(|s| s.by_contrast), &[roll, pitch]));
        let ground = unit(without(pattern(|s| s.by_ground), &[roll, pitch, contrast]));
        let weather = unit(pattern(|s| s.by_contrast));
        let weather = [weather, unit(without(pattern(|s| s.by_ground), &[weather]))];
        let rolled = unit(without(roll, &weather));
        let weatherless = [rolled, unit(without(without(pitch, &weather), &[rolled]))];
        let [weather, _] = weather;
        let known = [roll, pitch, contrast, ground];
        let shape = [pattern(|s| s.by_depth), pattern(|s| s.by_spread)].map(|p| without(p, &known));
        let (gain, unsure) = gain(&shape, covariance);
        let count = seen.iter().flatten().count();
        Self { turn: [roll, pitch], slope, contrast, weather, ground, shape, gain, unsure, weatherless, count }
    }

    /// The turn that a pattern looks like, rad; none where the sensors see no turn.
    pub fn turned(&self, pattern: &Pattern) -> [f64; 2] {
        std::array::from_fn(|k| if self.slope[k] > 1.0 { dot(pattern, &self.turn[k]) / self.slope[k] } else { 0.0 })
    }

    /// What of a pattern looks like another contrast, and is neither a turn nor what the contrast has given way by to one:
    /// where a turn is not believed, what is taken for a contrast instead would ask for more and more of that.
    pub fn weathered(&self, pattern: &Pattern) -> f64 {
        let (beside, whole) = (dot(pattern, &self.contrast), dot(pattern, &self.weather));
        if beside * whole > 0.0 { beside.signum() * beside.abs().min(whole.abs()) } else { 0.0 }
    }

    /// The mean square of what of a pattern is a turn and no other contrast or ground, over its variance.
    pub fn weatherless(&self, pattern: &Pattern, variance_of: impl Fn(&Pattern) -> f64) -> f64 {
        let square = |turn: &Pattern| dot(pattern, turn).powi(2) / variance_of(turn);
        self.weatherless.iter().map(square).sum::<f64>() / 2.0
    }

    /// How many sensors gave a reading.
    pub fn count(&self) -> usize {
        self.count
    }

    /// What of a pattern no turn, contrast or ground explains, and in how many dimensions that is seen.
    pub fn unexplained(&self, pattern: &Pattern) -> (Pattern, usize) {
        let known = [self.turn[0], self.turn[1], self.contrast, self.ground];
        let dimensions = self.count.saturating_sub(known.iter().filter(|k| dot(k, k) > 0.5).count());
        (without(*pattern, &known), dimensions)
    }

    /// What of a pattern is unexplained; of that, what the sky's shape, as uncertain as it is, does not explain either; and
    /// in how many dimensions that is seen. The only one left by five sensors is the shape's, until that is known.
    fn rests(&self, pattern: &Pattern) -> ([Pattern; 2], f64) {
        let (rest, dimensions) = self.unexplained(pattern);
        let along = [dot(&rest, &self.shape[0]), dot(&rest, &self.shape[1])];
        let mut sure = rest;
        for (gain, shape) in self.gain.iter().zip(&self.shape) {
            let share = gain[0] * along[0] + gain[1] * along[1];
            sure.iter_mut().zip(shape).for_each(|(r, s)| *r -= share * s);
        }
        if dimensions > 1 { ([rest, sure], dimensions as f64) } else { ([sure; 2], dimensions as f64 - self.unsure) }
    }
}

/// The gain of least squares for two patterns of which there is as much as `covariance` says, beside what is no scene;
/// and in how many dimensions they explain what is seen.
fn gain(patterns: &[Pattern; 2], covariance: [[f64; 2]; 2]) -> ([[f64; 2]; 2], f64) {
    let products = patterns.map(|a| patterns.map(|b| dot(&a, &b)));
    let times = |a: [[f64; 2]; 2], b: [[f64; 2]; 2]| {
        a.map(|row| std::array::from_fn::<f64, 2, _>(|k| row[0] * b[0][k] + row[1] * b[1][k]))
    };
    let [mut a, mut b] = times(products, covariance);
    let noise = UNLIKE_K.0 * UNLIKE_K.0;
    (a[0], b[1]) = (a[0] + noise, b[1] + noise);
    let determinant = a[0] * b[1] - a[1] * b[0];
    let inverse = [[b[1], -a[1]], [-b[0], a[0]]].map(|row| row.map(|v| v / determinant));
    let gain = times(covariance, inverse);
    let explained = times(gain, products);
    (gain, (explained[0][0] + explained[1][1]).clamp(0.0, 2.0))
}

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
    /// K², is how well they are known; `noise_k2` is the variance of a reading, K².
    pub fn update(
        &mut self,
        (innovations, scenes): (&Pattern, &Pattern),
        directions: &Directions,
        variance_of: impl Fn(&Pattern) -> f64,
        (noise_k2, dt_s): (f64, f64),
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
        self.lately = self.unlike().max(self.lately * (-dt_s / LATELY_S).exp());
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

    /// How much stronger than usual they are, K.
    pub fn new_k(&self) -> f64 {
        (self.seen_k() - NEW * self.usual_k).max(0.0)
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Banked, so that another contrast alone looks like a turn: right, left, up, down.
    fn banked() -> [Option<Seen>; MAX_SENSORS] {
        let (by_turn, by_contrast) = ([8.0, -30.0, 4.0, -1.0], [-0.1, -0.7, -0.9, 0.0]);
        std::array::from_fn(|i| {
            let by_turn = [*by_turn.get(i)?, 0.0, 0.0];
            Some(Seen { by_turn, by_ground: 1.0, by_contrast: by_contrast[i], ..Seen::default() })
        })
    }

    #[test]
    fn what_the_contrast_gives_way_by_to_a_turn_asks_for_no_more_of_it() {
        let seen = banked();
        let directions = Directions::new(&seen, [[0.0; 2]; 2]);
        let pattern = |f: fn(&Seen) -> f64| std::array::from_fn(|i| seen[i].as_ref().map_or(0.0, f));
        let (turn, contrast) = (pattern(|s| s.by_turn[0]), pattern(|s| s.by_contrast));
        assert!(directions.weathered(&turn).abs() < 1e-9);
        assert!((directions.weathered(&contrast) - dot(&contrast, &directions.contrast)).abs() < 1e-9);
        // A turn that is not believed, and the contrast that leaves least of it.
        let share = dot(&turn, &contrast) / dot(&contrast, &contrast);
        let left: Pattern = std::array::from_fn(|i| turn[i] - share * contrast[i]);
        assert!(dot(&left, &directions.contrast).abs() > 1.0 && directions.weathered(&left).abs() < 1e-9);
    }

    #[test]
    fn another_contrast_or_ground_is_no_turn() {
        let seen = banked();
        let directions = Directions::new(&seen, [[0.0; 2]; 2]);
        let pattern = |f: fn(&Seen) -> f64| std::array::from_fn(|i| seen[i].as_ref().map_or(0.0, f));
        let square = |p: Pattern| directions.weatherless(&p, |_| 1.0);
        assert!(dot(&pattern(|s| s.by_contrast), &directions.turn[0]).abs() > 0.3);
        assert!(square(pattern(|s| s.by_contrast)) < 1e-9 && square(pattern(|s| s.by_ground)) < 1e-9);
        assert!(square(pattern(|s| s.by_turn[0])) > 10.0);
    }
}
