//! Is a number what it may be.

/// Accepts `value` from `min` to `max`; NaN never is.
///
/// # Errors
/// Names the value and the range.
pub(crate) fn within(name: &str, value: f64, min: f64, max: f64) -> Result<(), String> {
    if value >= min && value <= max {
        Ok(())
    } else {
        Err(format!("{name} = {value} is outside {min} to {max}"))
    }
}
