//! Times as numbers of control periods.

/// Longest delay of the motor, and of all sensors in common \[s\].
pub(super) const LONGEST_S: f64 = 1.0;

/// Longest delay and sampling interval of one sensor \[s\].
pub(super) const LONGEST_SENSOR_S: f64 = 5.0;

/// Number of control periods in a time, which must be an integer. `name` begins the error's text.
///
/// # Errors
/// States the name, the time, and its range or the nearest times.
pub(super) fn whole_ticks(name: &str, time_s: f64, period_s: f64, most_s: f64) -> Result<u16, String> {
    let ticks = time_s / period_s;
    let name = if name.is_empty() { String::new() } else { format!("{name} ") };
    // The ranges refer to a control period of 1 ms.
    if !(0.0..=most_s * 1e3).contains(&ticks) {
        return Err(format!("{name}{} ms is outside 0 to {} ms", time_s * 1e3, most_s * period_s * 1e6));
    }
    if (ticks - ticks.round()).abs() > 1e-6 {
        let near = |n: f64| format!("{} ms", n * period_s * 1e3);
        return Err(format!(
            "{name}{} ms is not a whole number of control periods of {} ms; nearest are {} and {}",
            time_s * 1e3,
            period_s * 1e3,
            near(ticks.floor()),
            near(ticks.ceil())
        ));
    }
    Ok(ticks.round() as u16)
}
