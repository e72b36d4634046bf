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
            let frame = frame(time_s, &shown, None);
            self.stuck.hear(&frame);
            self.stuck.judge(&frame, sensors);
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

/// A quiet sensor that looks at the ground, or at the sky in small banks, says the same though all others move.
#[test]
fn what_looks_up_or_down_repeats_itself_honestly() {
    let mut flight = Flight::new();
    assert_eq!(flight.fly(600.0, &[], |i, s| if i == 5 { 16.0 } else { turning(i, s) }), 0, "down");
    let gentle = |i: usize, s: f64| if i > 3 { 20.0 } else { 0.2 * turning(i, s) };
    assert_eq!(flight.fly(600.0, &[], gentle), 0, "in small banks");
    // A method that expects it to move by 0.1 K every twelve seconds, or by 2 K.
    for (due_k, stuck) in [(0.05, 0), (1.0, 1)] {
        let mut flight = Flight::new();
        let show = |rests: bool| move |i: usize, s: f64| if i == 5 && rests { 16.0 } else { turning(i, s) };
        flight.fly(30.0, &[], show(false));
        for second in 0..60 {
            let mut sensors = [Hearing::default(); 8];
            sensors[5].expected_k = Some(16.0 + due_k * (f64::from(second) * 0.52).sin());
            flight.fly(1.0, &sensors, show(true));
        }
        assert_eq!(flight.stuck().len(), stuck, "{due_k} K");
    }
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

/// At rest nothing rolls, and a steady turn rolls hardly; a gyro's bias is no roll.
#[test]
fn all_are_stuck_that_say_the_same_while_a_gyro_rolls() {
    for (rate_deg_s, stuck) in [(None, 0), (Some(0.0), 0), (Some(-2.5), 0), (Some(f64::NAN), 0), (Some(-20.0), 6)] {
        let mut flight = Flight::new();
        flight.fly(5.0, &[], turning);
        for _ in 0..1500 {
            flight.scan += 1;
            let mut frame = frame(100.0 + STEP_S * f64::from(flight.scan), &[3.0; 6], None);
            frame.aiding.gyro_deg_s[0] = rate_deg_s;
            flight.stuck.hear(&frame);
            flight.stuck.judge(&frame, &[]);
        }
        assert_eq!(flight.stuck().len(), stuck, "{rate_deg_s:?}");
        flight.fly(1.0, &[], turning);
        assert_eq!(flight.stuck().len(), 0, "{rate_deg_s:?}");
    }
}
