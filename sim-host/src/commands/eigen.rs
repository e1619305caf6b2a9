//! Eigenvalues of the linearised bicycle over speed, and its critical speeds.

use super::CommandError;
use crate::bicycle::catalogue::Bicycle;
use crate::eigen::{
    CriticalSpeeds, Feedback, LinearActuator, Mode, Model, Stability, modes_until, roots, stability_until,
};
use crate::range::within;
use crate::report::document::EigenDocument;
use crate::report::resolved::{ResolvedBicycle, ResolvedCapsize, ResolvedLaw, ResolvedRider};
use crate::report::tool::{SCHEMA, Tool};
use crate::rider::compatibility_warnings;
use crate::scenario::LoadedRider;
use crate::scenario::speeds::FASTEST_M_S;
use control::{Capsize, Law};
use nalgebra::Complex;
use rayon::prelude::*;

/// Number of eigenvalues where there are infinitely many.
const ROOTS: usize = 12;

/// A bicycle with what steers it, and the speeds of the analysis.
#[derive(Clone, Debug)]
pub struct EigenTask {
    /// The bicycle.
    pub bicycle: Bicycle,
    /// The rider; `None` for a rigid one.
    pub rider: Option<LoadedRider>,
    /// The law, and its name.
    pub law: (String, Law),
    /// The added capsize term.
    pub capsize: Option<Capsize>,
    /// Between law and steer axis.
    pub actuator: LinearActuator,
    /// Forward speeds \[m/s\].
    pub speeds: Vec<f64>,
    /// Number of rightmost eigenvalues, if a rider or a delay makes infinitely many; `None` for 12.
    pub roots: Option<usize>,
}

/// Eigenvalues with their modes.
#[derive(Clone, Debug)]
pub struct Eigenvalues {
    /// The document.
    pub document: EigenDocument,
    /// Requested eigenvalues per speed.
    pub count: usize,
    /// Per speed the rightmost eigenvalues \[1/s\].
    pub values: Vec<Vec<Complex<f64>>>,
    /// The modes.
    pub modes: Vec<Mode>,
    /// Critical speeds and stable ranges \[m/s\].
    pub stability: Stability,
}

/// Computes the eigenvalues, on all cores of the current rayon pool. `stop` is called at every speed, and there are none once it
/// returns true.
///
/// # Errors
/// A speed out of range; an actuator or a speed that does not suit law and rider; eigenvalues that do not converge.
pub fn eigen_until(
    task: &EigenTask,
    stop: &(dyn Fn() -> bool + Sync),
) -> Result<Option<Eigenvalues>, CommandError> {
    let EigenTask { bicycle, rider, law: (law_name, law), actuator, speeds, .. } = task;
    if speeds.is_empty() {
        return Err(CommandError::choice("speeds", "none is given"));
    }
    for v in speeds {
        within("speed (m/s)", *v, -FASTEST_M_S, FASTEST_M_S)
            .map_err(|e| CommandError::choice("speeds", e))?;
    }
    let alone = *law == Law::None && rider.is_none() && task.capsize.is_none();
    if let (false, Some(v)) = (alone, speeds.iter().find(|v| **v < 0.0)) {
        let reason = "laws and riders are those of riding forward; below 0 only --law none without --rider and --capsize";
        return Err(CommandError::choice("speeds", format!("{v} m/s: {reason}")));
    }
    let count = match (rider, actuator.delay_s > 0.0) {
        (None, false) if task.roots.is_some() => {
            let reason =
                "without a rider and a delay of the actuator there are four eigenvalues, with its lag five";
            return Err(CommandError::Idle { name: "roots", reason });
        }
        (None, false) => 4 + usize::from(actuator.time_constant_s > 0.0),
        _ => task.roots.unwrap_or(ROOTS),
    };
    let capsize = task.capsize.unwrap_or_default();
    let feedback = Feedback::new(law.clone(), capsize);
    let model = Model::new(&bicycle.parameters, feedback, rider.as_ref().map(|one| one.rider.clone()));
    let model = model.with_actuator(*actuator)?;
    let Some(stability) = stability_until(&model, stop) else {
        return if stop() { Ok(None) } else { Err(CommandError::NoEigenvalue) };
    };
    let at = |&v: &f64| (!stop()).then(|| roots(&model.at(v), count));
    let Some(values) = speeds.par_iter().map(at).collect::<Option<Vec<_>>>() else { return Ok(None) };
    if values.iter().any(Vec::is_empty) {
        return Err(CommandError::NoEigenvalue);
    }
    let Some(modes) = modes_until(&model, speeds, count, stop) else { return Ok(None) };
    let CriticalSpeeds { v_d, v_w, v_c } = stability.critical;
    let document = EigenDocument {
        schema: SCHEMA,
        tool: Tool::this(),
        bicycle: ResolvedBicycle::new(bicycle),
        rider: rider.as_ref().map(ResolvedRider::new),
        warnings: rider.as_ref().map_or(Vec::new(), |one| compatibility_warnings(bicycle, &one.table)),
        law: ResolvedLaw::new(law_name, law),
        capsize: ResolvedCapsize::new(&capsize),
        actuator: Some(*actuator).filter(|a| *a != LinearActuator::default()),
        v_d,
        v_w,
        v_c,
        stable_ranges: stability.ranges.iter().map(|&(from, to)| [from, to]).collect(),
        stability_changes: stability.changes.clone(),
        speeds: speeds.clone(),
        eigenvalues: values.iter().map(|of_speed| of_speed.iter().map(|e| [e.re, e.im]).collect()).collect(),
        modes: modes.iter().map(|mode| (mode.name.clone(), per_speed(mode, speeds.len()))).collect(),
    };
    Ok(Some(Eigenvalues { document, count, values, modes, stability }))
}

/// The roots of a mode at each speed, in the document's form.
fn per_speed(mode: &Mode, speeds: usize) -> Vec<Vec<[f64; 2]>> {
    let at = |i: usize| mode.roots.iter().filter_map(|root| root[i]).map(|e| [e.re, e.im]).collect();
    (0..speeds).map(at).collect()
}
