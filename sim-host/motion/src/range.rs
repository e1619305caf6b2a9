//! Range checks of numbers, and parsers of times and time intervals.

/// A number outside its allowed range, or NaN.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{name} = {} is outside {min} to {max}", plain(*.value))]
pub struct RangeError {
    /// Name of the quantity, with its unit.
    pub name: String,
    /// Key of the quantity in a scenario's file, with dots, where it has one.
    pub key: Option<&'static str>,
    /// The rejected value.
    pub value: f64,
    /// Smallest allowed value.
    pub min: f64,
    /// Largest allowed value.
    pub max: f64,
}

impl RangeError {
    /// Smallest and largest allowed value in the unit of the key: messages have angles in degrees, keys in radians.
    pub fn bounds(&self) -> (f64, f64) {
        let angle = self.key.is_some_and(|key| key.ends_with("_rad")) && self.name.ends_with("(deg)");
        if angle { (self.min.to_radians(), self.max.to_radians()) } else { (self.min, self.max) }
    }
}

/// Accepts `value` from `min` to `max`; rejects NaN.
///
/// # Errors
/// The name, the value and the range.
pub fn within(name: &str, value: f64, min: f64, max: f64) -> Result<(), RangeError> {
    if value >= min && value <= max {
        return Ok(());
    }
    Err(RangeError { name: name.into(), key: None, value, min, max })
}

/// As [`within`], of the value of a scenario's `key`.
///
/// # Errors
/// The key, the name, the value and the range.
pub fn within_key(key: &'static str, name: &str, value: f64, min: f64, max: f64) -> Result<(), RangeError> {
    within(name, value, min, max).map_err(|error| RangeError { key: Some(key), ..error })
}

/// A number as text, with an exponent if very small or very large.
pub fn plain(value: f64) -> String {
    if value == 0.0 || !value.is_finite() || (1e-9..1e16).contains(&value.abs()) {
        value.to_string()
    } else {
        format!("{value:e}")
    }
}

/// A text that is no time or time interval.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TimeError {
    /// Not a number with a unit of time.
    #[error("`{0}` is not a time; expected a number with its unit, for example 20ms or 0.02s")]
    Form(String),
    /// A time outside its range.
    #[error("{text} is outside 0 s to {max_s} s")]
    Range {
        /// The text.
        text: String,
        /// Longest time \[s\].
        max_s: f64,
    },
    /// An interval that ends before it begins.
    #[error("its end, {to_s} s, is not after {from_s} s")]
    Order {
        /// Its begin \[s\].
        from_s: f64,
        /// Its end \[s\].
        to_s: f64,
    },
}

/// Parses a time with its unit, from 0 to `max_s` \[s\].
///
/// # Errors
/// The text and the expected form.
pub fn time(text: &str, max_s: f64) -> Result<f64, TimeError> {
    let wrong = || TimeError::Form(text.into());
    let (number, per_s) = match text.strip_suffix("ms") {
        Some(number) => (number, 1e3),
        None => (text.strip_suffix('s').ok_or_else(wrong)?, 1.0),
    };
    let value = number.trim().parse::<f64>().map_err(|_| wrong())? / per_s;
    if (0.0..=max_s).contains(&value) {
        Ok(value)
    } else {
        Err(TimeError::Range { text: text.into(), max_s })
    }
}

/// Latest time in a ride at which an event can begin or end \[s\].
const LATEST_S: f64 = 3600.0;

/// Parses a time interval `FROM[..TO]`; without TO its end is infinite \[s\].
///
/// # Errors
/// The text and the expected form.
pub fn span(text: &str) -> Result<(f64, f64), TimeError> {
    let (from, to) = text.split_once("..").map_or((text, None), |(from, to)| (from, Some(to)));
    let from_s = time(from, LATEST_S)?;
    let to_s = to.map_or(Ok(f64::INFINITY), |to| time(to, LATEST_S))?;
    if to_s > from_s { Ok((from_s, to_s)) } else { Err(TimeError::Order { from_s, to_s }) }
}
