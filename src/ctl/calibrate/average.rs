//! Means with their standard errors. Pure.

/// So many stretches are compared for a mean's standard error.
const STRETCHES: usize = 5;

/// The mean of some values.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mean {
    /// It.
    pub value: f64,
    /// Its standard error: by the means of five stretches, as values that follow each other are not
    /// independent.
    pub error: f64,
    /// The values' standard deviation.
    pub spread: f64,
    /// The difference between the largest and the smallest value.
    pub range: f64,
}

/// The mean of `values`, in the order of time; `None` of fewer than ten, or where one is no finite number.
pub fn mean(values: &[f64]) -> Option<Mean> {
    if values.len() < 2 * STRETCHES || !values.iter().all(|v| v.is_finite()) {
        return None;
    }
    let (value, spread) = moments(values);
    let length = values.len() / STRETCHES;
    let stretches: Vec<f64> = values.chunks_exact(length).take(STRETCHES).map(|c| moments(c).0).collect();
    let error = moments(&stretches).1 / (STRETCHES as f64).sqrt();
    let (least, most) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(*v), b.max(*v)));
    Some(Mean { value, error, spread, range: most - least })
}

/// Mean and standard deviation.
fn moments(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().map(|v| v / n).sum::<f64>();
    let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0).max(1.0);
    (mean, variance.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_constant_is_known_exactly_and_too_little_is_not_known() {
        let m = mean(&[1.25; 20]).unwrap();
        assert!((m.value - 1.25).abs() < 1e-12 && m.error < 1e-12 && m.spread < 1e-12 && m.range == 0.0, "{m:?}");
        assert_eq!((mean(&[]), mean(&[1.0; 9]), mean(&[f64::NAN; 20])), (None, None, None));
    }

    /// A drift shows in the standard error as independent noise of the same spread does not.
    #[test]
    fn a_drift_is_less_certain_than_noise() {
        let drift: Vec<f64> = (0..100).map(|i| f64::from(i) / 100.0).collect();
        let noise: Vec<f64> = (0..100).map(|i| f64::from(i * 37 % 100) / 100.0).collect();
        let (drift, noise) = (mean(&drift).unwrap(), mean(&noise).unwrap());
        assert!((drift.value - 0.495).abs() < 1e-9 && (noise.value - 0.495).abs() < 1e-9);
        assert!(drift.error > 5.0 * noise.error, "{drift:?} {noise:?}");
    }

    proptest! {
        #[test]
        fn it_lies_among_its_values(values in prop::collection::vec(-1e3_f64..1e3, 10..200)) {
            let m = mean(&values).unwrap();
            let least = values.iter().fold(f64::INFINITY, |a, b| a.min(*b));
            prop_assert!(m.value >= least - 1e-6 && m.value <= least + m.range + 1e-6);
            prop_assert!(m.error >= 0.0 && m.spread <= m.range + 1e-9);
        }
    }
}
