//! The sky over the sensors, and what the report's scheme must make of it. Nothing here comes from
//! the crate but the clock.

/// The ground's temperature, °C, and how much colder the zenith looks to a sensor, K: the report's
/// Namibian night through a wide field of view.
pub const GROUND_C: f64 = 16.0;
pub const CONTRAST_K: f64 = 38.9;

/// The upward vertical on the axes nose, left, up at this attitude.
pub fn vertical(roll_deg: f64, pitch_deg: f64) -> [f64; 3] {
    let (roll, pitch) = (roll_deg.to_radians(), pitch_deg.to_radians());
    [pitch.sin(), roll.sin() * pitch.cos(), roll.cos() * pitch.cos()]
}

/// What sensors to the nose, tail, left, right, up and down see, °C: from the ground's temperature
/// to the zenith's with the sine of the elevation, so that pairs are sinusoids.
pub fn six_c(roll_deg: f64, pitch_deg: f64) -> [f64; 6] {
    let [nose, left, up] = vertical(roll_deg, pitch_deg);
    [nose, -nose, left, -left, up, -up].map(|sine| GROUND_C - CONTRAST_K / 2.0 * (1.0 + sine))
}

/// The signals of pairs along nose, left and up, K.
pub fn pairs_k(roll_deg: f64, pitch_deg: f64) -> [f64; 3] {
    vertical(roll_deg, pitch_deg).map(|u| CONTRAST_K * u)
}

/// The report's scheme (section IV.B), restated. The expectation is not the attitude that the sky
/// was made for: it is what `asin(y/R)` and `asin(x/R)` give for the signals that the sensors were
/// made to show, with `R` the vertical pair's output low-passed over 3 s: level after a while in
/// level flight, and shrinking in a sustained bank.
#[derive(Clone, Copy, Debug)]
pub struct Scheme {
    /// Frames a second: the filter takes each frame's value for the time since the last frame.
    pub rate_hz: f64,
    /// The range's time constant, s.
    pub time_constant_s: f64,
    /// The largest roll given, °.
    pub roll_limit_deg: f64,
}

impl Scheme {
    /// Roll and pitch in degrees, `at_s`, when the pairs' signals (x, y, z in K) have changed to
    /// those in `steps` at the times there, in seconds. The first signals were there before the
    /// daemon started.
    pub fn expect(&self, steps: &[(f64, [f64; 3])], at_s: f64) -> (f64, f64) {
        let seen = |t: f64| steps[steps.partition_point(|(from, _)| *from <= t).max(1) - 1].1;
        let (mut time, mut range) = (steps[0].0, steps[0].1[2].abs());
        let period = 1.0 / self.rate_hz;
        while time < at_s {
            time += period;
            range += (seen(time.min(at_s))[2].abs() - range) * (1.0 - (-period / self.time_constant_s).exp());
        }
        let [x, y, _] = seen(at_s);
        let angle = |signal: f64| (signal / range).clamp(-1.0, 1.0).asin().to_degrees();
        (angle(y).clamp(-self.roll_limit_deg, self.roll_limit_deg), angle(x))
    }
}

#[test]
fn the_scheme_by_hand() {
    let scheme = Scheme { rate_hz: 50.0, time_constant_s: 3.0, roll_limit_deg: 180.0 };
    let level = (100.0, [0.0, 0.0, 40.0]);
    let (roll, pitch) = scheme.expect(&[level, (110.0, [10.0, -20.0, 40.0])], 110.0);
    assert!((roll + 30.0).abs() < 1e-9 && (pitch - 14.477_512).abs() < 1e-5, "{roll} {pitch}");
    // Three seconds after the vertical pair fell to 20 K: R = 20 + 20/e.
    let (roll, _) = scheme.expect(&[level, (110.0, [0.0, 15.0, 20.0])], 113.0);
    let range = 20.0 + 20.0 / std::f64::consts::E;
    assert!((roll - (15.0 / range).asin().to_degrees()).abs() < 0.3, "{roll}");
    let limited = Scheme { roll_limit_deg: 45.0, ..scheme };
    assert_eq!(limited.expect(&[level, (110.0, [0.0, 39.0, 40.0])], 110.0).0, 45.0);
}
