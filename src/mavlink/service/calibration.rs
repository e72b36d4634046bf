//! The trim out of a few seconds on level ground: what the attitude shows there is what trims are missing.

use crate::attitude::{Attitude, Mode};
use crate::estimator::vector::{Vector, dot, unit};
use crate::mavlink::session::Seen;
use crate::time::Time;

/// How long the attitude is averaged, s.
const LASTS_S: f64 = 5.0;

/// Fewer attitudes than this in that time are no average.
const FEWEST: u32 = 5;

/// The standard deviation above which an attitude is not good enough, °.
const SURE_DEG: f64 = 5.0;

/// How far from the first attitude a still head may show to be, °.
const STILL_DEG: f64 = 3.0;

/// How long there may be no new attitude, s.
const PATIENCE_S: f64 = 1.0;

/// Why it cannot begin or go on: a few words.
pub type Reason = &'static str;

/// How it stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Progress {
    /// It goes on; so much is done, %.
    Going(u8),
    /// It is over: the mean attitude.
    Done(Attitude),
    /// It has failed.
    Failed(Reason),
}

/// A calibration that goes on.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    started: Time,
    newest: Time,
    valid_at: Time,
    first: Vector,
    sum: Vector,
    count: u32,
}

/// The vertical that `seen` shows, if the trim may be taken from it.
fn level(seen: &Seen, flying: bool) -> Result<Vector, Reason> {
    if flying {
        return Err("no level calibration in flight");
    }
    let attitude = seen.moment.attitude.ok_or("no level calibration without attitude")?;
    if seen.moment.mode != Mode::Nominal {
        return Err("no level calibration while degraded");
    }
    let sure = [seen.moment.sigma.roll, seen.moment.sigma.pitch].iter().all(|s| s.abs() <= SURE_DEG.to_radians());
    let vertical = attitude.vertical();
    if !(sure && vertical.iter().all(|c| c.is_finite())) {
        return Err("no level calibration: unsure attitude");
    }
    Ok(vertical)
}

impl Calibration {
    /// Begins at `now`, if it can.
    pub fn begin(now: Time, seen: &Seen, flying: bool) -> Result<Self, Reason> {
        let first = level(seen, flying)?;
        Ok(Self { started: now, newest: now, valid_at: seen.moment.valid_at, first, sum: [0.0; 3], count: 0 })
    }

    /// Takes in what is seen at `now`.
    pub fn step(&mut self, now: Time, seen: &Seen, flying: bool) -> Progress {
        let vertical = match level(seen, flying) {
            Ok(vertical) => vertical,
            Err(reason) => return Progress::Failed(reason),
        };
        if seen.moment.valid_at != self.valid_at {
            if dot(vertical, self.first) < STILL_DEG.to_radians().cos() {
                return Progress::Failed("level calibration failed: it moved");
            }
            self.valid_at = seen.moment.valid_at;
            self.newest = now;
            self.count += 1;
            self.sum = std::array::from_fn(|i| self.sum[i] + vertical[i]);
        }
        let done_s = now.since(self.started);
        // Also when the clock is set back.
        if !(0.0..PATIENCE_S).contains(&now.since(self.newest)) {
            return Progress::Failed("level calibration failed: no attitude");
        }
        if done_s < LASTS_S {
            return Progress::Going((done_s / LASTS_S * 100.0) as u8);
        }
        match unit(self.sum) {
            Some(mean) if self.count >= FEWEST => Progress::Done(Attitude::from_vertical(mean)),
            _ => Progress::Failed("level calibration failed: too few"),
        }
    }
}

/// The trim with which an attitude of `shown` would have been level, when `trim` was taken off it: `turned` as the
/// vertical is turned, else angle by angle.
pub fn trim(shown: Attitude, trim: Attitude, turned: bool) -> Attitude {
    if !turned {
        return Attitude { roll: trim.roll + shown.roll, pitch: trim.pitch + shown.pitch };
    }
    // Back on the head's own axes: pitch first, then roll.
    let [nose, left, up] = shown.vertical();
    let ((sr, cr), (sp, cp)) = (trim.roll.sin_cos(), trim.pitch.sin_cos());
    let (nose, up) = (nose * cp + up * sp, up * cp - nose * sp);
    let head = [nose, left * cr + up * sr, up * cr - left * sr];
    Attitude::from_vertical(head)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimator::trim::level as taken_off;
    use crate::state::Moment;
    use proptest::prelude::*;

    fn at(secs: f64) -> Time {
        Time::from_secs_f64(1000.0 + secs)
    }

    fn seen(secs: f64, roll_deg: f64, pitch_deg: f64) -> Seen {
        let moment = Moment {
            valid_at: at(secs),
            attitude: Some(Attitude::from_degrees(roll_deg, pitch_deg)),
            sigma: Attitude::from_degrees(1.0, 2.0),
            mode: Mode::Nominal,
            ..Moment::default()
        };
        Seen { moment, ..Seen::default() }
    }

    /// Level, but for what `change` does.
    fn spoilt(secs: f64, change: impl Fn(&mut Moment)) -> Seen {
        let mut seen = seen(secs, 0.0, 0.0);
        change(&mut seen.moment);
        seen
    }

    /// Runs it over what `at_step` shows, 10 times a second; the last word and when it was said.
    fn run(mut at_step: impl FnMut(f64) -> (Seen, bool)) -> (f64, Progress) {
        let mut calibration = Calibration::begin(at(0.0), &seen(0.0, 4.0, -2.0), false).unwrap();
        for i in 1..200 {
            let secs = f64::from(i) / 10.0;
            let (seen, flying) = at_step(secs);
            match calibration.step(at(secs), &seen, flying) {
                Progress::Going(percent) => assert_eq!(percent, (secs * 20.0 + 1e-9) as u8),
                end => return (secs, end),
            }
        }
        panic!("it never ended");
    }

    #[test]
    fn the_mean_of_five_seconds() {
        let (secs, Progress::Done(mean)) = run(|s| (seen(s, 4.0 + (s * 31.0).sin(), -2.0 + (s * 31.0).cos()), false))
        else {
            panic!()
        };
        assert_eq!(secs, 5.0);
        assert!((mean.roll.to_degrees() - 4.0).abs() < 0.1 && (mean.pitch.to_degrees() + 2.0).abs() < 0.1, "{mean:?}");
    }

    #[test]
    fn what_ends_it_early() {
        let why = |at_step: fn(f64) -> (Seen, bool)| match run(at_step) {
            (secs, Progress::Failed(reason)) => (secs, reason.rsplit_once(' ').map_or(reason, |(_, last)| last)),
            other => panic!("{other:?}"),
        };
        assert_eq!(why(|s| (seen(s, 4.0, -2.0), s > 2.05)), (2.1, "flight"));
        assert_eq!(why(|s| (seen(s, if s > 3.05 { 9.0 } else { 4.0 }, -2.0), false)), (3.1, "moved"));
        assert_eq!(why(|s| (seen(s.min(2.0), 4.0, -2.0), false)), (3.0, "attitude"));
        assert_eq!(why(|s| (spoilt(s, |m| m.attitude = None), false)), (0.1, "attitude"));
        assert_eq!(why(|s| (spoilt(s, |m| m.mode = Mode::Degraded), false)), (0.1, "degraded"));
        let unsure = |s| (spoilt(s, |m| m.sigma = Attitude::from_degrees(1.0, f64::NAN)), false);
        assert_eq!(why(unsure), (0.1, "attitude"));
        assert!(Calibration::begin(at(0.0), &seen(0.0, 0.0, 0.0), true).is_err());
    }

    proptest! {
        #[test]
        fn with_the_new_trim_the_same_ground_is_level(
            roll in -40.0_f64..40.0, pitch in -40.0_f64..40.0, old_roll in -20.0_f64..20.0, old_pitch in -20.0_f64..20.0,
        ) {
            let (head, old) = (Attitude::from_degrees(roll, pitch), Attitude::from_degrees(old_roll, old_pitch));
            let new = trim(taken_off(head, old), old, true);
            let level = taken_off(head, new);
            prop_assert!(level.roll.abs() < 1e-9 && level.pitch.abs() < 1e-9, "{level:?}");
        }
    }
}
