//! A column of a recording that belongs to no sensor.

use super::extract::{column, times};
use super::map::Map;
use crate::recording::{Recording, Remark};

/// The values of a column over time \[s\], in the units of the file; blank cells are omitted.
///
/// # Errors
/// The column or the time does not exist.
pub fn over_time(recording: &Recording, map: &Map, name: &str) -> Result<Vec<(f64, f64)>, Remark> {
    let (group, found) = column(recording, name)
        .ok_or_else(|| Remark::of_column(Some(name), "there is no such column".into()))?;
    let times = times(group, map, None)?;
    let there = |(t_s, value): &(f64, f64)| t_s.is_finite() && !value.is_nan();
    Ok(times.into_iter().zip(found.values.iter().copied()).filter(there).collect())
}
