//! What is said of a flight.

use super::drawn::Drawn;
use super::heard::{Way, fly as fly_heard};
use irhorizon::attitude::Attitude;
use irhorizon::frame::Aiding;

/// How the instruments are heard.
pub const HEARD: [&str; 4] = ["nothing", "gyro", "GPS and airspeed", "all"];
const WAYS: [Way; 4] = [
    |_| Aiding::default(),
    |all| Aiding { gyro_deg_s: all.gyro_deg_s, ..Aiding::default() },
    |all| Aiding { gyro_deg_s: [None; 3], ..all },
    |all| all,
];
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

/// A wrong horizon: when last; how far off at worst, °, where, and what was said then.
struct Wrong {
    last_s: f64,
    worst_deg: f64,
    then: String,
}

/// Flies it.
pub fn fly(Drawn { seed, source, rate_hz, faults, text }: Drawn) -> Flown {
    let mut told: [Vec<Wrong>; 4] = Default::default();
    let mut flown = Flown { seed, faults, given_s: [0.0; 4], wrong_s: [0.0; 4], told: Vec::new() };
    fly_heard(source, (SECONDS, rate_hz), WAYS, |way, now| {
        let Some((said, truth)) = now.given.filter(|_| now.time_s > BEGINS_S) else { return };
        flown.given_s[way] += 1.0 / rate_hz;
        let Some(off_deg) = wrong(said, now.estimate.sigma, truth) else { return };
        flown.wrong_s[way] += 1.0 / rate_hz;
        let told = &mut told[way];
        if told.last().is_none_or(|last| now.time_s - last.last_s > SAME_S) {
            told.push(Wrong { last_s: now.time_s, worst_deg: 0.0, then: String::new() });
        }
        let Some(wrong) = told.last_mut() else { return };
        wrong.last_s = now.time_s;
        if off_deg > wrong.worst_deg {
            let [roll_deg, pitch_deg] = [now.truth.roll, now.truth.pitch].map(f64::to_degrees);
            let names: Vec<String> = now.names().collect();
            let (at_s, names) = (now.time_s, names.join(" "));
            wrong.worst_deg = off_deg;
            wrong.then =
                format!("{off_deg:.0}° off at {at_s:.1} s, roll {roll_deg:.0}°, pitch {pitch_deg:.0}°, said [{names}]");
        }
    });
    for (told, heard) in told.iter().zip(HEARD) {
        let tell = |w: &Wrong| format!("seed {seed}, {text}, heard {heard}: {}, until {:.1} s", w.then, w.last_s);
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
