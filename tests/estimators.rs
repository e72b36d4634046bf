//! Every method of estimation against hostile frames: it never panics, gives only what is finite and
//! in range, and is right again once the frames are.

mod methods;

use irhorizon::attitude::Attitude;
use irhorizon::config::settings::{Method, SimulationSettings};
use irhorizon::estimator::{Estimator, Solution};
use irhorizon::frame::{Aiding, Frame, Missing, Reading, Sample, Value};
use irhorizon::head::Head;
use irhorizon::simulation::{Flight, SimulatedSource};
use irhorizon::sky::FieldOfView;
use irhorizon::source::FrameSource;
use irhorizon::time::Time;
use proptest::collection::vec;
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::LazyLock;

/// The attitude of the clean frames: small enough for the report's scheme to be right within a degree or two.
const STEADY_DEG: (f64, f64) = (12.0, -6.0);
/// Clean frames at 50 Hz.
const CLEAN_FRAMES: usize = 30 * 50;
const TICK_NS: u64 = 20_000_000;
/// Three years.
const LEAP_NS: u64 = 100_000_000_000_000_000;

/// A steady flight under a clear night sky from the clock's zero on.
static CLEAN: LazyLock<Vec<Frame>> = LazyLock::new(|| {
    let head = Head::six();
    let field = FieldOfView::Gaussian { fwhm_deg: 90.0 };
    let mut source = SimulatedSource::new(&SimulationSettings::default(), &head, field)
        .with_flight(Flight::steady(STEADY_DEG.0, STEADY_DEG.1));
    let mut frame = Frame::new(6);
    let mut scan = |i| {
        source.scan(Time::from_nanos(i * TICK_NS), &mut frame);
        frame.clone()
    };
    (0..CLEAN_FRAMES as u64).map(&mut scan).collect()
});

/// A frame of [`CLEAN`], `by_ns` later.
fn clean(index: usize, by_ns: u64, rates: bool) -> Frame {
    let later = |t: Time| Time::from_nanos(t.as_nanos().saturating_add(by_ns));
    let mut frame = CLEAN[index].clone();
    frame.time = later(frame.time);
    for sample in frame.readings.iter_mut().flatten() {
        sample.time = later(sample.time);
    }
    if rates {
        frame.aiding.gyro_deg_s = [Some(0.0); 3];
    }
    frame
}

/// How a hostile frame's time, and each of its samples', differs from the time before, ns.
#[derive(Clone, Copy, Debug)]
enum Step {
    On(u64),
    Back(u64),
}

impl Step {
    fn from(self, ns: u64) -> u64 {
        match self {
            Self::On(by) => ns.saturating_add(by),
            Self::Back(by) => ns.saturating_sub(by),
        }
    }
}

fn step(longest_ns: u64) -> impl Strategy<Value = Step> {
    prop_oneof![
        4 => Just(Step::On(TICK_NS)),
        1 => Just(Step::On(0)),
        1 => (0..3 * TICK_NS).prop_map(Step::On),
        1 => (0..=longest_ns).prop_map(Step::On),
        1 => (0..3 * TICK_NS).prop_map(Step::Back),
        1 => (0..=longest_ns).prop_map(Step::Back),
    ]
}

/// Numbers up to `largest`, and what is none.
fn number(largest: f64) -> impl Strategy<Value = f64> {
    prop_oneof![
        Just(f64::NAN),
        Just(f64::INFINITY),
        Just(f64::NEG_INFINITY),
        Just(largest),
        Just(-largest),
        Just(0.0),
        Just(f64::MIN_POSITIVE),
        -largest..=largest,
        -40.0..40.0,
    ]
}

/// A sample as hostile as sources let through (`physical`: −273.15 to 1000 °C), or as a float can be.
fn reading(physical: bool) -> impl Strategy<Value = Reading> {
    let object = if physical {
        prop_oneof![Just(f64::NAN), Just(-273.15), Just(1000.0), -273.15..=1000.0, -30.0..=30.0].boxed()
    } else {
        number(f64::MAX).boxed()
    };
    let volts = number(if physical { 100.0 } else { f64::MAX });
    let sample = |value| Ok(Sample { value, time: Time::default() });
    prop_oneof![
        6 => (object, proptest::option::of(number(f64::MAX)))
            .prop_map(move |(object_c, ambient_c)| sample(Value::Absolute { object_c, ambient_c })),
        1 => volts.prop_map(move |v| sample(Value::Volts(v))),
        1 => Just(Err(Missing::NoAnswer)),
        1 => Just(Err(Missing::NotYet)),
    ]
}

fn aiding() -> impl Strategy<Value = Aiding> {
    let value = || proptest::option::of(number(f64::MAX));
    (value(), value(), value(), [value(), value(), value()], [value(), value()]).prop_map(
        |(airspeed_m_s, ground_speed_m_s, course_deg, gyro_deg_s, [climb_m_s, altitude_m])| Aiding {
            gyro_deg_s,
            airspeed_m_s,
            ground_speed_m_s,
            course_deg,
            climb_m_s,
            altitude_m,
        },
    )
}

/// What is wrong with one frame.
#[derive(Clone, Debug)]
struct Hostile {
    step: Step,
    /// How much each sample is off the frame's time.
    samples: [Step; 6],
    /// In place of the clean ones; `None` leaves them.
    readings: Option<Vec<Reading>>,
    aiding: Aiding,
}

fn hostile(physical: bool, longest_ns: u64) -> impl Strategy<Value = Hostile> {
    // Now and then there are fewer or more readings than sensors.
    let count = prop_oneof![8 => Just(6_usize), 1 => 0..9_usize];
    let readings = proptest::option::weighted(0.8, count.prop_flat_map(move |n| vec(reading(physical), n)));
    let samples = prop_oneof![2 => Just([Step::On(0); 6]), 1 => proptest::array::uniform6(step(longest_ns))];
    (step(longest_ns), samples, readings, aiding()).prop_map(|(step, samples, readings, aiding)| Hostile {
        step,
        samples,
        readings,
        aiding,
    })
}

/// The frame that `hostile` makes of clean frame `index`, at the time `now_ns`.
fn spoilt(hostile: &Hostile, index: usize, now_ns: u64) -> Frame {
    let mut frame = clean(index, 0, false);
    frame.time = Time::from_nanos(now_ns);
    frame.aiding = hostile.aiding;
    if let Some(readings) = &hostile.readings {
        frame.readings.clone_from(readings);
    }
    for (i, reading) in frame.readings.iter_mut().enumerate() {
        if let Ok(sample) = reading {
            sample.time = Time::from_nanos(hostile.samples[i % 6].from(now_ns));
        }
    }
    frame
}

/// Everything in `solution` is finite and in range.
fn sound(name: &str, solution: &Solution) -> Result<(), TestCaseError> {
    let Solution { attitude, sigma, contrast_k, seen_k, sensors, hidden, hint, wired } = solution;
    for a in attitude.iter().chain(wired.as_ref().map(|w| &w.attitude)) {
        prop_assert!(a.roll.abs() <= PI && a.pitch.abs() <= FRAC_PI_2, "{name}: {a:?}");
    }
    let told = sensors.iter().flat_map(|s| [s.expected_k, s.residual_k]).flatten().chain(*hidden);
    for k in told.chain(hint.iter().flat_map(|h| [h.bearing, h.strength_k])) {
        prop_assert!(k.is_finite(), "{name}: {sensors:?} {hidden:?} {hint:?}");
    }
    for s in [sigma.roll, sigma.pitch] {
        prop_assert!(s.is_finite() && s >= 0.0, "{name}: {sigma:?}");
    }
    prop_assert!(contrast_k.is_none_or(f64::is_finite), "{name}: {contrast_k:?}");
    prop_assert!(seen_k.is_none_or(|s| s.iter().all(|v| v.is_finite())), "{name}: {seen_k:?}");
    Ok(())
}

/// Feeds `frames` hostile frames after `warm` clean ones; gives the latest time in them, ns.
fn torment(name: &str, estimator: &mut dyn Estimator, warm: usize, frames: &[Hostile]) -> Result<u64, TestCaseError> {
    for i in 0..warm {
        sound(name, &estimator.update(&clean(i, 0, false)))?;
    }
    let mut now_ns = warm as u64 * TICK_NS;
    let mut latest_ns = now_ns;
    for (i, hostile) in frames.iter().enumerate() {
        now_ns = hostile.step.from(now_ns);
        let frame = spoilt(hostile, i % CLEAN_FRAMES, now_ns);
        let newest_ns = frame.sample_time().map_or(now_ns, |t| t.as_nanos().max(now_ns));
        latest_ns = latest_ns.max(newest_ns);
        sound(name, &estimator.update(&frame))?;
    }
    Ok(latest_ns)
}

fn off_deg(attitude: Attitude) -> f64 {
    (attitude.roll.to_degrees() - STEADY_DEG.0).abs().max((attitude.pitch.to_degrees() - STEADY_DEG.1).abs())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn what_goes_out_is_finite_and_in_range(
        warm in 0..60_usize,
        frames in vec(hostile(false, u64::MAX), 1..120),
    ) {
        for (name, method) in Method::NAMED {
            torment(name, methods::estimator(method, &Head::six()).as_mut(), warm, &frames)?;
        }
    }

    /// What sources let through is forgotten in half a minute of clean frames, with body rates or without.
    #[test]
    fn after_hostile_frames_the_attitude_is_right_again(
        warm in 0..60_usize,
        // So many leaps leave room on the clock.
        frames in vec(hostile(true, LEAP_NS), 1..80),
        pause_ns in prop_oneof![Just(TICK_NS), 0..10_000_000_000_u64],
        rates in any::<bool>(),
    ) {
        for (name, method) in Method::NAMED {
            let mut estimator = methods::estimator(method, &Head::six());
            let latest_ns = torment(name, estimator.as_mut(), warm, &frames)?;
            for i in 0..CLEAN_FRAMES {
                let solution = estimator.update(&clean(i, latest_ns + 1 + pause_ns, rates));
                sound(name, &solution)?;
                if i >= CLEAN_FRAMES - 50 {
                    let off = solution.attitude.map(off_deg);
                    prop_assert!(off.is_some_and(|off| off < 3.0), "{name}: {off:?}° off after half a minute");
                }
            }
        }
    }
}
