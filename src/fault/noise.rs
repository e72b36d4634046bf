//! How noisy the sensors are, from how their readings jump.

use crate::estimator::noise::Jumps;
use crate::frame::Frame;
use crate::head::{Head, Sensor};

/// Over this time noise is averaged, s.
const WINDOW_S: f64 = 10.0;
/// Of so many sensors the first are asked.
const MOST: usize = 16;
/// Noise at the beginning, K.
const FIRST_K: f64 = 0.1;

/// Measures the noise of a head's sensors by second differences: what changes evenly leaves none.
#[derive(Clone, Debug)]
pub struct NoiseMeter {
    /// Of each sensor, with its noise, K².
    sensors: Vec<(Jumps, f64)>,
}

impl NoiseMeter {
    /// For a head.
    pub fn new(head: &Head) -> Self {
        Self { sensors: vec![(Jumps::default(), FIRST_K * FIRST_K); head.sensors.len()] }
    }

    /// Takes in a frame of `head`.
    pub fn update(&mut self, head: &Head, frame: &Frame) {
        for (i, (jumps, square)) in self.sensors.iter_mut().enumerate() {
            let Some((reading, time)) = head.reading_k(i, frame) else { continue };
            if let Some((dt_s, seen)) = jumps.update(reading, time, *square) {
                let share = -(-dt_s / WINDOW_S).exp_m1();
                *square += share * (seen - *square);
            }
        }
    }

    /// The noise of a pair's difference, K rms: that of the middle one of the head's sensors.
    pub fn pair_k(&self, head: &Head) -> f64 {
        let two = |s: &Sensor| if s.is_absolute() { 2.0 } else { 1.0 };
        let mut middle = [0.0; MOST];
        let squares = self.sensors.iter().zip(&head.sensors).map(|((_, square), s)| two(s) * square);
        let count = middle.iter_mut().zip(squares).map(|(m, s)| *m = s).count();
        middle[..count].sort_by(f64::total_cmp);
        middle[count.saturating_sub(1) / 2].sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::super::kit::{alike, frame};
    use super::*;
    use crate::frame::{Sample, Value};
    use crate::head::SensorKind;
    use crate::simulation::noise::Noise;

    /// Sensors with so much noise, every `step_s` for a minute while the aircraft turns from side to side.
    fn measured(head: &Head, noise_k: f64, step_s: f64) -> f64 {
        let (mut meter, mut noise) = (NoiseMeter::new(head), Noise::new(7));
        for i in 0..(60.0 / step_s) as u32 {
            let time_s = 100.0 + f64::from(i) * step_s;
            let turning_c = 15.0 * (time_s * 1.3).sin();
            let shown: Vec<f64> = head.sensors.iter().map(|_| turning_c + noise_k * noise.normal()).collect();
            let mut frame = frame(time_s, &shown, None);
            for (reading, sensor) in frame.readings.iter_mut().zip(&head.sensors) {
                if let (Ok(Sample { value, .. }), SensorKind::Pair { kelvin_per_v, .. }) = (reading, sensor.kind) {
                    let Value::Absolute { object_c, .. } = *value else { panic!() };
                    *value = Value::Volts(object_c / kelvin_per_v);
                }
            }
            meter.update(head, &frame);
        }
        meter.pair_k(head)
    }

    #[test]
    fn it_finds_the_noise_of_a_pair_within_a_fifth() {
        let volts = SensorKind::Pair { neutral_v: 0.0, kelvin_per_v: -40.0 };
        for noise_k in [0.05, 0.08, 0.15, 0.3, 0.6, 1.0] {
            // Two sensors make a difference; a pair's channel is one.
            for (head, expected) in [
                (Head::six(), noise_k * 2_f64.sqrt()),
                (alike(3, volts), noise_k),
                (alike(16, SensorKind::ABSOLUTE), noise_k * 2_f64.sqrt()),
            ] {
                let found = measured(&head, noise_k, 0.02);
                assert!((found / expected - 1.0).abs() < 0.2, "{expected} K found as {found} K");
            }
        }
    }

    #[test]
    fn what_comes_too_seldom_tells_nothing_of_noise() {
        let first = NoiseMeter::new(&Head::six()).pair_k(&Head::six());
        assert!((first - 0.1 * 2_f64.sqrt()).abs() < 1e-12);
        assert_eq!(measured(&Head::six(), 0.6, 0.1), first);
    }

    #[test]
    fn the_same_reading_twice_is_no_reading() {
        let head = Head::six();
        let (mut once, mut twice, mut noise) = (NoiseMeter::new(&head), NoiseMeter::new(&head), Noise::new(3));
        for i in 0..1000 {
            let frame = frame(10.0 + 0.02 * f64::from(i), &[(); 6].map(|()| 0.3 * noise.normal()), None);
            once.update(&head, &frame);
            twice.update(&head, &frame);
            twice.update(&head, &frame);
        }
        assert_eq!(once.pair_k(&head), twice.pair_k(&head));
    }

    #[test]
    fn one_wild_sensor_is_not_the_middle_one_and_none_is_no_noise() {
        let head = Head::six();
        let (mut meter, mut noise) = (NoiseMeter::new(&head), Noise::new(5));
        for i in 0..3000 {
            let mut shown = [(); 6].map(|()| 0.1 * noise.normal());
            shown[2] *= 100.0;
            meter.update(&head, &frame(10.0 + 0.02 * f64::from(i), &shown, None));
        }
        assert!((meter.pair_k(&head) / 0.141 - 1.0).abs() < 0.2, "{}", meter.pair_k(&head));
        let none = Head::default();
        assert_eq!(NoiseMeter::new(&none).pair_k(&none), 0.0);
    }
}
