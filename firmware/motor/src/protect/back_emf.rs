//! Checks the voltage against current and encoder speed; only this check detects a stuck encoder on a turning motor.

use super::follow_mean;
use crate::fault::Fault;
use crate::transform::Vector;
use control::param::{ParamSpec, ParamVisitor};

/// Tolerances of the voltage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BackEmfConfig {
    /// Largest mean difference between the applied voltage and that which current and speed explain \[V\].
    pub error_v: f32,
    /// Additional tolerance as a fraction of the resistive voltage: copper's resistance rises by 40 % from 20 to 120
    /// deg C.
    pub resistance_part: f32,
    /// Time constant of the mean \[calls\].
    pub mean_calls: u16,
}

impl BackEmfConfig {
    /// Visits every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        to.number(&ParamSpec::new("emf", "error_v", 0.1, 50.0), &mut self.error_v);
        to.number(&ParamSpec::new("emf", "resistance_part", 0.0, 2.0), &mut self.resistance_part);
        to.count(&ParamSpec::new("emf", "mean_calls", 1.0, 10_000.0), &mut self.mean_calls);
    }
}

/// One call: `unexplained` is the applied voltage less the part that current and speed explain, `resistive_v` the
/// expected resistive voltage, `dead_v` the dead-time voltage of a phase, `mean_v` the state.
pub fn step(
    config: &BackEmfConfig,
    mean_v: &mut f32,
    unexplained: Vector,
    resistive_v: f32,
    dead_v: f32,
) -> Option<Fault> {
    let beyond = unexplained.length() - config.resistance_part * resistive_v - dead_v;
    follow_mean(mean_v, beyond, 1.0 / f32::from(config.mean_calls));
    (*mean_v > config.error_v).then_some(Fault::VoltageResidual)
}
