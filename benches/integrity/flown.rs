//! What is said of a flight.

use super::drawn::Drawn;
use irhorizon::attitude::{Attitude, Estimate};
use irhorizon::config::Settings;
use irhorizon::frame::{Aiding, Frame};
use irhorizon::head::Head;
use irhorizon::horizon::Horizon;
use irhorizon::source::FrameSource;
use irhorizon::time::Time;

/// How the instruments are heard.
pub const HEARD: [&str; 4] = ["nothing", "gyro", "GPS and airspeed", "all"];
/// How long each flight is, and how much of that is not looked at: a method may begin as it likes. s.
pub const SECONDS: f64 = 120.0;
const BEGINS_S: f64 = 5.0;
/// A horizon is wrong, and given with confidence, that is off by more than so much, °, and so many standard deviations.
pub const WRONG_DEG: f64 = 10.0;
pub const WRONG_SIGMAS: f64 = 3.0;
/// What begins so soon after the last is the same, s.
const SAME_S: f64 = 2.0;

/// What became of a flight, heard in each way.
pub struct Flown {
    pub seed: u64,
    /// How many faults it had.
    pub faults: usize,
    /// Seconds with an attitude, and with a wrong one given with confidence.
    pub given_s: [f64; 4],
    pub wrong_s: [f64; 4],
    /// Each wrong horizon, in words.
    pub told: Vec<String>,
}

/// What is heard in the way number `how`.
fn heard(all: Aiding, how: usize) -> Aiding {
    let gyro = Aiding { gyro_deg_s: all.gyro_deg_s, ..Aiding::default() };
    match how {
        0 => Aiding::default(),
        1 => gyro,
        2 => Aiding { gyro_deg_s: [None; 3], ..all },
        _ => all,
    }
}

/// Flies it through [`Horizon`].
pub fn fly(mut drawn: Drawn) -> Flown {
    let head = Head::six();
    let mut settings = Settings { rate_hz: drawn.rate_hz, ..Settings::default() };
    // What is learnt of the mounting would hide errors, and none is off here.
    settings.head.learn_trim = false;
    let mut all: [(Horizon, Estimate); 4] =
        std::array::from_fn(|_| (Horizon::new(&settings, head.clone()), Estimate::default()));
    let mut frame = Frame::new(head.sensors.len());
    let mut told: [Vec<(f64, f64)>; 4] = Default::default();
    let mut flown =
        Flown { seed: drawn.seed, faults: drawn.faults, given_s: [0.0; 4], wrong_s: [0.0; 4], told: Vec::new() };
    let begin = Time::from_secs_f64(100.0 + BEGINS_S);
    for i in 0..(SECONDS * drawn.rate_hz) as u32 {
        let time_s = f64::from(i) / drawn.rate_hz;
        drawn.source.scan(Time::from_secs_f64(100.0 + time_s), &mut frame);
        let aiding = frame.aiding;
        for (how, (horizon, estimate)) in all.iter_mut().enumerate() {
            frame.aiding = heard(aiding, how);
            let last = estimate.valid_at;
            horizon.update(&frame, &[], estimate);
            // One that was left standing was judged when it was new.
            let Some(said) = estimate.attitude.filter(|_| estimate.valid_at > last.max(begin)) else { continue };
            flown.given_s[how] += 1.0 / drawn.rate_hz;
            let off_deg = wrong(said, estimate.sigma, drawn.source.truth_at(estimate.valid_at));
            let Some(off_deg) = off_deg else { continue };
            flown.wrong_s[how] += 1.0 / drawn.rate_hz;
            match told[how].last_mut().filter(|(last_s, _)| time_s - *last_s < SAME_S) {
                Some((last_s, worst_deg)) => (*last_s, *worst_deg) = (time_s, worst_deg.max(off_deg)),
                None => told[how].push((time_s, off_deg)),
            }
        }
    }
    for (told, heard) in told.iter().zip(HEARD) {
        let tell = |(last_s, worst_deg): &(f64, f64)| {
            format!("seed {}, {}, heard {heard}: {worst_deg:.0}° off until {last_s:.1} s", drawn.seed, drawn.text)
        };
        flown.told.extend(told.iter().map(tell));
    }
    flown
}

/// How far roll or pitch is off, °, if that is wrong with confidence. Roll counts by the cosine of pitch.
fn wrong(said: Attitude, sigma: Attitude, truth: Attitude) -> Option<f64> {
    let turned = |a: f64| a.sin().atan2(a.cos()).abs();
    let level = said.pitch.cos().min(truth.pitch.cos()).max(0.0);
    let roll = (turned(said.roll - truth.roll) * level, sigma.roll * level);
    let pitch = ((said.pitch - truth.pitch).abs(), sigma.pitch);
    let wrong = |(off, sigma): &(f64, f64)| off.to_degrees() > WRONG_DEG && *off > WRONG_SIGMAS * sigma;
    [roll, pitch].into_iter().filter(wrong).map(|(off, _)| off.to_degrees()).reduce(f64::max)
}
