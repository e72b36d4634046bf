//! A film on a sensor that is still heard: it shows its own die, and little else.
//!
//! A film that grows for seconds surprises no witness much: ground and contrast may drift as fast. But where it ends is known:
//! at the temperature of the die, whatever there is to be seen.

use super::follow::Follow;

/// The share of the die in what is shown: of a film, least and most; of one that grows, least.
const SHARE: (f64, f64) = (0.8, 1.15);
const GROWING: f64 = 0.25;
/// The die must differ from what should be shown by so much, K.
const APART_K: f64 = 1.5;
/// What is shown must do so by so many standard deviations of that: where one side is warmer than the other more is no wonder.
const FAR: f64 = 7.0;
/// One that grows must have changed what is shown by so much, K and in standard deviations, and is done after so long, s.
const OFF: (f64, f64) = (1.0, 2.5);
const GROWS_S: f64 = 6.0;
/// For so long, s, it must have been nearer before: what was there from the beginning may be how the world is.
const RIGHT_S: f64 = 10.0;
/// What was shown while it was right is remembered for so long, s: where nothing changes a film must show something else, by
/// such a share of what it is off by.
const BEFORE_S: f64 = 60.0;
const ELSE: f64 = 0.25;
/// What should be shown is no colder and no warmer than the ground by more than so many times the contrast, or whoever says so
/// is lost.
const OF_THIS_WORLD: (f64, f64) = (1.5, 0.4);
/// A film leaves no more than such a share of how far die and scene are apart.
const LEFT: f64 = 0.1;
/// Where what should be shown changes by so much, K rms, a film loses such a share of it, least and most.
const CHANGES_K: f64 = 0.3;
const LOST: (f64, f64) = (0.65, 1.3);
/// It must be seen for so long, s: with such changes, and without.
const LASTS_S: (f64, f64) = (1.5, 3.0);

/// What one sensor shows, and should.
#[derive(Clone, Copy, Debug)]
pub struct Shown {
    /// What it shows, °C.
    pub reading: f64,
    /// Its die, °C.
    pub ambient_c: f64,
    /// What it should show, °C, and the standard deviation of that, K.
    pub expected: (f64, f64),
    /// The ground, °C, and the contrast, K.
    pub sky: (f64, f64),
}

/// What speaks for a film on one sensor.
#[derive(Clone, Copy, Debug, Default)]
pub struct Film {
    follow: Follow,
    ambient_c: f64,
    right_s: f64,
    /// The least and the most that was shown lately while it was right, °C.
    before: Option<(f64, f64)>,
    /// Whether it shows something else now.
    is_new: bool,
    seen_s: f64,
    growing_s: f64,
}

impl Film {
    /// Takes in what is shown over `dt_s`; where there is nothing, or no die is known, there is no film.
    pub fn see(&mut self, shown: Option<Shown>, dt_s: f64) {
        let Some(shown) = shown else { return *self = self.none() };
        let Shown { reading, ambient_c, expected: (expected, sigma_k), sky: (ground_c, contrast_k) } = shown;
        let (apart_k, off_k) = ((ambient_c - expected).abs(), (reading - expected).abs());
        let share = (reading - expected) / (ambient_c - expected);
        let sound = (-OF_THIS_WORLD.0..OF_THIS_WORLD.1).contains(&((expected - ground_c) / contrast_k));
        let is_off = off_k > OFF.0.max(OFF.1 * sigma_k);
        if !is_off {
            self.right_s += dt_s;
            self.remember(reading, dt_s);
        }
        let beyond = |(least, most): (f64, f64)| (least - reading).max(reading - most);
        self.is_new = self.before.is_none_or(|before| beyond(before) > ELSE * off_k);
        let may_be = sound && self.right_s > RIGHT_S;
        let grows = may_be && is_off && (GROWING..SHARE.1).contains(&share);
        self.growing_s = if grows { self.growing_s + dt_s } else { 0.0 };
        let far = apart_k > APART_K && off_k > FAR * sigma_k;
        if may_be && far && (SHARE.0..SHARE.1).contains(&share) {
            (self.ambient_c, self.seen_s) = (ambient_c, self.seen_s + dt_s);
            self.follow.update(expected, reading, dt_s);
        } else {
            *self = Self { growing_s: self.growing_s, ..self.none() };
        }
    }

    fn remember(&mut self, reading: f64, dt_s: f64) {
        let fades = -(-dt_s / BEFORE_S).exp_m1();
        let toward = |bound: f64| bound + fades * (reading - bound);
        let (least, most) = self.before.map_or((reading, reading), |(least, most)| (toward(least), toward(most)));
        self.before = Some((least.min(reading), most.max(reading)));
    }

    /// The same of which none is seen.
    pub fn none(self) -> Self {
        Self { right_s: self.right_s, before: self.before, ..Self::default() }
    }

    /// Whether it shows as much of its die as a film would.
    pub fn is_seen(&self) -> bool {
        self.seen_s > 0.0
    }

    /// The same, where it has shown nothing of the kind before.
    pub fn is_seen_anew(&self) -> bool {
        self.is_seen() && self.is_new
    }

    /// Whether a film may be growing.
    pub fn may_grow(&self) -> bool {
        (f64::MIN_POSITIVE..GROWS_S).contains(&self.growing_s)
    }

    /// Whether there is one. Where what it should show has not changed, what it sees may be as warm as its die: that is no wall
    /// where the sensor looks `upright`.
    pub fn is_there(&self, upright: bool) -> bool {
        let lasts = match self.follow.lost_of(CHANGES_K) {
            Some(lost) => (LOST.0..LOST.1).contains(&lost) && self.seen_s > LASTS_S.0,
            None => upright && self.is_new && self.seen_s > LASTS_S.1,
        };
        lasts && self.follow.beside_film(self.ambient_c).is_some_and(|left| left < LEFT)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sensor that should show 12 °C and `swing_k` to either side shows `shown` of that for so long, at 20 Hz.
    fn seen(swing_k: f64, seconds: f64, shown: impl Fn(f64) -> f64) -> Film {
        let mut film = Film { right_s: 2.0 * RIGHT_S, ..Film::default() };
        for i in 0..(20.0 * seconds) as u32 {
            let due = 12.0 + swing_k * (0.05 * f64::from(i)).sin();
            let shown = Shown { reading: shown(due), ambient_c: 20.0, expected: (due, 0.2), sky: (17.0, 30.0) };
            film.see(Some(shown), 0.05);
        }
        film
    }

    #[test]
    fn a_film_shows_its_die_whatever_there_is_to_be_seen() {
        let film = |due: f64| 0.92 * 20.0 + 0.08 * due;
        assert!(seen(2.0, 2.0, film).is_there(false));
        assert!(!seen(2.0, 1.0, film).is_there(true), "too soon");
        // Where nothing changes it takes longer, and may be a wall beside.
        let still = seen(0.0, 4.0, film);
        assert!(still.is_there(true) && !still.is_there(false));
        assert!(!seen(0.0, 2.0, film).is_there(true), "too soon");
        assert!(still.is_seen() && still.may_grow());
        assert!(!seen(0.0, 7.0, film).may_grow(), "it has grown");
    }

    #[test]
    fn what_follows_and_what_is_elsewhere_is_none() {
        // Something as warm as the die that is seen as the sky was.
        assert!(!seen(2.0, 10.0, |due| due + 7.5).is_there(true));
        // A wall, an error, a sensor that is right.
        for shown in [|_| 15.0, |due| due - 7.0, |due| due] {
            let film = seen(2.0, 10.0, shown);
            assert!(!film.is_seen() && !film.is_there(true));
        }
    }

    /// Who says what should be shown may be wrong: a film shows what the sensor did not show before.
    #[test]
    fn what_it_shows_as_before_is_none_where_nothing_changes() {
        let shown =
            |reading: f64, due: f64| Shown { reading, ambient_c: 20.0, expected: (due, 0.2), sky: (17.0, 30.0) };
        for (before, there) in [(18.9, false), (12.0, true)] {
            let mut film = Film::default();
            (0..400).for_each(|_| film.see(Some(shown(before, before)), 0.05));
            (0..80).for_each(|_| film.see(Some(shown(19.0, 10.0)), 0.05));
            assert_eq!(film.is_there(true), there, "{before} °C before");
        }
    }

    #[test]
    fn what_was_there_from_the_beginning_is_the_world() {
        let mut film = Film::default();
        let shown = |reading| Some(Shown { reading, ambient_c: 20.0, expected: (12.0, 0.2), sky: (17.0, 30.0) });
        (0..400).for_each(|_| film.see(shown(20.0), 0.05));
        assert!(!film.is_there(true) && !film.is_seen() && !film.may_grow());
        (0..400).for_each(|_| film.see(shown(12.5), 0.05));
        (0..100).for_each(|_| film.see(shown(20.0), 0.05));
        assert!(film.is_there(true));
    }

    #[test]
    fn who_does_not_know_the_die_or_the_world_tells_nothing() {
        let mut film = seen(0.0, 4.0, |_| 20.0);
        film.see(None, 0.05);
        assert!(!film.is_there(true) && !film.is_seen() && !film.may_grow());
        for expected in [90.0, 40.0, -30.0] {
            let lost = Shown { reading: 20.0, ambient_c: 20.0, expected: (expected, 0.2), sky: (17.0, 30.0) };
            (0..200).for_each(|_| film.see(Some(lost), 0.05));
            assert!(!film.is_there(true) && !film.may_grow(), "{expected} °C");
        }
    }
}
