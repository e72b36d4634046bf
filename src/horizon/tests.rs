use super::*;
use crate::config::Settings;
use crate::direction::Direction;
use crate::fault::FaultKind;
use crate::frame::{Aiding, Sample, Value};
use crate::time::Time;

mod missed;

fn by(method: Method) -> Settings {
    let mut settings = Settings::default();
    settings.estimator.method = Some(method);
    settings
}

/// A head under a sinusoidal sky: what its frames give, 50 a second.
struct Flight {
    horizon: Horizon,
    estimate: Estimate,
    now_s: f64,
    aiding: Aiding,
}

impl Flight {
    /// By the report's scheme, which needs every sensor.
    fn new() -> Self {
        Self::by(Method::InverseSine)
    }

    fn by(method: Method) -> Self {
        Self::with(&by(method))
    }

    fn with(settings: &Settings) -> Self {
        Self {
            horizon: Horizon::new(settings, Head::six()),
            estimate: Estimate::default(),
            now_s: 100.0,
            aiding: Aiding::default(),
        }
    }

    /// The next frame: `contrast_k` at level, `missing` by sensor.
    fn fly(&mut self, roll_deg: f64, contrast_k: f64, missing: &[(usize, Missing)]) -> &Estimate {
        let frame = self.frame(roll_deg, contrast_k, missing);
        self.horizon.update(&frame, &[], &mut self.estimate);
        &self.estimate
    }

    fn frame(&mut self, roll_deg: f64, contrast_k: f64, missing: &[(usize, Missing)]) -> Frame {
        self.now_s += 0.02;
        let time = Time::from_secs_f64(self.now_s);
        let vertical = Attitude::from_degrees(roll_deg, 0.0).vertical();
        let mut frame = Frame::new(6);
        frame.time = time;
        frame.aiding = self.aiding;
        for (reading, (_, direction)) in frame.readings.iter_mut().zip(Direction::NAMED) {
            let object_c = 16.0 - contrast_k / 2.0 * (1.0 + direction.dot(vertical));
            *reading = Ok(Sample { value: Value::Absolute { object_c, ambient_c: None }, time });
        }
        for (sensor, reason) in missing {
            frame.readings[*sensor] = Err(*reason);
        }
        frame
    }

    /// As many frames as `seconds` hold; the estimate after the last.
    fn for_s(&mut self, seconds: f64, roll_deg: f64, contrast_k: f64, missing: &[(usize, Missing)]) -> &Estimate {
        for _ in 0..(seconds * 50.0).round() as u32 {
            self.fly(roll_deg, contrast_k, missing);
        }
        &self.estimate
    }

    fn kinds(&self) -> Vec<FaultKind> {
        self.estimate.faults.iter().map(|f| f.kind).collect()
    }
}

#[test]
fn the_first_good_frame_is_nominal() {
    let mut f = Flight::new();
    let e = f.fly(10.0, 30.0, &[]);
    assert_eq!((e.mode, e.faults.len()), (Mode::Nominal, 0));
    assert!(e.attitude.is_some());
    assert_eq!(e.time, Time::from_secs_f64(100.02));
}

#[test]
fn a_sensor_at_its_end_is_saturated_not_lost() {
    let mut f = Flight::new();
    f.for_s(0.3, 0.0, 30.0, &[(4, Missing::Saturated)]);
    assert_eq!(f.kinds(), [FaultKind::SensorSaturated(4)]);
}

#[test]
fn fog_withholds_from_its_first_frame_and_is_named_soon() {
    let mut f = Flight::new();
    let before = f.for_s(1.0, 20.0, 30.0, &[]).time;
    f.fly(20.0, 0.3, &[]);
    assert_eq!(f.estimate.time, before, "suspected: nothing new is said");
    f.for_s(0.3, 20.0, 0.3, &[]);
    assert_eq!((f.kinds(), f.estimate.attitude), (vec![FaultKind::LowContrast], None));
    // The range needs its time constant to come back; then a second without doubt.
    f.for_s(5.0, 20.0, 30.0, &[]);
    assert_eq!((f.estimate.mode, f.kinds()), (Mode::Nominal, vec![]));
}

#[test]
fn a_moment_without_contrast_is_no_fault() {
    let mut f = Flight::new();
    f.for_s(1.0, 0.0, 30.0, &[]);
    f.for_s(0.1, 0.0, 0.5, &[]);
    f.fly(0.0, 30.0, &[]);
    assert_eq!((f.estimate.mode, f.kinds()), (Mode::Nominal, vec![]));
}

#[test]
fn ground_colder_than_the_sky_withholds() {
    let mut f = Flight::new();
    f.for_s(1.0, 0.0, 5.0, &[]);
    f.for_s(0.2, 0.0, -6.0, &[]);
    assert!(f.kinds().contains(&FaultKind::InvertedContrast), "{:?}", f.kinds());
    assert_eq!(f.estimate.attitude, None);
    f.for_s(30.0, 0.0, -6.0, &[]);
    assert!(f.estimate.contrast_k.unwrap() < -5.0, "shown with its sign");
    assert_eq!(f.estimate.attitude, None, "however long it lasts");
}

#[test]
fn from_contrast_to_none_to_reversed_there_is_no_gap_in_which_an_attitude_is_given() {
    let mut f = Flight::new();
    f.for_s(2.0, 15.0, 5.0, &[]);
    let mut withheld_since = None;
    for i in 0..200 {
        let contrast_k = 5.0 - 7.0 * f64::from(i) / 100.0;
        let e = f.fly(15.0, contrast_k.max(-2.0), &[]);
        match (withheld_since, e.attitude) {
            (None, None) => withheld_since = Some(contrast_k),
            (Some(_), Some(_)) => panic!("given again at {contrast_k} K"),
            _ => {}
        }
    }
    assert!(withheld_since.is_some_and(|k| k > 0.0), "withheld before the contrast crosses zero: {withheld_since:?}");
}

#[test]
fn steep_banks_in_good_contrast_are_no_fault() {
    let mut f = Flight::new();
    f.for_s(2.0, 0.0, 20.0, &[]);
    for i in 0..1000 {
        f.fly(60.0 * (f64::from(i) * 0.02).sin(), 20.0, &[]);
        assert_eq!(f.kinds(), []);
    }
}

#[test]
fn a_bus_that_is_down_is_one_fault_not_one_a_sensor() {
    let mut head = Head::six();
    head.buses.push("/dev/i2c-1".into());
    for sensor in &mut head.sensors {
        sensor.bus = Some(0);
    }
    let mut horizon = Horizon::new(&Settings::default(), head);
    let mut estimate = Estimate::default();
    for i in 0..20 {
        let mut frame = Frame::new(6);
        frame.readings.fill(Err(Missing::BusGone));
        frame.time = Time::from_secs_f64(1.0 + f64::from(i) * 0.02);
        horizon.update(&frame, &[Some(Missing::BusGone)], &mut estimate);
    }
    let kinds: Vec<_> = estimate.faults.iter().map(|f| f.kind).collect();
    assert_eq!(kinds, [FaultKind::BusDown(0)]);
    assert_eq!(estimate.mode, Mode::Faulted);
}

#[test]
fn trims_are_taken_off() {
    let mut settings = by(Method::InverseSine);
    settings.head.roll_trim_deg = 3.0;
    settings.head.pitch_trim_deg = -2.0;
    let mut f = Flight::with(&settings);
    let a = f.fly(10.0, 30.0, &[]).attitude.unwrap();
    // The range was learnt in that bank: asin(tan 10°).
    let expected = 10.0_f64.to_radians().tan().asin().to_degrees() - 3.0;
    assert!((a.roll.to_degrees() - expected).abs() < 0.05 && (a.pitch.to_degrees() - 2.0).abs() < 1e-9);
}

#[test]
fn the_other_methods_know_how_the_head_sits() {
    for method in [Method::Profile, Method::Field] {
        let mut settings = by(method);
        settings.head.roll_trim_deg = 30.0;
        settings.head.pitch_trim_deg = 0.0;
        let trimmed = Flight::with(&settings).for_s(1.0, 30.0, 30.0, &[]).attitude.unwrap();
        assert!(trimmed.roll.abs() < 0.06 && trimmed.pitch.abs() < 0.02, "{method:?}: {trimmed:?}");
        settings.head.pitch_trim_deg = 20.0;
        let turned = Flight::with(&settings).for_s(1.0, 30.0, 30.0, &[]).attitude.unwrap();
        // What is 20° nose up on the head is level: the airframe's nose is down by them.
        assert!(turned.roll.abs() < 0.06 && (turned.pitch.to_degrees() + 20.0).abs() < 1.0, "{method:?}: {turned:?}");
    }
}

#[test]
fn roll_is_limited_where_that_is_chosen_and_its_sigma_owns_up() {
    for method in [Method::Profile, Method::Field] {
        let roll = |limit_deg| {
            let mut settings = by(method);
            settings.estimator.roll_limit_deg = limit_deg;
            let mut f = Flight::with(&settings);
            let e = f.for_s(1.0, 60.0, 30.0, &[]);
            (e.attitude.unwrap().roll.to_degrees(), e.sigma.roll.to_degrees())
        };
        let (free, _) = roll(None);
        assert!((free - 60.0).abs() < 8.0, "{method:?}: {free}");
        let (limited, sigma) = roll(Some(45.0));
        assert!((limited - 45.0).abs() < 1e-9 && sigma > free - 45.1, "{method:?}: {limited} ± {sigma}");
    }
}

#[test]
fn field_goes_on_without_a_sensor_that_is_lost() {
    let mut f = Flight::by(Method::Field);
    f.for_s(2.0, 20.0, 30.0, &[]);
    let e = f.for_s(1.0, 20.0, 30.0, &[(2, Missing::NoAnswer)]).clone();
    // The sky of these tests is a sine's, which no real one is: that may be seen too.
    assert!(e.mode == Mode::Degraded && f.kinds().contains(&FaultKind::SensorLost(2)), "{e:?}");
    assert!((e.attitude.unwrap().roll.to_degrees() - 20.0).abs() < 3.0, "{e:?}");
}

#[test]
fn the_sensors_say_their_lag_where_the_configuration_does_not() {
    let rolls = |said: Option<f64>, told: Option<f64>| {
        let mut settings = by(Method::Field);
        settings.head.lag_s = said;
        // The sky of these tests is a sine's, which no real one is: that may be doubted.
        settings.faults.sigma_limit_deg = 90.0;
        let mut f = Flight::with(&settings);
        told.into_iter().for_each(|lag_s| f.horizon.set_lag_s(lag_s));
        f.for_s(1.0, 0.0, 30.0, &[]);
        (0..25).map(|i| f.fly(f64::from(i), 30.0, &[]).attitude.unwrap().roll.to_bits()).collect::<Vec<_>>()
    };
    let (unsaid, slow) = (rolls(None, None), rolls(Some(0.4), None));
    assert_ne!(unsaid, slow);
    assert_eq!(rolls(Some(0.1), None), unsaid);
    assert_eq!(rolls(None, Some(0.4)), slow);
    assert_eq!(rolls(Some(0.4), Some(0.2)), slow, "what the configuration says stays");
    for none in [f64::NAN, f64::INFINITY, -1.0, 5.1] {
        assert_eq!(rolls(None, Some(none)), unsaid, "{none}");
    }
}

#[test]
fn upright_again_after_an_inversion_there_is_one_fault_and_it_ends_once() {
    let mut f = Flight::new();
    f.for_s(10.0, 0.0, 30.0, &[]);
    for _ in 0..500 {
        f.fly(180.0, 30.0, &[]);
        assert!(!f.kinds().contains(&FaultKind::LowContrast));
    }
    assert_eq!(f.kinds(), [FaultKind::InvertedContrast]);
    let mut changes = 0;
    for _ in 0..500 {
        let before = f.estimate.mode;
        changes += u32::from(f.fly(0.0, 30.0, &[]).mode != before);
        assert!(f.estimate.mode != Mode::Nominal || f.estimate.contrast_k.unwrap() > 0.0);
    }
    assert_eq!((changes, f.estimate.mode), (1, Mode::Nominal));
}

/// Level and straight with GPS, under a head that shows 7° of pitch beyond a configured trim of 2°.
fn nine_up(learner: Option<Learner>, seconds: u32) -> Flight {
    let mut f = Flight::new();
    f.horizon.mounting = Mounting::Turned(Attitude::from_degrees(0.0, 2.0));
    f.horizon.learner = learner;
    f.glide(9.0, seconds);
    f
}

impl Flight {
    /// Level and straight with GPS, while the head shows `pitch_deg`.
    fn glide(&mut self, pitch_deg: f64, seconds: u32) {
        let vertical = Attitude::from_degrees(0.0, pitch_deg).vertical();
        for i in 0..seconds * 5 {
            self.now_s += 0.2;
            let time = Time::from_secs_f64(self.now_s);
            let mut frame = Frame::new(6);
            frame.time = time;
            for (reading, (_, direction)) in frame.readings.iter_mut().zip(Direction::NAMED) {
                let object_c = 16.0 - 15.0 * (1.0 + direction.dot(vertical));
                *reading = Ok(Sample { value: Value::Absolute { object_c, ambient_c: None }, time });
            }
            frame.aiding.ground_speed_m_s = Some(18.0);
            frame.aiding.climb_m_s = Some(0.0);
            // All round in 180 s: hardly a bank.
            frame.aiding.course_deg = Some(f64::from(i) * 0.4 % 360.0);
            self.horizon.update(&frame, &[], &mut self.estimate);
        }
    }
}

#[test]
fn what_a_configured_trim_leaves_is_learnt_and_taken_off() {
    let e = nine_up(Some(Learner::default()), 400).estimate;
    let (pitch, learnt) = (e.attitude.unwrap().pitch.to_degrees(), e.trim.pitch.to_degrees());
    assert!((learnt - 7.0).abs() < 0.5, "{learnt}");
    let without = nine_up(None, 400).estimate;
    let untrimmed = without.attitude.unwrap().pitch.to_degrees();
    assert!((untrimmed - 7.0).abs() < 0.2 && (pitch - (untrimmed - learnt)).abs() < 0.05, "{untrimmed} {pitch}");
    assert!(e.sigma.pitch > without.sigma.pitch);
    assert_eq!(without.trim, Attitude::default());
}

/// What departs from the mounting that was learnt is no mounting: the attitude says how far it is off, and the mounting is
/// what it was once that has gone.
#[test]
fn what_is_off_after_minutes_is_not_learnt_and_is_in_sigma() {
    let mut f = nine_up(Some(Learner::default()), 400);
    let (before, learnt) = (f.estimate.clone(), f.estimate.trim.pitch);
    for _ in 0..2 {
        f.glide(19.0, 60);
        let e = &f.estimate;
        let off_deg = (e.attitude.unwrap().pitch - before.attitude.unwrap().pitch).to_degrees();
        assert!((8.5..11.5).contains(&off_deg), "{off_deg}");
        assert!(e.sigma.pitch.to_degrees() > 0.6 * off_deg, "{:?}", e.sigma);
        assert!((e.trim.pitch - learnt).to_degrees().abs() < 1.0, "{:?}", e.trim);
    }
    f.glide(9.0, 90);
    assert!((f.estimate.sigma.pitch - before.sigma.pitch).abs() < 0.2_f64.to_radians(), "{:?}", f.estimate.sigma);
}

#[test]
fn the_report_s_scheme_learns_nothing_nor_does_a_horizon_that_is_told_not_to() {
    assert!(Flight::new().horizon.learner.is_none());
    let mut settings = Settings::default();
    settings.head.learn_trim = false;
    assert!(Horizon::new(&settings, Head::six()).learner.is_none());
}

/// How the body's rates lie to the head's axes is not forgotten where thresholds change.
#[test]
fn other_thresholds_leave_the_learnt_trim_where_it_is() {
    struct Told(std::sync::Arc<std::sync::Mutex<Attitude>>);
    impl Estimator for Told {
        fn update(&mut self, _: &Frame) -> crate::estimator::Solution {
            Default::default()
        }
        fn set_trim(&mut self, trim: Attitude) {
            *self.0.lock().unwrap() = trim;
        }
    }
    let mut f = nine_up(Some(Learner::default()), 400);
    let told = std::sync::Arc::default();
    f.horizon.estimator = Box::new(Told(std::sync::Arc::clone(&told)));
    let mut settings = Settings::default();
    settings.head.pitch_trim_deg = 2.0;
    settings.faults.low_contrast_c = 5.0;
    f.horizon.retune(&settings);
    let pitch_deg = told.lock().unwrap().pitch.to_degrees();
    assert!((pitch_deg - 9.0).abs() < 0.5, "{pitch_deg}");
}

#[test]
fn other_thresholds_and_trims_are_taken_up_without_forgetting() {
    let mut settings = by(Method::Field);
    let mut flight = Flight::with(&settings);
    flight.for_s(5.0, 10.0, 30.0, &[]);
    let before = flight.estimate.attitude.unwrap();
    settings.head.roll_trim_deg = 4.0;
    flight.horizon.retune(&settings);
    flight.for_s(3.0, 10.0, 30.0, &[]);
    let after = flight.estimate.attitude.unwrap();
    let turned_deg = (before.roll - after.roll).to_degrees();
    assert!((turned_deg - 4.0).abs() < 0.3, "{turned_deg}");
    // A contrast that was enough is low by another limit, at once and without a frame in between.
    settings.faults.low_contrast_c = 20.0;
    flight.horizon.retune(&settings);
    flight.for_s(1.0, 10.0, 15.0, &[]);
    assert!(flight.estimate.faults.iter().any(|f| f.kind == FaultKind::LowContrast), "{:?}", flight.estimate);
}
