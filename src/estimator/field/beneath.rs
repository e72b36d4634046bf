//! How much of what makes a scene unlike an even sky lies beneath: on the ground.
//!
//! Clouds, haze and the sun are in the sky, and what looks down sees none of them: it tells the attitude when the others are
//! misled. Fields, a shore or a slope in the sun are on the ground, and what looks down is misled the most. Which of the two
//! it is shows in what each sensor sees of a scene of its own.
//!
//! Beside a gyro it is taken to be in the sky until it shows. Without one much of a scene is taken for an attitude, and where it
//! lies shows less: it may be either until it does. What a sensor always shows where it looks as far up is no scene then: those
//! that see in another form than told would look like a ground of fields.

use super::FieldEstimator;
use super::model::Seen;
use super::state::MAX_SENSORS;

/// What looks down sees at least such a share of a scene.
pub const LEAST: f64 = 0.35;
/// Of what it is seen to see so much is believed: what others see is taken for a scene of its, too.
const BELIEVED: f64 = 0.75;
/// The share without a gyro where what looks down sees so many times as much as what looks up; it grows with the square.
const EITHER: (f64, f64) = (0.6, 0.9);
/// Scenes are averaged over this time, s.
const TIME_S: f64 = 60.0;
/// They are taken to be so strong at first, K: beside a gyro, and without.
const FIRST_K: (f64, f64) = (0.1, 0.2);
/// What is weaker tells nothing, K; so too.
const NOTHING_K: (f64, f64) = (0.03, 0.1);
/// One sensor's scene counts no more than so much, K: what it does alone is no scene.
const MOST_K: f64 = 1.0;
/// So many sensors must look at the sky, and as many at the ground.
const ENOUGH: f64 = 0.5;
/// So many parts, by how much of the sky is seen, have what is usual in them.
const PARTS: usize = 8;

/// The mean squares of what sensors see of scenes, K²: of those that look at the ground, and at the sky.
#[derive(Clone, Copy, Debug)]
struct Squares {
    ground: f64,
    sky: f64,
}

impl Squares {
    /// Of scenes, K, each with the share of the sky that is seen, in `dt_s`.
    fn update(&mut self, scenes: impl Iterator<Item = (f64, f64)> + Clone, dt_s: f64) {
        let mean = |weight: fn(f64) -> f64| {
            let (sum, whole) = scenes.clone().fold((0.0, 0.0), |(sum, whole), (sky, scene_k)| {
                (sum + weight(sky) * scene_k.powi(2).min(MOST_K * MOST_K), whole + weight(sky))
            });
            (whole > ENOUGH).then(|| sum / whole)
        };
        if let (Some(ground), Some(sky)) = (mean(|sky| 1.0 - sky), mean(|sky| sky)) {
            let share = -(-dt_s / TIME_S).exp_m1();
            self.ground += share * (ground - self.ground);
            self.sky += share * (sky - self.sky);
        }
    }
}

/// Where a scene lies.
#[derive(Clone, Copy, Debug)]
pub struct Beneath {
    gyro: Squares,
    alone: Squares,
    /// What is usually seen in each part, K, and how well that is known, 0..1: one over the other.
    usual: [(f64, f64); PARTS],
}

impl Default for Beneath {
    fn default() -> Self {
        let first = |share: f64, k: f64| Squares { ground: (share * k).powi(2), sky: k.powi(2) };
        Self { gyro: first(LEAST, FIRST_K.0), alone: first(EITHER.1, FIRST_K.1), usual: [(0.0, 0.0); PARTS] }
    }
}

impl Beneath {
    /// Takes in what each sensor sees, and its scene, K, for `dt_s`, beside a gyro or without.
    pub fn update(&mut self, scenes: impl Iterator<Item = (Seen, f64)> + Clone, gyro: bool, dt_s: f64) {
        let scenes = scenes.map(|(seen, scene_k)| (seen.sky, seen.scene * scene_k));
        if gyro {
            return self.gyro.update(scenes, dt_s);
        }
        let part = |sky: f64| ((sky * PARTS as f64) as usize).min(PARTS - 1);
        let share = -(-dt_s / TIME_S).exp_m1();
        for (sky, scene_k) in scenes.clone() {
            let (sum, known) = &mut self.usual[part(sky)];
            *sum += share * (scene_k.clamp(-MOST_K, MOST_K) - *sum);
            *known += share * (1.0 - *known);
        }
        let usual = self.usual.map(|(sum, known)| if known > 0.0 { sum / known } else { 0.0 });
        self.alone.update(scenes.map(|(sky, scene_k)| (sky, scene_k - usual[part(sky)])), dt_s);
    }

    /// The share that what looks straight down sees of a scene, beside a gyro.
    pub fn share(&self) -> f64 {
        let Squares { ground, sky } = self.gyro;
        (BELIEVED * (ground / (sky + NOTHING_K.0.powi(2))).sqrt()).clamp(LEAST, 1.0)
    }

    /// The same without: what is weak is thought to be in the sky, and what is new, `new_k`, to lie on either; it may be a wall.
    pub fn share_alone(&self, new_k: f64) -> f64 {
        let Squares { ground, sky } = self.alone;
        let ((share, times), nothing, new) = (EITHER, NOTHING_K.1.powi(2), new_k.powi(2));
        let seen = share * (ground / times.powi(2) + new) + LEAST * nothing;
        (seen / (sky + new + nothing)).clamp(LEAST, 1.0)
    }
}

impl FieldEstimator {
    /// Finds how much of the scene lies beneath in what the sensors have `seen` for `dt_s`.
    pub(super) fn find_beneath(&mut self, seen: &[Option<Seen>; MAX_SENSORS], dt_s: f64) {
        let all = seen.iter().flatten().count() == self.model.sensors();
        let gyro = self.gyro.in_use();
        // What one sensor does is no scene.
        if all && !self.witnesses.undecided() {
            let own = |i: usize| self.state.x[self.state.scene(i)];
            self.beneath.update(seen.iter().enumerate().filter_map(|(i, s)| Some(((*s)?, own(i)))), gyro, dt_s);
        }
        self.state.beneath = if gyro { self.beneath.share() } else { self.beneath.share_alone(self.scene.new_k()) };
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::after;
    use super::*;
    use crate::frame::Aiding;
    use crate::simulation::Scenario;

    /// After three minutes of scenes, K, of the horizontal four and of what looks up and down: those of one minute, and so on.
    fn shown(scenes_k: [(f64, f64, f64); 3], gyro: bool) -> f64 {
        let mut beneath = Beneath::default();
        let share = |beneath: &Beneath| if gyro { beneath.share() } else { beneath.share_alone(0.0) };
        for (level_k, up_k, down_k) in scenes_k {
            for _ in 0..3000 {
                let sees = |sky: f64| Seen { sky, scene: sky.max(share(&beneath)), ..Seen::default() };
                let scenes =
                    [(1.0, level_k), (1.0, -level_k), (1.0, level_k), (1.0, -level_k), (1.0, up_k), (0.0, down_k)];
                let scenes = scenes.map(|(sky, scene_k)| (sees(sky), scene_k));
                beneath.update(scenes.into_iter(), gyro, 0.02);
            }
        }
        share(&beneath)
    }

    #[test]
    fn what_looks_down_tells_where_it_lies() {
        let shown = |scenes_k| shown([scenes_k; 3], true);
        assert_eq!(shown((0.5, 0.5, 0.5)), LEAST, "as expected of the sky");
        assert_eq!(shown((0.5, 0.5, 0.0)), LEAST);
        assert_eq!(shown((0.3, 0.1, 0.9)), 1.0);
        assert_eq!(shown((0.01, 0.0, 0.02)), LEAST, "noise");
    }

    #[test]
    fn without_a_gyro_it_may_lie_on_either_until_it_shows() {
        let turned = |(level_k, up_k, down_k): (f64, f64, f64)| {
            shown([1.0, -1.0, 1.0].map(|a| (a * level_k, a * up_k, a * down_k)), false)
        };
        assert!((0.5..EITHER.0).contains(&Beneath::default().share_alone(0.0)));
        assert!(turned((0.02, 0.0, 0.02)) < 0.45, "noise");
        let clear = Beneath { alone: Squares { ground: 0.0, sky: 0.0 }, ..Beneath::default() };
        assert!(clear.share_alone(0.0) == LEAST && clear.share_alone(0.5) > 0.55, "what is new");
        assert_eq!(turned((0.5, 0.5, 0.1)), LEAST);
        assert_eq!(turned((0.3, 0.1, 0.9)), 1.0);
    }

    /// As of sensors that see in another form than told.
    #[test]
    fn what_is_always_seen_is_no_scene_without_a_gyro() {
        let [always, turned] = [[1.0; 3], [1.0, -1.0, 1.0]].map(|a| shown(a.map(|a| (0.3, 0.1, 0.9 * a)), false));
        assert!(always < turned, "{always} {turned}");
    }

    #[test]
    fn without_a_view_down_nothing_is_learnt() {
        let up = Seen { sky: 1.0, scene: 1.0, ..Seen::default() };
        for gyro in [false, true] {
            let mut beneath = Beneath::default();
            (0..3000).for_each(|_| beneath.update([(up, 0.5); 5].into_iter(), gyro, 0.02));
            let shares = |b: &Beneath| (b.share(), b.share_alone(0.0));
            assert_eq!(shares(&beneath), shares(&Beneath::default()));
        }
    }

    /// After two minutes in flight.
    #[test]
    fn fields_lie_on_the_ground_and_clouds_do_not() {
        for (scene, aided, alone) in [
            ("patchwork", 0.8..=1.0, 0.8..=1.0),
            ("warm-side", 0.8..=1.0, 0.8..=1.0),
            ("scattered", LEAST..=0.4, LEAST..=0.5),
        ] {
            for (instruments, expected) in [(false, alone), (true, aided)] {
                let share = after(&Scenario::named(scene).unwrap(), 32, 6000, |frame| {
                    if !instruments {
                        frame.aiding = Aiding::default();
                    }
                })
                .state
                .beneath;
                assert!(expected.contains(&share), "{scene}, instruments {instruments}: {share}");
            }
        }
    }
}
