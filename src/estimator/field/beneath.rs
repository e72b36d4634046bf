//! How much of what makes a scene unlike an even sky lies beneath: on the ground.
//!
//! Clouds, haze and the sun are in the sky, and what looks down sees none of them: it tells the attitude when the others are
//! misled. Fields, a shore or a slope in the sun are on the ground, and what looks down is misled the most. Which of the two
//! it is shows in what each sensor sees of a scene of its own.
//!
//! It is asked with a gyro alone. Without one much of a scene is taken for an attitude, and sensors that see in another form
//! than told look like a ground of fields: angles are underestimated by a half more then.

use super::FieldEstimator;
use super::model::Seen;
use super::state::MAX_SENSORS;

/// What looks down sees at least such a share of a scene.
pub const LEAST: f64 = 0.35;
/// Of what it is seen to see so much is believed: what others see is taken for a scene of its, too.
const BELIEVED: f64 = 0.75;
/// Scenes are averaged over this time, s.
const TIME_S: f64 = 60.0;
/// At first they are taken to be in the sky, and to be so strong, K.
const FIRST_K: f64 = 0.1;
/// What is weaker tells nothing, K.
const NOTHING_K: f64 = 0.03;
/// One sensor's scene counts no more than so much, K: what it does alone is no scene.
const MOST_K: f64 = 1.0;
/// So many sensors must look at the sky, and as many at the ground.
const ENOUGH: f64 = 0.5;

/// The mean squares of what sensors see of scenes, K²: of those that look at the ground, and at the sky.
#[derive(Clone, Copy, Debug)]
pub struct Beneath {
    ground: f64,
    sky: f64,
}

impl Default for Beneath {
    fn default() -> Self {
        Self { ground: (LEAST * FIRST_K).powi(2), sky: FIRST_K.powi(2) }
    }
}

impl Beneath {
    /// Takes in what each sensor sees, and its scene, K, for `dt_s`.
    pub fn update(&mut self, scenes: impl Iterator<Item = (Seen, f64)> + Clone, dt_s: f64) {
        let mean = |weight: fn(f64) -> f64| {
            let (sum, whole) = scenes.clone().fold((0.0, 0.0), |(sum, whole), (seen, scene_k)| {
                let square = (seen.scene * scene_k).powi(2).min(MOST_K * MOST_K);
                (sum + weight(seen.sky) * square, whole + weight(seen.sky))
            });
            (whole > ENOUGH).then(|| sum / whole)
        };
        if let (Some(ground), Some(sky)) = (mean(|sky| 1.0 - sky), mean(|sky| sky)) {
            let share = -(-dt_s / TIME_S).exp_m1();
            self.ground += share * (ground - self.ground);
            self.sky += share * (sky - self.sky);
        }
    }

    /// The share that what looks straight down sees of a scene.
    pub fn share(&self) -> f64 {
        (BELIEVED * (self.ground / (self.sky + NOTHING_K * NOTHING_K)).sqrt()).clamp(LEAST, 1.0)
    }
}

impl FieldEstimator {
    /// Finds how much of the scene lies beneath in what the sensors have `seen` for `dt_s`.
    pub(super) fn find_beneath(&mut self, seen: &[Option<Seen>; MAX_SENSORS], dt_s: f64) {
        let all = seen.iter().flatten().count() == self.model.sensors();
        // What one sensor does is no scene.
        if self.gyro.in_use() && all && !self.witnesses.undecided() {
            let own = |i: usize| self.state.x[self.state.scene(i)];
            self.beneath.update(seen.iter().enumerate().filter_map(|(i, s)| Some(((*s)?, own(i)))), dt_s);
        }
        self.state.beneath = if self.gyro.in_use() { self.beneath.share() } else { LEAST };
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::after;
    use super::*;
    use crate::frame::Aiding;
    use crate::simulation::Scenario;

    /// After three minutes of scenes, K, of the horizontal four and of what looks up and down.
    fn shown(level_k: f64, up_k: f64, down_k: f64) -> f64 {
        let mut beneath = Beneath::default();
        for _ in 0..9000 {
            let sees = |sky: f64| Seen { sky, scene: sky.max(beneath.share()), ..Seen::default() };
            let scenes = [(1.0, level_k), (1.0, -level_k), (1.0, level_k), (1.0, level_k), (1.0, up_k), (0.0, down_k)];
            let scenes = scenes.map(|(sky, scene_k)| (sees(sky), scene_k));
            beneath.update(scenes.into_iter(), 0.02);
        }
        beneath.share()
    }

    #[test]
    fn what_looks_down_tells_where_it_lies() {
        assert_eq!(shown(0.5, 0.5, 0.5), LEAST, "as expected of the sky");
        assert_eq!(shown(0.5, 0.5, 0.0), LEAST);
        assert_eq!(shown(0.3, 0.1, 0.9), 1.0);
        assert_eq!(shown(0.01, 0.0, 0.02), LEAST, "noise");
    }

    #[test]
    fn without_a_view_down_nothing_is_learnt() {
        let mut beneath = Beneath::default();
        let up = Seen { sky: 1.0, scene: 1.0, ..Seen::default() };
        (0..3000).for_each(|_| beneath.update([(up, 0.5); 5].into_iter(), 0.02));
        assert_eq!(beneath.share(), LEAST);
    }

    /// After two minutes in flight.
    #[test]
    fn fields_lie_on_the_ground_and_clouds_do_not() {
        for (scene, lowest, highest) in [("patchwork", 0.8, 1.0), ("warm-side", 0.8, 1.0), ("scattered", LEAST, 0.4)] {
            for aided in [false, true] {
                let share = after(&Scenario::named(scene).unwrap(), 32, 6000, |frame| {
                    if !aided {
                        frame.aiding = Aiding::default();
                    }
                })
                .state
                .beneath;
                let expected = if aided { lowest..=highest } else { LEAST..=LEAST };
                assert!(expected.contains(&share), "{scene}, aided {aided}: {share}");
            }
        }
    }
}
