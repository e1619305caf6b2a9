//! Whether the back-EMF belongs to the encoder's speed: the only sign of an encoder that stands while the motor turns.

use super::follow_mean;
use crate::fault::Fault;
use crate::transform::Vector;
use control::param::{ParamSpec, ParamVisitor};

/// How far the voltage may be off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BackEmfConfig {
    /// Largest mean distance between the voltage applied and that which current and speed explain \[V\].
    pub error_v: f32,
    /// Part of the resistance's voltage that comes on top: the resistance of copper rises by 40 % from 20 to 120 deg C.
    pub resistance_part: f32,
    /// Time constant of the mean \[calls\].
    pub mean_ticks: u16,
}

impl BackEmfConfig {
    /// Shows every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        to.number(&ParamSpec::new("emf", "error_v", 0.1, 50.0), &mut self.error_v);
        to.number(&ParamSpec::new("emf", "resistance_part", 0.0, 2.0), &mut self.resistance_part);
        to.count(&ParamSpec::new("emf", "mean_ticks", 1.0, 10_000.0), &mut self.mean_ticks);
    }
}

/// One call: `unexplained` is the voltage applied less that which current and speed explain, `resistive_v` what the
/// resistance should take of it, `dead_v` what the dead time takes of a phase. `mean_v` is remembered.
pub fn step(
    config: &BackEmfConfig,
    mean_v: &mut f32,
    unexplained: Vector,
    resistive_v: f32,
    dead_v: f32,
) -> Option<Fault> {
    let beyond = unexplained.length() - config.resistance_part * resistive_v - dead_v;
    follow_mean(mean_v, beyond, 1.0 / f32::from(config.mean_ticks));
    (*mean_v > config.error_v).then_some(Fault::VoltageAstray)
}
