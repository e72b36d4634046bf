//! Every method of estimation as tests and benchmarks make it: the one place to add one.

use irhorizon::config::settings::Method;
use irhorizon::estimator::field::Tuning;
use irhorizon::estimator::{Estimator, FieldEstimator, InverseSineEstimator, ProfileEstimator};
use irhorizon::head::Head;
use irhorizon::sky::FieldOfView;

/// A fresh estimator by `method` for `head`, with what holds when the configuration says nothing.
pub fn estimator(method: Method, head: &Head) -> Box<dyn Estimator> {
    let field = FieldOfView::Gaussian { fwhm_deg: 90.0 };
    match method {
        Method::InverseSine => Box::new(InverseSineEstimator::new(head.clone(), 90.0, 3.0, 45.0)),
        Method::Profile => Box::new(ProfileEstimator::in_flight(head.clone(), field, 0.1, 3.0)),
        Method::Field => Box::new(FieldEstimator::new(head, field, Tuning { lag_s: 0.1, ..Tuning::default() })),
    }
}
