//! The estimator that the settings ask for.

use crate::config::Settings;
use crate::config::settings::{HeadSettings, Method};
use crate::estimator::field::Tuning;
use crate::estimator::{Estimator, FieldEstimator, InverseSineEstimator, ProfileEstimator};
use crate::head::Head;
use crate::sky::{Averaging, FieldOfView, PairCurve, Response, Sky};

/// A fresh estimator by `method` for `head`.
pub fn estimator(settings: &Settings, method: Method, head: &Head) -> Box<dyn Estimator> {
    let (e, field_of_view_deg) = (&settings.estimator, settings.head.field_of_view_deg);
    let field = FieldOfView::Gaussian { fwhm_deg: field_of_view_deg };
    let range_s = e.range_time_constant_s;
    match method {
        Method::InverseSine => {
            let limit_deg = e.roll_limit_deg_for(method);
            Box::new(InverseSineEstimator::new(head.clone(), field_of_view_deg, range_s, limit_deg))
        }
        Method::Profile => Box::new(ProfileEstimator::new(head.clone(), namibia(field), range_s)),
        Method::Field => {
            let lag_s = settings.head.lag_s.unwrap_or(HeadSettings::UNSAID_LAG_S);
            Box::new(FieldEstimator::new(head, field, Tuning { lag_s, ..Tuning::default() }))
        }
    }
}

/// What pairs with this field of view make of the report's Namibia sky, averaging temperature as the
/// report does.
fn namibia(field: FieldOfView) -> PairCurve {
    let Sky { shape, ground_c, sky_max_k } = Sky::NAMIBIA;
    Response::new(shape, field, Averaging::Temperature).pair_curve(ground_c, sky_max_k)
}
