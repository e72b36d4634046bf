//! Films on one sensor and on all, seen by the sensors' own temperatures and without them.

use super::super::kit::{frame, seen, told, value};
use super::*;
use crate::estimator::{Hearing, Standing};

const WET: usize = 3;
const OWN_C: f64 = 24.0;

/// Six sensors at 50 Hz.
struct Flight {
    wet: WetSensors,
    time_s: f64,
    obstructed: bool,
}

/// What sensor [`WET`] should show, °C: it changes as the aircraft turns.
fn due_c(time_s: f64) -> f64 {
    -8.0 + 6.0 * (1.7 * time_s).sin()
}

impl Flight {
    fn new() -> Self {
        Self { wet: WetSensors::new(&Head::six(), 0.5), time_s: 100.0, obstructed: false }
    }

    /// So many seconds: a film that hides so much, and how the sensor stands. What it hides behind is its own
    /// temperature, whether that is read (`own_c`) or not.
    fn fly(&mut self, seconds: f64, film: f64, standing: Standing, own_c: Option<f64>) {
        for _ in 0..(seconds * 50.0).round() as u32 {
            self.time_s += 0.02;
            let due_c = due_c(self.time_s);
            let mut shown_c = [3.0; 6];
            shown_c[WET] = film * OWN_C + (1.0 - film) * due_c;
            let mut solution = seen(30.0);
            solution.sensors[WET] = Hearing { standing, expected_k: Some(due_c), residual_k: None, lost: Some(film) };
            self.wet.update(&frame(self.time_s, &shown_c, own_c), &solution, 2.0, self.obstructed);
        }
    }

    fn told(&self) -> Vec<(FaultKind, (f64, &'static str))> {
        told(|f| self.wet.report(f)).iter().map(|t| (t.0, value(t))).collect()
    }
}

#[test]
fn the_film_is_the_share_of_its_own_temperature() {
    for (film, expected) in [(0.3, false), (0.45, false), (0.55, true), (0.8, true), (1.0, true)] {
        let mut flight = Flight::new();
        flight.fly(5.0, film, Standing::LeftOut, Some(OWN_C));
        let told = flight.told();
        assert_eq!(told.len(), usize::from(expected), "{film}");
        for (kind, (value, unit)) in told {
            assert_eq!((kind, unit), (FaultKind::WetSensor(WET), "%"));
            assert!((value - 100.0 * film).abs() < 1.0, "{film}: {value} %");
        }
    }
}

#[test]
fn without_its_own_temperature_the_film_is_what_it_does_not_follow() {
    for (film, expected) in [(0.2, false), (0.4, false), (0.6, true), (0.9, true)] {
        let mut flight = Flight::new();
        flight.fly(7.0, film, Standing::LeftOut, None);
        let told = flight.told();
        assert_eq!(told.len(), usize::from(expected), "{film}");
        for (kind, (value, unit)) in told {
            assert_eq!((kind, unit), (FaultKind::WetSensor(WET), "%"));
            assert!((value - 100.0 * film).abs() < 2.0, "{film}: {value} %");
        }
    }
}

#[test]
fn only_a_sensor_that_is_left_out_is_wet() {
    for standing in [Standing::Heard, Standing::Doubted, Standing::Stuck] {
        let mut flight = Flight::new();
        flight.fly(20.0, 0.9, standing, Some(OWN_C));
        assert_eq!(flight.told(), [], "{standing:?}");
    }
}

#[test]
fn one_that_others_contradict_for_long_is_told_without_a_film() {
    let mut flight = Flight::new();
    flight.fly(7.5, 0.3, Standing::LeftOut, Some(OWN_C));
    assert_eq!(flight.told(), []);
    flight.fly(2.0, 0.3, Standing::LeftOut, Some(OWN_C));
    assert_eq!(flight.told().len(), 1);
}

/// Where the scene is not one horizon, others contradict a sensor that is right; a film is seen there as well.
#[test]
fn among_walls_what_the_others_say_proves_no_film() {
    let mut flight = Flight { obstructed: true, ..Flight::new() };
    flight.fly(20.0, 0.3, Standing::LeftOut, Some(OWN_C));
    assert_eq!(flight.told(), []);
    flight.obstructed = false;
    flight.fly(1.0, 0.3, Standing::LeftOut, Some(OWN_C));
    assert_eq!(flight.told().len(), 1, "out of the valley it is still contradicted");
    let mut flight = Flight { obstructed: true, ..Flight::new() };
    flight.fly(3.0, 0.9, Standing::LeftOut, Some(OWN_C));
    assert_eq!(flight.told().len(), 1);
}

/// Below, where ground and die are nearly as warm: a film is named, but not among walls, which leave in doubt how warm it should be.
#[test]
fn a_film_on_what_is_nearly_as_warm_is_named_where_no_walls_are() {
    for (obstructed, own_c, named) in [(false, 12.0, 1), (true, 12.0, 0), (true, 14.0, 1), (false, 11.0, 0)] {
        let mut wet = WetSensors::new(&Head::six(), 0.5);
        for i in 0..150 {
            let mut shown_c = [3.0; 6];
            shown_c[WET] = 0.9 * own_c + 0.1 * 10.0;
            let mut solution = seen(30.0);
            let expected_k = Some(10.0);
            solution.sensors[WET] = Hearing { standing: Standing::LeftOut, expected_k, residual_k: None, lost: None };
            wet.update(&frame(100.0 + 0.02 * f64::from(i), &shown_c, Some(own_c)), &solution, 2.0, obstructed);
        }
        assert_eq!(told(|f| wet.report(f)).len(), named, "{obstructed}, {own_c} °C");
    }
}

#[test]
fn it_dries() {
    let mut flight = Flight::new();
    flight.fly(3.0, 0.9, Standing::LeftOut, Some(OWN_C));
    assert_eq!(flight.told().len(), 1);
    // Above six tenths of the limit it stays.
    flight.fly(2.0, 0.35, Standing::LeftOut, Some(OWN_C));
    assert_eq!(flight.told().len(), 1);
    flight.fly(2.5, 0.1, Standing::LeftOut, Some(OWN_C));
    assert_eq!(flight.told(), []);
    flight.fly(3.0, 0.9, Standing::LeftOut, Some(OWN_C));
    flight.fly(0.9, 0.0, Standing::Heard, Some(OWN_C));
    assert_eq!(flight.told().len(), 1);
    flight.fly(0.2, 0.0, Standing::Heard, Some(OWN_C));
    assert_eq!(flight.told(), []);
}

/// A minute in the clear, then `seconds` in which so much is left of contrast and of what sensors show beyond
/// their own temperature.
fn collapse(wet: &mut WetSensors, seconds: f64, contrast: f64, apart: f64, low: bool) -> usize {
    for i in 0..(50.0 * (60.0 + seconds)) as u32 {
        let time_s = 100.0 + 0.02 * f64::from(i);
        let (contrast, apart) = if time_s < 160.0 { (1.0, 1.0) } else { (contrast, apart) };
        let shown_c = [1.0, -1.0, 1.0, -1.0, 1.0, -1.0].map(|side| OWN_C - 20.0 * apart + 15.0 * contrast * side);
        let low_k = if low { 10.0 } else { 2.0 };
        wet.update(&frame(time_s, &shown_c, Some(OWN_C)), &seen(30.0 * contrast), low_k, false);
    }
    told(|f| wet.report(f)).len()
}

#[test]
fn all_are_wet_where_contrast_and_distance_from_their_own_temperature_go_at_once() {
    for (seconds, contrast, apart, low, expected) in [
        (5.0, 0.1, 0.1, false, 6),
        (1.0, 0.1, 0.1, false, 0),
        (5.0, 0.1, 1.0, false, 0),
        (5.0, 1.0, 0.1, false, 0),
        (5.0, 0.3, 0.3, false, 0),
        (5.0, 0.1, 0.1, true, 0),
    ] {
        let mut wet = WetSensors::new(&Head::six(), 0.5);
        let found = collapse(&mut wet, seconds, contrast, apart, low);
        assert_eq!((found, wet.all()), (expected, expected > 0), "{contrast} and {apart} left for {seconds} s");
    }
}

/// What one sensor did says nothing of the others.
#[test]
fn one_that_was_wild_makes_not_all_wet_and_one_that_is_silent_takes_nothing_back() {
    let mut wet = WetSensors::new(&Head::six(), 0.5);
    for i in 0..3500 {
        let time_s = 100.0 + 0.02 * f64::from(i);
        let mut shown_c = [2.5, -2.5, 2.5, -2.5, 2.5, -2.5].map(|k| OWN_C + k);
        if time_s < 160.0 {
            shown_c[0] = 120.0;
        }
        wet.update(&frame(time_s, &shown_c, Some(OWN_C)), &seen(5.0), 2.0, false);
        assert!(!wet.all(), "{time_s} s");
    }
    let mut wet = WetSensors::new(&Head::six(), 0.5);
    assert_eq!(collapse(&mut wet, 5.0, 0.1, 0.1, false), 6);
    for i in 0..250 {
        let shown_c = [1.0, -1.0, 1.0, -1.0, 1.0, -1.0].map(|side| OWN_C - 2.0 + 1.5 * side);
        let mut frame = frame(165.0 + 0.02 * f64::from(i), &shown_c, Some(OWN_C));
        frame.readings[0] = Err(crate::frame::Missing::NoAnswer);
        wet.update(&frame, &seen(3.0), 2.0, false);
    }
    assert!(wet.all());
}
