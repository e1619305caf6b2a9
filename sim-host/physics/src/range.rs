//! Range checks of numbers, and parsers of times and time intervals.

/// Accepts `value` from `min` to `max`; rejects NaN.
///
/// # Errors
/// States the name, the value and the range.
pub fn within(name: &str, value: f64, min: f64, max: f64) -> Result<(), String> {
    if value >= min && value <= max {
        Ok(())
    } else {
        Err(format!("{name} = {} is outside {min} to {max}", plain(value)))
    }
}

/// A number as text, with an exponent if very small or very large.
pub fn plain(value: f64) -> String {
    if value == 0.0 || !value.is_finite() || (1e-9..1e16).contains(&value.abs()) {
        value.to_string()
    } else {
        format!("{value:e}")
    }
}

/// Parses a time with its unit, from 0 to `max` \[s\].
///
/// # Errors
/// States the text and the expected form.
pub fn time(text: &str, max: f64) -> Result<f64, String> {
    let wrong =
        || format!("`{text}` is not a time; expected a number with its unit, for example 20ms or 0.02s");
    let (number, per_s) = match text.strip_suffix("ms") {
        Some(number) => (number, 1e3),
        None => (text.strip_suffix('s').ok_or_else(wrong)?, 1.0),
    };
    let value = number.trim().parse::<f64>().map_err(|_| wrong())? / per_s;
    if (0.0..=max).contains(&value) { Ok(value) } else { Err(format!("{text} is outside 0 s to {max} s")) }
}

/// Latest time in a ride at which an event can begin or end \[s\].
const LATEST_S: f64 = 3600.0;

/// Parses a time interval `FROM[..TO]`; without TO its end is infinite \[s\].
///
/// # Errors
/// States the text and the expected form.
pub fn span(text: &str) -> Result<(f64, f64), String> {
    let (from, to) = text.split_once("..").map_or((text, None), |(from, to)| (from, Some(to)));
    let from_s = time(from, LATEST_S)?;
    let to_s = to.map_or(Ok(f64::INFINITY), |to| time(to, LATEST_S))?;
    if to_s > from_s {
        Ok((from_s, to_s))
    } else {
        Err(format!("its end, {to_s} s, is not after {from_s} s"))
    }
}
