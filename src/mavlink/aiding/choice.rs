//! One source of body rates at a time: the best that is heard. Pure.

use crate::time::Time;

/// A source is gone when it is silent for so long, s.
const SILENT_S: f64 = 0.5;
/// A better one takes over when it comes as often as this, s.
const BRISK_S: f64 = 0.25;

/// Messages with body rates, the best first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Source {
    /// ATTITUDE: filtered, free of bias, with a stamp.
    Attitude,
    /// HIGHRES_IMU.
    HighresImu,
    /// SCALED_IMU.
    ScaledImu,
    /// RAW_IMU.
    RawImu,
}

/// Which one is heeded.
#[derive(Clone, Debug, Default)]
pub struct Choice {
    current: Option<(Source, Time)>,
    last: [Option<Time>; 4],
}

impl Choice {
    /// Whether a message from `source` is heeded.
    pub fn heeds(&mut self, source: Source, now: Time) -> bool {
        let brisk = self.last[source as usize].replace(now).is_some_and(|last| now.since(last) <= BRISK_S);
        let heeded = match self.current {
            Some((current, last)) if current != source && now.since(last) <= SILENT_S => source < current && brisk,
            _ => true,
        };
        if heeded {
            self.current = Some((source, now));
        }
        heeded
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_best_brisk_one_and_another_when_it_falls_silent() {
        let mut choice = Choice::default();
        let mut heard = |ms: u32, source| choice.heeds(source, Time::from_secs_f64(9.0 + f64::from(ms) / 1000.0));
        assert!(heard(0, Source::RawImu));
        assert!(!heard(100, Source::ScaledImu), "better, but one is not brisk");
        assert!(heard(300, Source::ScaledImu) && !heard(310, Source::RawImu));
        // Once a second is not brisk either: it does not take over.
        assert!(!heard(320, Source::Attitude) && heard(500, Source::ScaledImu) && heard(900, Source::ScaledImu));
        assert!(!heard(1320, Source::Attitude) && heard(1400, Source::Attitude));
        assert!(!heard(1500, Source::ScaledImu));
        // Silent.
        assert!(heard(1901, Source::ScaledImu));
    }
}
