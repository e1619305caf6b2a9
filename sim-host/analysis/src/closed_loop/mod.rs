//! Identifies steer angle scale, control law and steer dynamics from a recording in which a controller closed the loop.
//!
//! `record` holds the samples, `checked` finds the usable ones. `steer_scale` needs only the kinematics of the bicycle;
//! `law` regresses the torque on the measured signals, `memory` fits a law with internal states, and `steer_dynamics` the
//! steer axis. They share `regress` (least squares with errors for correlated residuals), `collinear` (which signals a
//! closed loop leaves separable) and `smooth` (derivatives).
//!
//! Torque, steer and roll are positive to the right (axes of Meijaard et al. 2007).

mod checked;
mod collinear;
mod law;
mod memory;
mod output_error;
mod record;
mod regress;
mod smooth;
mod steer_dynamics;
mod steer_scale;

pub use checked::{Checked, RecordError, check};
pub use law::{Band, Gain, Law, Refused, law};
pub use memory::{MemoryLaw, Response, memory};
pub use record::{Channel, Record, Signal};
pub use regress::{Fit, Weights, regress};
pub use steer_dynamics::{Bracket, SteerDynamics, steer_dynamics};
pub use steer_scale::{Geometry, SteerScale, steer_scale};

/// A law of one instant is refused if it leaves this many times as much unexplained as one with internal states.
const WITHOUT_PAST: f64 = 4.0;

/// A part of the identification: its result, or the reason why the recording does not determine it.
#[derive(Clone, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
#[serde(untagged)]
pub enum Part<T> {
    /// The result.
    Found(T),
    /// No result.
    Not {
        /// The reason.
        cannot_be_identified: String,
    },
}

impl<T> Part<T> {
    /// No result, with the reason.
    pub fn not(reason: impl Into<String>) -> Self {
        Self::Not { cannot_be_identified: reason.into() }
    }

    /// The result, if there is one.
    pub const fn found(&self) -> Option<&T> {
        match self {
            Self::Found(result) => Some(result),
            Self::Not { .. } => None,
        }
    }

    /// The reason, if there is no result.
    pub fn reason(&self) -> Option<&str> {
        match self {
            Self::Found(_) => None,
            Self::Not { cannot_be_identified } => Some(cannot_be_identified),
        }
    }
}

/// Everything identified from a recording.
#[derive(Clone, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Identified {
    /// Time between two samples \[s\].
    pub period_s: f64,
    /// Duration of the recording \[s\].
    pub duration_s: f64,
    /// Part of the recording in which the torque changed \[s\].
    pub driven_s: f64,
    /// Largest torque, if the torque stood there: its limit \[N m\].
    pub limit_nm: Option<f64>,
    /// Fraction of the driven samples at this limit; left out of the law.
    pub at_limit: f64,
    /// Scale and offset of the steer angle, by kinematics.
    pub steer_scale: Part<SteerScale>,
    /// The torque as a function of the signals of one instant.
    pub law: Part<Law>,
    /// The torque as a function of the signals' past.
    pub memory: Part<MemoryLaw>,
    /// Inertia and friction of the steer axis.
    pub steer_dynamics: Part<SteerDynamics>,
}

/// Identifies all parts.
///
/// # Errors
/// A recording without usable samples.
pub fn identify(record: &Record, geometry: Option<&Geometry>) -> Result<Identified, RecordError> {
    let checked = check(record)?;
    let memory = memory(record, &checked);
    let law = law(record, &checked);
    let law = match (law.found(), memory.found()) {
        (Some(instant), Some(past))
            if past.states > 0 && 1.0 - instant.vaf_followed > WITHOUT_PAST * (1.0 - past.vaf) =>
        {
            Part::not("the torque depends on the past of the signals; see the law with internal states")
        }
        _ => law,
    };
    Ok(Identified {
        period_s: checked.period_s,
        duration_s: record.times_s[record.times_s.len() - 1] - record.times_s[0],
        driven_s: checked.seconds(&checked.driven),
        limit_nm: checked.limit_nm,
        at_limit: checked.limited,
        steer_scale: geometry.map_or_else(
            || {
                Part::not(
                    "wheelbase and steer axis tilt are not known: give --bicycle, or set them in the map",
                )
            },
            |geometry| steer_scale(record, &checked, geometry),
        ),
        memory,
        steer_dynamics: steer_dynamics(record, &checked),
        law,
    })
}
