//! The weave of the linear model at given speeds.

use crate::eigen::{ActuatorError, Feedback, LinearActuator, Model, roots};
use control::Law;
use nalgebra::{Complex, ComplexField};
use physics::bicycle::Parameters;

/// Upper eigenvalue of the weave \[1/s\] of a bicycle with a law and an actuator, at each of the speeds
/// \[m/s\]; `None` without a complex pair. At low speed caster and capsize can form a pair, too; the weave is
/// the pair with the smaller damping ratio.
///
/// # Errors
/// A value of the actuator is out of its range.
pub fn weave(
    bicycle: &Parameters,
    law: &Law,
    actuator: LinearActuator,
    speeds: &[f64],
) -> Result<Vec<Option<Complex<f64>>>, ActuatorError> {
    let model = Model::new(bicycle, Feedback::Law(law.clone()), None).with_actuator(actuator)?;
    let damping = |root: &Complex<f64>| -root.re / root.modulus();
    let least = |v: &f64| {
        let pairs = roots(&model.at(*v), 6).into_iter().filter(|root| root.im > 0.0);
        pairs.min_by(|a, b| damping(a).total_cmp(&damping(b)))
    };
    Ok(speeds.iter().map(least).collect())
}
