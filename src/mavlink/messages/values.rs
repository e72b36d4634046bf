//! Quality, contrast and standard deviation as NAMED_VALUE_FLOAT.

use super::{Message, time_boot_ms};
use crate::attitude::Mode;
use crate::mavlink::session::Seen;
use crate::time::Time;
use ::mavlink::dialects::common::NAMED_VALUE_FLOAT_DATA;

/// The standard deviation at which the quality is one half, °.
const HALF_QUALITY_SIGMA_DEG: f64 = 5.0;

/// The best quality of a degraded attitude.
const DEGRADED_QUALITY: f64 = 0.5;

/// NAMED_VALUE_FLOAT `ir_contr`: the contrast, K, as seen at `time`.
pub fn contrast(time: Time, contrast_k: f64) -> Message {
    value("ir_contr", time, contrast_k)
}

/// NAMED_VALUE_FLOAT `ir_sigma`: the larger standard deviation of roll and pitch, °, of the moment that the attitude
/// speaks of; `None` while there is no attitude, or none that is known at all.
pub fn sigma(seen: &Seen) -> Option<Message> {
    seen.moment.attitude?;
    let (roll, pitch) = (seen.moment.sigma.roll.abs(), seen.moment.sigma.pitch.abs());
    let known = roll.is_finite() && pitch.is_finite();
    known.then(|| value("ir_sigma", seen.moment.valid_at, roll.max(pitch).to_degrees()))
}

/// NAMED_VALUE_FLOAT `ir_qual`: the quality, 0 to 1, as it is at `time`; see [`quality`].
pub fn quality_value(time: Time, quality: f64) -> Message {
    value("ir_qual", time, quality)
}

fn value(name: &str, time: Time, value: f64) -> Message {
    Message::Value(NAMED_VALUE_FLOAT_DATA { time_boot_ms: time_boot_ms(time), value: value as f32, name: name.into() })
}

/// One number for how good the attitude is: 0 while it is withheld, else `1 / (1 + (σ / 5°)²)` of
/// the larger standard deviation, and at most 0.5 while degraded.
pub fn quality(seen: &Seen) -> f64 {
    let best = match (seen.moment.attitude, seen.moment.mode) {
        (None, _) | (_, Mode::Starting | Mode::Faulted) => return 0.0,
        (_, Mode::Degraded) => DEGRADED_QUALITY,
        (_, Mode::Nominal) => 1.0,
    };
    let (roll, pitch) = (seen.moment.sigma.roll, seen.moment.sigma.pitch);
    if !roll.is_finite() || !pitch.is_finite() {
        return 0.0;
    }
    let sigma = roll.abs().max(pitch.abs()).to_degrees() / HALF_QUALITY_SIGMA_DEG;
    (1.0 / (1.0 + sigma * sigma)).min(best)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::attitude::Attitude;
    use crate::state::Moment;

    #[test]
    fn sigma_is_the_larger_one_in_degrees_and_always_a_number() {
        let mut seen = Seen::default();
        seen.moment.attitude = Some(Attitude::default());
        seen.moment.sigma = Attitude { roll: 0.02, pitch: 0.01 };
        let Some(Message::Value(v)) = sigma(&seen) else { panic!() };
        assert_eq!(v.name.to_str(), Ok("ir_sigma"));
        assert!((v.value - 1.145_915_6).abs() < 1e-6);
        seen.moment.sigma.pitch = f64::NAN;
        assert_eq!(sigma(&seen), None);
        seen.moment.sigma.pitch = 0.0;
        seen.moment.attitude = None;
        assert_eq!(sigma(&seen), None);
    }

    #[test]
    fn quality_falls_with_sigma_and_mode() {
        let (attitude, sigma) = (Some(Attitude::default()), Attitude::from_degrees(0.0, 0.0));
        let moment = Moment { attitude, sigma, mode: Mode::Nominal, ..Moment::default() };
        let mut seen = Seen { moment, ..Seen::default() };
        assert_eq!(quality(&seen), 1.0);
        seen.moment.sigma = Attitude::from_degrees(1.0, 5.0);
        assert!((quality(&seen) - 0.5).abs() < 1e-12);
        seen.moment.mode = Mode::Degraded;
        seen.moment.sigma = Attitude::from_degrees(1.0, 0.0);
        assert_eq!(quality(&seen), 0.5);
        seen.moment.sigma.roll = f64::NAN;
        assert_eq!(quality(&seen), 0.0);
        seen.moment.sigma.roll = 0.0;
        seen.moment.attitude = None;
        assert_eq!(quality(&seen), 0.0);
    }
}
