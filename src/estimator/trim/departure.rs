//! Whether the differences of late are still those of the minutes before. A mounting does not change in flight: what
//! departs from it is an error of the attitude, and nothing to learn from.

/// The time that is of late, s: long enough for a gust to be none.
const LATE_S: f64 = 30.0;
/// So many standard deviations it departs by at least.
const SIGMAS: f64 = 2.5;
/// It has come back below this share of that.
const HYSTERESIS: f64 = 0.6;

/// What of late is left unexplained of one angle.
#[derive(Clone, Copy, Debug, Default)]
pub struct Departure {
    /// The mean of what is left and of the variance of a single reference, rad and rad².
    mean: f64,
    variance: f64,
    /// The time that they stand for, s, up to [`LATE_S`].
    weight_s: f64,
    departed: bool,
    /// For how long nothing departed, less how long something did, s.
    agreed_s: f64,
}

impl Departure {
    /// Takes in that `left` (rad) is unexplained of a difference from a reference that may be off by `sigma` (rad) for
    /// `lasts_s` seconds and stands for `span_s`; by `expected` (rad) the explanation itself may be off.
    pub fn hear(&mut self, left: f64, (sigma, lasts_s): (f64, f64), span_s: f64, expected: f64) {
        self.weight_s = (self.weight_s + span_s).min(LATE_S);
        let share = (span_s / self.weight_s).min(1.0);
        self.mean += share * (left - self.mean);
        self.variance += share * (sigma.powi(2) - self.variance);
        let error = self.variance * (lasts_s / self.weight_s).min(1.0);
        let limit = SIGMAS * error.sqrt().hypot(expected) * if self.departed { HYSTERESIS } else { 1.0 };
        self.departed = self.mean.abs() > limit;
        self.agreed_s = (self.agreed_s + if self.departed { -span_s } else { span_s }).max(0.0);
    }

    /// Whether there is nothing to learn from: it departs, from what has lasted for longer than it.
    pub fn is_odd(&self) -> bool {
        self.departed && self.agreed_s > 0.0
    }

    /// By how much the attitude is off for all that is known, rad.
    pub fn angle(&self) -> f64 {
        if self.departed { self.mean.abs() } else { 0.0 }
    }
}
