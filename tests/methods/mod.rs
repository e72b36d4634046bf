//! Every method of estimation as tests and benchmarks make it: the one place to add one.

use irhorizon::config::settings::Method;
use irhorizon::estimator::{Estimator, InverseSineEstimator};
use irhorizon::head::Head;

/// A fresh estimator by `method` for `head`, with what holds when the configuration says nothing.
pub fn estimator(method: Method, head: &Head) -> Box<dyn Estimator> {
    match method {
        Method::InverseSine => Box::new(InverseSineEstimator::new(head.clone(), 90.0, 3.0, 45.0)),
    }
}
