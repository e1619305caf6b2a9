//! Times as numbers of control periods.

/// Longest delay of the motor, and of all sensors in common \[s\].
pub(super) const LONGEST_S: f64 = 1.0;

/// Longest delay and sampling interval of one sensor \[s\].
pub(super) const LONGEST_SENSOR_S: f64 = 5.0;

/// A time that is no number of control periods.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TicksError {
    /// A time outside its range.
    #[error("{} ms is outside 0 to {} ms", .time_s * 1e3, .most_s * .period_s * 1e6)]
    Range {
        /// The time \[s\].
        time_s: f64,
        /// The control period \[s\].
        period_s: f64,
        /// Longest time at a control period of 1 ms \[s\].
        most_s: f64,
    },
    /// A part of a control period is left over.
    #[error(
        "{} ms is not a whole number of control periods of {} ms; nearest are {} ms and {} ms",
        .time_s * 1e3, .period_s * 1e3,
        (.time_s / .period_s).floor() * .period_s * 1e3, (.time_s / .period_s).ceil() * .period_s * 1e3
    )]
    Whole {
        /// The time \[s\].
        time_s: f64,
        /// The control period \[s\].
        period_s: f64,
    },
}

/// Number of control periods in a time, which must be an integer.
///
/// # Errors
/// States the time, and its range or the nearest times.
pub(super) fn whole_ticks(time_s: f64, period_s: f64, most_s: f64) -> Result<u16, TicksError> {
    let ticks = time_s / period_s;
    // The ranges refer to a control period of 1 ms.
    if !(0.0..=most_s * 1e3).contains(&ticks) {
        return Err(TicksError::Range { time_s, period_s, most_s });
    }
    if (ticks - ticks.round()).abs() > 1e-6 {
        return Err(TicksError::Whole { time_s, period_s });
    }
    Ok(ticks.round() as u16)
}
