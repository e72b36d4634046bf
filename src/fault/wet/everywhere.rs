//! A film on all sensors, by their own temperatures: what they differ by collapses, and so does the distance of each from
//! its own.

use crate::fault::debounce::Debounce;
use crate::fault::{ActiveFault, Evidence, FaultKind};
use crate::time::Time;

/// How long what was before is remembered, s, how fast what is now is seen, and for how long it must last.
const BEFORE_S: f64 = 20.0;
const NOW_S: f64 = 0.3;
const LASTS_S: (f64, f64) = (1.0, 1.0);
/// What may be left of what they differ by and of the distances from their own temperatures; what must have been
/// there, K.
const LEFT: f64 = 0.15;
const THERE_K: f64 = 5.0;
/// A sensor that was nearer to its own temperature tells nothing, K; so many of all must tell.
const NEAR_K: f64 = 1.0;
const TELL: f64 = 0.5;
/// Below this share of a low contrast it is fog.
const FOG: f64 = 0.5;

/// How large something was, and is now, K.
#[derive(Clone, Copy, Debug)]
struct Size {
    before: f64,
    now: f64,
}

impl Size {
    /// Takes in what is seen; what was before stays as it is while all has `collapsed`.
    fn see(&mut self, seen_k: f64, collapsed: bool, dt_s: f64) {
        self.now += -(-dt_s / NOW_S).exp_m1() * (seen_k - self.now);
        if !collapsed {
            self.before += -(-dt_s / BEFORE_S).exp_m1() * (self.now - self.before);
        }
    }

    fn is_below(self, share: f64) -> bool {
        self.now < share * self.before
    }
}

/// All of them.
#[derive(Clone, Debug)]
pub struct Everywhere {
    /// From the coldest to the warmest of them.
    range: Option<Size>,
    /// The distance of each from its own temperature, and whether it is seen now.
    apart: Vec<(Option<Size>, bool)>,
    collapsed: bool,
    wet: Debounce,
}

impl Everywhere {
    /// For so many sensors.
    pub fn new(sensors: usize) -> Self {
        let wet = Debounce::new(LASTS_S.0, LASTS_S.1);
        Self { range: None, apart: vec![(None, false); sensors], collapsed: false, wet }
    }

    /// Takes in how far sensor `i` is from its own temperature, K, where it is seen and says both.
    pub fn see(&mut self, i: usize, apart_k: Option<f64>, dt_s: f64) {
        let collapsed = self.collapsed;
        let Some((size, is_seen)) = self.apart.get_mut(i) else { return };
        *is_seen = apart_k.is_some();
        if let Some(k) = apart_k {
            size.get_or_insert(Size { before: k, now: k }).see(k, collapsed, dt_s);
        }
    }

    /// Takes in how far the coldest is from the warmest, K; `low_k` is the contrast below which it is low.
    pub fn judge(&mut self, range_k: f64, low_k: f64, dt_s: f64, time: Time) {
        let collapsed = self.collapsed;
        let range = self.range.get_or_insert(Size { before: range_k, now: range_k });
        range.see(range_k, collapsed, dt_s);
        let range = *range;
        self.collapsed = range.is_below(0.5) && self.all_below(0.5);
        let left = if self.wet.is_active() { 2.0 * LEFT } else { LEFT };
        // Where next to nothing is left it may as well be fog.
        let film = range.now > FOG * low_k && range.before > THERE_K;
        self.wet.update(film && range.is_below(left) && self.all_below(left), time);
    }

    /// Whether all that tell, but for one, are nearer than such a share of what they were. One that was wild tells nothing of
    /// the others.
    fn all_below(&self, share: f64) -> bool {
        let (tell, below) = (self.seen().count(), self.seen().filter(|s| s.is_below(share)).count());
        below + 1 >= tell && below as f64 >= TELL * self.apart.len() as f64
    }

    /// Those that are seen and tell.
    fn seen(&self) -> impl Iterator<Item = Size> + '_ {
        self.apart.iter().filter_map(|(size, is_seen)| size.filter(|s| *is_seen && s.before > NEAR_K))
    }

    /// Whether all of them are wet.
    pub fn is_active(&self) -> bool {
        self.wet.is_active()
    }

    /// Adds it to `faults`, as `kind`.
    pub fn report(&self, kind: FaultKind, faults: &mut Vec<ActiveFault>) {
        let (before, now) = self.seen().fold((0.0, 0.0), |sum, s| (sum.0 + s.before, sum.1 + s.now));
        let value = 100.0 * (1.0 - now / f64::max(before, 1e-3)).clamp(0.0, 1.0);
        self.wet.report(kind, Evidence::Limit { value, limit: 100.0 * (1.0 - LEFT), unit: "%" }, faults);
    }
}
