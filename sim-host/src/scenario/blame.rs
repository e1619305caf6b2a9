//! Which key is to blame for an error, and the range of its value.

use super::setting::DRAWS;
use super::speeds::{FASTEST_M_S, SpeedsError};
use super::text::decimal;
use super::text_error::TextError;
use super::ticks::TicksError;
use crate::basin::SearchError;
use crate::bicycle::{ParameterError, SetError};
use crate::parameters::{self, Rejected};
use crate::range::{RangeError, TimeError};
use crate::ride::ConditionsError;
use control::param::ParamError;
use std::error::Error;

/// The key of a search to blame.
pub(crate) fn search_key(error: &SearchError) -> &'static str {
    match error {
        SearchError::Order { .. } => "search.speeds",
        SearchError::Conditions(error) => conditions_key(error).unwrap_or("search"),
        _ => error.range().and_then(|error| error.key).unwrap_or("search"),
    }
}

/// The key of conditions to blame, if it is known.
pub(super) fn conditions_key(error: &ConditionsError) -> Option<&'static str> {
    match error {
        ConditionsError::Rider(_) => Some("rider"),
        ConditionsError::Plant(_) => Some(error.range().and_then(|error| error.key).unwrap_or("plant")),
        ConditionsError::IdealLaw => Some("assist"),
        _ => error.range().and_then(|error| error.key),
    }
}

/// The number outside its range that is the reason of an error, if there is one.
pub fn number<'a>(reason: &'a (dyn Error + 'static)) -> Option<&'a RangeError> {
    let of_text = || match reason.downcast_ref()? {
        TextError::Range(error) => Some(error),
        _ => None,
    };
    let of_search = || reason.downcast_ref::<SearchError>()?.range();
    reason.downcast_ref().or_else(of_text).or_else(of_search)
}

/// Smallest and largest allowed value, in the unit of the scenario's key, if the reason of an error is a number outside its range.
pub fn bounds(reason: &(dyn Error + 'static)) -> Option<(f64, f64)> {
    if let Some(error) = number(reason) {
        return Some(error.bounds());
    }
    if let Some(error) = reason.downcast_ref::<TextError>() {
        return match error {
            TextError::Time(error) => bounds(error),
            TextError::Speeds(error) => bounds(error),
            TextError::Draws(_) => Some((f64::from(*DRAWS.start()), f64::from(*DRAWS.end()))),
            _ => None,
        };
    }
    if let Some(TimeError::Range { max_s, .. }) = reason.downcast_ref() {
        return Some((0.0, *max_s));
    }
    if let Some(SpeedsError::Range { least_m_s, .. } | SpeedsError::Missing { least_m_s }) =
        reason.downcast_ref()
    {
        return Some((*least_m_s, FASTEST_M_S));
    }
    if let Some(TicksError::Range { period_s, most_s, .. }) = reason.downcast_ref() {
        return Some((0.0, most_s * period_s * 1e3));
    }
    if let Some(SetError::Parameter(ParameterError::Range { min, max, .. })) = reason.downcast_ref() {
        return Some((*min, *max));
    }
    let of_rejected = || match &reason.downcast_ref::<Rejected>()?.error {
        parameters::SetError::Range(error) => Some(error),
        _ => None,
    };
    let parameter: Option<&ParamError> = reason.downcast_ref().or_else(of_rejected);
    parameter.map(|error| (decimal(error.leaf.min), decimal(error.leaf.max)))
}
