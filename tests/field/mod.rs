//! The method `field` as its tests make it: the one place to change when its constructor does.

use irhorizon::estimator::FieldEstimator;
use irhorizon::estimator::field::Tuning;
use irhorizon::head::Head;
use irhorizon::sky::FieldOfView;

/// A fresh estimator for `head`, whose sensors are told to lag by `lag_s` and to see over 90°.
pub fn field(head: &Head, lag_s: f64) -> FieldEstimator {
    FieldEstimator::new(head, FieldOfView::Gaussian { fwhm_deg: 90.0 }, Tuning { lag_s, ..Tuning::default() })
}
