//! What speaks against one sensor.

use super::film::{Film, Shown};
use super::filter::Testimony;
use super::follow::Follow;
use crate::estimator::Standing;

/// From this sum of surprises on a sensor is doubted; and under an even sky.
const DOUBT: f64 = 8.0;
const EVEN_DOUBT: f64 = 4.0;
/// A reading this far from what the others say, K, as a share of the contrast and in standard deviations, may be
/// its sensor's matter,
const APART: (f64, f64, f64) = (0.5, 0.02, 2.5);
/// and no more when it has been nearer for this time, s, while it should have changed by so much: K and as a share
/// of the contrast. What is near for want of change proves nothing.
const BACK_S: f64 = 3.0;
const BACK: (f64, f64) = (1.0, 0.06);
/// What looks at the ground hardly changes: so long is enough in any case, s.
const BACK_AT_LAST_S: f64 = 20.0;
/// So far, K or as a share of the contrast, it must be to be left out: smaller ones are the scene's, but for what a film would
/// show. A second sensor must be so many times as far, and its sum as high.
const GUILTY: (f64, f64) = (1.0, 0.08);
const SECOND: f64 = 3.0;
/// In so many steps it must have been ahead of all others. If it looks at the sky, by such a share of the contrast, and shows
/// that colder than it should be, in more: no film makes it that, but what is too warm for the others, a wall, does.
const STEPS: u8 = 3;
const COLDER: (f64, u8) = (0.25, 6);
/// Without it all others must fit together: their squared surprises' mean over some time, s.
const FIT: f64 = 1.7;
const FIT_S: f64 = 0.5;
/// What is left of that where nothing else is amiss: readings are averaged, and noise leaves less than 1.
const PLAIN: f64 = 0.3;
/// Nothing but noise is there for certain below this.
const BEST: f64 = 0.2;
/// Doubt of small matters ends after this time, s.
const DOUBT_S: f64 = 1.5;

/// One sensor before the witnesses.
#[derive(Clone, Copy, Debug, Default)]
pub struct Case {
    pub standing: Standing,
    /// The sum of the surprises of the witness that hears all, less those of the one that does not hear this sensor.
    pub surprise: f64,
    /// For how many steps it has been ahead of all others.
    ahead: u8,
    /// Whether it looks at the sky, and shows that colder than the others say.
    colder: bool,
    pub expected_k: Option<f64>,
    pub residual_k: Option<f64>,
    /// Whether it follows what it should show, since it is not heard.
    follow: Follow,
    /// Whether it shows its own die.
    film: Film,
    near_s: f64,
    /// What it should have shown meanwhile, least and most.
    near_k: Option<(f64, f64)>,
    /// Whether it is far enough off to be left out.
    guilty: bool,
    /// How well all others fit together without it: 1 where there is nothing but noise.
    pub others_fit: f64,
    doubted_s: f64,
    /// Whether it has been in accord with the others for long enough.
    is_back: bool,
}

/// One step of a sensor.
#[derive(Clone, Copy, Debug)]
pub struct Heard {
    /// What it shows, and its die, °C.
    pub reading: Option<f64>,
    pub ambient_c: Option<f64>,
    /// How long the step is, s.
    pub dt_s: f64,
    /// The contrast, K, and the ground, °C.
    pub contrast: f64,
    pub ground_c: f64,
    /// Whether one is left out already.
    pub second: bool,
}

impl Case {
    /// Takes in what sensor `i` shows, and what the others say of it.
    pub fn hear(&mut self, i: usize, heard: &Heard, testimony: &Testimony) {
        let Heard { reading, ambient_c, dt_s, contrast, ground_c, second } = *heard;
        let expected = testimony.expected[i];
        self.expected_k = Some(expected);
        self.residual_k = reading.map(|r| r - expected);
        if self.standing == Standing::Heard {
            self.follow = Follow::default();
        } else {
            reading.into_iter().for_each(|r| self.follow.update(expected, r, dt_s));
        }
        let shown = reading.zip(ambient_c).map(|(reading, ambient_c)| Shown {
            reading,
            ambient_c,
            expected: (expected, testimony.sigma_k[i]),
            sky: (ground_c, contrast),
        });
        self.film.see(shown, dt_s);
        let apart_k = APART.0.max(APART.1 * contrast).max(APART.2 * testimony.sigma_k[i]);
        let far = self.residual_k.is_none_or(|r| r.abs() > apart_k);
        (self.near_s, self.near_k) = match self.near_k {
            _ if far => (0.0, None),
            None => (dt_s, Some((expected, expected))),
            Some((least, most)) => (self.near_s + dt_s, Some((least.min(expected), most.max(expected)))),
        };
        let moved_k = self.near_k.map_or(0.0, |(least, most)| most - least);
        let moved = moved_k > BACK.0.max(BACK.1 * contrast);
        self.is_back = self.near_s > BACK_S && moved || self.near_s > BACK_AT_LAST_S;
        self.colder = self.residual_k.is_some_and(|r| r < 0.0) && ground_c - expected > COLDER.0 * contrast;
        let scenes_k = if self.film.is_seen() { 0.0 } else { GUILTY.1 * contrast };
        let guilty_k = many(second) * GUILTY.0.max(scenes_k);
        self.guilty = self.residual_k.is_some_and(|r| r.abs() > guilty_k);
        self.others_fit += -(-dt_s / FIT_S).exp_m1() * (testimony.squared - self.others_fit);
        self.doubted_s = if self.standing == Standing::Doubted { self.doubted_s + dt_s } else { 0.0 };
    }

    /// How much it does not follow of what it should show, 0..1, where that has changed since it is not heard.
    pub fn lost(&self) -> Option<f64> {
        self.follow.lost()
    }

    /// How surely it goes another way than it should: 0..1.
    pub fn strays(&self) -> f64 {
        self.follow.strays()
    }

    /// One of which nothing is known but whether it was right before.
    pub fn anew(&self) -> Self {
        Self { film: self.film.none(), ..Self::default() }
    }

    /// Whether a film on it explains all that is amiss; it may look `upright`.
    pub fn has_film(&self, upright: bool) -> bool {
        self.standing != Standing::LeftOut && self.film.is_there(upright) && self.is_all_there_is()
    }

    /// Whether it shows as much of its die as a film would, and did not before.
    pub fn shows_die_anew(&self) -> bool {
        self.film.is_seen_anew()
    }

    /// Whether a film that grows on it may explain that.
    pub fn may_have_film(&self) -> bool {
        self.standing != Standing::LeftOut && self.film.may_grow() && self.is_all_there_is()
    }

    /// Whether it is left out and may be heard again. Where the others know little of it, what is far off is near by their
    /// measure: then it stays out.
    pub fn is_acquitted(&self) -> bool {
        self.standing == Standing::LeftOut && self.is_back && !self.guilty
    }

    /// Whether it surprises, and is as far from what the others say; under an `even` sky less does.
    pub fn is_suspect(&self, even: bool) -> bool {
        let doubt = if even { EVEN_DOUBT } else { DOUBT };
        self.standing != Standing::LeftOut && self.surprise > doubt && self.near_s == 0.0
    }

    /// Whether it is far enough off, and the others agree, for it to be left out.
    pub fn is_guilty(&self) -> bool {
        self.guilty && self.others_fit < FIT
    }

    /// Takes in whether it alone is to blame in this step; whether it has been for long enough.
    pub fn leads(&mut self, alone: bool) -> bool {
        self.ahead = if alone { self.ahead.saturating_add(1) } else { 0 };
        self.ahead >= if self.colder { COLDER.1 } else { STEPS }
    }

    /// Whether all others fit together without it as well as if there were nothing but noise.
    pub fn is_all_there_is(&self) -> bool {
        self.others_fit < PLAIN
    }

    /// Whether all others fit together without it even better: it alone is what is wrong, however much surprises.
    pub fn explains_all(&self) -> bool {
        self.others_fit < BEST
    }

    /// Whether it has been doubted for long, for what is too small to leave it out.
    pub fn is_small_matter(&self) -> bool {
        self.doubted_s > DOUBT_S && !self.guilty
    }

    /// Whether it is doubted, and far enough off to be left out.
    pub fn is_grave(&self) -> bool {
        self.doubted_s > 0.0 && self.guilty
    }

    /// Begins anew with all others.
    pub fn reopen(&mut self) {
        (self.surprise, self.ahead, self.near_s) = (0.0, 0, 0.0);
        if self.standing == Standing::Doubted {
            self.standing = Standing::Heard;
        }
    }
}

/// How many times as much it takes for a second sensor.
pub fn many(second: bool) -> f64 {
    if second { SECOND } else { 1.0 }
}
