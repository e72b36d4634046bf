//! Attitude against time: a pure function of the time since the flight began, and of a seed.

use super::noise::Noise;
use crate::attitude::Attitude;
use std::f64::consts::TAU;

/// An attitude to be reached at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waypoint {
    /// Seconds since the flight began.
    pub time_s: f64,
    /// Roll, °; goes on beyond 180 in a roll.
    pub roll_deg: f64,
    /// Pitch, °; goes on beyond 90 in a loop.
    pub pitch_deg: f64,
}

/// A waypoint of a table: seconds, roll, pitch.
const fn at(time_s: f64, roll_deg: f64, pitch_deg: f64) -> Waypoint {
    Waypoint { time_s, roll_deg, pitch_deg }
}

/// Level, a turn each way, a climb, a descent, a steep turn; then again from the start.
const DEMO: [Waypoint; 20] = [
    at(0.0, 0.0, 0.0),
    at(6.0, 0.0, 0.0),
    at(8.5, 30.0, 2.0),
    at(16.0, 30.0, 2.0),
    at(18.5, 0.0, 0.0),
    at(22.0, 0.0, 0.0),
    at(24.5, -30.0, 2.0),
    at(32.0, -30.0, 2.0),
    at(34.5, 0.0, 0.0),
    at(37.0, 0.0, 0.0),
    at(40.0, 0.0, 15.0),
    at(46.0, 0.0, 15.0),
    at(49.0, 0.0, 0.0),
    at(52.0, 0.0, -15.0),
    at(58.0, 0.0, -15.0),
    at(61.0, 0.0, 0.0),
    at(64.0, 0.0, 0.0),
    at(67.0, 45.0, 3.0),
    at(75.0, 45.0, 3.0),
    at(80.0, 0.0, 0.0),
];

/// Periods of the gusts, s: no two in step.
const GUST_PERIODS_S: [f64; 5] = [0.83, 1.37, 2.11, 3.39, 5.17];

/// Sines that add up to a gust in roll and one in pitch.
#[derive(Clone, Debug, PartialEq)]
struct Turbulence {
    amplitude_deg: [f64; 2],
    phases: [[f64; GUST_PERIODS_S.len()]; 2],
}

/// A flight.
#[derive(Clone, Debug, PartialEq)]
pub struct Flight {
    waypoints: Vec<Waypoint>,
    repeat: bool,
    turbulence: Option<Turbulence>,
}

impl Flight {
    /// The demonstration, 80 s, for ever: level, turns of 30° each way, a climb and a descent of 15°,
    /// a turn of 45°, in mild turbulence that `seed` chooses.
    pub fn demo(seed: u64) -> Self {
        let mut flight = Self::scripted(DEMO.to_vec()).with_turbulence(1.5, 0.8, seed);
        flight.repeat = true;
        flight
    }

    /// An aircraft that stands level, whose head is mounted 3° right side down and 2° nose down.
    pub fn parked() -> Self {
        Self::steady(3.0, -2.0)
    }

    /// From waypoint to waypoint by smooth transitions, in calm air; the first holds before, the
    /// last after. The waypoints are put in order of time; without any the flight is level.
    pub fn scripted(mut waypoints: Vec<Waypoint>) -> Self {
        waypoints.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
        Self { waypoints, repeat: false, turbulence: None }
    }

    /// One attitude for ever.
    pub fn steady(roll_deg: f64, pitch_deg: f64) -> Self {
        Self::scripted(vec![at(0.0, roll_deg, pitch_deg)])
    }

    /// The same in turbulence of `roll_deg` and `pitch_deg` rms.
    pub fn with_turbulence(mut self, roll_deg: f64, pitch_deg: f64, seed: u64) -> Self {
        let mut noise = Noise::new(seed);
        let phases = [(); 2].map(|()| GUST_PERIODS_S.map(|_| TAU * noise.uniform()));
        // A sine's rms is 1/√2 of its height, and so many of them add up by their squares.
        let height = (2.0 / GUST_PERIODS_S.len() as f64).sqrt();
        self.turbulence = Some(Turbulence { amplitude_deg: [roll_deg * height, pitch_deg * height], phases });
        self
    }

    /// The attitude `time_s` seconds after the flight began.
    pub fn attitude(&self, time_s: f64) -> Attitude {
        // By way of the vertical, so that a roll past 180° or a pitch past 90° comes out in range.
        let [roll, pitch] = self.angles(time_s);
        let [nose, left, up] = Attitude { roll, pitch }.vertical();
        Attitude { roll: left.atan2(up), pitch: nose.clamp(-1.0, 1.0).asin() }
    }

    /// Roll and pitch as the script has them, rad, going on beyond their ranges.
    pub fn angles(&self, time_s: f64) -> [f64; 2] {
        let [mut roll_deg, mut pitch_deg] = self.planned(time_s);
        if let Some(t) = &self.turbulence {
            let gust = |axis: usize| {
                let sines = GUST_PERIODS_S.iter().zip(&t.phases[axis]);
                t.amplitude_deg[axis] * sines.map(|(period, phase)| (TAU * time_s / period + phase).sin()).sum::<f64>()
            };
            roll_deg += gust(0);
            pitch_deg += gust(1);
        }
        [roll_deg, pitch_deg].map(f64::to_radians)
    }

    /// Roll and pitch without turbulence, °.
    fn planned(&self, time_s: f64) -> [f64; 2] {
        let (Some(first), Some(last)) = (self.waypoints.first(), self.waypoints.last()) else { return [0.0; 2] };
        let time_s = if self.repeat { time_s.rem_euclid(last.time_s.max(f64::MIN_POSITIVE)) } else { time_s };
        let next = self.waypoints.partition_point(|w| w.time_s <= time_s);
        let Some(a) = next.checked_sub(1).map(|i| self.waypoints[i]) else { return [first.roll_deg, first.pitch_deg] };
        let Some(b) = self.waypoints.get(next) else { return [last.roll_deg, last.pitch_deg] };
        let x = (time_s - a.time_s) / (b.time_s - a.time_s);
        // Rates and accelerations begin and end at zero.
        let s = x * x * x * (10.0 + x * (6.0 * x - 15.0));
        [a.roll_deg + s * (b.roll_deg - a.roll_deg), a.pitch_deg + s * (b.pitch_deg - a.pitch_deg)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn degrees(f: &Flight, t: f64) -> (f64, f64) {
        let a = f.attitude(t);
        (a.roll.to_degrees(), a.pitch.to_degrees())
    }

    #[test]
    fn a_script_passes_its_waypoints_and_holds_at_both_ends() {
        let f = Flight::scripted(vec![at(4.0, -20.0, 10.0), at(2.0, 0.0, 5.0)]);
        for (t, roll, pitch) in
            [(0.0, 0.0, 5.0), (2.0, 0.0, 5.0), (3.0, -10.0, 7.5), (4.0, -20.0, 10.0), (99.0, -20.0, 10.0)]
        {
            let (r, p) = degrees(&f, t);
            assert!((r - roll).abs() < 1e-9 && (p - pitch).abs() < 1e-9, "{t} s: {r} {p}");
        }
        assert_eq!(Flight::scripted(vec![]).attitude(3.0), Attitude::default());
        assert!((degrees(&Flight::steady(12.0, -7.0), 1e6).0 - 12.0).abs() < 1e-9);
    }

    #[test]
    fn rolls_and_loops_stay_in_the_ranges_of_roll_and_pitch() {
        let roll = Flight::scripted(vec![at(0.0, 0.0, 0.0), at(4.0, 360.0, 0.0)]);
        let (r, p) = degrees(&roll, 2.0);
        assert!((r.abs() - 180.0).abs() < 1e-9 && p.abs() < 1e-9);
        let (r, _) = degrees(&roll, 2.5);
        assert!((-180.0..0.0).contains(&r));
        let pull = Flight::scripted(vec![at(0.0, 0.0, 0.0), at(4.0, 0.0, 240.0)]);
        // 120° of pitch is 60° on the back.
        let (r, p) = degrees(&pull, 2.0);
        assert!((r.abs() - 180.0).abs() < 1e-9 && (p - 60.0).abs() < 1e-9, "{r} {p}");
    }

    #[test]
    fn the_demo_shows_every_manoeuvre_moves_smoothly_and_repeats() {
        let f = Flight::demo(7);
        let path: Vec<(f64, f64)> = (0..8000).map(|i| degrees(&f, f64::from(i) * 0.01)).collect();
        let range = |v: &mut dyn Iterator<Item = f64>| v.fold((0.0_f64, 0.0_f64), |m, x| (m.0.min(x), m.1.max(x)));
        let (left, right) = range(&mut path.iter().map(|p| p.0));
        let (down, up) = range(&mut path.iter().map(|p| p.1));
        assert!((-37.0..-28.0).contains(&left) && (43.0..52.0).contains(&right), "{left} {right}");
        assert!((-20.0..-13.0).contains(&down) && (13.0..20.0).contains(&up), "{down} {up}");
        for w in path.windows(2) {
            assert!((w[1].0 - w[0].0).abs() < 0.6 && (w[1].1 - w[0].1).abs() < 0.6, "more than 60 °/s");
        }
        let calm = Flight { turbulence: None, ..f };
        for t in [0.0, 12.0, 44.0, 71.3] {
            let (a, b) = (calm.attitude(t), calm.attitude(t + 800.0));
            assert!((a.roll - b.roll).abs() < 1e-9 && (a.pitch - b.pitch).abs() < 1e-9);
        }
    }

    #[test]
    fn turbulence_has_the_strength_asked_for_and_comes_from_the_seed() {
        let f = Flight::steady(0.0, 0.0).with_turbulence(2.0, 1.0, 3);
        let rms = |g: &dyn Fn(Attitude) -> f64| {
            ((0..60_000).map(|i| g(f.attitude(f64::from(i) * 0.01)).powi(2)).sum::<f64>() / 60_000.0).sqrt()
        };
        assert!((rms(&|a| a.roll.to_degrees()) - 2.0).abs() < 0.05);
        assert!((rms(&|a| a.pitch.to_degrees()) - 1.0).abs() < 0.03);
        assert_eq!(Flight::demo(3), Flight::demo(3));
        assert_ne!(Flight::demo(3).attitude(1.0), Flight::demo(4).attitude(1.0));
    }
}
