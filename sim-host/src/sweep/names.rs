//! Names of a sweep's variables: the axes and the results.

use super::{Axis, SweepError};

/// Names of the variables other than the axes'.
const RESULTS: [&str; 11] = [
    "speed",
    "height",
    "capped",
    "peak_torque",
    "rms_torque",
    "peak_slew",
    "fall_cause",
    "area",
    "mean_height",
    "area_capped",
    "complete",
];

/// Variable name of an axis.
pub(super) fn variable(axis: &Axis) -> String {
    axis.key.replace('-', "_")
}

/// Checks that the names of the axes are unique and differ from those of the results.
///
/// # Errors
/// States the key.
pub fn check(axes: &[Axis]) -> Result<(), SweepError> {
    for (i, axis) in axes.iter().enumerate() {
        let name = variable(axis);
        let reason = if axes[..i].iter().any(|other| variable(other) == name) {
            "is listed twice"
        } else if RESULTS.contains(&&*name) {
            "is the name of a result; choose another"
        } else {
            continue;
        };
        return Err(SweepError::Name { key: axis.key.clone(), reason });
    }
    Ok(())
}
