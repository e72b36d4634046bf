//! A sensor that says the same whatever the aircraft does.

use super::debounce::Debounce;
use super::{ActiveFault, Evidence, FaultKind};
use crate::estimator::noise::Noise;
use crate::estimator::{Hearing, Standing};
use crate::frame::Frame;
use crate::head::Head;
use crate::time::Time;

/// What the others must have moved by meanwhile, K, and how many of them.
const MOVED_K: f64 = 2.0;
const OTHERS: usize = 2;
/// Seconds for which it must have said something else again.
const BACK_S: f64 = 0.5;
/// A run of equal readings is one too many where it is as improbable as e to the minus this.
const IMPROBABLE: f64 = 20.0;
/// And so much more improbable that one other is enough.
const SURE: f64 = 100.0;
/// Noise of so much, K rms, is the sensor's own: what less the readings jump by may be the aircraft's.
const OWN_K: f64 = 0.03;
/// As improbable it must be where the method says that the reading should have changed.
const DOUBTFUL: f64 = 3.0;
/// How many readings the share of honest repetitions is learnt from, and its bounds.
const LEARNT: f64 = 500.0;
const HONEST: (f64, f64) = (0.02, 0.998);

/// One sensor's readings, K, since it last said something else.
#[derive(Clone, Debug)]
struct Run {
    reading_k: Option<f64>,
    since: Time,
    last: Time,
    /// What each of the others showed meanwhile, least and most.
    others: Vec<Option<(f64, f64)>>,
    /// How often a reading is repeated honestly.
    honest: f64,
    /// How improbable this run is.
    against: f64,
    noise: Noise,
    stuck: Debounce,
}

/// Sees `sensor-stuck`. A quiet sensor of coarse steps repeats itself honestly, and a head at rest does: the others
/// must have moved, and the run must be longer than those that this sensor is known for. One whose noise never lets it
/// say the same twice needs no others. One that is stuck remains so until it says something else.
#[derive(Clone, Debug)]
pub struct StuckSensors {
    head: Head,
    runs: Vec<Run>,
    repeating: Vec<bool>,
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
            others: vec![None; n],
            honest: HONEST.1,
            against: 0.0,
            noise: Noise::default(),
            stuck: Debounce::new(0.0, BACK_S),
        };
        Self { head: head.clone(), runs: vec![run; n], repeating: vec![false; n], after_s }
    }

    /// Another time for which a sensor must repeat itself, s.
    pub fn retune(&mut self, after_s: f64) {
        self.after_s = after_s;
    }

    /// Takes in a frame, and what the method makes of each sensor.
    pub fn update(&mut self, frame: &Frame, sensors: &[Hearing]) {
        let Self { head, runs, .. } = self;
        for (i, run) in runs.iter_mut().enumerate() {
            run.extend(head.reading_k(i, frame), frame.time);
            // Most runs are over at the next reading: those need no witnesses.
            if run.last > run.since {
                run.watch(i, |j| head.reading_k(j, frame).map(|(k, _)| k));
            }
        }
        for (run, repeating) in self.runs.iter().zip(&mut self.repeating) {
            *repeating = run.reading_k.is_some() && run.last.since(run.since) >= self.after_s;
        }
        for i in 0..self.runs.len() {
            let known = sensors.get(i).is_some_and(|h| h.standing == Standing::Stuck);
            let stuck = self.repeating[i] && (self.runs[i].stuck.is_active() || self.convicts(i, known));
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
        let witnessed = || !apart() && others() >= needed;
        let few = count <= OTHERS && count < repeating.len();
        let alone = few && run.against > IMPROBABLE && (run.is_noisy() && self.others_are_noisy(i) || witnessed());
        alone || (known && run.against > DOUBTFUL)
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

impl Run {
    fn extend(&mut self, reading: Option<(f64, Time)>, now: Time) {
        let Some((reading, time)) = reading else { return };
        self.noise.update(reading, time, self.reading_k);
        if self.reading_k == Some(reading) {
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
            self.others.fill(None);
        }
        self.last = self.last.max(time);
    }

    /// What the others than sensor `i` show meanwhile.
    fn watch(&mut self, i: usize, shows_k: impl Fn(usize) -> Option<f64>) {
        for (j, seen) in self.others.iter_mut().enumerate().filter(|(j, _)| *j != i) {
            if let Some(k) = shows_k(j) {
                let (least, most) = seen.unwrap_or((k, k));
                *seen = Some((least.min(k), most.max(k)));
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
mod tests {
    use super::super::kit::{frame, told, value};
    use super::*;
    use crate::simulation::noise::Noise;
    use std::cell::RefCell;

    const STEP_S: f64 = 0.02;

    /// Six sensors in a turning flight, from 100 s on; `show` says what they show at a time.
    struct Flight {
        stuck: StuckSensors,
        scan: u32,
    }

    impl Flight {
        fn new() -> Self {
            Self { stuck: StuckSensors::new(&Head::six(), 1.0), scan: 0 }
        }

        /// So many seconds; how many scans had a fault.
        fn fly(&mut self, seconds: f64, sensors: &[Hearing], show: impl Fn(usize, f64) -> f64) -> u32 {
            let mut faulty = 0;
            for _ in 0..(seconds / STEP_S).round() as u32 {
                self.scan += 1;
                let time_s = 100.0 + STEP_S * f64::from(self.scan);
                let shown: Vec<f64> = (0..6).map(|i| show(i, time_s)).collect();
                self.stuck.update(&frame(time_s, &shown, None), sensors);
                faulty += u32::from((0..6).any(|i| self.stuck.is_stuck(i)));
            }
            faulty
        }

        fn stuck(&self) -> Vec<usize> {
            (0..6).filter(|i| self.stuck.is_stuck(*i)).collect()
        }
    }

    /// Each sensor goes its own way, never twice through the same.
    fn turning(i: usize, time_s: f64) -> f64 {
        20.0 * (time_s * (1.1 + 0.1 * i as f64)).sin()
    }

    /// The same where these sensors rest.
    fn but(at_rest: &[usize]) -> impl Fn(usize, f64) -> f64 {
        move |i, time_s| if at_rest.contains(&i) { 3.0 } else { turning(i, time_s) }
    }

    #[test]
    fn one_that_repeats_itself_while_others_move_is_stuck_until_it_moves() {
        let mut flight = Flight::new();
        assert_eq!(flight.fly(30.0, &[], turning), 0);
        flight.fly(0.9, &[], but(&[2]));
        assert_eq!(flight.stuck(), [0; 0], "not yet");
        flight.fly(0.3, &[], but(&[2]));
        assert_eq!(flight.stuck(), [2]);
        flight.fly(10.0, &[], but(&[2]));
        let told = told(|f| flight.stuck.report(f));
        assert_eq!(told.iter().map(|t| t.0).collect::<Vec<_>>(), [FaultKind::SensorStuck(2)]);
        let (value, unit) = value(&told[0]);
        assert!((value - 11.2).abs() < 0.05 && unit == "s", "{value} {unit}");
        flight.fly(0.4, &[], turning);
        assert_eq!(flight.stuck(), [2], "not yet over");
        flight.fly(0.2, &[], turning);
        assert_eq!(flight.stuck(), [0; 0]);
    }

    #[test]
    fn a_quiet_sensor_of_coarse_steps_repeats_itself_honestly_for_ten_minutes() {
        // Steps of 0.5 K of what drifts by 1 K in 12 s and back: each lasts for some seconds.
        let coarse = |i: usize, time_s: f64| match i {
            5 => ((time_s / 12.0 * std::f64::consts::TAU).sin() / 0.5).round() * 0.5,
            _ => turning(i, time_s),
        };
        let mut flight = Flight::new();
        assert_eq!(flight.fly(600.0, &[], coarse), 0);
    }

    #[test]
    fn a_head_at_rest_has_no_stuck_sensor_and_few_that_move_convict_none() {
        for at_rest in [&[0, 1, 2, 3, 4, 5][..], &[0, 1, 2, 3, 4], &[0, 1, 2, 3], &[0, 1, 2]] {
            let mut flight = Flight::new();
            flight.fly(30.0, &[], turning);
            assert_eq!(flight.fly(30.0, &[], but(at_rest)), 0, "{at_rest:?}");
        }
        // Two at once are two.
        let mut flight = Flight::new();
        flight.fly(30.0, &[], turning);
        flight.fly(3.0, &[], but(&[0, 4]));
        assert_eq!(flight.stuck(), [0, 4]);
        // Others that move by less than 2 K say nothing.
        let still = |i: usize, time_s: f64| if i == 3 { 3.0 } else { 0.04 * turning(i, time_s) };
        let mut flight = Flight::new();
        flight.fly(30.0, &[], turning);
        assert_eq!(flight.fly(30.0, &[], still), 0);
    }

    #[test]
    fn one_whose_noise_ends_is_stuck_though_nothing_has_moved() {
        // Noise of 0.05 K in steps of 0.004 K, as of a pair, or of 0.01 K in steps of 0.02 K, as of a quiet sensor.
        let still = |noise_k: f64, step_k: f64| {
            let noise = RefCell::new(Noise::new(11));
            let mut flight = Flight::new();
            let show = |ends: bool| {
                let noise = &noise;
                move |i: usize, time_s: f64| {
                    let k = 0.5 * (0.2 * time_s).sin() + noise_k * noise.borrow_mut().normal();
                    if ends && i == 4 { 0.0 } else { (k / step_k).round() * step_k }
                }
            };
            let wrongly = flight.fly(120.0, &[], show(false));
            flight.fly(1.1, &[], show(true));
            (wrongly, flight.stuck())
        };
        assert_eq!(still(0.05, 0.004), (0, vec![4]));
        assert_eq!(still(0.01, 0.02), (0, vec![]));
    }

    #[test]
    fn noise_that_ends_for_all_at_once_was_the_aircraft_s() {
        let noise = RefCell::new(Noise::new(11));
        let mut flight = Flight::new();
        flight.fly(60.0, &[], |_, _| (0.05 * noise.borrow_mut().normal() / 0.004).round() * 0.004);
        let calm = |i: usize, time_s: f64| if i != 4 && (time_s * 25.0).fract() < 0.5 { 0.004 } else { 0.0 };
        assert_eq!(flight.fly(30.0, &[], calm), 0);
    }

    #[test]
    fn of_three_one_other_that_moves_is_enough_where_the_run_is_long() {
        let mut flight = Flight::new();
        let shows = |i: usize, time_s: f64| if i < 2 { turning(i, time_s) } else { 0.04 * turning(i, time_s) };
        flight.fly(30.0, &[], shows);
        flight.fly(2.0, &[], |i, time_s| if i == 1 { 3.0 } else { shows(i, time_s) });
        assert_eq!(flight.stuck(), [1]);
    }

    #[test]
    fn one_that_is_stuck_remains_so_though_the_method_asks_it_no_more() {
        let mut sensors = [Hearing::default(); 8];
        sensors[1].standing = Standing::Stuck;
        let mut flight = Flight::new();
        flight.fly(30.0, &[], turning);
        flight.fly(1.1, &sensors, but(&[0, 1, 2, 3]));
        assert_eq!(flight.stuck(), [1]);
        flight.fly(20.0, &[], but(&[0, 1, 2, 3]));
        assert_eq!(flight.stuck(), [1]);
        flight.fly(1.0, &[], turning);
        assert_eq!(flight.stuck(), [0; 0]);
    }

    #[test]
    fn what_the_method_says_counts_where_the_reading_is_the_same_for_as_long() {
        let mut sensors = [Hearing::default(); 8];
        sensors[1].standing = Standing::Stuck;
        let mut flight = Flight::new();
        assert_eq!(flight.fly(30.0, &sensors, turning), 0, "it does move");
        flight.fly(0.9, &sensors, but(&[0, 1, 2, 3]));
        assert_eq!(flight.stuck(), [0; 0]);
        flight.fly(0.2, &sensors, but(&[0, 1, 2, 3]));
        assert_eq!(flight.stuck(), [1]);
    }
}
