//! The inverse sine from a lookup table, as the report's autopilots had it.

/// Intervals of the table over [0, 1].
const INTERVALS: usize = 4096;

/// The inverse sine by linear interpolation.
///
/// On [0, 1] the inverse sine is convex, so a chord lies above it: what error the table has (below 0.001° up to 80°, and
/// up to 0.32° in its last interval of width h, a quarter of √(2h)) overestimates the angle, which is the safe side.
#[derive(Clone, Debug)]
pub struct InverseSine {
    table: Vec<f64>,
}

impl InverseSine {
    /// Makes the table.
    pub fn new() -> Self {
        Self { table: (0..=INTERVALS).map(|i| (i as f64 / INTERVALS as f64).asin()).collect() }
    }

    /// The angle whose sine is `sine`, rad; sines beyond ±1 give ±90°, NaN gives NaN.
    pub fn angle(&self, sine: f64) -> f64 {
        let position = sine.abs().clamp(0.0, 1.0) * INTERVALS as f64;
        // A float to integer cast sends NaN to 0; the NaN stays in `fraction`.
        let cell = (position as usize).min(INTERVALS - 1);
        let fraction = position - cell as f64;
        let angle = self.table[cell] + fraction * (self.table[cell + 1] - self.table[cell]);
        angle.copysign(sine)
    }
}

impl Default for InverseSine {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn known_angles() {
        let t = InverseSine::new();
        for (sine, angle_deg) in
            [(0.0, 0.0), (0.5, 30.0), (-0.5, -30.0), (0.866_025_403_8, 60.0), (1.0, 90.0), (7.0, 90.0)]
        {
            assert!((t.angle(sine).to_degrees() - angle_deg).abs() < 1e-3, "{sine}");
        }
        assert!(t.angle(f64::NAN).is_nan());
        assert!((t.angle(f64::NEG_INFINITY).to_degrees() + 90.0).abs() < 1e-9);
    }

    #[test]
    fn in_the_last_interval_it_is_furthest_off_a_quarter_of_it_below_1() {
        let (t, h) = (InverseSine::new(), 1.0 / INTERVALS as f64);
        let off = |u: f64| (t.angle(1.0 - u * h) - (1.0 - u * h).asin()).to_degrees();
        let worst = (1..1000).map(|i| off(f64::from(i) / 1000.0)).fold(0.0, f64::max);
        assert!((worst - off(0.25)).abs() < 1e-4 && worst < 0.32, "{worst}");
    }

    proptest! {
        #[test]
        fn never_below_the_true_inverse_sine_and_close_to_it(sine in 0.0..1.0_f64) {
            let (got, true_angle) = (InverseSine::new().angle(sine).to_degrees(), sine.asin().to_degrees());
            prop_assert!(got >= true_angle - 1e-9);
            let bound = if true_angle < 80.0 { 0.001 } else { 0.32 };
            prop_assert!(got - true_angle < bound);
        }

        #[test]
        fn odd_and_rising(a in -1.2..1.2_f64, b in -1.2..1.2_f64) {
            let t = InverseSine::new();
            prop_assert_eq!(t.angle(a), -t.angle(-a));
            prop_assert!(a >= b || t.angle(a) <= t.angle(b));
        }
    }
}
