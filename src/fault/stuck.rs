//! A sensor that says the same whatever the aircraft does.

mod turned;

use super::debounce::Debounce;
use super::{ActiveFault, Evidence, FaultKind};
use crate::estimator::noise::Noise;
use crate::estimator::{Hearing, Standing};
use crate::frame::Frame;
use crate::head::Head;
use crate::time::Time;
use turned::Turned;

/// What the others must have moved by meanwhile, K, and how many of them.
const MOVED_K: f64 = 2.0;
const OTHERS: usize = 2;
/// And by how much it should have moved itself, K, beyond a step of its readings and one of the others', where that is known:
/// from a method that hears the sensors one by one; else of what looks so much up or down, which shows little of small banks.
const DUE_K: f64 = 1.0;
const UPRIGHT: f64 = 0.7;
/// All that within so long, s: weather moves them, too, and what is learnt of it.
const WITHIN_S: f64 = 20.0;
/// Seconds for which it must have said something else again.
const BACK_S: f64 = 0.5;
/// A run of equal readings is one too many where it is as improbable as e to the minus this.
const IMPROBABLE: f64 = 20.0;
/// And so much more improbable that one other is enough.
const SURE: f64 = 100.0;
/// Noise of so much, K rms, is the sensor's own: what less the readings jump by may be the aircraft's.
const OWN_K: f64 = 0.03;
/// As improbable it must be where the method says that the reading should have changed: more than one repetition.
const DOUBTFUL: f64 = 4.0;
/// How many readings the share of honest repetitions is learnt from, and its bounds.
const LEARNT: f64 = 500.0;
const HONEST: (f64, f64) = (0.02, 0.998);

/// One sensor's readings, K, since it last said something else.
#[derive(Clone, Debug)]
struct Run {
    reading_k: Option<f64>,
    since: Time,
    last: Time,
    /// Since when the others are watched, what each has shown since, least and most,
    watched: Time,
    others: Vec<Option<(f64, f64)>>,
    /// and what they say that it should have shown.
    due: Option<(f64, f64)>,
    /// How often a reading is repeated honestly.
    honest: f64,
    /// How improbable this run is.
    against: f64,
    noise: Noise,
    stuck: Debounce,
}

/// Sees `sensor-stuck`. A quiet sensor of coarse steps repeats itself honestly, and a head at rest does: the others
/// must have moved, and the run must be longer than those that this sensor is known for. One whose noise never lets it
/// say the same twice needs no others; all are stuck that say the same while a gyro rolls. One that is stuck remains so
/// until it says something else.
#[derive(Clone, Debug)]
pub struct StuckSensors {
    head: Head,
    runs: Vec<Run>,
    repeating: Vec<bool>,
    turned: Turned,
    after_s: f64,
}

impl StuckSensors {
    /// With the time for which a sensor must repeat itself, s.
    pub fn new(head: &Head, after_s: f64) -> Self {
        let n = head.sensors.len();
        let run = Run {
            reading_k: None,
            since: Time::default(),
            last: Time::default(),
            watched: Time::default(),
            others: vec![None; n],
            due: None,
            honest: HONEST.1,
            against: 0.0,
            noise: Noise::default(),
            stuck: Debounce::new(0.0, BACK_S),
        };
        Self { head: head.clone(), runs: vec![run; n], repeating: vec![false; n], turned: Turned::default(), after_s }
    }

    /// Another time for which a sensor must repeat itself, s.
    pub fn retune(&mut self, after_s: f64) {
        self.after_s = after_s;
    }

    /// Takes in a frame. What has long said something else again is stuck no more, and to be heard with this frame.
    pub fn hear(&mut self, frame: &Frame) {
        let Self { head, runs, .. } = self;
        for (i, run) in runs.iter_mut().enumerate() {
            run.extend(head.reading_k(i, frame), frame.time);
            // Most runs are over at the next reading: those need no witnesses.
            if run.last > run.since {
                run.watch(i, |j| head.reading_k(j, frame).map(|(k, _)| k));
            }
        }
        for (run, repeating) in self.runs.iter_mut().zip(&mut self.repeating) {
            *repeating = run.reading_k.is_some() && run.last.since(run.since) >= self.after_s;
            if run.stuck.is_active() {
                run.stuck.update(*repeating, frame.time);
            }
        }
    }

    /// Takes in what the method makes of each sensor in the frame that was heard.
    pub fn judge(&mut self, frame: &Frame, sensors: &[Hearing]) {
        let still = self.repeating.iter().all(|r| *r);
        let [roll_rate, ..] = frame.aiding.gyro_deg_s;
        let all = self.turned.rolls(roll_rate.filter(|r| r.is_finite()), still, frame.time);
        for (run, hearing) in self.runs.iter_mut().zip(sensors) {
            run.due = hearing.expected_k.map(|k| extended(run.due, k)).or(run.due);
        }
        for i in 0..self.runs.len() {
            let known = sensors.get(i).is_some_and(|h| h.standing == Standing::Stuck);
            let stuck = self.repeating[i] && (self.runs[i].stuck.is_active() || all || self.convicts(i, known));
            self.runs[i].stuck.update(stuck, frame.time);
        }
    }

    /// Whether that sensor `i` repeats itself is more than chance; the method may have `known` that it should not.
    fn convicts(&self, i: usize, known: bool) -> bool {
        let (run, repeating) = (&self.runs[i], &self.repeating);
        // Several at once are a head at rest; two that look apart are left as they are by a pure climb or roll.
        let count = repeating.iter().filter(|r| **r).count();
        let looks = |j: usize| self.head.sensors[j].direction;
        let apart = || count == 2 && (0..repeating.len()).any(|j| repeating[j] && looks(i).opposes(looks(j)));
        let moved = |(j, seen): (usize, &Option<(f64, f64)>)| {
            !repeating[j] && seen.is_some_and(|(least, most)| most - least > MOVED_K)
        };
        let others = || run.others.iter().enumerate().filter(|(j, s)| moved((*j, s))).count();
        let needed = if run.against > SURE { 1 } else { OTHERS };
        let due_k = || run.due.map(|(least, most)| most - least).or_else(|| self.upright_k(i));
        let due = || due_k().is_none_or(|k| k > DUE_K + 2.0 * run.noise.step_k());
        let witnessed = || !apart() && others() >= needed && due();
        let few = count <= OTHERS && count < repeating.len();
        let alone = few && run.against > IMPROBABLE && (run.is_noisy() && self.others_are_noisy(i) || witnessed());
        alone || (known && run.against > DOUBTFUL)
    }

    /// By how much sensor `i` should have moved by what the others show, K, if it looks up or down: those that look level move
    /// with the sine of an angle of whose cosine it shows something, and of six temperatures the one below nothing but ground.
    fn upright_k(&self, i: usize) -> Option<f64> {
        let (run, sensors) = (&self.runs[i], &self.head.sensors);
        let up = sensors[i].direction.dot([0.0, 0.0, 1.0]);
        let shows_ground = up < 0.0 && sensors.iter().any(|s| sensors[i].direction.opposes(s.direction));
        let shown = |(least, most): &(f64, f64)| {
            let (sine_k, level_k) = ((most - least) / 2.0, (most + least) / 2.0);
            sine_k * sine_k / (2.0 * run.reading_k.map_or(1.0, |k| (k - level_k).abs().max(1.0)))
        };
        let most_k = || run.others.iter().flatten().map(shown).fold(0.0, f64::max);
        (up.abs() > UPRIGHT).then(|| if shows_ground { 0.0 } else { most_k() })
    }

    /// Whether the others than sensor `i` go on by as much as their noise: what all lose at once was no sensor's own.
    fn others_are_noisy(&self, i: usize) -> bool {
        let spans = self.runs[i].others.iter().zip(&self.runs).zip(&self.repeating);
        let mut noisy = spans
            .filter(|(_, repeating)| !**repeating)
            .filter_map(|((seen, other), _)| seen.map(|(least, most)| most - least > other.noise.rms_k()));
        noisy.next().is_some_and(|first| first && noisy.all(|other| other))
    }

    /// Which sensors are stuck.
    pub fn is_stuck(&self, i: usize) -> bool {
        self.runs.get(i).is_some_and(|r| r.stuck.is_active())
    }

    /// Adds what is there to `faults`.
    pub fn report(&self, faults: &mut Vec<ActiveFault>) {
        for (i, run) in self.runs.iter().enumerate() {
            let value = run.last.since(run.since);
            let evidence = Evidence::Limit { value, limit: self.after_s, unit: "s" };
            run.stuck.report(FaultKind::SensorStuck(i), evidence, faults);
        }
    }
}

/// A range with one more in it.
fn extended(range: Option<(f64, f64)>, k: f64) -> (f64, f64) {
    range.map_or((k, k), |(least, most)| (least.min(k), most.max(k)))
}

impl Run {
    fn extend(&mut self, reading: Option<(f64, Time)>, now: Time) {
        let Some((reading, time)) = reading else { return };
        if !self.stuck.is_active() {
            self.noise.update(reading, time, self.reading_k);
        }
        if self.reading_k.is_some_and(|k| (reading - k).abs() <= self.noise.still_k()) {
            if time > self.last {
                self.against -= self.honest.ln();
                if !self.stuck.is_active() {
                    self.learn(1.0);
                }
            }
        } else {
            self.learn(0.0);
            self.reading_k = Some(reading);
            (self.since, self.against) = (time.min(now), 0.0);
            self.watch_anew(self.since);
        }
        self.last = self.last.max(time);
    }

    fn watch_anew(&mut self, now: Time) {
        self.others.fill(None);
        (self.watched, self.due) = (now, None);
    }

    /// What the others than sensor `i` show meanwhile.
    fn watch(&mut self, i: usize, shows_k: impl Fn(usize) -> Option<f64>) {
        if self.last.since(self.watched) > WITHIN_S {
            self.watch_anew(self.last);
        }
        for (j, seen) in self.others.iter_mut().enumerate().filter(|(j, _)| *j != i) {
            if let Some(k) = shows_k(j) {
                *seen = Some(extended(*seen, k));
            }
        }
    }

    /// Whether its noise lets no reading stay as it is.
    fn is_noisy(&self) -> bool {
        self.noise.moves_all() && self.noise.rms_k() > OWN_K
    }

    fn learn(&mut self, repeated: f64) {
        self.honest = (self.honest + (repeated - self.honest) / LEARNT).clamp(HONEST.0, HONEST.1);
    }
}

#[cfg(test)]
mod tests;
