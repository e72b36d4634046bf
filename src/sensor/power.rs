//! Power-cycling hung sensors: what to do when, as a pure sequence of steps.

use crate::time::Time;
use std::time::Duration;

/// How long a sensor must have been silent for its first power cycle.
const PATIENCE: Duration = Duration::from_secs(2);
/// The patience doubles with each cycle in vain up to this.
const MOST_PATIENCE: Duration = Duration::from_secs(60);
/// How long the supply is off.
const OFF: Duration = Duration::from_millis(300);
/// How long the sensors get to start.
const START: Duration = Duration::from_millis(300);
/// How long all must answer for the patience to start over.
const WELL: Duration = Duration::from_secs(10);

/// What to do with the line now.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Nothing.
    Nothing,
    /// Let go of the chips and switch it off.
    SwitchOff,
    /// Switch it on.
    SwitchOn,
    /// Open the chips again.
    Open,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    On,
    Off { until: Time },
    Starting { until: Time },
}

/// The state of one line and of all chips on it.
#[derive(Clone, Copy, Debug)]
pub struct PowerCycle {
    state: State,
    patience: Duration,
    well_since: Option<Time>,
}

impl Default for PowerCycle {
    fn default() -> Self {
        Self { state: State::On, patience: PATIENCE, well_since: None }
    }
}

impl PowerCycle {
    /// The next step at `now`; `silent_since` is the time since when the chip that has been silent
    /// the longest has not answered, `None` when all answer.
    pub fn step(&mut self, now: Time, silent_since: Option<Time>) -> Step {
        match (self.state, silent_since) {
            (State::Off { until }, _) if now >= until => {
                self.state = State::Starting { until: now + START };
                Step::SwitchOn
            }
            (State::Starting { until }, _) if now >= until => {
                self.state = State::On;
                Step::Open
            }
            (State::On, Some(since)) => {
                self.well_since = None;
                if now < since + self.patience {
                    return Step::Nothing;
                }
                self.patience = (self.patience * 2).min(MOST_PATIENCE);
                self.state = State::Off { until: now + OFF };
                Step::SwitchOff
            }
            (State::On, None) => {
                if now >= *self.well_since.get_or_insert(now) + WELL {
                    self.patience = PATIENCE;
                }
                Step::Nothing
            }
            _ => Step::Nothing,
        }
    }

    /// Whether the chips are without supply, or starting.
    pub fn is_off(&self) -> bool {
        self.state != State::On
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(ms: u64) -> Time {
        Time::from_nanos(ms * 1_000_000)
    }

    /// Walks in steps of 20 ms with a chip that is silent as `silent` says (ms), and gives what was
    /// done when. A chip that is opened again counts as silent from then on.
    fn walk(end_ms: u64, mut silent: impl FnMut(u64) -> bool) -> Vec<(u64, Step)> {
        let mut cycle = PowerCycle::default();
        let mut since = None;
        let mut done = Vec::new();
        for ms in (0..end_ms).step_by(20) {
            since = if silent(ms) { since.or(Some(at(ms))) } else { None };
            let step = cycle.step(at(ms), since);
            match step {
                Step::Nothing => continue,
                Step::Open => since = None,
                _ => {}
            }
            assert_eq!(cycle.is_off(), step != Step::Open);
            done.push((ms, step));
        }
        done
    }

    #[test]
    fn a_sensor_that_answers_is_left_alone() {
        assert_eq!(walk(120_000, |_| false), []);
        assert_eq!(walk(120_000, |ms| ms % 2000 < 1900), [], "nor one that answers now and then");
    }

    #[test]
    fn off_then_on_then_open() {
        let done = walk(8_000, |ms| ms < 2_000);
        assert_eq!(done, [], "it came back by itself");
        let done = walk(3_000, |_| true);
        assert_eq!(done, [(2_000, Step::SwitchOff), (2_300, Step::SwitchOn), (2_600, Step::Open)]);
    }

    #[test]
    fn the_pause_doubles_up_to_a_minute() {
        let offs: Vec<u64> =
            walk(400_000, |_| true).iter().filter(|(_, s)| *s == Step::SwitchOff).map(|(ms, _)| *ms).collect();
        let pauses: Vec<u64> = offs.windows(2).map(|w| (w[1] - w[0] - 620) / 1000).collect();
        assert_eq!(pauses[..7], [4, 8, 16, 32, 60, 60, 60]);
    }

    #[test]
    fn patience_starts_over_after_ten_good_seconds() {
        // Silent at first, well for 12 s, silent again.
        let done = walk(30_000, |ms| !(2_300..=14_400).contains(&ms));
        let offs: Vec<u64> = done.iter().filter(|(_, s)| *s == Step::SwitchOff).map(|(ms, _)| *ms).collect();
        assert_eq!(offs[..2], [2_000, 16_420]);
    }
}
