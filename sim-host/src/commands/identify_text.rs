//! Choices of an identification as text, for the command line, documents and scripts.

use crate::identify::{Drift, Select};
use crate::range::{RangeError, within};

/// A text that is no choice.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ChoiceTextError {
    /// Another form.
    #[error("expected {0}")]
    Form(&'static str),
    /// No percentage.
    #[error("expected a percentage from 0 to 100")]
    Percent,
    /// A number outside its range.
    #[error(transparent)]
    Range(#[from] RangeError),
}

impl ChoiceTextError {
    /// Smallest and largest allowed value, if a number is outside its range.
    pub fn range(&self) -> Option<(f64, f64)> {
        match self {
            Self::Form(_) => None,
            Self::Percent => Some((0.0, 100.0)),
            Self::Range(error) => Some(error.bounds()),
        }
    }
}

/// Parses a drift: none, offset, or a frequency such as 0.05Hz.
///
/// # Errors
/// The expected form or range.
pub fn drift(text: &str) -> Result<Drift, ChoiceTextError> {
    match text {
        "none" => Ok(Drift::None),
        "offset" => Ok(Drift::Offset),
        _ => {
            let wrong = || ChoiceTextError::Form("none, offset, or a frequency such as 0.05Hz");
            let hz =
                text.strip_suffix("Hz").and_then(|hz| hz.trim().parse::<f64>().ok()).ok_or_else(wrong)?;
            within("frequency (Hz)", hz, 1e-4, 0.5)?;
            Ok(Drift::Below(hz))
        }
    }
}

/// The drift as [`drift`] reads it.
pub fn drift_name(drift: Drift) -> String {
    match drift {
        Drift::None => "none".into(),
        Drift::Offset => "offset".into(),
        Drift::Below(hz) => format!("{hz}Hz"),
    }
}

/// Parses a criterion that selects gains.
///
/// # Errors
/// The expected form.
pub fn select(text: &str) -> Result<Select, ChoiceTextError> {
    match text {
        "full" => Ok(Select::Full),
        "aic" => Ok(Select::Aic),
        "bic" => Ok(Select::Bic),
        "held" => Ok(Select::CrossValidated),
        _ => match text.split_once(':') {
            Some(("vaf", number)) => percent(number).map(Select::Vaf),
            Some(("onset", number)) => percent(number).map(Select::Onset),
            _ => Err(ChoiceTextError::Form("full, vaf:PERCENT, onset:PERCENT, aic, bic or held")),
        },
    }
}

/// The criterion as [`select`] reads it.
pub fn select_name(select: Select) -> String {
    match select {
        Select::Full => "full".into(),
        Select::Vaf(vaf) => format!("vaf:{}", 100.0 * vaf),
        Select::Onset(vaf) => format!("onset:{}", 100.0 * vaf),
        Select::Aic => "aic".into(),
        Select::Bic => "bic".into(),
        Select::CrossValidated => "held".into(),
    }
}

/// Parses a percentage as a fraction.
///
/// # Errors
/// The expected range.
pub fn percent(text: &str) -> Result<f64, ChoiceTextError> {
    let value = text.parse::<f64>().ok().filter(|x| (0.0..=100.0).contains(x));
    value.map(|x| x / 100.0).ok_or(ChoiceTextError::Percent)
}
