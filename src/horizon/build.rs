//! The estimator that the settings ask for.

use crate::config::Settings;
use crate::config::settings::{HeadSettings, Method};
use crate::estimator::field::Tuning;
use crate::estimator::{Estimator, FieldEstimator, InverseSineEstimator, ProfileEstimator};
use crate::head::Head;
use crate::sky::FieldOfView;

/// A fresh estimator by `method` for `head`.
pub fn estimator(settings: &Settings, method: Method, head: &Head) -> Box<dyn Estimator> {
    let (e, field_of_view_deg) = (&settings.estimator, settings.head.field_of_view_deg);
    let field = FieldOfView::Gaussian { fwhm_deg: field_of_view_deg };
    let range_s = e.range_time_constant_s;
    let lag_s = settings.head.lag_s.unwrap_or(HeadSettings::UNSAID_LAG_S);
    match method {
        Method::InverseSine => {
            let limit_deg = e.roll_limit_deg_for(method);
            Box::new(InverseSineEstimator::new(head.clone(), field_of_view_deg, range_s, limit_deg))
        }
        Method::Profile => Box::new(ProfileEstimator::in_flight(head.clone(), field, lag_s, range_s)),
        Method::Field => Box::new(FieldEstimator::new(head, field, Tuning { lag_s, ..Tuning::default() })),
    }
}
