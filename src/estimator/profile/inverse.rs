//! The way back from a pair's ratio to the sine of its elevation, by one look-up.

use crate::sky::PairCurve;

/// Intervals of the table.
const INTERVALS: usize = 1024;

/// From this entry on, a ratio of 0.995, a sine between two curves need not rise.
const LAST_RISE: usize = INTERVALS * 93 / 100;

/// A [`PairCurve`]'s inverse, tabulated; or one between those of two curves.
///
/// The table is uniform in `√(1 − ratio)`: towards the vertical, where the signal hardly rises any
/// more, its steps in the ratio become as small as they must be. Within 1e-4 of
/// [`PairCurve::inverse`] for fields of view of 35° and more. A field so narrow that it sees nothing
/// of the sky while it looks at the horizon is inverted to 0.2 % of the contrast.
#[derive(Clone, Debug)]
pub struct Inverse {
    /// Sines over ratios from 0 to 1, and how much more they are by the other curve.
    sines: Vec<[f64; 2]>,
    /// The share of the other curve.
    share: f64,
}

impl Inverse {
    /// Tabulates `curve`.
    pub fn new(curve: &PairCurve) -> Self {
        Self::between(curve, curve)
    }

    /// Tabulates both: that of `one` until a share of the `other` is set.
    pub fn between(one: &PairCurve, other: &PairCurve) -> Self {
        let sines = |ratio: f64| {
            let sine = one.inverse(ratio);
            [sine, other.inverse(ratio) - sine]
        };
        Self { sines: (0..=INTERVALS).map(|i| sines(ratio_of(i))).collect(), share: 0.0 }
    }

    /// The share of the other curve from now on, one of those with which what [rises](Self::rising) with the ratio still does.
    pub fn set_share(&mut self, share: f64) {
        self.share = share;
    }

    /// That share.
    pub fn share(&self) -> f64 {
        self.share
    }

    /// From which share of the other curve to which the sine rises with the ratio: from below 0 to above 1. Within a few
    /// degrees of the vertical, where it hardly rises, it may stand still.
    pub fn rising(&self) -> (f64, f64) {
        let steps = self.sines[..LAST_RISE].windows(2).map(|w| [w[1][0] - w[0][0], w[1][1] - w[0][1]]);
        steps.fold((f64::NEG_INFINITY, f64::INFINITY), |(least, most), [one, more]| match more {
            _ if more > 0.0 => (least.max(-one / more), most),
            _ if more < 0.0 => (least, most.min(-one / more)),
            _ => (least, most),
        })
    }

    /// The sine of the elevation at which a pair gives `ratio` of its contrast; ±1 at and beyond
    /// ±1, NaN for NaN.
    pub fn sine(&self, ratio: f64) -> f64 {
        self.sine_and_slope(ratio).0
    }

    /// How much more that sine is by the other curve than by the one.
    pub fn by_share(&self, ratio: f64) -> f64 {
        let place = place(ratio);
        let cell = cell(place);
        let [low, high] = [self.sines[cell][1], self.sines[cell + 1][1]];
        (low + (place - cell as f64) * (high - low)) * ratio.signum()
    }

    fn entry(&self, i: usize) -> f64 {
        let [one, more] = self.sines[i];
        (one + self.share * more).min(1.0)
    }

    /// That sine, and how fast it rises with the ratio, ≥ 0; beyond ±1 as at ±1.
    pub fn sine_and_slope(&self, ratio: f64) -> (f64, f64) {
        let place = place(ratio);
        let cell = cell(place);
        let low = self.entry(cell);
        let step = self.entry(cell + 1) - low;
        let sine = low + (place - cell as f64) * step;
        // The middle of the step in √(1 − ratio), and what the ratio moves by in it.
        let rest = (INTERVALS as f64 - cell as f64 - 0.5) / INTERVALS as f64;
        (sine.copysign(ratio), step.max(0.0) * INTERVALS as f64 / (2.0 * rest))
    }
}

/// The ratio of entry `i`.
fn ratio_of(i: usize) -> f64 {
    1.0 - (1.0 - i as f64 / INTERVALS as f64).powi(2)
}

/// The place of a ratio in the table, in entries.
fn place(ratio: f64) -> f64 {
    (1.0 - (1.0 - ratio.abs().clamp(0.0, 1.0)).sqrt()) * INTERVALS as f64
}

/// The interval that a place lies in. A cast sends NaN to 0; the NaN stays in the place.
fn cell(place: f64) -> usize {
    (place as usize).min(INTERVALS - 1)
}

#[cfg(test)]
mod tests {
    use super::super::shape::POSSIBLE;
    use super::*;
    use crate::sky::{Averaging, FieldOfView, Response, Shape};

    fn curves(fields: &[FieldOfView]) -> Vec<PairCurve> {
        let shapes = [Shape::Exponential { k: 5.5 }, Shape::Grey { depth: 0.3 }, Shape::Grey { depth: 1.5 }];
        let both = shapes.into_iter().flat_map(|s| fields.iter().map(move |f| (s, *f)));
        both.map(|(s, f)| Response::new(s, f, Averaging::Radiance).pair_curve(16.0, 40.0)).collect()
    }

    #[test]
    fn it_is_the_curve_s_own_inverse() {
        let fields = [
            FieldOfView::InPlane { half_deg: 50.0 },
            FieldOfView::Cone { half_deg: 50.0 },
            FieldOfView::Gaussian { fwhm_deg: 90.0 },
            FieldOfView::Gaussian { fwhm_deg: 35.0 },
        ];
        for (n, curve) in curves(&fields).iter().enumerate() {
            let table = Inverse::new(curve);
            for ratio in ratios() {
                let (got, expected) = (table.sine(ratio), curve.inverse(ratio));
                assert!((got - expected).abs() < 1e-4, "curve {n} at {ratio}: {got} for {expected}");
            }
        }
    }

    /// From 0 to 1, finer towards 1.
    fn ratios() -> impl Iterator<Item = f64> {
        (0..=30_011).map(|i| 1.0 - (1.0 - f64::from(i) / 30_011.0).powi(3))
    }

    #[test]
    fn a_narrow_field_that_sees_nothing_of_the_horizon_is_inverted_to_a_fifth_of_a_percent() {
        for (n, curve) in curves(&[FieldOfView::Gaussian { fwhm_deg: 5.0 }]).iter().enumerate() {
            let table = Inverse::new(curve);
            for ratio in ratios() {
                let back = curve.g(table.sine(ratio));
                assert!((back - ratio).abs() < 2e-3, "curve {n} at {ratio}: {back}");
            }
        }
    }

    fn usual() -> Inverse {
        Inverse::new(&curves(&[FieldOfView::Gaussian { fwhm_deg: 90.0 }])[0])
    }

    #[test]
    fn it_is_odd_rising_and_bears_any_number() {
        let table = usual();
        let values: Vec<f64> = (-1100..=1100).map(|i| table.sine(f64::from(i) / 1000.0)).collect();
        assert!(values.windows(2).all(|w| w[0] <= w[1]));
        assert_eq!(table.sine(-0.3), -table.sine(0.3));
        for ratio in [1.0, 1.0 + 1e-12, 7.0, 1e300, f64::INFINITY] {
            assert_eq!((table.sine(ratio), table.sine(-ratio)), (1.0, -1.0));
            assert!(table.sine_and_slope(ratio).1.is_finite());
        }
        assert_eq!(table.sine(0.0), 0.0);
        assert!(table.sine(f64::NAN).is_nan());
    }

    #[test]
    fn between_two_curves_it_is_between_their_inverses_and_rises_wherever_it_may_be_set() {
        for fwhm_deg in [10.0, 35.0, 60.0, 90.0, 120.0] {
            let field = FieldOfView::Gaussian { fwhm_deg };
            let [dry, humid] = [Shape::Exponential { k: 5.5 }, Shape::Grey { depth: 1.5 }]
                .map(|s| Response::new(s, field, Averaging::Temperature).pair_curve(16.0, 40.0));
            let mut table = Inverse::between(&dry, &humid);
            let (least, most) = table.rising();
            assert!(least <= 0.0 && most >= 1.0, "{least} {most}");
            assert!(fwhm_deg < 90.0 || least <= POSSIBLE.0 && most >= POSSIBLE.1, "{fwhm_deg}: {least} {most}");
            for share in [POSSIBLE.0.max(least), 0.0, 0.5, 1.0, POSSIBLE.1.min(most)] {
                table.set_share(share);
                let mut last = 0.0;
                for ratio in ratios().step_by(30) {
                    let (got, slope) = table.sine_and_slope(ratio);
                    let expected = dry.inverse(ratio) + share * (humid.inverse(ratio) - dry.inverse(ratio));
                    let close = if fwhm_deg < 35.0 { 2e-2 } else { 1e-3 };
                    assert!((got - expected).abs() < close && (table.sine(-ratio) + got).abs() < 1e-12, "{ratio}");
                    assert!(
                        got >= last - 1e-3 && got <= 1.0 && slope >= 0.0,
                        "{fwhm_deg} {share} {ratio}: {got} {slope}"
                    );
                    assert!((table.by_share(ratio) + table.by_share(-ratio)).abs() < 1e-12);
                    last = got;
                }
            }
        }
    }

    #[test]
    fn the_slope_is_that_of_the_sine() {
        let table = usual();
        for i in -99..=99 {
            let (ratio, step) = (f64::from(i) / 100.0, 2e-3);
            let slope = (table.sine(ratio + step) - table.sine(ratio - step)) / (2.0 * step);
            assert!(
                (table.sine_and_slope(ratio).1 - slope).abs() < 0.05 * slope,
                "{ratio}: {} for {slope}",
                table.sine_and_slope(ratio).1
            );
        }
    }
}
