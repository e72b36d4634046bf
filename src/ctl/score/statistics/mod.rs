//! Errors of attitude against a reference, and what is said of many of them. Pure.
//!
//! A percentile is interpolated linearly between the two errors next to its rank `p·(n − 1)`.
//! An underestimation is the amount by which the estimate of roll falls short of the true roll in
//! size, `|true| − |estimate|`, at least 0; it is asked for wherever the true roll is beyond 20°.

use crate::attitude::Attitude;
use serde::Serialize;

/// True roll beyond which an underestimation counts, °.
const UNDERESTIMATED_BEYOND_DEG: f64 = 20.0;

/// Roll and pitch that hold, °.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Truth {
    /// Roll.
    pub roll_deg: f64,
    /// Pitch.
    pub pitch_deg: f64,
}

/// Roll and pitch that were estimated, °.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Said {
    /// Roll.
    pub roll_deg: f64,
    /// Pitch.
    pub pitch_deg: f64,
    /// Standard deviation of roll; `None` or no number where it is not known.
    pub roll_sigma_deg: Option<f64>,
    /// Standard deviation of pitch, likewise.
    pub pitch_sigma_deg: Option<f64>,
}

impl Said {
    /// What an estimate says.
    pub fn new(attitude: Attitude, sigma: Attitude) -> Self {
        Self {
            roll_deg: attitude.roll.to_degrees(),
            pitch_deg: attitude.pitch.to_degrees(),
            roll_sigma_deg: Some(sigma.roll.to_degrees()),
            pitch_sigma_deg: Some(sigma.pitch.to_degrees()),
        }
    }
}

/// Errors as they come.
#[derive(Clone, Debug, Default)]
pub struct Errors {
    withheld: u64,
    roll: Moments,
    pitch: Moments,
    larger_deg: Vec<f64>,
    underestimated_deg: Vec<f64>,
    covered: [u64; 3],
    /// Whether any row had a standard deviation of roll, of pitch.
    with_sigma: [bool; 2],
}

/// Sum and sum of squares.
#[derive(Clone, Copy, Debug, Default)]
struct Moments {
    sum: f64,
    squares: f64,
}

impl Moments {
    fn add(&mut self, value: f64) {
        self.sum += value;
        self.squares += value * value;
    }
}

/// What is said of the errors; angles in degrees, `None` where there is nothing to say it of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Score {
    /// Rows that gave an attitude.
    pub rows: u64,
    /// Rows that gave none, of all, %.
    pub withheld_percent: Option<f64>,
    /// Root mean square of the error of roll.
    pub roll_rms_deg: Option<f64>,
    /// Root mean square of the error of pitch.
    pub pitch_rms_deg: Option<f64>,
    /// Mean error of roll.
    pub roll_bias_deg: Option<f64>,
    /// Mean error of pitch.
    pub pitch_bias_deg: Option<f64>,
    /// Median of the larger error of the two.
    pub error_p50_deg: Option<f64>,
    /// Its 95th percentile.
    pub error_p95_deg: Option<f64>,
    /// Its 99th percentile.
    pub error_p99_deg: Option<f64>,
    /// 99th percentile of the underestimation of roll.
    pub underestimated_p99_deg: Option<f64>,
    /// The worst one.
    pub underestimated_worst_deg: Option<f64>,
    /// Errors of roll within twice the standard deviation, %. A row without one is not within; where none has one,
    /// nothing is said.
    pub roll_in_2_sigma_percent: Option<f64>,
    /// Errors of pitch, likewise.
    pub pitch_in_2_sigma_percent: Option<f64>,
    /// Rows where both are.
    pub both_in_2_sigma_percent: Option<f64>,
}

impl Errors {
    /// Takes in a row: what holds, and what was estimated, if anything was.
    pub fn add(&mut self, truth: Truth, said: Option<Said>) {
        let Some(said) = said.filter(|s| s.roll_deg.is_finite() && s.pitch_deg.is_finite()) else {
            self.withheld += 1;
            return;
        };
        let roll = wrapped(said.roll_deg - truth.roll_deg);
        let pitch = said.pitch_deg - truth.pitch_deg;
        self.roll.add(roll);
        self.pitch.add(pitch);
        self.larger_deg.push(roll.abs().max(pitch.abs()));
        let true_roll = wrapped(truth.roll_deg).abs();
        if true_roll > UNDERESTIMATED_BEYOND_DEG {
            self.underestimated_deg.push((true_roll - wrapped(said.roll_deg).abs()).max(0.0));
        }
        // A comparison with what is no number is false.
        let within = |error: f64, sigma: Option<f64>| sigma.is_some_and(|s| error.abs() <= 2.0 * s);
        let (in_roll, in_pitch) = (within(roll, said.roll_sigma_deg), within(pitch, said.pitch_sigma_deg));
        for (count, covered) in self.covered.iter_mut().zip([in_roll, in_pitch, in_roll && in_pitch]) {
            *count += u64::from(covered);
        }
        for (any, sigma) in self.with_sigma.iter_mut().zip([said.roll_sigma_deg, said.pitch_sigma_deg]) {
            *any |= sigma.is_some_and(|s| !s.is_nan());
        }
    }

    /// Whether no row has come.
    pub fn is_empty(&self) -> bool {
        self.withheld == 0 && self.larger_deg.is_empty()
    }

    /// What is to be said of them.
    pub fn score(mut self) -> Score {
        let rows = self.larger_deg.len() as u64;
        self.larger_deg.sort_by(f64::total_cmp);
        self.underestimated_deg.sort_by(f64::total_cmp);
        let of_rows = |value: f64| (rows > 0).then(|| value / rows as f64);
        let [roll, pitch] = self.with_sigma;
        let covered = |i: usize, known: bool| of_rows(100.0 * self.covered[i] as f64).filter(|_| known);
        let all = rows + self.withheld;
        Score {
            rows,
            withheld_percent: (all > 0).then(|| 100.0 * self.withheld as f64 / all as f64),
            roll_rms_deg: of_rows(self.roll.squares).map(f64::sqrt),
            pitch_rms_deg: of_rows(self.pitch.squares).map(f64::sqrt),
            roll_bias_deg: of_rows(self.roll.sum),
            pitch_bias_deg: of_rows(self.pitch.sum),
            error_p50_deg: percentile(&self.larger_deg, 50.0),
            error_p95_deg: percentile(&self.larger_deg, 95.0),
            error_p99_deg: percentile(&self.larger_deg, 99.0),
            underestimated_p99_deg: percentile(&self.underestimated_deg, 99.0),
            underestimated_worst_deg: self.underestimated_deg.last().copied(),
            roll_in_2_sigma_percent: covered(0, roll),
            pitch_in_2_sigma_percent: covered(1, pitch),
            both_in_2_sigma_percent: covered(2, roll && pitch),
        }
    }
}

impl Score {
    /// All figures, in the order of the fields.
    pub fn figures(&mut self) -> [&mut Option<f64>; 13] {
        [
            &mut self.withheld_percent,
            &mut self.roll_rms_deg,
            &mut self.pitch_rms_deg,
            &mut self.roll_bias_deg,
            &mut self.pitch_bias_deg,
            &mut self.error_p50_deg,
            &mut self.error_p95_deg,
            &mut self.error_p99_deg,
            &mut self.underestimated_p99_deg,
            &mut self.underestimated_worst_deg,
            &mut self.roll_in_2_sigma_percent,
            &mut self.pitch_in_2_sigma_percent,
            &mut self.both_in_2_sigma_percent,
        ]
    }
}

/// An angle brought into −180° to below 180°.
pub fn wrapped(deg: f64) -> f64 {
    (deg + 180.0).rem_euclid(360.0) - 180.0
}

/// The percentile `p`, 0 to 100, of values in rising order.
fn percentile(sorted: &[f64], p: f64) -> Option<f64> {
    let last = sorted.len().checked_sub(1)?;
    let rank = (p / 100.0).clamp(0.0, 1.0) * last as f64;
    let (low, share) = (rank.floor(), rank.fract());
    let (a, b) = (sorted[low as usize], sorted[(low as usize + 1).min(last)]);
    Some(a + share * (b - a))
}

#[cfg(test)]
mod tests;
