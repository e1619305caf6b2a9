//! The linear model's weave.

use crate::bicycle::Parameters;
use crate::eigen::{Feedback, LinearActuator, Model, roots};
use control::Law;
use nalgebra::Complex;

/// The upper eigenvalue of the rightmost pair \[1/s\] of a bicycle under a law that an actuator turns into torque, at each of
/// the speeds \[m/s\]; `None` where there is no pair.
///
/// # Errors
/// A value of the actuator out of its range.
pub fn weave(
    bicycle: &Parameters,
    law: &Law,
    actuator: LinearActuator,
    speeds: &[f64],
) -> Result<Vec<Option<Complex<f64>>>, String> {
    let model = Model::new(bicycle, Feedback::Law(law.clone()), None).with_actuator(actuator)?;
    let pair = |v: &f64| roots(&model.at(*v), 6).into_iter().find(|root| root.im > 0.0);
    Ok(speeds.iter().map(pair).collect())
}
