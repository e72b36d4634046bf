//! Directions among the sensors' readings, by which innovations are told apart.

use super::model::Seen;
use super::scene::UNLIKE_K;
use super::state::MAX_SENSORS;
use crate::estimator::linear::solve;

/// What the sky's shape is told by: its depth, how much is averaged in radiance, and the field of view.
pub const SHAPE: usize = 5;

/// One number a sensor.
pub type Pattern = [f64; MAX_SENSORS];

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
    /// The sky's shape, less what all these explain.
    shape: [Pattern; SHAPE],
    /// How much of each a pattern is taken to be, as uncertain as they are, for its products with all of them.
    gain: [[f64; SHAPE]; SHAPE],
    /// In how many dimensions the shape, as uncertain as it is, explains what is seen: 0..5.
    unsure: f64,
    /// The turns, less what another contrast or ground would explain.
    weatherless: [Pattern; 2],
    /// How many sensors gave a reading.
    count: usize,
}

impl Directions {
    /// Of the sensors that gave a reading, under a sky whose shape, depth's logarithm, averaging and field of view, has this
    /// covariance.
    pub fn new(seen: &[Option<Seen>; MAX_SENSORS], covariance: [[f64; SHAPE]; SHAPE]) -> Self {
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
        let shape = [
            pattern(|s| s.by_depth),
            pattern(|s| s.by_radiance),
            pattern(|s| s.by_view[0]),
            pattern(|s| s.by_view[1]),
            pattern(|s| s.by_view[2]),
        ];
        let shape = shape.map(|p| without(p, &known));
        let (gain, unsure) = gain(&shape, covariance);
        let count = seen.iter().flatten().count();
        Self { turn: [roll, pitch], slope, contrast, weather, ground, shape, gain, unsure, weatherless, count }
    }

    /// The turn that a pattern looks like, rad; none about an axis of which the sensors show less than `least`, K/rad.
    pub fn turned(&self, pattern: &Pattern, least: f64) -> [f64; 2] {
        std::array::from_fn(|k| if self.slope[k] > least { dot(pattern, &self.turn[k]) / self.slope[k] } else { 0.0 })
    }

    /// How much all sensors show of a turn about `axis` in its direction, K/rad.
    pub fn slope(&self, axis: usize) -> f64 {
        self.slope[axis]
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

    /// What the sky's shape would change, less what turns, contrast and ground explain.
    pub fn shape(&self) -> &[Pattern; SHAPE] {
        &self.shape
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
    pub fn rests(&self, pattern: &Pattern) -> ([Pattern; 2], f64) {
        let (rest, dimensions) = self.unexplained(pattern);
        let along = self.shape.map(|shape| dot(&rest, &shape));
        let mut sure = rest;
        for (gain, shape) in self.gain.iter().zip(&self.shape) {
            let share = dot(gain, &along);
            sure.iter_mut().zip(shape).for_each(|(r, s)| *r -= share * s);
        }
        if dimensions > 1 { ([rest, sure], dimensions as f64) } else { ([sure; 2], dimensions as f64 - self.unsure) }
    }
}

/// The gain of least squares for patterns of which there is as much as `covariance` says, beside what is no scene;
/// and in how many dimensions they explain what is seen.
fn gain(patterns: &[Pattern; SHAPE], covariance: [[f64; SHAPE]; SHAPE]) -> ([[f64; SHAPE]; SHAPE], f64) {
    let products = patterns.map(|a| patterns.map(|b| dot(&a, &b)));
    // Both are symmetric: covariance · (products · covariance + noise)⁻¹, row by row.
    let mut matrix = covariance.map(|row| products.map(|column| dot(&row, &column)));
    (0..SHAPE).for_each(|k| matrix[k][k] += UNLIKE_K.0 * UNLIKE_K.0);
    let gain = covariance.map(|row| solve(matrix, row).unwrap_or_default());
    let explained: f64 = gain.iter().zip(&products).map(|(g, p)| dot(g, p)).sum();
    (gain, explained.clamp(0.0, SHAPE as f64))
}

/// The scalar product, of two patterns or of what belongs to the sky's shape.
pub fn dot<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Length 1, or zero where there is no length.
pub fn unit(a: Pattern) -> Pattern {
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
        let directions = Directions::new(&seen, Default::default());
        let pattern = |f: fn(&Seen) -> f64| std::array::from_fn(|i| seen[i].as_ref().map_or(0.0, f));
        let (turn, contrast) = (pattern(|s| s.by_turn[0]), pattern(|s| s.by_contrast));
        assert!(directions.weathered(&turn).abs() < 1e-9);
        assert!((directions.weathered(&contrast) - dot(&contrast, &directions.contrast)).abs() < 1e-9);
        // A turn that is not believed, and the contrast that leaves least of it.
        let share = dot(&turn, &contrast) / dot(&contrast, &contrast);
        let left: Pattern = std::array::from_fn(|i| turn[i] - share * contrast[i]);
        assert!(dot(&left, &directions.contrast).abs() > 1.0 && directions.weathered(&left).abs() < 1e-9);
    }

    /// Half a kelvin of what looks up and down was a bank of 15°, where nothing that looks level was heard.
    #[test]
    fn sensors_that_show_next_to_nothing_of_a_turn_do_not_tell_it() {
        let turned = |by_turn: &[f64]| {
            let seen = std::array::from_fn(|i| {
                Some(Seen { by_turn: [*by_turn.get(i)?, 0.0, 0.0], by_ground: 1.0, ..Seen::default() })
            });
            Directions::new(&seen, Default::default()).turned(&[0.5, -0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], 6.0)
        };
        assert_eq!(turned(&[1.4, -1.4]), [0.0; 2]);
        let [roll, pitch] = turned(&[10.0, -10.0]);
        assert!((roll - 0.05).abs() < 1e-9 && pitch == 0.0, "{roll}, {pitch}");
    }

    #[test]
    fn another_contrast_or_ground_is_no_turn() {
        let seen = banked();
        let directions = Directions::new(&seen, Default::default());
        let pattern = |f: fn(&Seen) -> f64| std::array::from_fn(|i| seen[i].as_ref().map_or(0.0, f));
        let square = |p: Pattern| directions.weatherless(&p, |_| 1.0);
        assert!(dot(&pattern(|s| s.by_contrast), &directions.turn[0]).abs() > 0.3);
        assert!(square(pattern(|s| s.by_contrast)) < 1e-9 && square(pattern(|s| s.by_ground)) < 1e-9);
        assert!(square(pattern(|s| s.by_turn[0])) > 10.0);
    }
}
