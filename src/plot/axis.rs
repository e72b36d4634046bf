//! From a quantity to a place on the paper, with ticks at round numbers.

/// The steps between ticks that are thought of, up to a power of ten.
const STEPS: [f64; 4] = [1.0, 2.0, 5.0, 10.0];
/// Those of angles, °.
const DEGREES: [f64; 9] = [1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 45.0, 90.0, 180.0];

/// An axis: what lies at its ends, and where its ticks are.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    low: f64,
    high: f64,
    step: f64,
}

impl Axis {
    /// From `low` to `high`, with about `ticks` ticks. Whatever is no range becomes one.
    pub fn exact(low: f64, high: f64, ticks: usize) -> Self {
        let (low, high) = range(low, high);
        Self { low, high, step: plain_step((high - low) / ticks.max(1) as f64) }
    }

    /// As [`exact`](Self::exact), extended to the ticks next outside.
    pub fn rounded(low: f64, high: f64, ticks: usize) -> Self {
        Self::exact(low, high, ticks).extended()
    }

    /// As [`rounded`](Self::rounded), for angles in degrees.
    pub fn degrees(low: f64, high: f64, ticks: usize) -> Self {
        let mut axis = Self::exact(low, high, ticks);
        let least = (axis.high - axis.low) / ticks.max(1) as f64;
        if least > 1.0 {
            axis.step = DEGREES.into_iter().find(|s| *s >= least).unwrap_or(axis.step);
        }
        axis.extended()
    }

    fn extended(self) -> Self {
        // A hair's breadth beyond a tick is on it.
        let low = (self.low / self.step + 1e-6).floor() * self.step;
        let high = (self.high / self.step - 1e-6).ceil() * self.step;
        Self { low, high, ..self }
    }

    /// What lies at its beginning.
    pub fn low(&self) -> f64 {
        self.low
    }

    /// What lies at its end.
    pub fn high(&self) -> f64 {
        self.high
    }

    /// How far along the axis `value` lies, 0 at its beginning, 1 at its end.
    pub fn share(&self, value: f64) -> f64 {
        (value - self.low) / (self.high - self.low)
    }

    /// The ticks within it, with their labels.
    pub fn ticks(&self) -> Vec<(f64, String)> {
        let first = (self.low / self.step - 1e-6).ceil();
        let count = ((self.high / self.step + 1e-6).floor() - first).clamp(0.0, 100.0) as usize + 1;
        let decimals = (-self.step.log10().floor()).clamp(0.0, 9.0) as usize;
        (0..count)
            .map(|i| {
                let tick = (first + i as f64) * self.step;
                // Never "-0".
                let tick = if tick.abs() < self.step / 2.0 { 0.0 } else { tick };
                (tick, format!("{tick:.decimals$}").replace('-', "−"))
            })
            .collect()
    }
}

/// Two different finite numbers in rising order, as near to the given ones as can be.
fn range(low: f64, high: f64) -> (f64, f64) {
    let finite = |v: f64, other: f64| match (v.is_finite(), other.is_finite()) {
        (true, _) => v.clamp(-1e12, 1e12),
        (false, true) => other.clamp(-1e12, 1e12),
        (false, false) => 0.0,
    };
    let (a, b) = (finite(low, high), finite(high, low));
    let (low, high) = (a.min(b), a.max(b));
    let least = 1e-6 * low.abs().max(high.abs()).max(1.0);
    if high - low < least { (low - 0.5 * least.max(1.0), high + 0.5 * least.max(1.0)) } else { (low, high) }
}

/// The round step at or above `least`.
fn plain_step(least: f64) -> f64 {
    let power = 10_f64.powf(least.log10().floor());
    STEPS.into_iter().map(|s| s * power).find(|s| *s >= 0.999_999 * least).unwrap_or(10.0 * power)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn labels(axis: &Axis) -> Vec<String> {
        axis.ticks().into_iter().map(|(_, label)| label).collect()
    }

    #[test]
    fn ticks_stand_at_round_numbers() {
        assert_eq!(labels(&Axis::rounded(-0.7, 1.1, 4)), ["−1.0", "−0.5", "0.0", "0.5", "1.0", "1.5"]);
        assert_eq!(labels(&Axis::exact(3.0, 307.0, 6)), ["100", "200", "300"]);
        assert_eq!(labels(&Axis::degrees(-44.0, 61.0, 5)), ["−60", "−30", "0", "30", "60", "90"]);
        assert_eq!(labels(&Axis::degrees(-0.3, 0.3, 3)), ["−0.4", "−0.2", "0.0", "0.2", "0.4"]);
    }

    #[test]
    fn its_ends_are_at_the_ends() {
        let axis = Axis::exact(-2.0, 6.0, 4);
        assert_eq!((axis.share(-2.0), axis.share(0.0), axis.share(6.0)), (0.0, 0.25, 1.0));
    }

    proptest! {
        #[test]
        fn any_numbers_make_an_axis(low in any::<f64>(), high in any::<f64>(), ticks in 0_usize..20) {
            for axis in [Axis::exact(low, high, ticks), Axis::rounded(low, high, ticks), Axis::degrees(low, high, ticks)] {
                prop_assert!(axis.low() < axis.high() && axis.low().is_finite() && axis.high().is_finite());
                prop_assert!(axis.ticks().len() <= 101);
            }
        }

        #[test]
        fn what_is_shown_lies_within(low in -1e4..1e4_f64, span in 0.01..1e4_f64, ticks in 2_usize..12) {
            let axis = Axis::rounded(low, low + span, ticks);
            prop_assert!(axis.share(low) >= -1e-6 && axis.share(low + span) <= 1.0 + 1e-6);
            prop_assert!(axis.ticks().len() >= 2 && axis.ticks().len() <= ticks + 3);
        }
    }
}
