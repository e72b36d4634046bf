//! A sensor that says anything: readings that jump as no scene does.

use crate::frame::{Frame, Missing};
use crate::head::Head;
use crate::time::Time;

/// No honest reading jumps by more than this, K, and in a second by so much more: a warm ground and a cold sky, 100 K apart,
/// go past a narrow field of view in a few hundredths of a second at the quickest roll.
const JUMP_K: f64 = 10.0;
const SLEW_K_S: f64 = 800.0;
/// Jumps are counted over this time, s. After more than so many the sensor says anything, until so few are left.
const OVER_S: f64 = 1.0;
const ERRATIC: f64 = 2.0;
const CALM: f64 = 1.0;
/// A sensor that changes at more than this share of the last so many readings does not say what it cannot have seen
/// twice and mean it.
const RESTLESS: f64 = 0.9;
/// The same, that is, but for what a converter adds, K.
const SAME_K: f64 = 0.02;
const LEARNT: f64 = 50.0;

/// One sensor.
#[derive(Clone, Copy, Debug, Default)]
struct Watch {
    /// When it was read last, and the last reading that was no jump: when, K.
    read: Option<Time>,
    last: Option<(Time, f64)>,
    jumps: f64,
    /// What was not believed last, K, and the share of the readings that differ from those before.
    doubted_k: Option<f64>,
    changes: f64,
    erratic: bool,
}

impl Watch {
    /// Takes in a reading, K, or NaN for one that is no temperature; whether it is to be believed.
    fn believes(&mut self, time: Time, reading_k: f64) -> bool {
        if self.read == Some(time) {
            // Told again.
            return !self.erratic && self.last.is_some_and(|(last, _)| last == time);
        }
        if self.read.is_some_and(|read| time < read) {
            // A clock that has been set back begins anew.
            *self = Self::default();
        }
        let since_s = self.read.replace(time).map_or(f64::INFINITY, |read| time.since(read));
        self.jumps *= (-since_s / OVER_S).exp();
        // A wire that is off says the same for ever.
        let again = self.doubted_k.is_some_and(|k| (reading_k - k).abs() <= SAME_K) && self.changes > RESTLESS;
        let far = |(last, last_k): (Time, f64)| (reading_k - last_k).abs() > JUMP_K + SLEW_K_S * time.since(last);
        let jumps = reading_k.is_nan() || !again && self.last.is_some_and(far);
        self.jumps += f64::from(jumps);
        self.erratic = self.jumps > if self.erratic { CALM } else { ERRATIC };
        if jumps || again {
            self.doubted_k = Some(reading_k);
            return false;
        }
        let last = self.last.replace((time, reading_k)).filter(|_| !self.erratic);
        if let Some((_, last_k)) = last {
            self.changes += (f64::from(last_k != reading_k) - self.changes) / LEARNT;
        }
        self.doubted_k = None;
        !self.erratic
    }
}

/// Takes out what sensors cannot have seen.
#[derive(Clone, Debug)]
pub struct ErraticSensors {
    head: Head,
    watches: Vec<Watch>,
}

impl ErraticSensors {
    /// For the sensors of `head`.
    pub fn new(head: &Head) -> Self {
        Self { watches: vec![Watch::default(); head.sensors.len()], head: head.clone() }
    }

    /// Makes [`Missing::Impossible`] of each reading that is no temperature, or jumps by more than 10 K and 800 K a second, and,
    /// after more than two of these in a second, of all that the sensor says until it has been calm for one to some seconds.
    /// A sensor that never says the same twice is not believed either while it repeats such a reading.
    pub fn take_out(&mut self, frame: &mut Frame) {
        for (i, watch) in self.watches.iter_mut().enumerate() {
            let reading_k = self.head.reading_k(i, frame).map_or(f64::NAN, |(reading_k, _)| reading_k);
            let Some(reading) = frame.readings.get_mut(i) else { continue };
            if reading.is_ok_and(|sample| !watch.believes(sample.time, reading_k)) {
                *reading = Err(Missing::Impossible);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::{Sample, Value};
    use crate::simulation::noise::Noise;

    /// Which readings of one sensor, K, 50 a second, are believed.
    fn believed(readings_k: &[f64]) -> Vec<bool> {
        let mut watch = Watch::default();
        let at = |i: usize| Time::from_secs_f64(10.0 + 0.02 * i as f64);
        readings_k.iter().enumerate().map(|(i, k)| watch.believes(at(i), *k)).collect()
    }

    #[test]
    fn what_a_scene_does_is_believed() {
        // A roll of 400° a second between a ground of 40 °C and a sky of −40 °C.
        let rolls: Vec<f64> = (0..500).map(|i| 40.0 * (f64::from(i) * 8.0_f64.to_radians()).sin()).collect();
        assert!(believed(&rolls).iter().all(|b| *b));
    }

    #[test]
    fn one_reading_that_jumps_costs_itself_alone() {
        let mut readings = [5.0; 100];
        readings[50] = 300.0;
        readings[60] = -40.0;
        let wrong: Vec<usize> = (0..100).filter(|i| !believed(&readings)[*i]).collect();
        assert_eq!(wrong, [50, 60]);
    }

    #[test]
    fn a_sensor_that_says_anything_is_not_heard_until_it_is_calm() {
        let mut bits = 7_u32;
        let mut chance = || {
            bits = bits.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(bits >> 8) / f64::from(1 << 24)
        };
        let mut readings = vec![5.0; 50];
        readings.extend((0..500).map(|_| -70.0 + 450.0 * chance()));
        readings.extend([5.0; 500]);
        let believed = believed(&readings);
        assert!(believed[..50].iter().all(|b| *b));
        assert!(believed[50..60].iter().filter(|b| **b).count() <= 2, "{believed:?}");
        assert!(believed[60..550].iter().all(|b| !b));
        let back = believed[550..].iter().position(|b| *b).unwrap();
        assert!((50..250).contains(&back), "{back}");
        assert!(believed[550 + back..].iter().all(|b| *b));
    }

    #[test]
    fn what_is_no_temperature_is_impossible() {
        let (mut sensors, mut frame) = (ErraticSensors::new(&Head::six()), Frame::new(6));
        let values = [20.0, 5000.0, f64::NAN].map(|object_c| Value::Absolute { object_c, ambient_c: None });
        for (reading, value) in frame.readings.iter_mut().zip(values) {
            *reading = Ok(Sample { value, time: Time::from_secs_f64(10.0) });
        }
        sensors.take_out(&mut frame);
        assert!(frame.readings[0].is_ok(), "{frame:?}");
        assert_eq!(frame.readings[1..3], [Err(Missing::Impossible); 2]);
        assert_eq!(frame.readings[3..], [Err(Missing::NotYet); 3]);
    }

    #[test]
    fn what_has_changed_for_good_is_believed_again() {
        let mut readings = vec![5.0; 50];
        readings.extend([150.0; 250]);
        let believed = believed(&readings);
        assert!(!believed[50] && believed[170..].iter().all(|b| *b));
    }

    #[test]
    fn what_no_scene_does_is_not_believed_the_longer_it_stays_the_same() {
        // A pair's noise, then a wire that is off for ten seconds.
        let mut noise = Noise::new(5);
        let mut readings: Vec<f64> = (0..1500).map(|_| 3.0 + 0.05 * noise.normal()).collect();
        readings[500..1000].fill(-49.5);
        let believed = believed(&readings);
        assert!(believed[..500].iter().all(|b| *b));
        assert!(believed[500..1000].iter().all(|b| !b));
        assert!(believed[1000..].iter().all(|b| *b));
    }

    #[test]
    fn a_reading_told_again_is_judged_as_before() {
        let mut watch = Watch::default();
        let at = Time::from_secs_f64;
        assert!(watch.believes(at(1.0), 5.0) && watch.believes(at(1.0), 5.0));
        assert!(!watch.believes(at(1.02), 300.0) && !watch.believes(at(1.02), 300.0));
        assert!(watch.believes(at(1.04), 5.0));
    }

    #[test]
    fn a_clock_that_has_been_set_back_begins_anew() {
        let mut watch = Watch::default();
        let at = Time::from_secs_f64;
        assert!(watch.believes(at(5000.0), 5.0) && watch.believes(at(10.0), 60.0));
        assert!(watch.believes(at(10.02), 60.0) && !watch.believes(at(10.04), 5.0));
    }
}
