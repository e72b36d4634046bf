//! A sky that is as it was half a minute ago, and one sensor that is not.
//!
//! A film that grows for as long takes ground and contrast along with it, for whoever hears it: in the end one of two that look
//! apart is explained as well as the other, by another sky. That nothing has changed but one sensor is the simpler. Of those who
//! believe so, each without one sensor, only the one who does not hear the film is not surprised.

use super::super::model::Scene;
use super::super::start::Start;
use super::super::state::MAX_SENSORS;
use super::case::Case;
use super::filter::{Step, Witness};
use super::judge::is_upright;
use super::other::opposed;
use super::{Known, Model, Witnesses};
use crate::estimator::Standing;

/// After so long they begin anew, with the sky of then, s; where they cannot for many times as long, with that of now.
const AGO_S: f64 = 30.0;
const AGES: f64 = 3.0;
/// Walks of ground, K, and contrast, as a share of it, for a second.
const WALK: (f64, f64) = (0.1, 0.01);
/// How much surprises is averaged over this time, s.
const FIT_S: f64 = 4.0;
/// Who is surprised by less, in mean squares, believes rightly about those that are spared, and about one that is blamed.
const FITS: (f64, f64) = (1.0, 0.7);
/// If those without any other sensor are surprised by so many times more, they go on as they are; and those sensors are spared.
const SUSPECTS: f64 = 1.25;
const SPARES: f64 = 1.4;
/// Of two that look apart one is to blame by that alone from so many times on.
const OPPOSED: f64 = 2.0;
/// A sensor is off by so many standard deviations where it is suspect; where it is to blame by more, by so much, K and as a share
/// of the contrast, and toward its die by such a share of the way, least and most.
const OFF: (f64, f64) = (3.0, 5.0);
const OFF_K: (f64, f64) = (1.0, 0.08);
const SHARE: (f64, f64) = (0.15, 1.15);
/// What a film on one of two that look apart and along the horizon changes is what that one shows; if it were on the other, what
/// that one should show would have changed by as much, by chance. Over some time, s, in which how far each is off changes by so
/// much, K, the slope of what it should show over that is above for the one, and below for the other. Both are smoothed over
/// the other time first, s: with the aircraft's turns a film changes how far the one is off, too.
const SLOPE_S: f64 = 30.0;
const SMOOTH_S: f64 = 6.0;
const MOVES_K: f64 = 0.7;
const SLOPES: (f64, f64) = (-0.3, -0.75);
/// It has been so for so long, s, and the logarithm of how many times more the others are surprised comes to so much over time, s.
const LASTS_S: f64 = 3.0;
const BLAMES_S: f64 = 2.0;

/// One who does not hear one sensor.
#[derive(Clone, Debug)]
struct Believer {
    witness: Witness,
    /// The mean of the squared surprises.
    squared: f64,
    /// How far that sensor is from what it should show, standard deviations; and for how long it has been so as a film is, s.
    off: f64,
    film_s: f64,
    /// The logarithm of how many times more all others are surprised meanwhile, over time, s.
    ahead_s: f64,
    /// How far off it is and what it should show, both smoothed.
    smooth: [f64; 2],
    /// Weights, means of these two, the square of the one and its product with the other.
    sums: [f64; 5],
}

/// Those who believe in a sky.
#[derive(Clone, Debug, Default)]
pub struct SteadySky {
    without: Vec<Believer>,
    /// The sky, and the one they will believe in next.
    sky: Option<Scene>,
    next: Option<Scene>,
    /// Whether it is as old as it should be, and for how long it is believed in, s.
    is_old: bool,
    age_s: f64,
}

/// Whose word is taken.
#[derive(Clone, Copy, Debug)]
struct Verdict {
    /// The sensor that is not heard, and the one that looks the other way.
    blamed: usize,
    opposite: Option<usize>,
    /// How many times more those are surprised who do not hear any other sensor but these, and who do not hear the opposite one.
    others: f64,
    opposed: f64,
}

impl SteadySky {
    /// With room for `sensors`.
    pub fn new(sensors: usize) -> Self {
        Self { without: Vec::with_capacity(sensors), ..Self::default() }
    }

    /// Nothing is known of what was.
    pub fn forget(&mut self) {
        self.without.clear();
        self.next = None;
    }

    /// Takes in a step, in which nothing else is amiss if all is `calm`.
    pub fn hear(
        &mut self,
        model: &Model,
        known: &Known<'_>,
        step: &Step,
        readings: &[Option<f64>; MAX_SENSORS],
        calm: bool,
    ) {
        if !self.without.iter().all(|b| b.witness.is_sound()) {
            self.forget();
        }
        let over = self.age_s > AGO_S && calm && !self.suspects(model);
        if over || self.without.is_empty() {
            self.begin(model, known, step.own.0);
        }
        self.age_s += step.dt_s;
        let sky = self.sky.unwrap_or(known.sky);
        let contrast_k = sky.contrast_k.abs().max(1.0);
        let step = Step { walk_k: [WALK.0, WALK.1 * contrast_k], sky, ..*step };
        for (i, believer) in self.without.iter_mut().enumerate() {
            let said = believer.witness.hear(model, &step, readings);
            believer.squared += -(-step.dt_s / FIT_S).exp_m1() * (said.squared - believer.squared);
            let (expected, sigma_k) = (said.expected[i], said.sigma_k[i]);
            let off_k = readings[i].map_or(0.0, |reading| reading - expected);
            believer.off = off_k.abs() / sigma_k;
            let least_k = OFF_K.0.max(OFF_K.1 * contrast_k).max(OFF.1 * sigma_k);
            let share = known.ambient_c[i].map_or(0.0, |ambient_c| off_k / (ambient_c - expected));
            let film = off_k.abs() > least_k && (SHARE.0..SHARE.1).contains(&share) && believer.squared < FITS.1;
            believer.film_s = if film { believer.film_s + step.dt_s } else { 0.0 };
            believer.follow(step.dt_s, [off_k, expected]);
        }
        let verdict = self.verdict(model);
        for (i, believer) in self.without.iter_mut().enumerate() {
            let leads = verdict.filter(|v| v.blamed == i && believer.film_s > 0.0).map(Verdict::lead);
            let ahead_s = |lead: f64| believer.ahead_s + step.dt_s * (lead / SUSPECTS).ln();
            believer.ahead_s = leads.filter(|lead| *lead > SUSPECTS).map_or(0.0, ahead_s);
        }
    }

    /// With the sky of before.
    fn begin(&mut self, model: &Model, known: &Known<'_>, own_k: f64) {
        let next = self.next.filter(|_| self.age_s < AGES * AGO_S);
        self.is_old = next.is_some();
        let sky = next.unwrap_or(known.sky);
        (self.sky, self.next, self.age_s) = (Some(sky), Some(known.sky), 0.0);
        let all = Witness::new(known.axes, &sky, model.sensors(), own_k);
        for i in 0..model.sensors() {
            let witness = all.deaf_to(i);
            match self.without.get_mut(i) {
                Some(believer) => {
                    let Believer { squared, smooth, sums, .. } = *believer;
                    *believer = Believer { squared, smooth, sums, ..Believer::new(witness) };
                }
                None => self.without.push(Believer::new(witness)),
            }
        }
    }

    fn verdict(&self, model: &Model) -> Option<Verdict> {
        let each = || self.without.iter().map(|b| b.squared).enumerate();
        let (first, _) = each().min_by(|a, b| a.1.total_cmp(&b.1))?;
        let second = opposed(model).find_map(|(i, j)| match first {
            b if b == i => Some(j),
            b if b == j => Some(i),
            _ => None,
        });
        let of = |i: usize| &self.without[i];
        let tells =
            |i: usize, than: usize| !is_upright(model, i) && of(i).slope() > SLOPES.0 && of(than).slope() < SLOPES.1;
        let apart = second.map_or(f64::INFINITY, |second| of(second).squared / of(first).squared);
        let (blamed, opposite, opposed) = match second.filter(|_| apart < OPPOSED) {
            Some(second) if tells(second, first) => (second, Some(first), f64::INFINITY),
            Some(second) if tells(first, second) => (first, Some(second), f64::INFINITY),
            _ => (first, second, apart),
        };
        let others = each().filter(|(i, _)| *i != blamed && Some(*i) != opposite);
        let others = others.map(|(_, squared)| squared).fold(f64::INFINITY, f64::min) / of(blamed).squared;
        (of(blamed).off > OFF.0).then_some(Verdict { blamed, opposite, others, opposed })
    }

    /// Whether one sensor, or one of two that look apart, may be what has changed.
    fn suspects(&self, model: &Model) -> bool {
        self.verdict(model).is_some_and(|v| v.others > SUSPECTS)
    }

    /// Whether sensor `i` is not what has changed.
    pub fn spares(&self, model: &Model, i: usize) -> bool {
        let fits = |v: &Verdict| self.is_old && self.without[v.blamed].squared < FITS.0;
        let Some(verdict) = self.verdict(model).filter(|v| fits(v) && v.others > SPARES) else { return false };
        i != verdict.blamed && (Some(i) != verdict.opposite || verdict.opposed > SPARES)
    }

    /// The sensor that is what has changed, who does not hear it, and what that one knows.
    pub fn blames(&self, model: &Model) -> Option<(usize, &Witness, Start)> {
        let Verdict { blamed, .. } = self.verdict(model).filter(|_| self.is_old)?;
        let believer = &self.without[blamed];
        let lasts = believer.film_s > LASTS_S && believer.ahead_s > BLAMES_S;
        lasts.then_some((blamed, &believer.witness, believer.witness.told(&self.sky?)))
    }
}

impl Believer {
    /// Takes in how far off it is and what it should show.
    fn follow(&mut self, dt_s: f64, told: [f64; 2]) {
        let is_first = self.sums[0] == 0.0;
        let near = if is_first { 0.0 } else { (-dt_s / SMOOTH_S).exp() };
        self.smooth.iter_mut().zip(told).for_each(|(s, x)| *s = near * *s + (1.0 - near) * x);
        let [off_k, expected] = self.smooth;
        let keep = (-dt_s / SLOPE_S).exp();
        let sample = [1.0, off_k, expected, off_k * off_k, off_k * expected];
        self.sums.iter_mut().zip(sample).for_each(|(s, x)| *s = keep * *s + (1.0 - keep) * x);
    }

    /// How much what it should show changes with how far off it is.
    fn slope(&self) -> f64 {
        let [weight, off_k, expected, squared, product] = self.sums;
        let weight = weight.max(f64::MIN_POSITIVE);
        let variance = squared / weight - (off_k / weight).powi(2);
        let moves = variance > MOVES_K * MOVES_K;
        if moves { (product / weight - off_k * expected / weight.powi(2)) / variance } else { f64::NAN }
    }

    fn new(witness: Witness) -> Self {
        Self { witness, squared: 0.0, off: 0.0, film_s: 0.0, ahead_s: 0.0, smooth: [0.0; 2], sums: [0.0; 5] }
    }
}

impl Verdict {
    /// How many times more whoever else is the least surprised is surprised.
    fn lead(self) -> f64 {
        self.others.min(self.opposed)
    }
}

impl Witnesses {
    /// Asks those by whom the sky is as it was; whether they have found the sensor that is not.
    pub(super) fn disbelieves_change(
        &mut self,
        model: &Model,
        known: &Known<'_>,
        step: &Step,
        readings: &[Option<f64>; MAX_SENSORS],
    ) -> bool {
        let n = model.sensors();
        let calm = self.cases[..n].iter().all(|c| c.surprise < 0.0 && c.standing == Standing::Heard);
        self.steady.hear(model, known, step, readings, calm);
        let left_out = self.cases[..n].iter().filter(|c| c.standing == Standing::LeftOut).count();
        let Some((i, witness, start)) = self.steady.blames(model) else { return false };
        if self.cases[i].standing == Standing::LeftOut || left_out > 1 || readings[..n].iter().any(Option::is_none) {
            return false;
        }
        let all = witness.clone();
        (self.revised, self.rival) = (Some(start), None);
        self.cases.iter_mut().filter(|c| c.standing == Standing::LeftOut).for_each(|c| *c = Case::default());
        self.cases[i].standing = Standing::LeftOut;
        self.swear(model, all);
        true
    }
}
